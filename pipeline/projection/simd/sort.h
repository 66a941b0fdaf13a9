// The points of eight bins put in order at once, a bin a lane, by a sorting network. Included once for each instruction
// set.
#pragma once

#include "pipeline/projection/simd/kernels.h"
#include "pipeline/projection/simd/vectors.h"

namespace {

struct EightBins {
  Floats x[8];  // slot by slot
  Floats y[8];
  Floats z[8];
};

// The higher of slots a and b goes to a; of equal heights the one of lesser x, then lesser y.
SPARSHA_INLINE void put_in_order(EightBins& bins, int a, int b) {
  const Floats za = bins.z[a];
  const Floats zb = bins.z[b];
  const Floats xa = bins.x[a];
  const Floats xb = bins.x[b];
  const Floats ya = bins.y[a];
  const Floats yb = bins.y[b];
  const Ints wrong = (zb > za) | ((zb == za) & ((xb < xa) | ((xb == xa) & (yb < ya))));
  bins.z[a] = choose(wrong, zb, za);
  bins.z[b] = choose(wrong, za, zb);
  bins.x[a] = choose(wrong, xb, xa);
  bins.x[b] = choose(wrong, xa, xb);
  bins.y[a] = choose(wrong, yb, ya);
  bins.y[b] = choose(wrong, ya, yb);
}

// Batcher's network of four slots and one of nineteen comparisons of eight.
constexpr int kFour[5][2] = {{0, 2}, {1, 3}, {0, 1}, {2, 3}, {1, 2}};
constexpr int kEight[19][2] = {{0, 2}, {1, 3}, {4, 6}, {5, 7}, {0, 4}, {1, 5}, {2, 6}, {3, 7}, {0, 1}, {2, 3},
                               {4, 5}, {6, 7}, {2, 4}, {3, 5}, {1, 4}, {3, 6}, {1, 2}, {3, 4}, {5, 6}};

// Points of bins b and b + 4, side by side.
SPARSHA_INLINE Floats load_two(const sparsha::pipeline::BandPoint* low, const sparsha::pipeline::BandPoint* high) {
  return __builtin_shufflevector(load_four(&low->z), load_four(&high->z), 0, 1, 2, 3, 4, 5, 6, 7);
}

// Point s of eight bins.
SPARSHA_INLINE void load_slot(const sparsha::pipeline::BandPoint* from, const std::uint32_t* start, int s,
                              EightBins& bins) {
  from += s;
  const Floats a = load_two(from + start[0], from + start[4]);
  const Floats b = load_two(from + start[1], from + start[5]);
  const Floats c = load_two(from + start[2], from + start[6]);
  const Floats d = load_two(from + start[3], from + start[7]);
  const Floats zx_ab = __builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13);
  const Floats zx_cd = __builtin_shufflevector(c, d, 0, 8, 1, 9, 4, 12, 5, 13);
  const Floats y_ab = __builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15);
  const Floats y_cd = __builtin_shufflevector(c, d, 2, 10, 3, 11, 6, 14, 7, 15);
  bins.z[s] = __builtin_shufflevector(zx_ab, zx_cd, 0, 1, 8, 9, 4, 5, 12, 13);
  bins.x[s] = __builtin_shufflevector(zx_ab, zx_cd, 2, 3, 10, 11, 6, 7, 14, 15);
  bins.y[s] = __builtin_shufflevector(y_ab, y_cd, 0, 1, 8, 9, 4, 5, 12, 13);
}

// Writes eight points a bin, each bin over what the one before wrote too much.
SPARSHA_INLINE void store_slots(Floats* slots, const std::uint32_t* start, float* to) {
  transpose(slots);
  for (int bin = 0; bin < 8; ++bin) store(to + start[bin], slots[bin]);
}

SPARSHA_INLINE void sort_eight(const sparsha::pipeline::BinSort& sort, const std::uint32_t* start, float* x, float* y,
                               float* z) {
  Ints begin;
  Ints end;
  __builtin_memcpy(&begin, start, sizeof(begin));
  __builtin_memcpy(&end, start + 1, sizeof(end));
  const Ints count = end - begin;
  EightBins bins;
#pragma GCC unroll 8
  for (int s = 0; s < 8; ++s) load_slot(sort.from, start, s, bins);
  for (int s = 0; s < 8; ++s) bins.z[s] = choose(count > s, bins.z[s], all(-__builtin_inff()));
  if (any(count > 4)) {
#pragma GCC unroll 19
    for (int c = 0; c < 19; ++c) put_in_order(bins, kEight[c][0], kEight[c][1]);
  } else if (any(count > 1)) {
#pragma GCC unroll 5
    for (int c = 0; c < 5; ++c) put_in_order(bins, kFour[c][0], kFour[c][1]);
  }
  store_slots(bins.x, start, x);
  store_slots(bins.y, start, y);
  store_slots(bins.z, start, z);
}

// Bins of up to eight points, the bins' starts being relative to the arrays'; fuller bins are left to the caller.
SPARSHA_INLINE void sort_few(const sparsha::pipeline::BinSort& sort, std::size_t bins) {
  const std::uint32_t total = sort.start[bins];
  for (std::size_t b = 0; b < bins; b += kLanes) {
    const std::size_t last = b + kLanes < bins ? b + kLanes : bins;
    if (sort.start[b] == sort.start[last]) continue;
    if (last == b + kLanes && sort.start[last] + kLanes <= total) {
      sort_eight(sort, sort.start + b, sort.x, sort.y, sort.z);
      continue;
    }
    // The last few one by one, for no more may be written than there is.
    for (std::size_t bin = b; bin < last; ++bin) {
      const std::uint32_t first = sort.start[bin];
      const std::uint32_t count = sort.start[bin + 1] - first;
      if (count == 0 || count > sparsha::pipeline::BinSort::kFew) continue;
      const std::uint32_t start[kLanes + 1] = {0, count, count, count, count, count, count, count, count};
      sparsha::pipeline::BinSort one = sort;
      one.from += first;
      float x[2 * kLanes];
      float y[2 * kLanes];
      float z[2 * kLanes];
      sort_eight(one, start, x, y, z);
      for (std::uint32_t k = 0; k < count; ++k) {
        sort.x[first + k] = x[k];
        sort.y[first + k] = y[k];
        sort.z[first + k] = z[k];
      }
    }
  }
}

}  // namespace
