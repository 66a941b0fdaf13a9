// Whether a column that never falls is a time, and the three behind it are the x, y and z that a scanner swept over.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace sparsha::pipeline {

/// Keeps a table's first rows. A scanner's path goes to and fro while its time rises within each sweep; of a surface
/// whose points are sorted by x, or stand in columns of equal x, x rises between sweeps, or the others jump.
class TimeColumn {
 public:
  /// One row's first four values, in the file's order; left out when one of them is not a number.
  void add(const std::array<double, 4>& row) {
    if (std::any_of(row.begin(), row.end(), [](double v) { return std::isnan(v); })) return;
    if (rows() == kMostRows) return;
    for (std::size_t k = 0; k < 4; ++k) values_[k].push_back(row[k]);
  }

  /// Whether the columns behind the first are a path that sweeps over a surface, in steps of any length. Requires that
  /// the first never falls.
  [[nodiscard]] bool sweeps() const;
  /// Whether the first column can be no time: the others make a straight profile, or a lattice turned by a little.
  [[nodiscard]] bool is_profile_or_lattice() const;

 private:
  static constexpr std::size_t kMostRows = 65536;
  [[nodiscard]] std::size_t rows() const { return values_[3].size(); }

  std::array<std::vector<double>, 4> values_;
};

}  // namespace sparsha::pipeline
