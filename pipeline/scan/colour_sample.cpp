#include "pipeline/scan/colour_sample.h"

namespace sparsha::pipeline {

std::vector<std::string_view> sampled_lines(std::string_view text) {
  constexpr std::size_t kAll = std::size_t{4} << 20;
  constexpr std::size_t kParts = 256;
  constexpr std::size_t kPart = kAll / kParts;
  constexpr std::string_view kEnds = "\r\n";
  if (text.size() <= kAll) return {text};
  std::vector<std::string_view> parts;
  for (std::size_t k = 0; k < kParts; ++k) {
    const std::size_t place = k + 1 < kParts ? (text.size() - kPart) / (kParts - 1) * k : text.size() - kPart;
    std::string_view part = text.substr(place, kPart);
    if (k > 0) part.remove_prefix(std::min(part.find_first_of(kEnds), part.size()));  // the end of another line
    if (k + 1 < kParts) part = part.substr(0, part.find_last_of(kEnds) + 1);          // npos + 1: no line ends here
    if (!part.empty()) parts.push_back(part);
  }
  return parts;
}

}  // namespace sparsha::pipeline
