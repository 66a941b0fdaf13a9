// APPNOTE of PKWARE, without ZIP64, split archives and encryption.
#include "pipeline/scan/formats/threemf/zip.h"

#include <zlib.h>

#include <algorithm>

#include <fmt/format.h>

#include "base/text/lower_case.h"
#include "pipeline/scan/inflate.h"
#include "pipeline/scan/text.h"

namespace sparsha::pipeline {
namespace {

constexpr std::size_t kEnd = 22, kEntry = 46, kLocal = 30;  // bytes without names and remarks

std::uint16_t word(std::string_view bytes, std::size_t at) { return load<std::uint16_t>(bytes.data() + at); }
std::uint32_t number(std::string_view bytes, std::size_t at) { return load<std::uint32_t>(bytes.data() + at); }

std::string key_of(std::string_view name) {
  if (name.starts_with('/')) name.remove_prefix(1);
  return lower_case(name);
}

}  // namespace

ZipArchive::ZipArchive(const ScanFile& file) : file_(file) {
  const std::string_view bytes = file.bytes;
  constexpr std::size_t kMostRemark = 65535;
  const std::size_t from = bytes.size() - std::min(bytes.size(), kEnd + kMostRemark);
  const std::size_t end = bytes.rfind("PK\x05\x06");
  if (end == std::string_view::npos || end < from || bytes.size() - end < kEnd) {
    throw file.error("the zip archive has no directory at its end", "a complete file; it may be cut short");
  }
  const std::size_t count = word(bytes, end + 10);
  std::size_t at = number(bytes, end + 16);
  if (at == 0xFFFFFFFFU || count == 0xFFFFU) throw file.error("a zip archive of the kind ZIP64", "one below 4 GB");
  for (std::size_t i = 0; i < count; ++i) {
    if (at > end || end - at < kEntry || bytes.substr(at, 4) != "PK\x01\x02") {
      throw file.error(fmt::format("the directory of the zip archive has no entry {} at byte {}", i + 1, at),
                       "an undamaged file");
    }
    const std::size_t name = word(bytes, at + 28);
    const std::size_t size = kEntry + name + word(bytes, at + 30) + word(bytes, at + 32);
    if (end - at < size) throw file.error("the directory of the zip archive breaks off", "an undamaged file");
    parts_.push_back({key_of(bytes.substr(at + kEntry, name)), word(bytes, at + 8), word(bytes, at + 10),
                      number(bytes, at + 16), number(bytes, at + 20), number(bytes, at + 24), number(bytes, at + 42)});
    at += size;
  }
}

const ZipArchive::Part* ZipArchive::find(std::string_view name) const {
  const std::string key = key_of(name);
  const auto found = std::find_if(parts_.begin(), parts_.end(), [&](const Part& part) { return part.name == key; });
  return found == parts_.end() ? nullptr : &*found;
}

std::string ZipArchive::read(std::string_view name) const {
  const Part* const part = find(name);
  if (part == nullptr) throw file_.error("the archive has no part " + in_quotes(name), "a whole 3MF package");
  const auto error = [&](const char* what) {
    return file_.error("the archive's part " + in_quotes(name) + " " + what, "an undamaged file");
  };
  const std::string_view bytes = file_.bytes;
  const std::size_t place = part->place;
  if (place > bytes.size() || bytes.size() - place < kLocal || bytes.substr(place, 4) != "PK\x03\x04") {
    throw error("is not where the directory says");
  }
  const std::size_t begin = place + kLocal + word(bytes, place + 26) + word(bytes, place + 28);
  if (begin > bytes.size() || bytes.size() - begin < part->packed) throw error("does not fit the file");
  if ((part->flags & 1U) != 0) throw error("is encrypted");
  const std::string_view packed = bytes.substr(begin, part->packed);
  std::string text;
  constexpr std::size_t kSmall = 64'000'000, kMostRatio = 100;
  if (part->size > kSmall && part->size / kMostRatio > packed.size()) throw error("unpacks to far more than it holds");
  if (part->method == 0) {
    text = packed;
  } else if (part->method == Z_DEFLATED) {
    Inflater in(packed, Inflater::Wrapping::none);
    text = in.read(part->size);
    if (!in.whole()) throw error("does not end where the directory says");
  } else {
    throw error("is packed in a way that is not known");
  }
  const auto checksum = crc32_z(0, reinterpret_cast<const Bytef*>(text.data()), text.size());
  if (text.size() != part->size || checksum != part->checksum) throw error("is damaged: its checksum is another one");
  return text;
}

}  // namespace sparsha::pipeline
