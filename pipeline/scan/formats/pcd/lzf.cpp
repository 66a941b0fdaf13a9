#include "pipeline/scan/formats/pcd/lzf.h"

#include <cstring>

namespace sparsha::pipeline {

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

// A control byte below 32 is followed by that many + 1 literal bytes. Otherwise its upper three bits are a length, 7
// meaning one more byte of it, and its lower five with the next byte a distance: copy length + 2 from so far back.
bool lzf_decompress(std::span<const char> in, std::span<char> out) {
  const auto* source = reinterpret_cast<const unsigned char*>(in.data());
  const unsigned char* const source_end = source + in.size();
  char* target = out.data();
  char* const target_end = target + out.size();
  while (source < source_end) {
    const std::size_t control = *source++;
    if (control < 32) {
      const std::size_t length = control + 1;
      if (static_cast<std::size_t>(source_end - source) < length ||
          static_cast<std::size_t>(target_end - target) < length) {
        return false;
      }
      std::memcpy(target, source, length);
      source += length;
      target += length;
      continue;
    }
    std::size_t length = control >> 5;
    if (length == 7) {
      if (source == source_end) return false;
      length += *source++;
    }
    if (source == source_end) return false;
    const std::size_t distance = ((control & 31) << 8 | *source++) + 1;
    length += 2;
    if (static_cast<std::size_t>(target - out.data()) < distance ||
        static_cast<std::size_t>(target_end - target) < length) {
      return false;
    }
    const char* from = target - distance;
    if (distance >= length) {
      std::memcpy(target, from, length);
      target += length;
    } else {  // overlapping: a run repeats itself
      for (std::size_t i = 0; i < length; ++i) *target++ = *from++;
    }
  }
  return target == target_end;
}

}  // namespace sparsha::pipeline
