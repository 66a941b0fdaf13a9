#include "haptics/replay/unrolled_trace.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "base/error.h"
#include "haptics/window/surface.h"
#include "scene/folder/repeated_read.h"
#include "scene/frame/unrolling.h"

namespace sparsha::haptics {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kMostNodes = 1U << 28U;

/// Makes the path one of the unrolled frame, each place beside the one before it and not on the other side of the seam.
void lay_flat(std::vector<HipSample>& path, const scene::Unrolling& unrolling) {
  int turns = 0;
  double before = 0.0;
  for (HipSample& sample : path) {
    if (!sample.position_m.allFinite()) continue;
    const Eigen::Vector3d flat_m = unrolling.flat(sample.position_m);
    const double angle = unrolling.angle(flat_m);
    turns += static_cast<int>(std::lround((before - angle - kTurn * turns) / kTurn));
    before = angle + kTurn * turns;
    if (unrolling.is_cone() && std::abs(before) > kTurn * 7.0 / 12.0)
      throw usage_error("the path goes farther around the cone than its picture reaches",
                        "paths up to 30 degrees beyond the seam");
    sample.position_m = unrolling.turned(flat_m, turns);
  }
}

scene::Layers layers_under(const scene::Scene& scene, const std::vector<HipSample>& path) {
  const scene::Lattice& lattice = scene.description().levels.front();
  const int around = scene::nodes_around(scene.description(), 0);
  if (around == 0) return scene.read_level(0);
  double left = 0.0, right = lattice.nx;
  for (const HipSample& sample : path) {
    const double i = (sample.position_m.x() - lattice.x_m(0)) / lattice.spacing_m;
    if (!std::isfinite(i)) continue;
    left = std::min(left, i);
    right = std::max(right, i + 1.0);
  }
  left = left < 0.0 ? std::floor(left / around) * around : 0.0;
  right = right > lattice.nx ? lattice.nx + std::ceil((right - lattice.nx) / around) * around : lattice.nx;
  if ((right - left) * lattice.ny > kMostNodes)
    throw usage_error("the path goes around too often", "a path of fewer turns");
  return scene::read_repeated(scene, 0, static_cast<int>(left), 0, static_cast<int>(right - left), lattice.ny);
}

}  // namespace

TraceResult trace_unrolled(const scene::Scene& scene, const std::vector<HipSample>& path,
                           const SurfaceOptions& surface_options, const scene::HapticsConfig& haptics,
                           const SolverOptions& options, Progress* progress) {
  const scene::SceneDescription& description = scene.description();
  const scene::Unrolling unrolling(*description.config.unroll, description.config.orientation.scan_to_grid);
  std::vector<HipSample> flat = path;
  lay_flat(flat, unrolling);
  const auto surface = make_surface(description, layers_under(scene, flat), 0, 1.0, surface_options);
  TraceResult result = trace(*surface, flat, haptics, options, progress);
  for (std::size_t n = 0; n < result.rows.size(); ++n) {
    TraceRow& row = result.rows[n];
    const Eigen::Vector3d proxy_m = row.proxy_m;
    row.hip_m = path[n].position_m;
    row.proxy_m = proxy_m == flat[n].position_m ? row.hip_m : unrolling.scan(proxy_m);
    row.force_n = unrolling.scan_from_flat(proxy_m) * row.force_n;
  }
  return result;
}

}  // namespace sparsha::haptics
