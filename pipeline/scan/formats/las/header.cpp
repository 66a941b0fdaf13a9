#include "pipeline/scan/formats/las/header.h"

#include <algorithm>
#include <cmath>

#include "pipeline/scan/scalar.h"
#include "pipeline/scan/text.h"

namespace sparsha::pipeline::las {
namespace {

// Fewest bytes of a point, by format (LAS 1.4 R15, tables 7 to 17).
constexpr std::array<std::size_t, 11> kPointSize = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
constexpr std::size_t kLeastHeader = 227;
constexpr std::size_t kHeader14 = 375;
constexpr std::size_t kRecordHeader = 54;
constexpr std::size_t kLongRecordHeader = 60;

std::string text_field(std::string_view bytes) { return std::string(bytes.substr(0, bytes.find('\0'))); }

/// Records between the header and the points. A wrong number of them does no harm: the points' place is known.
void read_records(const ScanFile& file, std::size_t begin, std::uint64_t count, Header& header) {
  const std::string_view bytes = file.bytes;
  std::size_t at = begin;
  for (std::uint64_t i = 0; i < count; ++i) {
    const bool fits = header.first_point >= at + kRecordHeader &&
                      load<std::uint16_t>(bytes.data() + at + 20) <= header.first_point - at - kRecordHeader;
    if (!fits) {
      header.warnings.push_back("the header promises " + std::to_string(count) + " variable length records, only " +
                                std::to_string(i) + " are there");
      return;
    }
    const std::size_t length = load<std::uint16_t>(bytes.data() + at + 20);
    header.records.push_back({text_field(bytes.substr(at + 2, 16)), load<std::uint16_t>(bytes.data() + at + 18),
                              bytes.substr(at + kRecordHeader, length)});
    at += kRecordHeader + length;
  }
}

/// Records behind the points, LAS 1.4.
void read_long_records(const ScanFile& file, Header& header) {
  const std::string_view bytes = file.bytes;
  std::uint64_t at = load<std::uint64_t>(bytes.data() + 235);
  const std::uint32_t count = load<std::uint32_t>(bytes.data() + 243);
  for (std::uint32_t i = 0; i < count; ++i) {
    if (at > bytes.size() || bytes.size() - at < kLongRecordHeader) return;
    const std::uint64_t length = load<std::uint64_t>(bytes.data() + at + 20);
    if (length > bytes.size() - at - kLongRecordHeader) return;
    header.records.push_back({text_field(bytes.substr(at + 2, 16)), load<std::uint16_t>(bytes.data() + at + 18),
                              bytes.substr(at + kLongRecordHeader, length)});
    at += kLongRecordHeader + length;
  }
}

/// From LAS 1.3 on, waveforms and long records may follow the points; where they do, the header says.
std::size_t end_of_points(const ScanFile& file, const Header& header) {
  std::size_t end = file.bytes.size();
  const auto followed_from = [&](std::size_t place) {
    const auto begin = load<std::uint64_t>(file.bytes.data() + place);
    const std::uint64_t points = header.first_point + header.points * header.record_size;
    if (begin >= points && begin < end) end = static_cast<std::size_t>(begin);
  };
  if (header.minor >= 3) followed_from(227);
  if (header.minor >= 4 && load<std::uint32_t>(file.bytes.data() + 243) > 0) followed_from(235);
  return end;
}

void read_box(const char* header_bytes, Header& header) {
  const auto number = [&](std::size_t at) { return load<double>(header_bytes + at); };
  bool known = true;
  double longest = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    header.box_high[k] = number(179 + 16 * k);
    header.box_low[k] = number(187 + 16 * k);
    const double side = header.box_high[k] - header.box_low[k];
    known = known && std::isfinite(side) && side >= 0.0;
    longest = std::max(longest, side);
  }
  header.box_side = known ? longest : 0.0;
}

void check_points(const ScanFile& file, std::size_t header_size, Header& header) {
  if (header.first_point < header_size) {
    throw file.error("the points should begin at byte " + std::to_string(header.first_point) +
                         ", within the header of " + std::to_string(header_size) + " bytes",
                     "points behind the header");
  }
  if (header.first_point > file.bytes.size()) {
    throw file.error("the points should begin at byte " + std::to_string(header.first_point) + ", the file has " +
                         std::to_string(file.bytes.size()),
                     "a complete file");
  }
  if (header.compressed) return;
  const std::uint64_t whole = (file.bytes.size() - header.first_point) / header.record_size;
  if (header.points > whole) {
    throw file.error("the header promises " + std::to_string(header.points) + " points, only " + std::to_string(whole) +
                         " whole ones are in the file",
                     "a complete file; it may be cut short");
  }
  const std::uint64_t room = (end_of_points(file, header) - header.first_point) / header.record_size;
  if (header.points >= room) return;
  if (has_translated_line_ends(file.bytes)) {
    throw file.error("its line feeds were turned into CR LF: the file was copied as text", "a copy of its bytes");
  }
  header.warnings.push_back("the file has room for " + std::to_string(room) + " points, its header promises " +
                            std::to_string(header.points) + "; the others are left out");
}

}  // namespace

bool Record::is_reference(std::uint16_t of) const {
  return id == of && (user == "LASF_Projection" || (of == kWkt && user == "liblas"));
}

std::size_t Header::colour_offset() const {
  switch (format) {
    case 2:
      return 20;
    case 3:
    case 5:
      return 28;
    case 7:
    case 8:
    case 10:
      return 30;
    default:
      return 0;
  }
}

std::size_t Header::extra_offset() const { return kPointSize[static_cast<std::size_t>(format)]; }

Header parse_header(const ScanFile& file) {
  const std::string_view bytes = file.bytes;
  if (bytes.size() < kLeastHeader) throw file.error("the LAS header breaks off", "227 bytes and more");
  const char* const p = bytes.data();
  Header header;
  header.minor = load<std::uint8_t>(p + 25);
  const int major = load<std::uint8_t>(p + 24);
  if (major != 1 || header.minor > 4) {
    throw file.error("LAS version " + std::to_string(major) + "." + std::to_string(header.minor), "1.0 to 1.4");
  }
  constexpr unsigned kIsWkt = 16;
  header.says_wkt = (load<std::uint16_t>(p + 6) & kIsWkt) != 0;
  const std::size_t size = load<std::uint16_t>(p + 94);
  const std::size_t least = header.minor >= 4 ? kHeader14 : kLeastHeader;
  if (size < least || size > bytes.size()) {
    throw file.error("a LAS header of " + std::to_string(size) + " bytes", std::to_string(least) + " and more");
  }
  header.first_point = load<std::uint32_t>(p + 96);
  const int format = load<std::uint8_t>(p + 104);
  header.compressed = (format & 0xC0) != 0;
  if ((format & 0xC0) == 0xC0)
    throw file.error("points packed by a trial version of LASzip", "LAZ of LASzip 2 or later");
  header.format = format & 0x3F;
  if (header.format >= static_cast<int>(kPointSize.size())) {
    throw file.error("LAS point format " + std::to_string(header.format), "0 to 10");
  }
  header.record_size = load<std::uint16_t>(p + 105);
  if (header.record_size < kPointSize[static_cast<std::size_t>(header.format)]) {
    throw file.error("LAS points of format " + std::to_string(header.format) + " in " +
                         std::to_string(header.record_size) + " bytes",
                     std::to_string(kPointSize[static_cast<std::size_t>(header.format)]) + " and more");
  }
  header.points = load<std::uint32_t>(p + 107);
  if (header.minor >= 4 && load<std::uint64_t>(p + 247) != 0) {
    const std::uint64_t legacy = header.points;
    header.points = load<std::uint64_t>(p + 247);
    if (legacy != 0 && legacy != header.points && !header.compressed) {
      header.warnings.push_back("the header promises " + std::to_string(header.points) + " points, in its old place " +
                                std::to_string(legacy) + "; the former is taken");
    }
  }
  for (std::size_t k = 0; k < 3; ++k) {
    header.scale[k] = load<double>(p + 131 + 8 * k);
    header.offset[k] = load<double>(p + 155 + 8 * k);
    if (!std::isfinite(header.scale[k]) || header.scale[k] == 0.0 || !std::isfinite(header.offset[k])) {
      throw file.error(
          "a LAS scale of " + std::to_string(header.scale[k]) + " or offset of " + std::to_string(header.offset[k]),
          "finite numbers, scales not zero");
    }
  }
  read_box(p, header);
  check_points(file, size, header);
  read_records(file, size, load<std::uint32_t>(p + 100), header);
  if (header.minor >= 4) read_long_records(file, header);
  return header;
}

}  // namespace sparsha::pipeline::las
