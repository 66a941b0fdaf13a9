#include "pipeline/scan/formats/las/notes.h"

#include <algorithm>

#include "pipeline/scan/text.h"

namespace sparsha::pipeline::las {
namespace {

constexpr std::uint16_t kWkt = 2112, kGeoText = 34737;

/// A field of so many bytes that ends at its first zero, without blanks around it.
std::string text_at(std::string_view bytes) {
  bytes = bytes.substr(0, bytes.find('\0'));
  bytes.remove_prefix(std::min(bytes.find_first_not_of(' '), bytes.size()));
  return printable(bytes.substr(0, bytes.find_last_not_of(' ') + 1));
}

/// The first name in WKT is that of the whole; of GeoTIFF's texts the first part.
std::string reference_of(const Header& header) {
  for (const Record& record : header.records) {
    if (record.id != kWkt || record.user != "LASF_Projection") continue;
    const std::size_t begin = record.data.find('"');
    if (begin == std::string_view::npos) continue;
    return printable(record.data.substr(begin + 1, record.data.find('"', begin + 1) - begin - 1));
  }
  for (const Record& record : header.records) {
    if (record.id == kGeoText && record.user == "LASF_Projection") {
      return text_at(record.data.substr(0, record.data.find('|')));
    }
  }
  return {};
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
  return notes;
}

}  // namespace sparsha::pipeline::las
