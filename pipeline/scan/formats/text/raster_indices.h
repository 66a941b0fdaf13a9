// Rows and columns of a grid that stand in front of the coordinates of its points, without names.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pipeline/scan/formats/text/rows.h"

namespace sparsha::pipeline {

/// Collects evidence over the rows of a table that the first two columns count along a grid, one of them fast and one
/// slow, and that the three behind them are the coordinates of its points. Rows whose coordinates are no numbers or
/// all 0 are unmeasured places of the grid.
class RasterIndices {
 public:
  static constexpr std::size_t kBehind = 2;  ///< the column of x

  /// `fast`: the column, 0 or 1, that changes from point to point.
  explicit RasterIndices(std::size_t fast) : fast_(fast) {}

  /// Rows in the order of the file, of at least five values. False as soon as a row contradicts.
  bool add(const TableRow& row);
  /// True when all rows ran along the grid and the coordinates follow it: neighbours lie beside each other, one
  /// coordinate grows along the fast column, and another one along the slow one.
  [[nodiscard]] bool found() const;

 private:
  using Three = std::array<double, 3>;
  /// Sums for the correlation of a run's mean with its number.
  struct Trend {
    double n = 0.0, t = 0.0, tt = 0.0, v = 0.0, vv = 0.0, tv = 0.0;
    void add(double at, double value);
    [[nodiscard]] double correlation() const;
    [[nodiscard]] double deviation() const;
  };

  void end_run();
  void measure(double at, const Three& point);

  std::uint64_t rows_ = 0;
  std::array<double, 2> last_{};
  std::size_t fast_;
  double slow_sign_ = 0.0;  ///< of the steps of the slow column
  std::uint64_t runs_ = 0;
  double sign_of_run_ = 0.0;
  // Of the present run.
  double measured_ = 0.0;
  bool has_point_ = false;
  double at_ = 0.0;
  Three point_{}, sum_{}, net_{}, way_{};
  // Of all runs.
  Three origin_{};
  bool has_origin_ = false;
  bool shares_ = true;  ///< the last two coordinates lie from 0 to 1, as places in a picture do
  std::array<Trend, 3> values_, means_;
  Three all_net_{}, all_way_{}, steps_{};
  double step_count_ = 0.0;
};

/// True when the sampled rows may be such a table, so that it is worth to look at all.
[[nodiscard]] bool may_have_raster_indices(const std::vector<TableRow>& sample, std::size_t usual, std::size_t fast);

}  // namespace sparsha::pipeline
