#include "haptics/session/guide_line.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "haptics/outline/outline.h"
#include "scene/area/regions.h"
#include "scene/scene.h"

namespace sparsha::haptics {
namespace {

using Eigen::Vector2d;
using Box = std::array<double, 4>;

constexpr std::size_t kMostNodes = 4'000'000;
constexpr double kRoom = 0.1;    // of a part's size, around it
constexpr double kInside = 0.8;  // of a line's points, in the box

/// The finest level that is not finer than the one touched nor too large.
int searched_level(const scene::SceneDescription& scene, int touched) {
  int level = std::clamp(touched, 0, static_cast<int>(scene.levels.size()) - 1);
  while (level + 1 < static_cast<int>(scene.levels.size()) &&
         scene.levels[static_cast<std::size_t>(level)].count() > kMostNodes)
    ++level;
  return level;
}

/// Whether a place is in a part or near it.
using Near = std::function<bool(const Vector2d& place_m)>;

/// Empty where the part is nowhere. Of an object that was turned the box of the places that belong to the part.
Near near_part(const scene::Scene& scene, std::size_t part) {
  const std::optional<Box> box = scene::part_box(scene, part);
  if (!box) return {};
  const double room_m = kRoom * std::max((*box)[2] - (*box)[0], (*box)[3] - (*box)[1]);
  const Box grown{(*box)[0] - room_m, (*box)[1] - room_m, (*box)[2] + room_m, (*box)[3] + room_m};
  const scene::Area area = scene::area_of(scene.description(), part);
  const bool boxed = area.box() != nullptr || scene.description().region_from_grid.has_value();
  return [=](const Vector2d& p) {
    return scene::in_box(grown, p.x(), p.y()) && (boxed || area.inside_m(p.x(), p.y()) >= -room_m);
  };
}

bool mostly(const Line& line, const Near& near) {
  const auto inside = std::count_if(line.begin(), line.end(), near);
  return static_cast<double>(inside) >= kInside * static_cast<double>(line.size());
}

Vector2d way_to(const GuidePath& path, const Vector2d& hand_m) {
  const Eigen::Vector3d place_m(hand_m.x(), hand_m.y(), 0.0);
  return (path.point_m(path.nearest_among(0, path.pieces(), place_m)) - place_m).head<2>();
}

/// The longest in or near the part, else the nearest.
Line choose(std::vector<Line> lines, const Near& near, const Vector2d& hand_m) {
  if (near)
    for (Line& line : lines)
      if (mostly(line, near)) return std::move(line);
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
  const scene::SceneDescription& scene = wish.scene->description();
  std::optional<std::size_t> nearest;
  double least_m = std::numeric_limits<double>::infinity();
  for (std::size_t part = 0; part < scene.config.parts.size(); ++part) {
    const std::optional<Box> box = scene::part_box(*wish.scene, part);
    if (!box) continue;
    const scene::Area area = scene.region_from_grid ? scene::Area(*box) : scene::area_of(scene, part);
    const double way_m = area.distance_m(wish.hand_m.x(), wish.hand_m.y());
    if (way_m >= least_m) continue;
    least_m = way_m;
    nearest = part;
  }
  return nearest;
}

/// What of a closed line lies on one side of a line along an axis, closed along that line (Sutherland & Hodgman 1974).
Line clipped(const Line& loop, Eigen::Index axis, double limit_m, bool keeps_less) {
  const auto keeps = [&](const Vector2d& p) { return keeps_less ? p[axis] <= limit_m : p[axis] >= limit_m; };
  Line left;
  const auto add = [&left](const Vector2d& p) {
    if (left.empty() || left.back() != p) left.push_back(p);
  };
  for (std::size_t k = 0; k + 1 < loop.size(); ++k) {
    const Vector2d& from = loop[k];
    const Vector2d& to = loop[k + 1];
    if (keeps(from)) add(from);
    if (keeps(from) == keeps(to)) continue;
    Vector2d crossing = from + (limit_m - from[axis]) / (to[axis] - from[axis]) * (to - from);
    crossing[axis] = limit_m;
    add(crossing);
  }
  if (left.size() < 3) return {};
  if (left.back() != left.front()) left.push_back(left.front());
  return left;
}

double length_m(const Line& line) {
  double sum_m = 0.0;
  for (std::size_t k = 1; k < line.size(); ++k) sum_m += (line[k] - line[k - 1]).norm();
  return sum_m;
}

/// The longest of an area's borders, as far as the scene reaches.
Line border_on(const scene::Area& area, const scene::Lattice& lattice) {
  Line longest;
  for (Line border : area.borders_m()) {
    border = clipped(border, 0, lattice.x_m(0), false);
    border = clipped(border, 0, lattice.x_m(lattice.nx - 1), true);
    border = clipped(border, 1, lattice.y_m(0), false);
    border = clipped(border, 1, lattice.y_m(lattice.ny - 1), true);
    if (length_m(border) > length_m(longest)) longest = std::move(border);
  }
  return longest;
}

/// The part's own border, as far as the scene reaches; of an object that was turned, the border of the places that
/// belong to the part.
Line border_of(const scene::Scene& scene, std::size_t part, int level) {
  const scene::SceneDescription& description = scene.description();
  const scene::Area area = scene::area_of(description, part);
  const scene::Lattice& lattice = description.levels.at(static_cast<std::size_t>(level));
  if (!description.region_from_grid) {
    if (area.box() == nullptr) return border_on(area, lattice);
    const Box& box = *area.box();
    const double left = std::max(box[0], lattice.x_m(0));
    const double right = std::min(box[2], lattice.x_m(lattice.nx - 1));
    const double low = std::max(box[1], lattice.y_m(0));
    const double high = std::min(box[3], lattice.y_m(lattice.ny - 1));
    if (!(left < right && low < high)) return {};
    return {{left, low}, {right, low}, {right, high}, {left, high}, {left, low}};
  }
  const scene::DepthGrid grid = scene.read_level(level).grid;
  const Eigen::Matrix4d& region_from_grid = *description.region_from_grid;
  std::vector<Line> borders = find_borders(lattice, [&](int i, int j) {
    const auto height_m = static_cast<double>(grid.height_m[lattice.index(i, j)]);
    if (!std::isfinite(height_m)) return false;
    const Eigen::Vector4d place =
        region_from_grid * Eigen::Vector4d(lattice.x_m(i), lattice.y_m(j), lattice.origin_m.z() + height_m, 1.0);
    return area.holds(place.x(), place.y());
  });
  return borders.empty() ? Line{} : std::move(borders.front());
}

/// The share of a segment, from begin to end, that lies in a box (Liang & Barsky 1984); empty where none does.
std::optional<std::array<double, 2>> share_in(const Box& box, const Vector2d& from, const Vector2d& to) {
  double begin = 0.0, end = 1.0;
  for (Eigen::Index axis = 0; axis < 2; ++axis) {
    const double low = box.at(static_cast<std::size_t>(axis)), high = box.at(static_cast<std::size_t>(axis) + 2);
    const double way = to[axis] - from[axis];
    if (way == 0.0) {
      if (from[axis] < low || from[axis] > high) return std::nullopt;
      continue;
    }
    const double enters = ((way > 0.0 ? low : high) - from[axis]) / way;
    const double leaves = ((way > 0.0 ? high : low) - from[axis]) / way;
    begin = std::max(begin, enters);
    end = std::min(end, leaves);
  }
  if (begin > end) return std::nullopt;
  return std::array{begin, end};
}

/// The runs of a line that lie in a box. Of a closed line the last one goes on with the first.
std::vector<Line> runs_in(const Box& box, const Line& line) {
  std::vector<Line> runs;
  bool goes_on = false;
  for (std::size_t k = 0; k + 1 < line.size(); ++k) {
    const Vector2d way = line[k + 1] - line[k];
    const auto share = share_in(box, line[k], line[k + 1]);
    if (!share) {
      goes_on = false;
      continue;
    }
    if (!goes_on) runs.push_back({(*share)[0] > 0.0 ? Vector2d(line[k] + (*share)[0] * way) : line[k]});
    goes_on = (*share)[1] == 1.0;
    const Vector2d end = goes_on ? line[k + 1] : Vector2d(line[k] + (*share)[1] * way);
    if (end != runs.back().back()) runs.back().push_back(end);
  }
  if (runs.size() > 1 && line.front() == line.back() && goes_on && runs.front().front() == line.front()) {
    runs.back().insert(runs.back().end(), runs.front().begin() + 1, runs.front().end());
    runs.erase(runs.begin());
  }
  return runs;
}

/// The longest run of the drawn line that lies on the scene.
Line drawn_line(const scene::SceneDescription& scene, const scene::GuideConfig& config) {
  const scene::Lattice& lattice = scene.levels.front();
  const Box box{lattice.x_m(0), lattice.y_m(0), lattice.x_m(lattice.nx - 1), lattice.y_m(lattice.ny - 1)};
  Line line;
  for (const auto& point : config.line_m) line.emplace_back(point[0], point[1]);
  Line longest;
  for (Line& run : runs_in(box, line))
    if (length_m(run) > length_m(longest)) longest = std::move(run);
  return longest;
}

}  // namespace

GuideAnswer find_guide(const GuideWish& wish) {
  if (wish.around) return find_guide_on_object(wish);
  using Path = scene::GuideConfig::Path;
  const scene::SceneDescription& scene = wish.scene->description();
  const scene::GuideConfig config = scene.config.guide.value_or(scene::GuideConfig{});
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
      line = border_of(*wish.scene, *part, level);
    }
  } else {
    const Near near = wish.part ? near_part(*wish.scene, *wish.part) : Near{};
    line = choose(find_outlines(wish.scene->read_level(level).grid, scene.noise_m), near, wish.hand_m.head<2>());
  }
  if (line.size() < 2) return answer;
  answer.guide = std::make_shared<const Guide>(Guide{GuidePath(line), config.force_n, config.speed_m_per_s});
  answer.way_m = wish.scale * way_to(answer.guide->path, wish.hand_m.head<2>());
  return answer;
}

}  // namespace sparsha::haptics
