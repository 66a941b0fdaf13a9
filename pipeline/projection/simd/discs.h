// Tangent discs: for each point the plane through its nearest neighbours in space, found in columns of points that are
// sorted by height. Included once for each instruction set.
#pragma once

#include "pipeline/projection/simd/disc_planes.h"
#include "pipeline/projection/simd/sheets_apart.h"

namespace {

// The neighbourhood of a point, among the candidates near or, when they are too few, from farther columns.
SPARSHA_INLINE void add_point(const DiscKernel& k, std::size_t row, std::size_t column, std::size_t point,
                              Candidates& near, DiscBatch& batch) {
  measure(k, point, near);
  std::int32_t count = 0;
  float r2 = neighbourhood2(k, near, k.side_m * k.side_m, count);
  if (r2 > 0.0F) {
    add_moments(k, near, r2, count, point, batch);
    return;
  }
  Candidates far = candidates_in(k, 1);
  for (std::size_t rings = 2; r2 == 0.0F && rings <= k.rings; ++rings) {
    gather_wide(k, row, column, rings, point, far);
    const float reach = k.side_m * static_cast<float>(rings);
    r2 = neighbourhood2(k, far, reach * reach, count);
  }
  if (r2 > 0.0F) add_moments(k, far, r2, count, point, batch);
}

// Once more, from all points within `columns` columns, those of a row whose squared radius is 0. A scanner's lines are
// often farther apart than the points on them, so that the nearest points all lie on one line and tell no plane.
SPARSHA_APART void widen(const DiscKernel& k, std::size_t row, float columns) {
  DiscBatch batch;
  batch.flatness = 0.2F;             // what is wide may hold two surfaces
  batch.reach_of_neighbours = 1.0F;  // to the next line
  Candidates far = candidates_in(k, 1);
  const float r2 = columns * columns * k.side_m * k.side_m;
  const auto rings = static_cast<std::size_t>(__builtin_ceilf(columns));
  const std::uint32_t* const start = k.start + row * k.bins_x;
  std::size_t column = 0;
  const std::size_t end = start[k.bins_x];
  for (std::size_t first = start[0]; first < end; first += kLanes) {
    std::uint32_t lanes = lanes_of(load(k.radius2 + first) == 0.0F);
    if (end - first < kLanes) lanes &= (1U << (end - first)) - 1U;
    for (; lanes != 0; lanes &= lanes - 1U) {
      const std::size_t p = first + static_cast<std::size_t>(__builtin_ctz(lanes));
      while (start[column + 1] <= p) ++column;
      k.radius2[p] = kNoDisc;
      gather_wide(k, row, column, rings, p, far);
      const std::int32_t count = count_within(far, r2);
      if (count >= k.least) add_moments(k, far, r2, count, p, batch);
      if (batch.size == kLanes) write_discs(k, batch);
    }
  }
  if (batch.size > 0) write_discs(k, batch);
}

SPARSHA_APART void fit_discs(const DiscKernel& k, std::size_t row) {
  DiscBatch batch;
  batch.thick_again = k.noise_m >= 0.0F;
  Candidates near = candidates_in(k, 0);
  for (std::size_t column = 0; column < k.bins_x; ++column) {
    const std::size_t bin = row * k.bins_x + column;
    const std::size_t end = k.start[bin + 1];
    if (k.start[bin] == end) continue;
    for (std::size_t p = k.start[bin]; p < end; ++p) k.radius2[p] = kNoDisc;
    Windows windows = windows_around(k, row, column);
    for (std::size_t begin = k.start[bin]; begin < end && k.z[begin] >= k.needed_m[bin];) {
      // Points at nearly one height have nearly the same candidates.
      std::size_t last = begin + 1;
      while (last < end && k.z[begin] - k.z[last] <= 0.5F * k.side_m && k.z[last] >= k.needed_m[bin]) ++last;
      gather_near(k, windows, k.z[begin], k.z[last - 1], near);
      for (std::size_t p = begin; p < last; ++p) {
        add_point(k, row, column, p, near, batch);
        if (batch.size == kLanes) write_discs(k, batch);
      }
      begin = last;
    }
  }
  if (batch.size > 0) write_discs(k, batch);
  if (k.noise_m >= 0.0F) tell_sheets_apart(k, row);
  constexpr float kWider[] = {1.2F, 1.6F, 2.0F, 3.0F};  // columns
  for (const float columns : kWider) widen(k, row, columns);
  const auto widest = static_cast<float>(k.rings);
  for (float columns = 1.4F * kWider[3]; columns < 1.2F * widest; columns *= 1.4F) {
    widen(k, row, columns < widest ? columns : widest);
  }
}

}  // namespace
