#include "scene/area/regions.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "base/png/png_reader.h"
#include "scene/scene.h"

namespace sparsha::scene {
namespace {

/// What was made before of a part that lies there too.
const Area* known_area(const SceneDescription& scene, const PartConfig& part) {
  if (!scene.part_areas) return nullptr;
  for (const Area& area : *scene.part_areas) {
    if (const auto polygon = area.polygon(); polygon && polygon->corners_m() == part.polygon_m) return &area;
    if (const auto label = area.label(); label && label->map() == scene.label_map && label->label() == part.label)
      return &area;
  }
  return nullptr;
}

Area make_area(const SceneDescription& scene, const PartConfig& part) {
  if (part.is_box()) return Area(part.box_m);
  if (part.solid_m) return solid_area(scene, *part.solid_m);
  if (const Area* known = known_area(scene, part)) return *known;
  if (!part.label) return Area(std::make_shared<const Polygon>(part.polygon_m));
  return scene.label_map ? Area(std::make_shared<const LabelArea>(scene.label_map, *part.label)) : Area();
}

/// Of the nodes that belong to a part.
class Found {
 public:
  void add(double x_m, double y_m, double depth_m) {
    box_m_ = {std::min(box_m_[0], x_m), std::min(box_m_[1], y_m), std::max(box_m_[2], x_m), std::max(box_m_[3], y_m)};
    if (!(depth_m > depth_m_)) return;
    depth_m_ = depth_m;
    deepest_m_ = {x_m, y_m};
  }
  [[nodiscard]] std::optional<PartPlace> place(bool is_box) const {
    if (!(box_m_[0] <= box_m_[2])) return std::nullopt;
    const Eigen::Vector2d middle_m(0.5 * (box_m_[0] + box_m_[2]), 0.5 * (box_m_[1] + box_m_[3]));
    return PartPlace{box_m_, is_box ? middle_m : deepest_m_};
  }

 private:
  static constexpr double kFar = std::numeric_limits<double>::infinity();
  std::array<double, 4> box_m_{kFar, kFar, -kFar, -kFar};
  double depth_m_ = -kFar;
  Eigen::Vector2d deepest_m_ = Eigen::Vector2d::Zero();
};

}  // namespace

Area solid_area(const SceneDescription& scene, const std::array<double, 6>& box_m) {
  Eigen::Matrix4d scan_from_region = scene.scan_from_grid;
  if (scene.region_from_grid) scan_from_region *= scene.region_from_grid->inverse();
  return Area(SolidBox::of(box_m, RegionFrame(scan_from_region.topRows<3>())));
}

std::shared_ptr<const LabelMap> label_map_of(const SceneDescription& scene) {
  if (scene.label_map || !scene.config.audio || !scene.config.audio->labels) return scene.label_map;
  const LabelImageConfig& config = *scene.config.audio->labels;
  NumberImage image = read_number_png(config.file);
  auto map = std::make_shared<LabelMap>();
  map->width = image.width;
  map->height = image.height;
  map->values = std::move(image.values);
  if (config.bounds_m) {
    map->bounds_m = *config.bounds_m;
  } else {
    const Lattice& grid = scene.levels.front();
    map->bounds_m = {grid.x_m(0), grid.y_m(0), grid.x_m(grid.nx - 1), grid.y_m(grid.ny - 1)};
  }
  return map;
}

void make_areas(SceneDescription& scene) {
  const auto& parts = scene.config.parts;
  if (std::any_of(parts.begin(), parts.end(), [](const PartConfig& part) { return part.label.has_value(); }))
    scene.label_map = label_map_of(scene);
  auto areas = std::make_shared<std::vector<Area>>();
  for (const PartConfig& part : parts) areas->push_back(make_area(scene, part));
  scene.part_areas = std::move(areas);
}

Area area_of(const SceneDescription& scene, std::size_t part) {
  const PartConfig& config = scene.config.parts.at(part);
  if (config.is_box()) return Area(config.box_m);
  const bool ready = scene.part_areas && scene.part_areas->size() == scene.config.parts.size();
  return ready ? (*scene.part_areas)[part] : make_area(scene, config);
}

const PartConfig* part_at(const SceneDescription& scene, const std::array<double, 3>& place_m) {
  for (std::size_t part = 0; part < scene.config.parts.size(); ++part)
    if (area_of(scene, part).holds(Eigen::Vector3d(place_m[0], place_m[1], place_m[2])))
      return &scene.config.parts[part];
  return nullptr;
}

std::optional<PartPlace> solid_place(const SceneDescription& scene, const SolidBox& solid) {
  if (!scene.charts) return std::nullopt;
  const Charts& charts = *scene.charts;
  Eigen::AlignedBox3d box;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (const Sheet& sheet : charts.sheets)
    for (int j = 0; j < sheet.ny; ++j)
      for (int i = 0; i < sheet.nx; ++i) {
        if (!sheet.measured(sheet.index(i, j))) continue;
        const Eigen::Vector3d place_m = charts.origin_m + charts.place_m(sheet, i, j);
        Eigen::Vector3d region_m = place_m;
        if (scene.region_from_grid) region_m = (*scene.region_from_grid * place_m.homogeneous()).head<3>();
        if (solid.inside_m(region_m) < 0.0) continue;
        box.extend(place_m);
        normal += Charts::normal(sheet, i, j);
      }
  if (box.isEmpty()) return std::nullopt;
  PartPlace place{{box.min().x(), box.min().y(), box.max().x(), box.max().y()}, box.center().head<2>()};
  place.solid = PartPlace::Solid{box.center(), normal, box.diagonal().norm()};
  return place;
}

std::optional<PartPlace> part_place(const Scene& scene, std::size_t part) {
  const SceneDescription& description = scene.description();
  const Area area = area_of(description, part);
  if (area.solid() != nullptr) return solid_place(description, *area.solid());
  if (!description.region_from_grid) {
    const std::optional<Area::Box> box_m = area.bounds_m();
    const std::optional<Eigen::Vector2d> middle_m = area.middle_m();
    return box_m && middle_m ? std::optional(PartPlace{*box_m, *middle_m}) : std::nullopt;
  }
  const Eigen::Matrix4d& region_from_grid = *description.region_from_grid;
  const int coarsest = static_cast<int>(description.levels.size()) - 1;
  const DepthGrid grid = scene.read_level(coarsest).grid;
  const Lattice& lattice = grid.lattice;
  Found found;
  for (int j = 0; j < lattice.ny; ++j)
    for (int i = 0; i < lattice.nx; ++i) {
      const auto height_m = static_cast<double>(grid.height_m[lattice.index(i, j)]);
      if (!std::isfinite(height_m)) continue;
      const double x_m = lattice.x_m(i);
      const double y_m = lattice.y_m(j);
      const Eigen::Vector4d place = region_from_grid * Eigen::Vector4d(x_m, y_m, lattice.origin_m.z() + height_m, 1.0);
      if (!area.holds(place.x(), place.y())) continue;
      found.add(x_m, y_m, area.box() != nullptr ? 0.0 : area.inside_m(place.x(), place.y()));
    }
  return found.place(area.box() != nullptr);
}

std::optional<std::array<double, 4>> part_box(const Scene& scene, std::size_t part) {
  const std::optional<PartPlace> place = part_place(scene, part);
  return place ? std::optional(place->box_m) : std::nullopt;
}

}  // namespace sparsha::scene
