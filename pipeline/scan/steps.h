// Coordinates that were rounded before they were stored: float32 far from zero, text of few decimals, LAS with a coarse
// scale. What is finer than a step is lost, and no noise shows it.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace sparsha::pipeline {

/// Hands over all points of a scan, block by block; may be called again.
using EachPoint = std::function<void(const std::function<void(std::span<const Eigen::Vector3d>)>&)>;

struct CoarseSteps {
  std::array<double, 3> step{};  ///< of x, y and z; 0 where it is fine enough or unknown
  double apart = 0.0;            ///< distance of neighbouring points
  bool single = false;           ///< the steps are those of float32 at this distance from zero

  [[nodiscard]] bool any() const { return step[0] > 0.0 || step[1] > 0.0 || step[2] > 0.0; }
};

/// Steps of more than a tenth of the points' distance; nothing where there are none. `sample` is that of a PointSample
/// over all `points`, in any order; they are gone through again where the sample makes a step likely. A scan on a
/// regular raster, whose points take each place once, has the raster's steps across and is not rounded. Of a
/// `mesh`, whose vertices may be designed on a lattice, only steps of float32 count, or those of many vertices that are
/// no raster.
[[nodiscard]] std::optional<CoarseSteps> coarse_steps(std::vector<Eigen::Vector3d> sample, std::uint64_t points,
                                                      bool mesh, const EachPoint& each);

}  // namespace sparsha::pipeline
