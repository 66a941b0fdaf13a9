#include "haptics/replay/traced_surface.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cstddef>

#include "base/error.h"
#include "haptics/window/surface.h"
#include "haptics/window/window.h"
#include "scene/frame/workspace.h"
#include "scene/ground/window_lattice.h"
#include "scene/scene.h"

namespace sparsha::haptics {

std::shared_ptr<const MongeSurface> traced_surface(const scene::Scene& scene, const TracedPart& part) {
  const scene::SceneDescription& description = scene.description();
  SurfaceOptions options;
  options.effects.texture = part.texture;
  options.effects.friction = part.friction;
  options.tip_radius_m = part.tip_radius_m;
  options.progress = part.progress;
  if (part.level < 0 && !part.centre_m) {
    const scene::Layers layers = scene.read_level(0);
    if (part.progress != nullptr) part.progress->throw_if_cancelled();
    return make_surface(description, layers, 0, 1.0, options);
  }
  const int level = std::max(part.level, 0);
  const auto count = static_cast<int>(description.levels.size());
  if (level >= count) {
    throw usage_error(fmt::format("the scene has no level {}", level), fmt::format("0 to {}", count - 1));
  }
  const scene::Lattice& lattice = description.levels[static_cast<std::size_t>(level)];
  if (!scene::has_cell(lattice)) {
    throw usage_error(fmt::format("level {} is a single row of nodes, which cannot be touched", level),
                      fmt::format("0 to {}", overview_level(description)));
  }
  const Eigen::Vector2d centre_m = part.centre_m.value_or(middle_of(lattice));
  WindowPlan plan;
  scene::SceneDescription record = description;  // what a hand falls off is continued
  record.config.haptics.beyond = scene::HapticsConfig::Beyond::continued;
  if (centre_m.allFinite()) plan = plan_window(record, level, centre_m, scene::kDeskWorkspace_m);
  if (plan.nx == 0 || plan.i0 >= lattice.nx || plan.j0 >= lattice.ny || plan.i0 + plan.nx <= 0 ||
      plan.j0 + plan.ny <= 0) {
    throw usage_error("the window around --centre holds nothing of the scene",
                      fmt::format("about {:.6g} to {:.6g} and {:.6g} to {:.6g}", lattice.x_m(0),
                                  lattice.x_m(lattice.nx - 1), lattice.y_m(0), lattice.y_m(lattice.ny - 1)));
  }
  plan.effects = options.effects;
  plan.tip_radius_m = options.tip_radius_m;
  return load_window(scene, plan, 0).surface;
}

Eigen::Vector3d in_grid_frame(const Eigen::Vector3d& position_m, HipFrame frame, const Eigen::Matrix4d& grid_from_scan,
                              const MongeSurface& surface) {
  if (frame == HipFrame::scan) return (grid_from_scan * position_m.homogeneous()).head<3>();
  if (frame == HipFrame::device) return position_m / surface.scale + surface.centre_m;
  return position_m;
}

void to_grid_frame(std::vector<HipSample>& path, HipFrame frame, const scene::SceneDescription& scene,
                   const MongeSurface& surface) {
  if (frame == HipFrame::grid) return;
  const Eigen::Matrix4d grid_from_scan = scene.scan_from_grid.inverse();
  for (HipSample& sample : path) {
    sample.position_m = in_grid_frame(sample.position_m, frame, grid_from_scan, surface);
  }
}

}  // namespace sparsha::haptics
