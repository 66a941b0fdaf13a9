#include "pipeline/report/base64.h"

#include <cstddef>
#include <cstdint>

namespace sparsha::pipeline {

void append_base64(std::string& text, const std::string& bytes) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const std::size_t begin = text.size();
  text.resize(begin + (bytes.size() + 2) / 3 * 4);
  char* out = text.data() + begin;
  for (std::size_t k = 0; k < bytes.size(); k += 3) {
    std::uint32_t word = 0;
    for (std::size_t n = 0; n < 3; ++n)
      word = word << 8 | (k + n < bytes.size() ? static_cast<unsigned char>(bytes[k + n]) : 0U);
    for (std::size_t n = 0; n < 4; ++n) *out++ = k + n <= bytes.size() ? kDigits[word >> (18 - 6 * n) & 63U] : '=';
  }
}

}  // namespace sparsha::pipeline
