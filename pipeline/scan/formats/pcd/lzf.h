// Decompression of LZF, the byte-oriented LZ77 of binary_compressed PCD files, by liblzf.
#pragma once

#include <span>

namespace sparsha::pipeline {

/// No LZF stream of that many bytes can expand to more.
[[nodiscard]] constexpr std::size_t lzf_largest_output(std::size_t compressed) {
  return compressed > (~std::size_t{0} / 264) ? ~std::size_t{0} : compressed * 88 + 264;
}

/// Bytes that `in` expands to, or that it would if it were not damaged; needs no memory.
[[nodiscard]] std::size_t lzf_output_size(std::span<const char> in);

/// Expands `in` into exactly `out.size()` bytes; false when the stream is damaged or its length differs. Both below 4
/// GiB.
[[nodiscard]] bool lzf_decompress(std::span<const char> in, std::span<char> out);

}  // namespace sparsha::pipeline
