// The discs that were found, one after the other.
#pragma once

#include <cstddef>
#include <vector>

#include "pipeline/projection/tangent_discs.h"

namespace sparsha::bench {

/// Indices of all discs, row by row. Between the rows the arrays hold what is no disc.
[[nodiscard]] inline std::vector<std::size_t> disc_indices(const pipeline::TangentDiscs& discs) {
  std::vector<std::size_t> indices;
  const auto columns = static_cast<std::size_t>(discs.columns.bins_x());
  for (auto row = static_cast<std::size_t>(discs.window.first_row);
       row < static_cast<std::size_t>(discs.window.last_row); ++row) {
    const std::size_t first = row * (columns + 1);
    for (std::size_t d = discs.start[first]; d < discs.start[first + columns]; ++d)
      if (discs.radius2[d] > 0.0F) indices.push_back(d);
  }
  return indices;
}

}  // namespace sparsha::bench
