// The whole surface of an object as many exact points with normals, to judge charts by. Shares no code with them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "scene/charts.h"
#include "tests/support/closed_objects.h"
#include "tests/support/closed_scan.h"

namespace sparsha::test {

class WholeSurface {
 public:
  /// `points` exact points; those of a cell of `cell_m` are kept together.
  WholeSurface(const ClosedObject& object, std::size_t points, double cell_m, std::uint64_t seed = 99);

  /// The surface's point that is nearest, found within `reach_m`; null when there is none.
  [[nodiscard]] const SurfacePoint* nearest(const Eigen::Vector3d& place_m, double reach_m) const;
  /// Whether the normal varies by less than `cosine` within `radius_m` of a place.
  [[nodiscard]] bool smooth(const Eigen::Vector3d& place_m, const Eigen::Vector3d& normal, double radius_m,
                            double cosine) const;
  [[nodiscard]] const std::vector<SurfacePoint>& points() const { return points_; }

 private:
  template <typename Use>
  void around(const Eigen::Vector3d& place_m, double reach_m, const Use& use) const;
  [[nodiscard]] std::uint64_t key(const Eigen::Array3i& cell) const;

  double cell_m_;
  std::vector<SurfacePoint> points_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells_;
};

/// Shares from 0 to 1, lengths in point spacings. Smooth: the true normal varies by less than 30 degrees within one
/// and a half spacings.
struct ChartJudgement {
  std::size_t nodes = 0, sheets = 0;
  std::size_t smooth = 0;
  double wrong = 0.0;       ///< of smooth nodes, more than 3 spacings off
  double turned = 0.0;      ///< of smooth nodes, facing the wrong way
  double wrong_any = 0.0;   ///< of all nodes
  double turned_any = 0.0;  ///< of all nodes within 3 spacings of the surface, normal over 90 degrees off
  double median = 0.0;      ///< error of smooth nodes
  double p99 = 0.0;
  double covered = 0.0;  ///< of the places that a ball of 3 spacings radius reaches
  double in_two = 0.0;   ///< of these, covered by sheets of two sides
  std::size_t reachable = 0;
};
/// `places`: how many places are asked for coverage.
[[nodiscard]] ChartJudgement judge_charts(const scene::Charts& charts, const WholeSurface& truth, double spacing_m,
                                          std::size_t places = 20'000);

}  // namespace sparsha::test
