// Tangent discs of all points of an object, with their outward normals.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <Eigen/Core>

#include "base/threads/context.h"
#include "pipeline/charts/mixed_faces.h"
#include "pipeline/projection/buffer.h"
#include "pipeline/projection/extent.h"
#include "pipeline/projection/tangent_discs.h"
#include "pipeline/scan/cloud.h"

namespace sparsha::pipeline {

/// A disc whose outer side is known. Grid frame, metres relative to SidedDiscs::origin_m.
struct SidedDisc {
  std::array<float, 3> foot;    ///< the point, moved onto its plane
  std::array<float, 3> normal;  ///< outward, unit length
  float above;                  ///< the point above its plane, along the normal
  float radius2;                ///< m^2
};

struct SidedDiscs {
  static constexpr double kThinSpacings = 2.3;  ///< walls that are thinner are undecided: points of both faces mix

  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();
  DiscRule rule;
  double point_spacing_m = 0.0;
  std::uint64_t found = 0;        ///< discs, whether their sides are known or not
  std::uint64_t undecided = 0;    ///< of them, those of which nothing tells the side
  std::uint64_t thin = 0;         ///< of them, those of walls that are too thin
  std::uint64_t thin_agreed = 0;  ///< of these, those that at least three discs are opposite of
  MixedFaces mixed;               ///< walls whose faces are taken for one surface; nothing is left out there
  std::uint64_t outside = 0;      ///< of them, those outside the box of supported points
  Eigen::Vector3d min_m, max_m;   ///< that box
  std::size_t count = 0;
  Buffer<SidedDisc> discs;  ///< in an order that depends on the set of points alone
};

/// Throws Error{input} when the points form no surface, or nothing tells the side of most of it; UnevenPoints.
[[nodiscard]] SidedDiscs find_sided_discs(const Cloud& cloud, const Eigen::Matrix4d& scan_to_grid,
                                          const Context& context);

}  // namespace sparsha::pipeline
