// The nodes of whole objects that stand for the surface: of each place those of the sheet that faces it best.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "scene/charts.h"

namespace sparsha::scene {

/// A measured node. Metres, relative to the charts' origin.
struct SurfaceNode {
  static constexpr double kSameSide = 0.5;  ///< cosine of 60 degrees: normals that differ by more are of other surfaces

  Eigen::Vector3d place_m;
  Eigen::Vector3d normal;  ///< outward, unit
  double area = 1.0;       ///< of the surface, in squares of the node spacing
  double value = 0.0;      ///< whatever is to be averaged
};

/// Nodes in cubes of space. Immutable; any thread.
class SurfaceNodes {
 public:
  /// Every `stride`-th node along both axes of a sheet. Cubes are `reach_m` wide. `value(sheet, node)` gives
  /// SurfaceNode::value.
  template <class Value>
  SurfaceNodes(const Charts& charts, double reach_m, int stride, const Value& value) : reach_m_(reach_m) {
    for (const Sheet& sheet : charts.sheets)
      for (int j = 0; j < sheet.ny; ++j)
        for (int i = 0; i < sheet.nx; ++i)
          if (counts(sheet, i, j, stride))
            nodes_.push_back({charts.place_m(sheet, i, j), Charts::normal(sheet, i, j),
                              stride * stride * area_of(sheet, sheet.index(i, j)), value(sheet, sheet.index(i, j))});
    sort();
  }
  /// Of places that are no nodes of charts.
  SurfaceNodes(std::vector<SurfaceNode> nodes, double reach_m) : reach_m_(reach_m), nodes_(std::move(nodes)) { sort(); }
  /// A stride with which no more than some 8 nodes lie along a reach.
  [[nodiscard]] static int stride_within(double reach_m, double spacing_m);
  [[nodiscard]] std::size_t size() const { return nodes_.size(); }

  /// All nodes within `reach_m` of any place of the cube, and some more, into `found`, always in the same order.
  void near(const Eigen::Vector3i& cube, std::vector<SurfaceNode>& found) const;
  [[nodiscard]] Eigen::Vector3i cube_of(const Eigen::Vector3d& place_m) const {
    return (place_m / reach_m_).array().floor().cast<int>();
  }
  /// The same cube has the same key; at most 2^20 cubes from zero along each axis.
  [[nodiscard]] static std::uint64_t key_of(const Eigen::Vector3i& cube);

 private:
  [[nodiscard]] static bool counts(const Sheet& sheet, int i, int j, int stride);
  [[nodiscard]] static double area_of(const Sheet& sheet, std::size_t node);
  void sort();

  double reach_m_;
  std::vector<SurfaceNode> nodes_;   // by cubes
  std::vector<std::uint64_t> keys_;  // of cubes that hold a node, rising
  std::vector<std::size_t> begins_;  // of each cube's nodes, and their end
};

}  // namespace sparsha::scene
