// Vertices are taken cube by cube of space, so that the nodes about them are looked up once a cube.
#include "pipeline/solid/vertex_colours.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "base/numbers/colour_sum.h"
#include "scene/solid/surface_nodes.h"

namespace sparsha::pipeline {
namespace {

/// `about`: nodes within reach of it, and others.
std::uint32_t colour_at(const Eigen::Vector3d& place_m, const std::vector<scene::SurfaceNode>& about, double reach_m,
                        double alike_m) {
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const scene::SurfaceNode& node : about) {
    if (node.value != 0.0) nearest_m = std::min(nearest_m, (node.place_m - place_m).norm());
  }
  if (nearest_m > reach_m) return 0;
  ColourSum sum;
  for (const scene::SurfaceNode& node : about)
    if ((node.place_m - place_m).norm() <= nearest_m + alike_m) sum.add(static_cast<std::uint32_t>(node.value));
  return sum.mean();
}

}  // namespace

bool has_colours(const scene::Charts& charts) {
  return !charts.sheets.empty() && std::ranges::all_of(charts.sheets, [](const scene::Sheet& sheet) {
    return sheet.colour_rgba.size() == sheet.count();
  });
}

std::vector<std::uint32_t> vertex_colours(const scene::Charts& charts, const std::vector<Eigen::Vector3f>& vertices_m,
                                          const Context& context) {
  constexpr double kReach = 2.0, kAlike = 1.0 / 3.0;  // spacings
  const double reach_m = kReach * charts.spacing_m, alike_m = kAlike * charts.spacing_m;
  const scene::SurfaceNodes nodes(charts, reach_m + alike_m, 1, [](const scene::Sheet& sheet, std::size_t node) {
    return static_cast<double>(sheet.colour_rgba[node]);
  });
  std::vector<std::pair<std::uint64_t, std::size_t>> order(vertices_m.size());
  for (std::size_t v = 0; v < order.size(); ++v)
    order[v] = {scene::SurfaceNodes::key_of(nodes.cube_of(vertices_m[v].cast<double>())), v};
  std::sort(order.begin(), order.end());
  std::vector<std::uint32_t> colours(vertices_m.size(), 0);
  constexpr std::size_t kPiece = 4096;
  context.pool.for_ranges(order.size(), kPiece, [&](std::size_t begin, std::size_t end) {
    std::vector<scene::SurfaceNode> about;
    for (std::size_t k = begin; k < end; ++k) {
      const Eigen::Vector3d place_m = vertices_m[order[k].second].cast<double>();
      if (k == begin || order[k].first != order[k - 1].first) nodes.near(nodes.cube_of(place_m), about);
      colours[order[k].second] = colour_at(place_m, about, reach_m, alike_m);
    }
  });
  return colours;
}

}  // namespace sparsha::pipeline
