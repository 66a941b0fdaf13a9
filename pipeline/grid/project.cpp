// The projection's stages in order; each stage has its own file beside this one.
#include "pipeline/grid/project.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <new>

#include "pipeline/base/error.h"
#include "pipeline/grid/project_attributes.h"
#include "pipeline/grid/project_bins.h"
#include "pipeline/grid/project_extent.h"
#include "pipeline/grid/project_fate.h"
#include "pipeline/grid/project_kernel.h"
#include "pipeline/grid/project_lattice.h"
#include "pipeline/grid/project_node.h"
#include "pipeline/grid/project_points.h"
#include "pipeline/grid/project_samples.h"
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

constexpr std::size_t kRows = 8;

// 1/R^2 of the kernel by the number of front points in a window.
std::vector<float> kernel_radii(double window_area) {
  std::vector<float> per_r2(NodeKernel::kMostPoints + 1, 0.0F);
  for (std::size_t points = 1; points < per_r2.size(); ++points) {
    const double radius =
        kernel_radius(std::max(1.0, std::sqrt(window_area / static_cast<double>(points))), points, window_area);
    per_r2[points] = static_cast<float>(1.0 / (radius * radius));
  }
  return per_r2;
}

NodeKernel node_kernel(const Bins& bins, double noise_m, const std::array<std::vector<float>, 2>& per_r2) {
  const BinLattice& lattice = bins.lattice;
  const double scale = residual_scale(noise_m, lattice.spacing_m);
  NodeKernel kernel;
  kernel.start = bins.start.get();
  kernel.top = bins.top.get();
  kernel.x = bins.x.get();
  kernel.y = bins.y.get();
  kernel.z = bins.z.get();
  kernel.bins_x = static_cast<std::size_t>(lattice.bins_x());
  kernel.margin = BinLattice::kMargin;
  kernel.nx = static_cast<std::size_t>(lattice.nx);
  kernel.x0_m = lattice.x0_m;
  kernel.y0_m = lattice.y0_m;
  kernel.spacing_m = lattice.spacing_m;
  kernel.band_m = static_cast<float>(6.0 * noise_m + 2.25 * lattice.spacing_m);
  kernel.scale_m = static_cast<float>(scale);
  kernel.ridge = static_cast<float>(slope_ridge(scale, lattice.spacing_m));
  for (std::size_t reach = 0; reach < 2; ++reach) kernel.per_r2[reach] = per_r2[reach].data();
  return kernel;
}

// Simple nodes by the kernel, row by row; the others by NodeFitter.
void fit_nodes(const Bins& bins, const NodeRule& rule, ThreadPool& pool, Progress& progress, DepthGrid& grid) {
  const Lattice& lattice = grid.lattice;
  const std::array<std::vector<float>, 2> per_r2{kernel_radii(9.0), kernel_radii(25.0)};
  const NodeKernel kernel = node_kernel(bins, rule.noise_m, per_r2);
  pool.for_ranges(static_cast<std::size_t>(lattice.ny), kRows, [&](std::size_t begin, std::size_t end) {
    progress.throw_if_cancelled();
    NodeFitter fitter(bins, rule);
    std::vector<std::uint8_t> decided(kernel.nx);
    for (std::size_t j = begin; j < end; ++j) {
      const std::size_t row = lattice.index(0, static_cast<int>(j));
      fastest_kernels().fit_row(kernel, j, grid.height_m.data() + row, decided.data());
      for (std::size_t i = 0; i < kernel.nx; ++i) {
        if (decided[i] == 0) {
          const NodeFit fit = fitter.fit(static_cast<int>(i), static_cast<int>(j));
          if (!fit.measured) continue;
          grid.height_m[row + i] = static_cast<float>(fit.height_m);
        }
        grid.state[row + i] = NodeState::measured;
      }
    }
  });
}

// A node far below a neighbour, with a point or two at the neighbour's height in its window, may have missed a front
// that chance has thinned there: wider windows decide again.
void look_again(const Bins& bins, const NodeRule& rule, double gap_m, ThreadPool& pool, DepthGrid& grid) {
  const Lattice& lattice = grid.lattice;
  const auto nx = static_cast<std::size_t>(lattice.nx);
  const auto ny = static_cast<std::size_t>(lattice.ny);
  const auto gap = static_cast<float>(gap_m);
  struct Change {
    std::size_t node;
    NodeFit fit;
  };
  std::vector<std::vector<Change>> changes((ny + kRows - 1) / kRows);
  pool.for_ranges(ny, kRows, [&](std::size_t begin, std::size_t end) {
    NodeFitter fitter(bins, rule);
    // One more on either side; unknown heights are NaN and never win a comparison.
    std::vector<float> highest(nx + 2);
    for (std::size_t j = begin; j < end; ++j) {
      std::fill(highest.begin(), highest.end(), -std::numeric_limits<float>::infinity());
      for (std::size_t b = j == 0 ? 0 : j - 1; b <= std::min(ny - 1, j + 1); ++b) {
        const float* row = grid.height_m.data() + b * nx;
        for (std::size_t i = 0; i < nx; ++i) highest[i + 1] = row[i] > highest[i + 1] ? row[i] : highest[i + 1];
      }
      const float* row = grid.height_m.data() + j * nx;
      for (std::size_t i = 0; i < nx; ++i) {
        const float neighbour = std::max(highest[i], std::max(highest[i + 1], highest[i + 2]));
        if (!(neighbour - row[i] > gap)) [[likely]]
          continue;
        const auto a = static_cast<int>(i);
        const auto b = static_cast<int>(j);
        if (!fitter.misses_thin_front(a, b, row[i] + gap)) continue;
        changes[begin / kRows].push_back({j * nx + i, fitter.fit(a, b, 2)});
      }
    }
  });
  for (const std::vector<Change>& of_rows : changes) {
    for (const Change& change : of_rows) {
      if (!change.fit.measured) continue;
      grid.height_m[change.node] = static_cast<float>(change.fit.height_m);
    }
  }
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

  const OrientedPoints points = orient_points(raw, cloud.origin_m, scan_to_grid, pool);
  const Extent extent = supported_extent(points, vertices, pool);
  CloudStatistics statistics = sample_cloud(points, extent, pool);
  if (only_mesh) statistics.noise_m = 0.0;

  Projection projection;
  projection.noise_m = statistics.noise_m;
  projection.point_spacing_m = statistics.point_spacing_m;
  projection.gap_m = layer_gap_m(statistics.noise_m, statistics.point_spacing_m);
  projection.grid =
      DepthGrid(choose_lattice(config, extent, points.origin_m, statistics.point_spacing_m, resolution_m));
  const Lattice& lattice = projection.grid.lattice;
  const BinLattice bin_lattice{lattice.nx, lattice.ny, lattice.spacing_m, lattice.origin_m.x() - points.origin_m.x(),
                               lattice.origin_m.y() - points.origin_m.y()};
  progress.throw_if_cancelled();

  Bins bins;
  if (!only_mesh) {
    bins = sort_into_bins(points, vertices, bin_lattice, pool);
    const double finer = statistics.point_spacing_m / lattice.spacing_m;
    const NodeRule rule{statistics.noise_m, std::clamp(static_cast<int>(std::ceil(6.0 * finer)), 3, 24)};
    fit_nodes(bins, rule, pool, progress, projection.grid);
    look_again(bins, rule, projection.gap_m, pool, projection.grid);
  }
  TriangleHeights mesh;
  if (!cloud.faces.empty()) {
    mesh = project_triangles(points, cloud.faces, bin_lattice, pool);
    merge_mesh(mesh, projection.gap_m, projection.grid);
  }
  if (std::find(projection.grid.state.begin(), projection.grid.state.end(), NodeState::measured) ==
      projection.grid.state.end()) {
    throw input_error({}, "no node of the depth grid can be measured: too few points near each other",
                      "four points around a node; a larger grid.spacing_mm, other bounds or another orientation");
  }
  classify_points(points, bin_lattice, pool, projection);
  if (config.colour || config.intensity) {
    project_attributes(cloud, points, bin_lattice, mesh, config, pool, projection);
  }
  return projection;
} catch (const std::bad_alloc&) {
  throw usage_error("the depth grid does not fit into memory", "a smaller grid.size or larger grid.spacing_mm");
}

}  // namespace sparsha::pipeline
