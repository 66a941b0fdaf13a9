#include "base/yaml_text.h"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <algorithm>
#include <cstdint>

#include "base/utf8.h"

namespace sparsha::yaml {
namespace {

/// What YAML does not let stand in a text as it is, or an editor may change.
bool must_be_escaped(std::uint32_t code) {
  return code < 0x20 || (code >= 0x7F && code < 0xA0) || code == 0x2028 || code == 0x2029 || code == 0xFEFF ||
         code == 0xFFFE || code == 0xFFFF;
}

const unsigned char* bytes_of(std::string_view text) { return reinterpret_cast<const unsigned char*>(text.data()); }

std::string to_base64(std::string_view bytes) {
  std::string text((bytes.size() + 2) / 3 * 4 + 1, '\0');
  const int length =
      EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()), bytes_of(bytes), static_cast<int>(bytes.size()));
  text.resize(static_cast<std::size_t>(length));
  return text;
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

bool from_base64(std::string_view text, std::string& bytes) {
  std::string packed;
  std::copy_if(text.begin(), text.end(), std::back_inserter(packed),
               [](char c) { return c != ' ' && c != '\t' && c != '\r' && c != '\n'; });
  const std::size_t end = packed.find_last_not_of('=') + 1;
  if (packed.size() % 4 != 0 || packed.find('=') < end || packed.size() - end > 2 || packed.size() > (1U << 20))
    return false;
  bytes.assign(packed.size() / 4 * 3, '\0');
  const int length = EVP_DecodeBlock(reinterpret_cast<unsigned char*>(bytes.data()), bytes_of(packed),
                                     static_cast<int>(packed.size()));
  if (length < 0) return false;
  bytes.resize(static_cast<std::size_t>(length) - (packed.size() - end));
  return true;
}

}  // namespace sparsha::yaml
