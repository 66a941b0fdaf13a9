// From an oriented cloud to a depth grid: front layer, robust local fit, exact triangles: docs/architecture.md,
// "How the surface is computed".
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "base/threads/context.h"
#include "pipeline/scan/cloud.h"
#include "scene/config/grid.h"
#include "scene/depth_grid.h"

namespace sparsha::pipeline {

/// What became of each point that reached the projection.
enum class PointClass : std::uint8_t { used, occluded, outlier, outside };

struct Projection {
  scene::DepthGrid grid;
  double noise_m = 0.0;                 ///< standard deviation of the points about the fits, from samples
  bool only_mesh = false;               ///< every point is a corner of a face: there is no noise to find
  double point_spacing_m = 0.0;         ///< median spacing of front points
  double gap_m = 0.0;                   ///< the depth gap that separates front from back
  bool closed = false;                  ///< several sides, told apart by tangent discs, see tangent_discs.h
  bool discs = false;                   ///< tangent discs decide the nodes, else windows in x and y (or triangles)
  double sparse_share = 0.0;            ///< of an object's places: too sparse for discs as wide as elsewhere
  std::uint64_t nodes_doubtful = 0;     ///< measured nodes where another layer follows closely; of closed ones
  bool facing_asked = false;            ///< a back may show through holes of the front; only then are these counted:
  bool facing_known = false;            ///< layers that face away were told from others
  std::uint64_t nodes_turned_away = 0;  ///< nodes in holes of the front, left unknown: what is seen there faces away
  /// Measured nodes of which nothing tells which way they face; not closed, only those that lie behind what is around
  /// them.
  std::uint64_t nodes_unsure = 0;
  std::vector<std::string> lying_stations;  ///< scans that were seen from elsewhere than they say, so it seems
  std::vector<std::string> lying_normals;   ///< scans whose normals do not point outwards, so it seems
  std::uint64_t used = 0, occluded = 0, outlier = 0, outside = 0;
  std::uint64_t scattered = 0;  ///< of all four, in the grid: belong to no surface and were left out, see scattered.h
  std::uint64_t edge_on = 0;    ///< of the occluded: on surfaces that the view shows edge-on
  /// Of the largest of those in one direction: unit normal, scan frame, towards the middle of the grid; else zero.
  Eigen::Vector3d edge_on_normal = Eigen::Vector3d::Zero();
  std::vector<PointClass> point_class;     ///< one per point of the cloud
  std::vector<std::uint32_t> colour_rgba;  ///< when asked for and present
  std::vector<float> intensity;
};

/// What measuring the nodes takes beside points as they are in the cloud and the nodes themselves.
struct ProjectionNeeds {
  std::uint64_t bytes_per_point = 0;  ///< while points are sorted and nodes are measured
  std::uint64_t column_bytes = 0;     ///< of the columns that discs are found in, over the whole lattice
  double wanted_samples = 0.0;        ///< that tell sides apart, of as many points or more
  double points = 0.0;                ///< of which this is known

  /// Of samples while they tell sides apart, and of what is kept of them while nodes are measured; of so many points.
  [[nodiscard]] std::uint64_t side_bytes(double of_points) const;
  [[nodiscard]] std::uint64_t kept_side_bytes(double of_points) const;
};

/// May refuse what a projection needs by throwing, before memory is taken for it. Both may be empty.
struct Approval {
  std::function<void(std::uint64_t bytes)> sides;  ///< what telling sides apart takes at most
  std::function<void(const scene::Lattice& lattice, const ProjectionNeeds& needs)> nodes;
};

/// Projects `cloud` as seen along -z of the grid frame, grid = scan_to_grid * scan. `resolution_m` bounds the automatic
/// spacing from below. Looking at a cloud from one side after another is faster by a Projector. The result depends
/// neither on the pool's threads nor on the order of the points. Throws Error{input} when no node can be measured,
/// Error{usage} when the grid would exceed 2^31 nodes or memory. `approval` may
/// refuse what it takes.
[[nodiscard]] Projection project(const Cloud& cloud, const Eigen::Matrix4d& scan_to_grid, const scene::GridConfig& grid,
                                 double resolution_m, const Context& context, const Approval& approval = {});

}  // namespace sparsha::pipeline
