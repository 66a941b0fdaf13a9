// Rows of bins, transposed: the first points of all bins side by side, then the second ones, and so on, so that eight
// nodes read theirs at once. Included once for each instruction set.
#pragma once

#include "pipeline/projection/simd/kernels.h"
#include "pipeline/projection/simd/vectors.h"

namespace {

constexpr std::size_t kTile = 128;  ///< nodes of a row that are decided before the next row
constexpr std::size_t kColumns = kTile + 2 * kLanes;
constexpr std::size_t kSlots = 16;

/// A row of bins; column 0 is the bin before the tile's first node. Bins of more than kSlots points show the first.
struct alignas(64) SlotRow {
  std::int32_t count[kColumns];
  float u[kSlots][kColumns];  ///< from the bin's own node, in spacings
  float v[kSlots][kColumns];
  float z[kSlots][kColumns];  ///< metres
};

// Eight vectors from eight places, transposed.
SPARSHA_INLINE void turn(const float* from, const std::uint32_t* start, Floats* out) {
  for (int r = 0; r < 8; ++r) out[r] = load(from + start[r]);
  transpose(out);
}

// Slots [from, from + 8) of the bins at `column`.
SPARSHA_INLINE void turn_slots(const sparsha::pipeline::NodeKernel& k, const std::uint32_t* start, std::size_t from,
                               Floats node_x, float node_y, float per_spacing, Ints count, std::size_t column,
                               SlotRow& row) {
  Floats turned[8];
  turn(k.x + from, start, turned);
  for (std::size_t s = 0; s < 8; ++s) store(row.u[from + s] + column, (turned[s] - node_x) * per_spacing);
  turn(k.y + from, start, turned);
  for (std::size_t s = 0; s < 8; ++s) store(row.v[from + s] + column, (turned[s] - node_y) * per_spacing);
  turn(k.z + from, start, turned);
  for (std::size_t s = 0; s < 8; ++s) {
    const Ints there = count > static_cast<std::int32_t>(from + s);
    store(row.z[from + s] + column, choose(there, turned[s], all(kAbsent)));
  }
}

// Bins of lattice row `j` (-1 is the one below the first) for the nodes from `first` on.
SPARSHA_APART void fill_slots(const sparsha::pipeline::NodeKernel& k, std::ptrdiff_t j, std::size_t first,
                              SlotRow& row) {
  const float per_spacing = static_cast<float>(1.0 / k.spacing_m);
  const float node_y = static_cast<float>(k.y0_m + static_cast<double>(j) * k.spacing_m);
  const std::size_t left = k.nx - first;
  const std::size_t columns = (left < kTile ? left : kTile) + 2;
  const std::uint32_t* start =
      k.start + (static_cast<std::size_t>(j + static_cast<std::ptrdiff_t>(k.margin)) * k.bins_x + k.margin + first - 1);
  for (std::size_t column = 0; column < columns; column += kLanes) {
    Ints begin;
    Ints end;
    __builtin_memcpy(&begin, start + column, sizeof(begin));
    __builtin_memcpy(&end, start + column + 1, sizeof(end));
    const Ints count = end - begin;
    __builtin_memcpy(row.count + column, &count, sizeof(count));
    float x[kLanes];
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      x[lane] = static_cast<float>(k.x0_m + (static_cast<double>(first + column + lane) - 1.0) * k.spacing_m);
    }
    const Floats node_x = load(x);
    std::size_t filled = 0;
    for (; filled < kSlots && any(count > static_cast<std::int32_t>(filled)); filled += 8) {
      turn_slots(k, start + column, filled, node_x, node_y, per_spacing, count, column, row);
    }
    for (; filled < kSlots; ++filled) store(row.z[filled] + column, all(kAbsent));
  }
}

}  // namespace
