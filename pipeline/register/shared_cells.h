// Which scans may have something in common, told without comparing every pair of them.
#pragma once

#include <cstddef>
#include <vector>

#include "pipeline/register/posed_scan.h"
#include "pipeline/register/relaxation.h"

namespace sparsha::pipeline {

/// The shares that pairs of scans have in common, by the cells of one grid in which their coarse elements lie with the
/// present poses. The effort grows with elements and shared cells, not with pairs.
class SharedCells {
 public:
  SharedCells(const std::vector<PosedScan>& scans, double cell_m);

  /// The larger share of one's coarse elements that have one of the other's in their cell or beside it; 0 to 1.
  [[nodiscard]] double share(std::size_t a, std::size_t b) const;

  /// At most `most` pairs, the scan of smaller index first, in the order of their indices: the heaviest tree that
  /// links what can be linked, then the best of each scan in turn. Only pairs that have something in common.
  [[nodiscard]] std::vector<Edge> best_pairs(std::size_t most) const;

 private:
  std::size_t scans_;
  std::vector<double> shares_;  ///< of scan a in b: at a * scans_ + b
};

}  // namespace sparsha::pipeline
