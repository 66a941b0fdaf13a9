#include "pipeline/scan/formats/pcd/lzf.h"

#include <limits>

#include <lzf.h>

namespace sparsha::pipeline {

// A control byte below 32 is followed by that many + 1 literal bytes. Otherwise its upper three bits are a length, 7
// meaning one more byte of it, to which 2 are added, and its lower five with the next byte a distance.
std::size_t lzf_output_size(std::span<const char> in) {
  const auto* source = reinterpret_cast<const unsigned char*>(in.data());
  std::size_t size = 0;
  for (std::size_t i = 0; i < in.size();) {
    const std::size_t control = source[i];
    if (control < 32) {
      size += control + 1;
      i += control + 2;
      continue;
    }
    const bool longer = control >> 5 == 7;
    if (longer && i + 1 == in.size()) break;
    size += (control >> 5) + 2 + (longer ? source[i + 1] : std::size_t{0});
    i += longer ? 3 : 2;
  }
  return size;
}

bool lzf_decompress(std::span<const char> in, std::span<char> out) {
  constexpr std::size_t kMost = std::numeric_limits<unsigned int>::max();  // of the library's lengths
  if (in.size() > kMost || out.size() > kMost) return false;
  if (in.empty() || out.empty()) return in.empty() && out.empty();  // the library reads a byte before it looks
  return ::lzf_decompress(in.data(), static_cast<unsigned int>(in.size()), out.data(),
                          static_cast<unsigned int>(out.size())) == out.size();
}

}  // namespace sparsha::pipeline
