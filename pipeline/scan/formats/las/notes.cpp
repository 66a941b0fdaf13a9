#include "pipeline/scan/formats/las/notes.h"

#include <algorithm>

#include <fmt/format.h>

#include "pipeline/scan/formats/las/fields.h"
#include "pipeline/scan/text.h"

namespace sparsha::pipeline::las {
namespace {

/// A field of so many bytes that ends at its first zero, without blanks around it.
std::string text_at(std::string_view bytes) {
  bytes = bytes.substr(0, bytes.find('\0'));
  bytes.remove_prefix(std::min(bytes.find_first_not_of(' '), bytes.size()));
  return printable(bytes.substr(0, bytes.find_last_not_of(' ') + 1));
}

/// The first name in WKT is that of the whole.
std::string name_in_wkt(const Header& header) {
  for (const Record& record : header.records) {
    if (!record.is_reference(kWkt)) continue;
    const std::size_t begin = record.data.find('"');
    if (begin == std::string_view::npos) continue;
    return printable(record.data.substr(begin + 1, record.data.find('"', begin + 1) - begin - 1));
  }
  return {};
}

/// Of GeoTIFF's texts the first part.
std::string name_in_keys(const Header& header) {
  for (const Record& record : header.records) {
    if (record.is_reference(kGeoText)) return text_at(record.data.substr(0, record.data.find('|')));
  }
  return {};
}

/// Of both the one that the header says, as with units.
std::string reference_of(const Header& header) {
  const std::string wkt = name_in_wkt(header), keys = name_in_keys(header);
  return wkt.empty() || (!header.says_wkt && !keys.empty()) ? keys : wkt;
}

/// LAS 1.4 R15, 2.4: formats 6 and above have their reference as WKT, and no number of points in the old place.
void add_broken_rules(const ScanFile& file, const Header& header, std::vector<std::string>& notes) {
  if (header.minor < 4 || header.format < 6) return;
  constexpr std::size_t kOldPoints = 107;
  const std::string format = std::to_string(header.format);
  if (!header.says_wkt)
    notes.push_back("LAS: points of format " + format + " should have their reference as WKT, the header denies it");
  if (const auto old = load<std::uint32_t>(file.bytes.data() + kOldPoints); old != 0)
    notes.push_back("LAS: points of format " + format +
                    " should have no number in the old place of the header, it has " + std::to_string(old));
}

/// What the points have and nobody reads.
void add_unread(const Header& header, std::vector<std::string>& notes) {
  if (header.format == 4 || header.format == 5 || header.format >= 9)
    notes.emplace_back("LAS: wave packets, which are not read");
  if (const std::size_t bytes = undescribed_bytes(header); bytes > 0) {
    notes.push_back(fmt::format("LAS: {} byte{} behind each point, which the file does not describe, {} not read",
                                bytes, bytes == 1 ? "" : "s", bytes == 1 ? "is" : "are"));
  }
}

}  // namespace

std::vector<std::string> notes_of(const ScanFile& file, const Header& header) {
  constexpr std::size_t kSystem = 26, kSoftware = 58, kField = 32;
  std::vector<std::string> notes;
  const auto add = [&](const char* what, const std::string& text) {
    if (!text.empty()) notes.push_back(what + text);
  };
  add("LAS: written by ", text_at(file.bytes.substr(kSoftware, kField)));
  add("LAS: system ", text_at(file.bytes.substr(kSystem, kField)));
  add("LAS: coordinates of ", reference_of(header));
  add_broken_rules(file, header, notes);
  add_unread(header, notes);
  return notes;
}

}  // namespace sparsha::pipeline::las
