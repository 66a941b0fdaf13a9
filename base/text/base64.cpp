#include "base/text/base64.h"

#include <openssl/evp.h>

#include <algorithm>
#include <cstddef>
#include <iterator>

namespace sparsha {
namespace {

// OpenSSL counts bytes as int: texts go through it in parts that end where four digits and three bytes do.
constexpr std::size_t kDigits = std::size_t{1} << 24U, kBytes = kDigits / 4 * 3;

const unsigned char* bytes_of(std::string_view text) { return reinterpret_cast<const unsigned char*>(text.data()); }

}  // namespace

std::string to_base64(std::string_view bytes) {
  std::string text((bytes.size() + 2) / 3 * 4 + 1, '\0');  // and the zero that OpenSSL writes behind it
  std::size_t length = 0;
  for (; !bytes.empty(); bytes.remove_prefix(std::min(kBytes, bytes.size()))) {
    const int digits = EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data() + length), bytes_of(bytes),
                                       static_cast<int>(std::min(kBytes, bytes.size())));
    length += static_cast<std::size_t>(digits);
  }
  text.resize(length);
  return text;
}

bool from_base64(std::string_view text, std::string& bytes) {
  std::string packed;
  packed.reserve(text.size());
  std::copy_if(text.begin(), text.end(), std::back_inserter(packed),
               [](char c) { return c != ' ' && c != '\t' && c != '\r' && c != '\n'; });
  const std::size_t end = packed.find_last_not_of('=') + 1;
  if (packed.size() % 4 != 0 || packed.find('=') < end || packed.size() - end > 2) return false;
  bytes.assign(packed.size() / 4 * 3, '\0');
  for (std::size_t at = 0; at < packed.size(); at += kDigits) {
    const std::string_view part = std::string_view(packed).substr(at, kDigits);
    if (EVP_DecodeBlock(reinterpret_cast<unsigned char*>(bytes.data() + at / 4 * 3), bytes_of(part),
                        static_cast<int>(part.size())) < 0) {
      return false;
    }
  }
  bytes.resize(bytes.size() - (packed.size() - end));
  return true;
}

}  // namespace sparsha
