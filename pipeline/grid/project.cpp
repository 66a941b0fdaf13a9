// The projection's stages in order; each stage has its own file beside this one.
#include "pipeline/grid/project.h"

#include <algorithm>
#include <array>
#include <new>

#include "pipeline/base/error.h"
#include "pipeline/grid/project_attributes.h"
#include "pipeline/grid/project_fate.h"
#include "pipeline/grid/project_plan.h"
#include "pipeline/grid/project_rows.h"
#include "pipeline/grid/project_triangles.h"

namespace sparsha::pipeline {
namespace {

// One flag a point that is a vertex of a face; empty without faces.
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
void merge_mesh(const TriangleHeights& mesh, double gap_m, DepthGrid& grid) {
  for (std::size_t node = 0; node < mesh.height_m.size(); ++node) {
    if (mesh.face[node] == TriangleHeights::kNone) continue;
    const bool points_in_front = grid.state[node] == NodeState::measured &&
                                 static_cast<double>(grid.height_m[node] - mesh.height_m[node]) > gap_m;
    if (points_in_front) continue;
    grid.height_m[node] = mesh.height_m[node];
    grid.state[node] = NodeState::measured;
  }
}

}  // namespace

Projection project(const Cloud& cloud, const Eigen::Matrix4d& scan_to_grid, const GridConfig& config,
                   double resolution_m, ThreadPool& pool, Progress& progress) try {
  const RawPoints raw = raw_points(cloud);
  if (raw.count == 0) throw input_error({}, "no points to project", "at least four points");
  const std::vector<std::uint8_t> vertices = flag_vertices(cloud, raw.count);
  const bool only_mesh = !vertices.empty() && std::find(vertices.begin(), vertices.end(), 0) == vertices.end();

  const Eigen::Vector3d origin_m = robust_origin(
      raw.count, [&](const auto& use) { use(raw); }, cloud.origin_m, scan_to_grid, pool);
  const OrientedPoints points = orient_points(raw, cloud.origin_m, scan_to_grid, origin_m, pool);
  const OrientedPieces whole = [&](const auto& use) { use(points); };
  PointTotals totals;
  totals.add(points);
  Extent extent = supported_extent(totals, whole, pool);
  include_vertices(points, vertices, extent);
  const ProjectionPlan plan = plan_projection(whole, extent, origin_m, only_mesh, config, resolution_m, pool);
  Projection projection = plan.empty_projection();
  progress.throw_if_cancelled();

  if (!only_mesh) {
    const Bins bins = sort_into_bins(points, vertices, plan.bins, BinWindow::all(plan.bins), pool);
    fit_rows(bins, plan.rule, plan.gap_m, 0, pool, progress, projection.grid);
  }
  TriangleHeights mesh;
  if (!cloud.faces.empty()) {
    mesh = project_triangles(points, cloud.faces, plan.bins, pool);
    merge_mesh(mesh, projection.gap_m, projection.grid);
  }
  require_a_measured_node(projection.grid);
  projection.fate.resize(points.count);
  add_fates(fates_of_points(points, plan.bins, projection.grid, plan.gap_m, pool, projection.fate.data()), projection);
  const bool colour = config.colour && cloud.rgba.size() == points.count;
  const bool intensity = config.intensity && cloud.intensity.size() == points.count;
  if (colour || intensity) {
    const float largest = intensity ? largest_magnitude(cloud.intensity.data(), points.count) : 0.0F;
    AttributeSums sums(projection.grid.lattice, plan.bins, colour, intensity, largest);
    sums.add(points, projection.fate.data(), cloud.rgba.data(), cloud.intensity.data());
    sums.write(projection, cloud, points, mesh);
  }
  return projection;
} catch (const std::bad_alloc&) {
  throw usage_error("the depth grid does not fit into memory", "a smaller grid.size or larger grid.spacing_mm");
}

}  // namespace sparsha::pipeline
