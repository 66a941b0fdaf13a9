// What is decided before a node is fitted: origin, lattice, noise, spacing and gap. It needs all points, but not at
// once.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "base/threads/thread_pool.h"
#include "pipeline/projection/bins.h"
#include "pipeline/projection/extent.h"
#include "pipeline/projection/facing.h"
#include "pipeline/projection/node_fitter.h"
#include "pipeline/projection/points.h"
#include "pipeline/projection/projection.h"
#include "pipeline/projection/scattered.h"
#include "pipeline/projection/surface_statistics.h"
#include "pipeline/projection/tangent_discs.h"
#include "pipeline/scan/cloud.h"
#include "scene/config/grid.h"
#include "scene/depth_grid.h"

namespace sparsha::pipeline {

struct ProjectionPlan {
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();  ///< of oriented points
  scene::Lattice lattice;
  BinLattice bins;
  NodeFitParameters rule;
  double point_spacing_m = 0.0;  ///< of the whole surface; front_spacing_m: of what the viewer sees
  double front_spacing_m = 0.0;
  double gap_m = 0.0;
  std::optional<DiscRule> discs;              ///< closed objects and scans in lines: tangent discs decide the nodes
  double sparse_share = 0.0;                  ///< of places that need wider discs, or that ruled discs out
  bool closed = false;                        ///< discs, of an object that has several sides
  double layers_apart_m = 0.0;                ///< median, of places with two layers
  ScatterRule scatter;                        ///< points of no surface stay out
  double facing_samples = 0.0;                ///< wanted to tell sides apart; 0 where nothing asks for them
  bool facing_asked = false;                  ///< a back may show through holes of the front
  std::shared_ptr<const FacingField> facing;  ///< when asked and known what faces away
  std::vector<std::string> lying_stations;    ///< files whose stations do not see the sides that are outside
  std::vector<std::string> lying_normals;     ///< files whose normals do not point outwards

  /// Memory of a point while it is sorted and nodes are measured, and some to spare; without the cloud's own.
  [[nodiscard]] std::uint64_t bytes_per_point() const { return discs ? 112 : 56; }
  /// Of so many points.
  [[nodiscard]] ProjectionNeeds needs(std::uint64_t points) const;

  /// With nothing measured yet.
  [[nodiscard]] Projection empty_projection() const;
};

/// How points were oriented, and the stations in the frame that they came from.
struct OrientedStations {
  const std::vector<Station>& stations;
  Eigen::Matrix4d scan_to_grid;
  Eigen::Vector3d origin_m;  ///< of the oriented points
};

/// What the stations saw, in the frame of the oriented points: one view per station; of those that are not to be asked
/// an empty one.
[[nodiscard]] std::vector<StationView> station_views(const OrientedStations& oriented, SideEvidence evidence);

/// How discs are drawn on a surface with these statistics.
[[nodiscard]] DiscRule disc_rule(const SurfaceStatistics& surface, bool on_lines);

/// `totals` are of the pieces, `oriented` says how they were made. Vertices of faces carry no noise: `only_mesh` says
/// there is nothing else. `approve_sides` as in Approval. Throws as choose_lattice does.
[[nodiscard]] ProjectionPlan plan_projection(const OrientedPieces& pieces, const PointTotals& totals,
                                             const Extent& extent, const OrientedStations& oriented, bool only_mesh,
                                             const scene::GridConfig& config, double resolution_m, ThreadPool& pool,
                                             const std::function<void(std::uint64_t bytes)>& approve_sides = {});

/// Throws Error{input} when no node is measured.
void require_a_measured_node(const scene::DepthGrid& grid);

}  // namespace sparsha::pipeline
