#include "base/text/html.h"

#include <cstddef>

#include "base/text/utf8.h"

namespace sparsha {
std::string escape_html(std::string_view text) {
  std::string result;
  for (std::size_t k = 0; k < text.size();) {
    const std::size_t length = first_utf8(text.substr(k)).bytes;
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
