#include "haptics/session/guide_line.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "haptics/outline/outline.h"
#include "scene/regions.h"

namespace sparsha::haptics {
namespace {

using Eigen::Vector2d;
using Box = std::array<double, 4>;

constexpr std::size_t kMostNodes = 4'000'000;
constexpr double kRoom = 0.1;    // of a part's size, around it
constexpr double kInside = 0.8;  // of a line's points, in the box

/// The finest level that is not finer than the one touched nor too large.
int searched_level(const pipeline::SceneDescription& scene, int touched) {
  int level = std::clamp(touched, 0, static_cast<int>(scene.levels.size()) - 1);
  while (level + 1 < static_cast<int>(scene.levels.size()) &&
         scene.levels[static_cast<std::size_t>(level)].count() > kMostNodes)
    ++level;
  return level;
}

Box grown(const Box& box) {
  const double room_m = kRoom * std::max(box[2] - box[0], box[3] - box[1]);
  return {box[0] - room_m, box[1] - room_m, box[2] + room_m, box[3] + room_m};
}

bool mostly_inside(const Line& line, const Box& box) {
  const auto inside =
      std::count_if(line.begin(), line.end(), [&](const Vector2d& p) { return pipeline::in_box(box, p.x(), p.y()); });
  return static_cast<double>(inside) >= kInside * static_cast<double>(line.size());
}

Vector2d way_to(const GuidePath& path, const Vector2d& hand_m) {
  return path.point_m(path.nearest_among(0, path.pieces(), hand_m)) - hand_m;
}

/// The longest in the box, else the nearest.
Line choose(std::vector<Line> lines, const std::optional<Box>& box, const Vector2d& hand_m) {
  if (box)
    for (Line& line : lines)
      if (mostly_inside(line, *box)) return std::move(line);
  Line* nearest = nullptr;
  double least_m = std::numeric_limits<double>::infinity();
  for (Line& line : lines)
    if (const double distance_m = way_to(GuidePath(line), hand_m).norm(); distance_m < least_m) {
      least_m = distance_m;
      nearest = &line;
    }
  return nearest != nullptr ? std::move(*nearest) : Line{};
}

/// Index of the part that was asked for, else of the nearest one that is on this side.
std::optional<std::size_t> chosen_part(const GuideWish& wish) {
  if (wish.part) return wish.part;
  const auto& parts = wish.scene->description().config.parts;
  std::optional<std::size_t> nearest;
  double least_m = std::numeric_limits<double>::infinity();
  for (std::size_t part = 0; part < parts.size(); ++part) {
    const std::optional<Box> box = pipeline::part_box(*wish.scene, parts[part]);
    if (!box) continue;
    const double x_m = std::max({(*box)[0] - wish.hand_m.x(), 0.0, wish.hand_m.x() - (*box)[2]});
    const double y_m = std::max({(*box)[1] - wish.hand_m.y(), 0.0, wish.hand_m.y() - (*box)[3]});
    if (std::hypot(x_m, y_m) >= least_m) continue;
    least_m = std::hypot(x_m, y_m);
    nearest = part;
  }
  return nearest;
}

/// The part's own border, as far as the scene reaches; of an object that was turned, the border of the places that
/// belong to the part.
Line border_of(const pipeline::Scene& scene, const pipeline::PartConfig& part, int level) {
  const pipeline::SceneDescription& description = scene.description();
  const pipeline::Lattice& lattice = description.levels.at(static_cast<std::size_t>(level));
  if (!description.region_from_grid) {
    const Box& box = part.box_m;
    const double left = std::max(box[0], lattice.x_m(0));
    const double right = std::min(box[2], lattice.x_m(lattice.nx - 1));
    const double low = std::max(box[1], lattice.y_m(0));
    const double high = std::min(box[3], lattice.y_m(lattice.ny - 1));
    if (!(left < right && low < high)) return {};
    return {{left, low}, {right, low}, {right, high}, {left, high}, {left, low}};
  }
  const pipeline::DepthGrid grid = scene.read_level(level).grid;
  const Eigen::Matrix4d& region_from_grid = *description.region_from_grid;
  std::vector<Line> borders = find_borders(lattice, [&](int i, int j) {
    const auto height_m = static_cast<double>(grid.height_m[lattice.index(i, j)]);
    if (!std::isfinite(height_m)) return false;
    const Eigen::Vector4d place =
        region_from_grid * Eigen::Vector4d(lattice.x_m(i), lattice.y_m(j), lattice.origin_m.z() + height_m, 1.0);
    return pipeline::in_box(part.box_m, place.x(), place.y());
  });
  return borders.empty() ? Line{} : std::move(borders.front());
}

/// The run of the drawn line that lies on the scene.
Line drawn_line(const pipeline::SceneDescription& scene, const pipeline::GuideConfig& config) {
  const pipeline::Lattice& lattice = scene.levels.front();
  const Box box{lattice.x_m(0), lattice.y_m(0), lattice.x_m(lattice.nx - 1), lattice.y_m(lattice.ny - 1)};
  Line line;
  for (const auto& point : config.line_m) line.emplace_back(point[0], point[1]);
  const bool outside =
      std::none_of(line.begin(), line.end(), [&](const Vector2d& p) { return pipeline::in_box(box, p.x(), p.y()); });
  return outside ? Line{} : line;
}

}  // namespace

GuideAnswer find_guide(const GuideWish& wish) {
  using Path = pipeline::GuideConfig::Path;
  const pipeline::SceneDescription& scene = wish.scene->description();
  const pipeline::GuideConfig config = scene.config.guide.value_or(pipeline::GuideConfig{});
  const int level = searched_level(scene, wish.level);
  GuideAnswer answer;
  Line line;
  if (config.path == Path::drawn) {
    answer.why = scene.region_from_grid ? Phrase("guide_other_side") : Phrase("guide_no_line");
    if (!scene.region_from_grid) line = drawn_line(scene, config);
  } else if (config.path == Path::part) {
    answer.why = "no_parts";
    if (const std::optional<std::size_t> part = chosen_part(wish)) {
      answer.why = "guide_no_outline";
      answer.part = scene.config.parts.at(*part).say;
      line = border_of(*wish.scene, scene.config.parts[*part], level);
    }
  } else {
    std::optional<Box> box;
    if (wish.part) box = pipeline::part_box(*wish.scene, scene.config.parts.at(*wish.part));
    if (box) box = grown(*box);
    line = choose(find_outlines(wish.scene->read_level(level).grid, scene.noise_m), box, wish.hand_m);
  }
  if (line.size() < 2) return answer;
  answer.guide = std::make_shared<const Guide>(Guide{GuidePath(line), config.force_n, config.speed_m_per_s});
  answer.way_m = way_to(answer.guide->path, wish.hand_m);
  return answer;
}

}  // namespace sparsha::haptics
