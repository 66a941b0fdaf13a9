// A raw cloud of a closed object, and heights judged against the object itself.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "scene/depth_grid.h"
#include "tests/support/closed_objects.h"
#include "tests/support/relief_scene.h"

namespace sparsha::test {

/// What is taken out of the front: every point that is seen first within `radius_m` of the centre.
struct Hole {
  Eigen::Vector2d centre_m = Eigen::Vector2d::Zero();
  double radius_m = 0.0;
};

struct ScanOptions {
  std::size_t points = 100'000;
  double noise_spacings = 0.1;  ///< standard deviation along the normal, in mean point spacings
  std::uint64_t seed = 1;
  double density_ratio = 1.0;  ///< greatest density over least, falling exponentially along x
  double hole_spacings = 0.0;  ///< radius of a hole where the front varies least; 0 makes none
  /// Points lie on lines, in planes across `across`, that are so many times farther apart than the points on them where
  /// the surface is at right angles to the planes, and farther where it is not; 0: nowhere in particular.
  double lines = 0.0;
  Eigen::Vector3d across = Eigen::Vector3d::UnitX();
};

struct ObjectScan {
  Points points;
  std::vector<Eigen::Vector3d> normals;  ///< true ones, outward, one per point
  double spacing_m = 0.0;                ///< mean: root of area over points
  double noise_m = 0.0;
  std::optional<Hole> hole;  ///< nothing where no place of the front can hold one
};

/// The points in random order; the same options give the same cloud.
[[nodiscard]] ObjectScan scan_object(const ClosedObject& object, const ScanOptions& options);

/// The orientations from which +z, -z, +x, -x, +y and -y of a scan look at the viewer.
[[nodiscard]] std::vector<Eigen::Matrix4d> six_views();

/// Errors of measured nodes, in shares (0 to 1) and mean point spacings. Wrong: more than three spacings off. Smooth:
/// the truth is within three spacings of the node's all around it at one and a half.
struct Judgement {
  std::size_t nodes = 0;         ///< measured
  double beyond = 0.0;           ///< of the nodes, outside the silhouette
  double smooth = 0.0;           ///< of the nodes on the object
  double wrong = 0.0;            ///< of the nodes on the object
  double wrong_smooth = 0.0;     ///< of the smooth ones
  double median_spacings = 0.0;  ///< of the error where the object is smooth
  double covered = 0.0;          ///< of the lattice's nodes in the silhouette that have front points, measured
  std::size_t hole_nodes = 0;    ///< of the lattice, two spacings or more within the hole
  std::size_t hole_through = 0;  ///< of those, measured and wrong: they show what lies behind
};

/// Measured nodes, and the rest of the lattice for coverage. Nodes in the hole and within two spacings of it count as
/// hole_through only.
[[nodiscard]] Judgement judge_object(const scene::DepthGrid& grid, const ClosedObject& object, const ObjectScan& scan);
/// The same for the nodes of another program, `step_m` apart; without coverage.
[[nodiscard]] Judgement judge_object(std::span<const Eigen::Vector3d> nodes, double step_m, const ClosedObject& object,
                                     const ObjectScan& scan);

}  // namespace sparsha::test
