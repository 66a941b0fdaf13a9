// The neighbours in space of a point, found in columns of points that are sorted by height. Included once for each
// instruction set.
#pragma once

#include "pipeline/projection/simd/kernels.h"
#include "pipeline/projection/simd/vectors.h"

namespace {

using sparsha::pipeline::DiscKernel;

/// Candidates for neighbours of points, and how far they are from one of them.
struct Candidates {
  float* x;
  float* y;
  float* z;
  float* r2;  // squared distances
  std::size_t count = 0;
};

// The first or the second of two lists.
SPARSHA_INLINE Candidates candidates_in(const DiscKernel& k, std::size_t list) {
  const std::size_t room = DiscKernel::kMostCandidates + DiscKernel::kReadAhead;
  float* s = k.scratch + list * 4 * room;
  return {s, s + room, s + 2 * room, s + 3 * room, 0};
}

// Points [begin, end), appended as far as there is room.
SPARSHA_INLINE void append(const DiscKernel& k, std::size_t begin, std::size_t end, Candidates& to) {
  const std::size_t room = DiscKernel::kMostCandidates - to.count;
  const std::size_t here = end - begin < room ? end - begin : room;
  for (std::size_t p = 0; p < here; p += kLanes) {
    store(to.x + to.count + p, load(k.x + begin + p));
    store(to.y + to.count + p, load(k.y + begin + p));
    store(to.z + to.count + p, load(k.z + begin + p));
  }
  to.count += here;
}

// Beyond the last candidate are some that are infinitely far away.
SPARSHA_INLINE void finish(Candidates& c) { store(c.x + c.count, all(__builtin_inff())); }

SPARSHA_INLINE void measure(const DiscKernel& k, std::size_t point, Candidates& c) {
  const float x = k.x[point];
  const float y = k.y[point];
  const float z = k.z[point];
  for (std::size_t p = 0; p < c.count; p += kLanes) {
    const Floats dx = load(c.x + p) - x;
    const Floats dy = load(c.y + p) - y;
    const Floats dz = load(c.z + p) - z;
    store(c.r2 + p, dx * dx + dy * dy + dz * dz);
  }
}

SPARSHA_INLINE std::int32_t count_within(const Candidates& c, float r2) {
  Ints within{};
  for (std::size_t p = 0; p < c.count; p += kLanes) within -= load(c.r2 + p) <= r2;
  return total(within);
}

// First point of [begin, end), which descend in z, that is lower than `z` (or as low, when `equal` is).
SPARSHA_INLINE std::size_t first_below(const float* heights, std::size_t begin, std::size_t end, float z, bool equal) {
  while (begin < end) {
    const std::size_t middle = begin + (end - begin) / 2;
    const bool above = equal ? heights[middle] > z : heights[middle] >= z;
    if (above) {
      begin = middle + 1;
    } else {
      end = middle;
    }
  }
  return begin;
}

// Candidates from `rings` columns to each side, within `reach` in z.
SPARSHA_APART void gather_wide(const DiscKernel& k, std::size_t row, std::size_t column, std::size_t rings,
                               std::size_t point, Candidates& to) {
  const float z = k.z[point];
  const float reach = k.side_m * static_cast<float>(rings);
  to.count = 0;
  const std::size_t row0 = row > k.first_row + rings ? row - rings : k.first_row;
  const std::size_t row1 = row + rings < k.last_row ? row + rings : k.last_row - 1;
  const std::size_t column0 = column > rings ? column - rings : 0;
  const std::size_t column1 = column + rings < k.bins_x ? column + rings : k.bins_x - 1;
  for (std::size_t j = row0; j <= row1; ++j) {
    for (std::size_t i = column0; i <= column1; ++i) {
      const std::uint32_t* bin = k.start + j * k.bins_x + i;
      const std::size_t begin = first_below(k.z, bin[0], bin[1], z + reach, true);
      append(k, begin, first_below(k.z, begin, bin[1], z - reach, false), to);
    }
  }
  finish(to);
  measure(k, point, to);
}

/// The columns around one, and where a window of heights that moves down stands in each.
struct Windows {
  std::uint32_t begin[9], end[9], last[9];
  std::size_t count = 0;
};

SPARSHA_INLINE Windows windows_around(const DiscKernel& k, std::size_t row, std::size_t column) {
  Windows w;
  for (std::size_t j = row > k.first_row ? row - 1 : row; j <= row + 1 && j < k.last_row; ++j) {
    for (std::size_t i = column > 0 ? column - 1 : 0; i <= column + 1 && i < k.bins_x; ++i) {
      const std::uint32_t* bin = k.start + j * k.bins_x + i;
      if (bin[0] == bin[1]) continue;
      w.begin[w.count] = w.end[w.count] = bin[0];
      w.last[w.count++] = bin[1];
    }
  }
  return w;
}

// The first of points [begin, end), which descend in z, that is not above `z` (or not as high, when `equal` is): few
// steps from `begin`.
SPARSHA_INLINE std::uint32_t next_below(const float* heights, std::uint32_t begin, std::uint32_t end, float z,
                                        bool equal) {
  for (;;) {
    const Floats here = load(heights + begin);
    std::uint32_t lanes = lanes_of(equal ? here >= z : here > z);
    if (end - begin < kLanes) lanes &= (1U << (end - begin)) - 1U;
    const auto above = static_cast<std::uint32_t>(__builtin_ctz(~lanes));
    begin += above;
    if (above < kLanes) return begin;
  }
}

// Candidates for the points from `top` down to `bottom` of the column in the middle.
SPARSHA_INLINE void gather_near(const DiscKernel& k, Windows& w, float top, float bottom, Candidates& to) {
  top += k.side_m;
  bottom -= k.side_m;
  to.count = 0;
  for (std::size_t c = 0; c < w.count; ++c) {
    w.begin[c] = next_below(k.z, w.begin[c], w.last[c], top, false);
    if (w.end[c] < w.begin[c]) w.end[c] = w.begin[c];
    w.end[c] = next_below(k.z, w.end[c], w.last[c], bottom, true);
    append(k, w.begin[c], w.end[c], to);
  }
  finish(to);
}

// The squared radius that holds about the wanted number of candidates, no more than `most`; 0 when they are too few.
SPARSHA_INLINE float neighbourhood2(const DiscKernel& k, const Candidates& c, float most, std::int32_t& count) {
  count = count_within(c, most);
  if (count < k.least) return 0.0F;
  float r2 = most;
  // On a surface the number within grows as the squared radius.
  for (int round = 0; round < 6 && (count > k.wanted + 3 || count < k.wanted - 3); ++round) {
    float next = r2 * static_cast<float>(k.wanted) / static_cast<float>(count);
    next = next < most ? next : most;
    if (next == r2) break;
    r2 = next;
    count = count_within(c, r2);
    if (count < 1) count = 1;
  }
  if (count >= k.least) return r2;
  r2 = most;
  count = count_within(c, most);
  return r2;
}

// The neighbourhood of a point from as many columns as it takes; 0 when its points are too few.
SPARSHA_INLINE float neighbourhood_of(const DiscKernel& k, std::size_t row, std::size_t column, std::size_t point,
                                      Candidates& c, std::int32_t& count) {
  float r2 = 0.0F;
  for (std::size_t rings = 1; r2 == 0.0F && rings <= k.rings; ++rings) {
    gather_wide(k, row, column, rings, point, c);
    const float reach = k.side_m * static_cast<float>(rings);
    r2 = neighbourhood2(k, c, reach * reach, count);
  }
  return r2;
}

}  // namespace
