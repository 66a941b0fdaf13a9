// Small clouds and a stand-in for the work on scans.
#pragma once

#include <memory>
#include <random>
#include <vector>

#include "viewer/cloud/point_view.h"

namespace sparsha::viewer::test {

/// `per_side` squared points, evenly over a square of `side_m` in the plane z = 0, its middle at the origin.
[[nodiscard]] inline PointView square(int per_side, double side_m) {
  PointView view;
  for (int j = 0; j < per_side; ++j)
    for (int i = 0; i < per_side; ++i) {
      const double u = (i + 0.5) / per_side - 0.5, v = (j + 0.5) / per_side - 0.5;
      view.points.emplace_back(Eigen::Vector3d(u * side_m, v * side_m, 0.0).cast<float>());
    }
  view.total = view.points.size();
  return view;
}

[[nodiscard]] inline PointView scattered(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> place(-1.0F, 1.0F);
  PointView view;
  for (int n = 0; n < count; ++n) {
    view.points.emplace_back(place(random), place(random), place(random));
    view.rgba.push_back(0xFF000000U | static_cast<std::uint32_t>(n));
  }
  view.total = view.points.size();
  return view;
}

/// Answers at once and remembers what was asked.
struct Workshop {
  std::shared_ptr<PointView> points;
  OrientingStatus status;
  std::vector<ScanSetup> scans, saves;
  int saved_scenes = 0;
  std::vector<scene::OrientationConfig::Face> faces;
  std::vector<scene::LengthUnit> units;
  int opened = 0, cancelled = 0;

  explicit Workshop(PointView view) : points(std::make_shared<PointView>(std::move(view))) {
    arrange(*points);
    status.points = points;
  }
  [[nodiscard]] Orienting orienting() {
    Orienting result;
    result.unavailable = [] { return std::string(); };
    result.open = [this] { ++opened; };
    result.status = [this] { return status; };
    result.find_face = [this](auto face, const ScanSetup&) { faces.push_back(face); };
    result.set_unit = [this](scene::LengthUnit unit) { units.push_back(unit); };
    result.scan = [this](const ScanSetup& setup) { scans.push_back(setup); };
    result.cancel = [this] { ++cancelled; };
    result.save_scene = [this] { ++saved_scenes; };
    result.save = [this](const ScanSetup& setup) { saves.push_back(setup); };
    return result;
  }
};

}  // namespace sparsha::viewer::test
