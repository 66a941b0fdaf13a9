#include "app/tour.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <variant>

#include "haptics/window/scene_window.h"
#include "scene/workspace.h"

namespace sparsha::app {
namespace {

using Box = std::array<double, 4>;

constexpr std::size_t kNotes = 3;
constexpr std::uint64_t kZoomIn = 1;  // the first button of a grip

/// From the grid frame of a whole level to the device frame of its window.
class Overview {
 public:
  explicit Overview(const pipeline::SceneDescription& scene) {
    const pipeline::Lattice& level = scene.levels.at(static_cast<std::size_t>(haptics::overview_level(scene)));
    middle_m_ = haptics::middle_of(level);
    scale_ = pipeline::level_scale(scene.config.levels.window, level, pipeline::kDeskWorkspaceM);
  }
  [[nodiscard]] Eigen::Vector2d device_m(double x_m, double y_m) const {
    // Whoever wrote the boxes may have placed some beyond the scene; the hand stays in its workspace.
    constexpr double kReachM = 0.5 * pipeline::kDeskWorkspaceM;
    const Eigen::Vector2d place = scale_ * (Eigen::Vector2d(x_m, y_m) - middle_m_);
    return place.cwiseMax(-kReachM).cwiseMin(kReachM);
  }
  [[nodiscard]] Eigen::Vector2d middle_of(const Box& box) const {
    return device_m(0.5 * (box[0] + box[2]), 0.5 * (box[1] + box[3]));
  }

 private:
  Eigen::Vector2d middle_m_;
  double scale_ = 1.0;
};

double area_m2(const Box& box) { return (box[2] - box[0]) * (box[3] - box[1]); }

haptics::TourStop strike(const Eigen::Vector2d& at_m) { return {haptics::TourStop::Kind::strike, at_m, at_m, 0}; }

}  // namespace

std::vector<haptics::TourStop> tour_of(const pipeline::SceneDescription& scene) {
  // Boxes of a scene that was turned lie elsewhere in its grid.
  if (scene.levels.empty() || scene.region_from_grid) return {};
  const Overview overview(scene);
  std::vector<haptics::TourStop> tour;
  std::vector<haptics::TourStop> notes;
  if (scene.config.audio) {
    for (const pipeline::AudioRegionConfig& region : scene.config.audio->regions) {
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
  const auto& parts = scene.config.parts;
  const auto largest = std::max_element(
      parts.begin(), parts.end(), [](const auto& a, const auto& b) { return area_m2(a.box_m) < area_m2(b.box_m); });
  if (largest != parts.end()) {
    // Across the part and back, a little inside its edges.
    const Box& box = largest->box_m;
    const double y_m = 0.5 * (box[1] + box[3]);
    const double inset_m = 0.1 * (box[2] - box[0]);
    const Eigen::Vector2d left = overview.device_m(box[0] + inset_m, y_m);
    const Eigen::Vector2d right = overview.device_m(box[2] - inset_m, y_m);
    tour.push_back({haptics::TourStop::Kind::stroke, left, right, kZoomIn});
  }
  return tour;
}

}  // namespace sparsha::app
