// The line on a whole object that a visitor is led along.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "haptics/outline/object_lines.h"
#include "haptics/session/guide_line.h"
#include "scene/area/regions.h"
#include "scene/scene.h"
#include "scene/solid/surface_nodes.h"

namespace sparsha::haptics {
namespace {

using Eigen::Vector3d;

/// A part of a whole object: how far inside it places of the grid frame are.
class ObjectPart {
 public:
  ObjectPart(const scene::SceneDescription& scene, std::size_t part)
      : region_from_grid_(scene.region_from_grid), area_(scene::area_of(scene, part)) {}

  /// Metres, negative outside.
  [[nodiscard]] double inside_m(const Vector3d& grid_m) const {
    const Vector3d place_m =
        region_from_grid_ ? Vector3d((*region_from_grid_ * grid_m.homogeneous()).head<3>()) : grid_m;
    return area_.solid() != nullptr ? area_.solid()->inside_m(place_m) : area_.inside_m(place_m.x(), place_m.y());
  }

 private:
  std::optional<Eigen::Matrix4d> region_from_grid_;
  scene::Area area_;
};

Vector3d nearest_way(const ObjectLine& line, const Vector3d& hand_m) {
  Vector3d way_m = Vector3d::Constant(std::numeric_limits<double>::infinity());
  for (const LinePlace& corner : line)
    if (const Vector3d to_m = corner.place_m - hand_m; to_m.squaredNorm() < way_m.squaredNorm()) way_m = to_m;
  return way_m;
}

/// Of the lines that are at least half as long as the longest, which comes first, the nearest.
ObjectLine nearest_long(std::vector<ObjectLine> lines, const Vector3d& hand_m, double least_share) {
  ObjectLine* nearest = nullptr;
  double least_m = std::numeric_limits<double>::infinity();
  for (ObjectLine& line : lines) {
    if (length_m(line) < least_share * length_m(lines.front())) break;
    const double distance_m = nearest_way(line, hand_m).norm();
    if (distance_m >= least_m) continue;
    least_m = distance_m;
    nearest = &line;
  }
  return nearest != nullptr ? std::move(*nearest) : ObjectLine{};
}

/// Index of the part that was asked for, else of the one with the nearest node.
std::optional<std::size_t> chosen_object_part(const GuideWish& wish) {
  if (wish.part) return wish.part;
  const scene::SceneDescription& scene = wish.scene->description();
  const scene::Charts& charts = *scene.charts;
  std::optional<std::size_t> nearest;
  double least_m = std::numeric_limits<double>::infinity();
  for (std::size_t part = 0; part < scene.config.parts.size(); ++part) {
    const ObjectPart area(scene, part);
    for (const scene::Sheet& sheet : charts.sheets)
      for (int j = 0; j < sheet.ny; ++j)
        for (int i = 0; i < sheet.nx; ++i) {
          if (!sheet.measured(sheet.index(i, j))) continue;
          const Vector3d place_m = charts.origin_m + charts.place_m(sheet, i, j);
          const double distance_m = (place_m - wish.hand_m).norm();
          if (distance_m >= least_m || area.inside_m(place_m) < 0.0) continue;
          least_m = distance_m;
          nearest = part;
        }
  }
  return nearest;
}

/// The longest outline in or close to the part, else the one nearest to the hand.
ObjectLine outline(const GuideWish& wish) {
  constexpr double kRoom_m = 0.005;             // at the hand, around a part
  constexpr double kInside = 0.8;               // of a line's places, in that
  constexpr double kNodesUnderHand_m = 0.0004;  // apart; finer nodes are not felt as lines
  const scene::SceneDescription& scene = wish.scene->description();
  const scene::Charts& charts = *scene.charts;
  const int stride = std::max(1, static_cast<int>(kNodesUnderHand_m / (wish.scale * charts.spacing_m)));
  std::vector<ObjectLine> lines = find_object_outlines(charts, scene.noise_m, stride);
  if (wish.part) {
    const ObjectPart part(scene, *wish.part);
    for (ObjectLine& line : lines) {
      const auto inside = std::count_if(line.begin(), line.end(), [&](const LinePlace& corner) {
        return part.inside_m(corner.place_m) >= -kRoom_m / wish.scale;
      });
      if (static_cast<double>(inside) >= kInside * static_cast<double>(line.size())) return std::move(line);
    }
  }
  return nearest_long(std::move(lines), wish.hand_m, 0.0);
}

/// The drawn line in the grid frame. Points in the plane lie on what is before them: the front of the object.
std::vector<Vector3d> drawn_places(const scene::SceneDescription& scene, const scene::GuideConfig& config) {
  const scene::Charts& charts = *scene.charts;
  std::vector<Vector3d> places_m;
  if (!config.line_in_space_m.empty()) {
    const Eigen::Matrix4d grid_from_scan = scene.scan_from_grid.inverse();
    for (const auto& [x, y, z] : config.line_in_space_m)
      places_m.emplace_back((grid_from_scan * Eigen::Vector4d(x, y, z, 1.0)).head<3>());
    return places_m;
  }
  const scene::SideAxes front = scene::SideAxes::of(scene::Side::front);
  // Of the nodes about each place the highest one; between them places are moved onto the surface anyway.
  const auto height_m = [&](const Eigen::Vector2d& at_m) {
    const Vector3d at = front.to_chart(Vector3d(at_m.x() - charts.origin_m.x(), at_m.y() - charts.origin_m.y(), 0.0));
    double highest_m = -std::numeric_limits<double>::infinity();
    for (const scene::Sheet& sheet : charts.sheets) {
      if (sheet.side != scene::Side::front) continue;
      const int i = static_cast<int>(std::lround(at.x() / charts.spacing_m)) - sheet.first_u;
      const int j = static_cast<int>(std::lround(at.y() / charts.spacing_m)) - sheet.first_v;
      if (i < 0 || j < 0 || i >= sheet.nx || j >= sheet.ny || !sheet.measured(sheet.index(i, j))) continue;
      highest_m = std::max(highest_m, static_cast<double>(sheet.height_m[sheet.index(i, j)]));
    }
    return charts.origin_m.z() + highest_m;
  };
  for (std::size_t k = 0; k + 1 < config.line_m.size(); ++k) {
    const Eigen::Vector2d from_m(config.line_m[k][0], config.line_m[k][1]);
    const Eigen::Vector2d way_m = Eigen::Vector2d(config.line_m[k + 1][0], config.line_m[k + 1][1]) - from_m;
    const double pieces = std::max(1.0, std::ceil(way_m.norm() / charts.spacing_m));
    for (double piece = k == 0 ? 0.0 : 1.0; piece <= pieces; ++piece) {
      const Eigen::Vector2d at_m = from_m + piece / pieces * way_m;
      places_m.emplace_back(at_m.x(), at_m.y(), height_m(at_m));
    }
  }
  return places_m;
}

}  // namespace

GuideAnswer find_guide_on_object(const GuideWish& wish) {
  using Path = scene::GuideConfig::Path;
  constexpr double kHalf = 0.5;
  const scene::SceneDescription& scene = wish.scene->description();
  const scene::Charts& charts = *scene.charts;
  const scene::GuideConfig config = scene.config.guide.value_or(scene::GuideConfig{});
  GuideAnswer answer;
  ObjectLine line;
  if (config.path == Path::drawn) {
    // A line in the plane was drawn on the side that was the front.
    const bool other_side = scene.region_from_grid.has_value() && config.line_in_space_m.empty();
    answer.why = other_side ? Phrase("guide_other_side") : Phrase("guide_no_line");
    if (!other_side)
      line = on_surface(charts, drawn_places(scene, config), scene::GuideConfig::kReachSpacings * charts.spacing_m);
  } else if (config.path == Path::part) {
    answer.why = "no_parts";
    if (const std::optional<std::size_t> part = chosen_object_part(wish)) {
      answer.why = "guide_no_outline";
      answer.part = scene.config.parts.at(*part).say;
      const ObjectPart area(scene, *part);
      line = nearest_long(find_object_borders(charts, [&](const Vector3d& p) { return area.inside_m(p); }), wish.hand_m,
                          kHalf);
    }
  } else {
    line = outline(wish);
  }
  if (line.size() < 2) return answer;
  std::vector<PathCorner> corners;
  for (const LinePlace& place : line) corners.push_back({place.place_m, place.normal});
  answer.guide = std::make_shared<const Guide>(Guide{GuidePath(corners), config.force_n, config.speed_m_per_s});
  answer.way_m = (wish.turn * (wish.scale * nearest_way(line, wish.hand_m))).head<2>();
  return answer;
}

}  // namespace sparsha::haptics
