// The projection's stages in order; each stage has its own file beside this one.
#include "pipeline/projection/projector.h"

#include <algorithm>
#include <array>
#include <new>

#include "base/error.h"
#include "base/system/disk_arrays.h"
#include "pipeline/projection/attributes.h"
#include "pipeline/projection/classification.h"
#include "pipeline/projection/edge_on.h"
#include "pipeline/projection/measure_rows.h"
#include "pipeline/projection/plan.h"
#include "pipeline/projection/triangles.h"
#include "pipeline/projection/turned_away.h"

namespace sparsha::pipeline {
namespace {

// One flag per point that is a vertex of a face; empty without faces.
std::vector<std::uint8_t> flag_vertices(const Cloud& cloud, std::size_t points) {
  std::vector<std::uint8_t> flags;
  if (cloud.faces.empty()) return flags;
  flags.assign(points, 0);
  for (const std::array<std::uint32_t, 3>& face : cloud.faces) {
    for (const std::uint32_t v : face) {
      if (v >= points) throw input_error({}, "a face names point " + std::to_string(v), "faces index existing points");
      flags[v] = 1;
    }
  }
  return flags;
}

// Where both a mesh and points give a height, the mesh counts unless the points lie in front of it by more than the
// gap.
void merge_mesh(const TriangleHeights& mesh, double gap_m, scene::DepthGrid& grid) {
  for (std::size_t node = 0; node < mesh.height_m.size(); ++node) {
    if (mesh.face[node] == TriangleHeights::kNone) continue;
    const bool points_in_front = grid.state[node] == scene::NodeState::measured &&
                                 static_cast<double>(grid.height_m[node] - mesh.height_m[node]) > gap_m;
    if (points_in_front) continue;
    grid.height_m[node] = mesh.height_m[node];
    grid.state[node] = scene::NodeState::measured;
  }
}

void leave_out_edge_on(const OrientedPoints& points, const ProjectionPlan& plan, const Eigen::Matrix4d& scan_to_grid,
                       ThreadPool& pool, Projection& projection) {
  EdgeOnSurfaces surfaces(plan.bins, plan.point_spacing_m);
  surfaces.add(points, projection.point_class.data());
  const std::uint64_t count = surfaces.take_out(points, projection.point_class.data(), pool);
  add_edge_on(count, surfaces.main_normal(), scan_to_grid, projection);
}

}  // namespace

Projector::Projector(const Cloud& cloud, ThreadPool& pool, bool keep_memory)
    : cloud_(cloud), raw_(raw_points(cloud)), keep_memory_(keep_memory) {
  if (raw_.count == 0) throw input_error({}, "no points to project", "at least four points");
  vertices_ = flag_vertices(cloud, raw_.count);
  only_mesh_ = !vertices_.empty() && std::find(vertices_.begin(), vertices_.end(), 0) == vertices_.end();
  origin_sample_ = origin_sample(
      raw_.count, [&](const auto& use) { use(raw_); }, pool);
}

ProjectionPlan Projector::plan(const OrientedPoints& points, const Eigen::Matrix4d& scan_to_grid,
                               const Eigen::Vector3d& origin_m, const scene::GridConfig& config, double resolution_m,
                               ThreadPool& pool, const Approval& approval) const {
  const OrientedPieces whole = [&](const auto& use) { use(points); };
  PointTotals totals;
  totals.add(points);
  Extent extent = supported_extent(totals, whole, pool);
  include_faces(points, cloud_.faces, extent);
  return plan_projection(whole, totals, extent, {cloud_.stations, scan_to_grid, origin_m}, only_mesh_, config,
                         resolution_m, pool, approval.sides);
}

scene::Lattice Projector::lattice(const Eigen::Matrix4d& scan_to_grid, const scene::GridConfig& config,
                                  double resolution_m, const Context& context) {
  context.progress.throw_if_cancelled();
  const Eigen::Vector3d origin_m = origin_of_sample(origin_sample_, cloud_.origin_m, scan_to_grid);
  const OrientedPoints points = orient_points(raw_, cloud_.origin_m, scan_to_grid, origin_m, context.pool, nullptr);
  return plan(points, scan_to_grid, origin_m, config, resolution_m, context.pool, {}).lattice;
}

Projection Projector::project(const Eigen::Matrix4d& scan_to_grid, const scene::GridConfig& config, double resolution_m,
                              const Context& context, const Approval& approval) try {
  MemoryStore* const store = keep_memory_ ? &memory_ : nullptr;
  const Eigen::Vector3d origin_m = origin_of_sample(origin_sample_, cloud_.origin_m, scan_to_grid);
  const OrientedPoints points = orient_points(raw_, cloud_.origin_m, scan_to_grid, origin_m, context.pool, store);
  const ProjectionPlan plan = this->plan(points, scan_to_grid, origin_m, config, resolution_m, context.pool, approval);
  if (approval.nodes) approval.nodes(plan.lattice, plan.needs(points.count));
  Projection projection = plan.empty_projection();
  projection.only_mesh = only_mesh_;
  context.progress.throw_if_cancelled();

  if (!only_mesh_) {
    std::vector<std::uint8_t> skip = vertices_;
    projection.scattered = flag_scattered(points, plan.scatter, plan.bins, BinWindow::nodes(plan.bins), skip);
    const std::vector<std::uint8_t> verdicts =
        measure_rows(points, skip, plan, BinWindow::all(plan.bins), 0, context, projection.grid, store);
    add_verdicts(verdicts, projection);
    leave_out_turned_away(plan, verdicts, context.pool, projection);
  }
  TriangleHeights mesh;
  if (!cloud_.faces.empty()) {
    mesh = project_triangles(points, cloud_.faces, plan.bins, context.pool);
    merge_mesh(mesh, projection.gap_m, projection.grid);
  }
  require_a_measured_node(projection.grid);
  projection.point_class.resize(points.count);
  add_classes(classify_points(points, plan.bins, projection.grid, plan.gap_m, plan.facing.get(), context.pool,
                              projection.point_class.data()),
              projection);
  leave_out_edge_on(points, plan, scan_to_grid, context.pool, projection);
  const bool colour = config.colour && cloud_.rgba.size() == points.count;
  const bool intensity = config.intensity && cloud_.intensity.size() == points.count;
  if (colour || intensity) {
    const float largest = intensity ? largest_magnitude(cloud_.intensity.data(), points.count) : 0.0F;
    AttributeSums sums(projection.grid.lattice, plan.bins, colour, intensity, largest);
    sums.add(points, projection.point_class.data(), cloud_.rgba.data(), cloud_.intensity.data());
    sums.write(projection, cloud_, points, mesh);
  }
  return projection;
} catch (const std::bad_alloc&) {
  system::throw_if_disk_was_full();
  throw usage_error("the depth grid does not fit into memory", "a smaller grid.size or larger grid.spacing_mm");
}

}  // namespace sparsha::pipeline
