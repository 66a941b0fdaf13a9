#include "base/yaml/yaml_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

#include "base/text/base64.h"
#include "base/text/utf8.h"

namespace sparsha::yaml {
namespace {

/// What YAML does not let stand in a text as it is, or an editor may change.
bool must_be_escaped(std::uint32_t code) {
  return code < 0x20 || (code >= 0x7F && code < 0xA0) || code == 0x2028 || code == 0x2029 || code == 0xFEFF ||
         code == 0xFFFE || code == 0xFFFF;
}

}  // namespace

std::string quoted(std::string_view text) {
  if (!is_utf8(text)) return "!!binary \"" + to_base64(text) + "\"";
  std::string result = "\"";
  while (!text.empty()) {
    const Utf8Character c = first_utf8(text);
    if (c.code == '"' || c.code == '\\') {
      result += '\\';
      result += static_cast<char>(c.code);
    } else if (c.code == '\n') {
      result += "\\n";
    } else if (must_be_escaped(c.code)) {
      result += c.code < 0x100 ? fmt::format("\\x{:02x}", c.code) : fmt::format("\\u{:04x}", c.code);
    } else {
      result += text.substr(0, c.bytes);
    }
    text.remove_prefix(c.bytes);
  }
  return result + '"';
}

std::string comment(std::string_view text) {
  std::string result;
  while (!text.empty()) {
    const Utf8Character c = first_utf8(text);
    if (c.bytes == 0 || must_be_escaped(c.code)) {
      result += '?';
    } else {
      result += text.substr(0, c.bytes);
    }
    text.remove_prefix(std::max<std::size_t>(c.bytes, 1));
  }
  return result;
}

}  // namespace sparsha::yaml
