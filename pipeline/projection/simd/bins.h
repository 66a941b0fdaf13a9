// Points on their way to bands of bins: which band and bin each one belongs to, and the copy itself. Included once for
// each instruction set.
#pragma once

#include "pipeline/projection/simd/kernels.h"
#include "pipeline/projection/simd/vectors.h"

namespace {

SPARSHA_INLINE void index_eight(const sparsha::pipeline::BandKernel& k, Floats x, Floats y, Ints& band, Ints& bin) {
  const Floats u = (x - k.x_shift_m) * k.per_m;
  const Floats v = (y - k.y_shift_m) * k.per_m;
  const Ints inside = (u >= k.left) & (v >= k.bottom) & (u < k.right) & (v < k.top);
  const Ints column = __builtin_convertvector(masked(inside, u), Ints);
  const Ints row = __builtin_convertvector(masked(inside, v), Ints) - (inside & k.first_row);
  band = (inside & (row >> k.band_rows_log2)) | (~inside & k.nowhere);
  bin = (row & k.row_mask) * k.row_length + column;
}

SPARSHA_INLINE void index(const sparsha::pipeline::BandKernel& k, const float* x, const float* y, std::size_t count,
                          std::int32_t* band, std::int32_t* bin) {
  for (std::size_t p = 0; p < count; p += kLanes) {
    const std::size_t here = count - p < kLanes ? count - p : kLanes;
    const Places places = load_places(x + p, y + p, here);
    Ints bands;
    Ints bins;
    index_eight(k, places.x, places.y, bands, bins);
    if (here == kLanes) {
      __builtin_memcpy(band + p, &bands, sizeof(bands));
      __builtin_memcpy(bin + p, &bins, sizeof(bins));
    } else {
      __builtin_memcpy(band + p, &bands, here * sizeof(std::int32_t));
      __builtin_memcpy(bin + p, &bins, here * sizeof(std::int32_t));
    }
  }
}

// Neighbours in the cloud mostly go to the same band: with a head each, four of them need not wait for one another.
SPARSHA_INLINE void send(const sparsha::pipeline::BandSend& s, std::size_t count) {
  std::size_t p = 0;
  for (; p + 4 <= count; p += 4) {
    const Quad z = load_four(s.z + p);
    const Quad x = load_four(s.x + p);
    const Quad y = load_four(s.y + p);
    Quad bin;
    __builtin_memcpy(&bin, s.bin + p, sizeof(bin));
    const Quad zx_low = __builtin_shufflevector(z, x, 0, 4, 1, 5);
    const Quad zx_high = __builtin_shufflevector(z, x, 2, 6, 3, 7);
    const Quad yb_low = __builtin_shufflevector(y, bin, 0, 4, 1, 5);
    const Quad yb_high = __builtin_shufflevector(y, bin, 2, 6, 3, 7);
    const Quad point[4] = {
        __builtin_shufflevector(zx_low, yb_low, 0, 1, 4, 5), __builtin_shufflevector(zx_low, yb_low, 2, 3, 6, 7),
        __builtin_shufflevector(zx_high, yb_high, 0, 1, 4, 5), __builtin_shufflevector(zx_high, yb_high, 2, 3, 6, 7)};
    for (std::size_t lane = 0; lane < 4; ++lane) {
      const std::uint32_t at = s.head[4 * static_cast<std::size_t>(s.band[p + lane]) + lane]++;
      __builtin_memcpy(s.to + at, &point[lane], sizeof(point[lane]));
    }
  }
  for (; p < count; ++p) {
    const std::uint32_t at = s.head[4 * static_cast<std::size_t>(s.band[p]) + p % 4]++;
    s.to[at] = {s.z[p], s.x[p], s.y[p], static_cast<std::uint32_t>(s.bin[p])};
  }
}

}  // namespace
