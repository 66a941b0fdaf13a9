// Strokes across the medallion of the sample relief's true surface at its own size, without friction: a point gets
// stickier as the nodes come closer, because it enters pits that no fingertip enters.
#include "bench/haptics/drag.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "haptics/proxy/proxy.h"
#include "haptics/surface/monge_surface.h"
#include "pipeline/simulate/surface.h"

namespace sparsha::bench {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kHalfWindow_m = 0.045;
constexpr double kHalfStroke_m = 0.040;
constexpr double kDepth_m = 0.00125;  // a newton at 800 N/m
constexpr double kStep_m = 0.00004;   // a tick of 1 ms at 40 mm/s
constexpr double kSettled_m = 0.002;
constexpr int kStrokes = 24;
const Vector2d kMedallion_m(0.18, 0.262);

pipeline::Surface relief() {
  pipeline::SurfaceConfig config;
  config.width_m = 0.36;
  config.height_m = 0.44;
  config.form = pipeline::ReliefForm{};
  return pipeline::Surface(config);
}

std::shared_ptr<const haptics::MongeSurface> window(const pipeline::Surface& stone, double spacing_m, double tip_m) {
  haptics::SurfaceParts parts;
  parts.lattice.nx = parts.lattice.ny = 1 + 2 * static_cast<int>(std::lround(kHalfWindow_m / spacing_m));
  parts.lattice.spacing_m = spacing_m;
  const double half_m = 0.5 * (parts.lattice.nx - 1) * spacing_m;
  parts.lattice.origin_m = {kMedallion_m.x() - half_m, kMedallion_m.y() - half_m, 0.0};
  parts.scale = 1.0;
  parts.tip_radius_m = tip_m;
  for (int j = 0; j < parts.lattice.ny; ++j)
    for (int i = 0; i < parts.lattice.nx; ++i)
      parts.height_m.push_back(static_cast<float>(
          stone.z(parts.lattice.origin_m.x() + i * spacing_m, parts.lattice.origin_m.y() + j * spacing_m)));
  return haptics::make_surface(std::move(parts));
}

/// A hand passes over grain and follows forms: the mean height of the disc around it, which it stays below, on every
/// sample and with every fingertip.
std::vector<std::vector<Vector3d>> strokes_over(const pipeline::Surface& stone) {
  constexpr double kDisc_m = 0.002, kNode_m = 0.00025;
  std::vector<std::vector<Vector3d>> strokes(kStrokes);
  for (int stroke = 0; stroke < kStrokes; ++stroke) {
    const double heading = 2.0 * std::numbers::pi * (stroke + 0.5) / kStrokes;
    const Vector2d way(std::cos(heading), std::sin(heading));
    for (double s = -kHalfStroke_m; s <= kHalfStroke_m; s += kStep_m) {
      const Vector2d place = kMedallion_m + s * way;
      double sum = 0.0;
      int count = 0;
      for (double y = -kDisc_m; y <= kDisc_m; y += kNode_m)
        for (double x = -kDisc_m; x <= kDisc_m; x += kNode_m) {
          if (x * x + y * y > kDisc_m * kDisc_m) continue;
          sum += stone.z(place.x() + x, place.y() + y);
          ++count;
        }
      strokes[static_cast<std::size_t>(stroke)].emplace_back(place.x(), place.y(), sum / count);
    }
  }
  return strokes;
}

/// Means over all strokes: force against the way over force upwards.
double drag_over_press(const haptics::MongeSurface& surface, const std::vector<std::vector<Vector3d>>& strokes,
                       double depth_m) {
  const haptics::SolverOptions options{.shape = haptics::CellShape::rounded};
  const Vector3d origin_m = surface.lattice.origin_m + Vector3d(0.0, 0.0, depth_m);
  double drag = 0.0, press = 0.0;
  for (const std::vector<Vector3d>& stroke : strokes) {
    const Vector2d way = (stroke.back() - stroke.front()).head<2>().normalized();
    haptics::ProxyState state = start_proxy(surface, stroke.front() - origin_m);
    for (std::size_t k = 0; k < stroke.size(); ++k) {
      const Vector3d hip = stroke[k] - origin_m;
      const haptics::ProxyUpdate found = update_exact(surface, hip, state, options);
      if (!found.contact || static_cast<double>(k) * kStep_m < kSettled_m) continue;
      drag -= (found.position - hip).head<2>().dot(way);
      press += found.position.z() - hip.z();
    }
  }
  return drag / press;
}

}  // namespace

bool write_drag(const std::filesystem::path& folder) {
  struct Tip {
    double radius_m;
    std::vector<double> depths_m;
  };
  const std::vector<double> depths_m{0.0005, 0.001, kDepth_m, 0.002};
  const std::array tips{Tip{0.0, depths_m}, Tip{0.00025, {kDepth_m}}, Tip{0.0005, depths_m}, Tip{0.001, {kDepth_m}}};
  constexpr std::array kSpacings_m{0.0018, 0.0009, 0.00045, 0.0001};
  const pipeline::Surface stone = relief();
  const auto strokes = strokes_over(stone);
  std::ofstream csv(folder / "haptics_drag.csv");
  csv << "tip_radius_mm,depth_mm,spacing_mm,drag_over_press\n";
  std::puts("drag over press, sample relief's true surface, 1:1, no friction");
  std::printf("%-10s %-10s %8s %8s %8s %8s\n", "tip radius", "depth", "1.8 mm", "0.9 mm", "0.45 mm", "0.1 mm");
  for (const Tip& tip : tips) {
    std::vector<std::shared_ptr<const haptics::MongeSurface>> samples;
    for (const double spacing_m : kSpacings_m) samples.push_back(window(stone, spacing_m, tip.radius_m));
    for (const double depth_m : tip.depths_m) {
      std::printf("%7.2f mm %7.2f mm", 1e3 * tip.radius_m, 1e3 * depth_m);
      for (std::size_t k = 0; k < samples.size(); ++k) {
        const double ratio = drag_over_press(*samples[k], strokes, depth_m);
        std::printf(" %8.3f", ratio);
        csv << 1e3 * tip.radius_m << ',' << 1e3 * depth_m << ',' << 1e3 * kSpacings_m[k] << ',' << ratio << '\n';
      }
      std::puts("");
    }
  }
  return static_cast<bool>(csv.flush());
}

}  // namespace sparsha::bench
