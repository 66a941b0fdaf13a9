#include "app/exploration/tour.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <utility>
#include <variant>

#include "haptics/window/window.h"
#include "scene/area/regions.h"
#include "scene/frame/workspace.h"
#include "scene/scene.h"

namespace sparsha::app {
namespace {

using Box = std::array<double, 4>;

constexpr std::size_t kNotes = 3;
constexpr std::uint64_t kZoomIn = 1;  // the first button of a grip

/// From the grid frame of a whole level to the device frame of its window.
class Overview {
 public:
  explicit Overview(const scene::SceneDescription& scene) {
    const scene::Lattice& level = scene.levels.at(static_cast<std::size_t>(haptics::overview_level(scene)));
    middle_m_ = haptics::middle_of(level);
    scale_ = scene::level_scale(scene.config.levels.window, level, scene::kDeskWorkspace_m);
  }
  [[nodiscard]] Eigen::Vector2d device_m(double x_m, double y_m) const {
    // Whoever wrote the boxes may have placed some beyond the scene; the hand stays in its workspace.
    constexpr double kReach_m = 0.5 * scene::kDeskWorkspace_m;
    const Eigen::Vector2d place = scale_ * (Eigen::Vector2d(x_m, y_m) - middle_m_);
    return place.cwiseMax(-kReach_m).cwiseMin(kReach_m);
  }
  [[nodiscard]] Eigen::Vector2d middle_of(const Box& box) const {
    return device_m(0.5 * (box[0] + box[2]), 0.5 * (box[1] + box[3]));
  }

 private:
  Eigen::Vector2d middle_m_;
  double scale_ = 1.0;
};

/// From left to right across a part, a little inside its edges: of a box along its middle, else along the run of places
/// inside that goes through its middle. Empty for a part that is nowhere.
std::optional<std::pair<Eigen::Vector2d, Eigen::Vector2d>> way_across(const scene::Area& area) {
  const std::optional<Eigen::Vector2d> middle_m = area.middle_m();
  const std::optional<Box> bounds_m = area.bounds_m();
  if (!middle_m || !bounds_m) return std::nullopt;
  double left_m = (*bounds_m)[0];
  double right_m = (*bounds_m)[2];
  if (area.box() == nullptr) {
    constexpr int kSteps = 200;
    const double step_m = (right_m - left_m) / kSteps;
    const auto end = [&](double by_m) {
      double x_m = middle_m->x();
      for (int step = 0; step < kSteps && area.holds(x_m + by_m, middle_m->y()); ++step) x_m += by_m;
      return x_m;
    };
    left_m = end(-step_m);
    right_m = end(step_m);
  }
  const double inset_m = 0.1 * (right_m - left_m);
  return std::pair(Eigen::Vector2d(left_m + inset_m, middle_m->y()), Eigen::Vector2d(right_m - inset_m, middle_m->y()));
}

haptics::TourStop strike(const Eigen::Vector2d& at_m) { return {haptics::TourStop::Kind::strike, at_m, at_m, 0}; }

}  // namespace

std::vector<haptics::TourStop> tour_of(const scene::SceneDescription& scene) {
  // Boxes of a scene that was turned lie elsewhere in its grid.
  if (scene.levels.empty() || scene.region_from_grid) return {};
  const Overview overview(scene);
  std::vector<haptics::TourStop> tour;
  std::vector<haptics::TourStop> notes;
  if (scene.config.audio) {
    for (const scene::AudioRegionConfig& region : scene.config.audio->regions) {
      if (!region.box_m) continue;
      const haptics::TourStop stop = strike(overview.middle_of(*region.box_m));
      if (std::holds_alternative<std::filesystem::path>(region.sound)) {
        if (tour.empty()) tour.push_back(stop);
      } else if (notes.size() < kNotes) {
        notes.push_back(stop);
      }
    }
  }
  tour.insert(tour.end(), notes.begin(), notes.end());
  scene::Area largest;
  for (std::size_t part = 0; part < scene.config.parts.size(); ++part)
    if (scene::Area area = scene::area_of(scene, part); area.area_m2() > largest.area_m2()) largest = std::move(area);
  if (const auto way = way_across(largest)) {
    const auto& [left_m, right_m] = *way;
    tour.push_back({haptics::TourStop::Kind::stroke, overview.device_m(left_m.x(), left_m.y()),
                    overview.device_m(right_m.x(), right_m.y()), kZoomIn});
  }
  return tour;
}

}  // namespace sparsha::app
