#include "pipeline/build/empty_places.h"

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <Eigen/Core>
#include <Eigen/Geometry>

#include "scene/area/regions.h"
#include "scene/scene.h"

namespace sparsha::pipeline {
namespace {

void warn_if_beside(const scene::SceneDescription& scene, const std::string& what, const scene::Area::Box& box_m,
                    Progress& progress) {
  const scene::Lattice& grid = scene.levels.front();
  const double xmax_m = grid.x_m(grid.nx - 1), ymax_m = grid.y_m(grid.ny - 1);
  const bool beside =
      box_m.at(2) < grid.x_m(0) || box_m.at(0) > xmax_m || box_m.at(3) < grid.y_m(0) || box_m.at(1) > ymax_m;
  if (!beside || scene.region_from_grid) return;
  progress.warn(fmt::format("{} is nowhere: it lies beside the grid, which is [{:.3f}, {:.3f}, {:.3f}, {:.3f}] m", what,
                            grid.x_m(0), grid.y_m(0), xmax_m, ymax_m));
}

// What was drawn for another grid, in another unit or on another label image. `what`: "part 'lotus'".
void warn_if_nowhere(const scene::SceneDescription& scene, const std::string& what, const scene::Area& area,
                     const std::optional<int>& label, Progress& progress) {
  if (area.solid() != nullptr) {
    if (!scene::solid_place(scene, *area.solid()))
      progress.warn(fmt::format("{} is nowhere: no surface lies in its box of the scans' frame", what));
    return;
  }
  const std::optional<scene::Area::Box> box_m = area.bounds_m();
  if (!box_m) {
    progress.warn(label ? fmt::format("{} is nowhere: no pixel of the label image has the value {}", what, *label)
                        : fmt::format("{} is nowhere: its polygon encloses nothing", what));
    return;
  }
  warn_if_beside(scene, what, *box_m, progress);
}

}  // namespace

void warn_of_empty_places(const scene::SceneDescription& scene, Progress& progress) {
  for (std::size_t part = 0; part < scene.config.parts.size(); ++part) {
    const scene::PartConfig& config = scene.config.parts[part];
    warn_if_nowhere(scene, fmt::format("part '{}'", config.name), scene::area_of(scene, part), config.label, progress);
  }
  if (const auto& guide = scene.config.guide; guide && !guide->line_m.empty()) {
    const auto& line_m = guide->line_m;
    const auto [left, right] = std::ranges::minmax_element(line_m, {}, [](const auto& point) { return point[0]; });
    const auto [low, high] = std::ranges::minmax_element(line_m, {}, [](const auto& point) { return point[1]; });
    warn_if_beside(scene, "the guide's line", {(*left)[0], (*low)[1], (*right)[0], (*high)[1]}, progress);
  }
  if (const auto& guide = scene.config.guide; guide && !guide->line_in_space_m.empty()) {
    Eigen::AlignedBox3d box;
    for (const auto& [x, y, z] : guide->line_in_space_m) box.extend(Eigen::Vector3d(x, y, z));
    const double reach_m = scene::GuideConfig::kReachSpacings * (scene.charts ? scene.charts->spacing_m : 0.0);
    box = Eigen::AlignedBox3d(box.min().array() - reach_m, box.max().array() + reach_m);
    const scene::Area area = scene::solid_area(
        scene, {box.min().x(), box.min().y(), box.min().z(), box.max().x(), box.max().y(), box.max().z()});
    warn_if_nowhere(scene, "the guide's line", area, {}, progress);
  }
  if (!scene.config.audio) return;
  std::shared_ptr<const scene::LabelMap> labels;
  for (const scene::AudioRegionConfig& region : scene.config.audio->regions) {
    if (!region.has_place()) continue;
    scene::Area area;
    if (region.box_m) {
      area = scene::Area(*region.box_m);
    } else if (region.solid_m) {
      area = scene::solid_area(scene, *region.solid_m);
    } else if (!region.polygon_m.empty()) {
      area = scene::Area(std::make_shared<const scene::Polygon>(region.polygon_m));
    } else {
      if (!labels) labels = scene::label_map_of(scene);
      area =
          scene::Area(std::make_shared<const scene::LabelArea>(labels, *region.label, scene::LabelArea::Border::none));
    }
    warn_if_nowhere(scene, fmt::format("audio region '{}'", region.name), area, region.label, progress);
  }
}

}  // namespace sparsha::pipeline
