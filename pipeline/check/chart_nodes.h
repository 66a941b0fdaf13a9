// Measured nodes of all sheets in cells of a hashed lattice in space; the nearest is found ring by ring.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "base/numbers/hash.h"
#include "scene/charts.h"

namespace sparsha::pipeline {

struct ChartNode {
  Eigen::Vector3f place_m;  ///< relative to the charts' origin
  Eigen::Vector3f normal;
  scene::Side side;
  std::uint32_t sheet;  ///< number in the charts
};

/// Immutable; queries are thread-safe.
class ChartNodes {
 public:
  explicit ChartNodes(const scene::Charts& charts);

  /// By sheet.
  [[nodiscard]] const std::vector<ChartNode>& all() const { return nodes_; }

  /// The nearest node within `reach` spacings that `counts`; null when there is none. Of nodes that are equally near
  /// the first.
  template <typename Counts>
  [[nodiscard]] const ChartNode* nearest(const Eigen::Vector3d& place_m, double reach, const Counts& counts) const {
    const std::array<std::int64_t, 3> middle = cell_of(place_m);
    const double side_m = 1.0 / per_m_;
    const ChartNode* best = nullptr;
    double least2 = reach * reach * side_m * side_m;
    const auto rings = static_cast<std::int64_t>(std::ceil(reach));
    for (std::int64_t ring = 0; ring <= rings; ++ring) {
      if (best != nullptr && std::sqrt(least2) < static_cast<double>(ring - 1) * side_m) break;
      for (std::int64_t a = -ring; a <= ring; ++a) {
        for (std::int64_t b = -ring; b <= ring; ++b) {
          const bool inner = std::max(std::abs(a), std::abs(b)) < ring;
          for (std::int64_t c = -ring; c <= ring; c += inner ? 2 * std::max<std::int64_t>(1, ring) : 1) {
            for (std::uint32_t n = table_[slot({middle[0] + a, middle[1] + b, middle[2] + c})]; n != kNone;
                 n = next_[n]) {
              const double here = (nodes_[n].place_m.cast<double>() - place_m).squaredNorm();
              if (here > least2 || (best != nullptr && here == least2 && &nodes_[n] >= best)) continue;
              if (!counts(nodes_[n])) continue;
              least2 = here;
              best = &nodes_[n];
            }
          }
        }
      }
    }
    return best;
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffffU;

  [[nodiscard]] std::array<std::int64_t, 3> cell_of(const Eigen::Vector3d& place_m) const;
  [[nodiscard]] std::size_t slot(const std::array<std::int64_t, 3>& cell) const {
    return hash_cell(cell) & (table_.size() - 1);
  }

  double per_m_;
  std::vector<ChartNode> nodes_;
  std::vector<std::uint32_t> table_, next_;
};

}  // namespace sparsha::pipeline
