// Ranks of values: the one place for quantiles and medians.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace sparsha {

/// The value that `rank` others precede when they ascend. Reorders; linear time. Requires rank < values.size().
template <typename T>
[[nodiscard]] T value_of_rank(std::vector<T>& values, std::size_t rank) {
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

/// The value of rank share * (count - 1), rounded down; `share` from 0 to 1. Reorders. Requires values.
template <typename T>
[[nodiscard]] T quantile(std::vector<T>& values, double share) {
  return value_of_rank(values, static_cast<std::size_t>(share * static_cast<double>(values.size() - 1)));
}

/// The middle value; of an even number the upper of the two in the middle. Reorders. Requires values.
template <typename T>
[[nodiscard]] T median(std::vector<T>& values) {
  return value_of_rank(values, values.size() / 2);
}

}  // namespace sparsha
