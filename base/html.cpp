#include "base/html.h"

#include <cstddef>

namespace sparsha {
namespace {

/// Length of the valid UTF-8 sequence at the start of `text`, 0 when there is none.
std::size_t utf8_length(std::string_view text) {
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
  const unsigned first = byte(0);
  const std::size_t length = first < 0x80 ? 1 : first >> 5 == 6 ? 2 : first >> 4 == 14 ? 3 : first >> 3 == 30 ? 4 : 0;
  if (length == 0 || length > text.size()) return 0;
  unsigned code = length == 1 ? first : first & (0xFFU >> (length + 1));
  for (std::size_t k = 1; k < length; ++k) {
    if (byte(k) >> 6 != 2) return 0;
    code = code << 6 | (byte(k) & 0x3FU);
  }
  constexpr unsigned kLeast[] = {0, 0, 0x80, 0x800, 0x10000};
  return code < kLeast[length] || code > 0x10FFFF || (code >> 11) == 0x1B ? 0 : length;
}

}  // namespace

std::string escape_html(std::string_view text) {
  std::string result;
  for (std::size_t k = 0; k < text.size();) {
    const std::size_t length = utf8_length(text.substr(k));
    if (length == 0) {
      result += "\uFFFD";
      ++k;
      continue;
    }
    const std::string_view symbol = text.substr(k, length);
    k += length;
    if (symbol == "&")
      result += "&amp;";
    else if (symbol == "<")
      result += "&lt;";
    else if (symbol == ">")
      result += "&gt;";
    else if (symbol == "\"")
      result += "&quot;";
    else if (symbol == "'")
      result += "&#39;";
    else
      result += symbol;
  }
  return result;
}

}  // namespace sparsha
