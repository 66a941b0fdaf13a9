// Sampling with noise, holes and uneven density; the judge's measures are those of docs/measure/accuracy.md.
#include "tests/support/closed_scan.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sparsha::test {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kWrong = 3.0;        // spacings
constexpr double kSmoothReach = 1.5;  // spacings around a node
constexpr double kHoleMargin = 2.0;   // spacings on either side of a hole's edge that are not judged
constexpr double kFrontDepth = 2.0;   // spacings below the front that still belong to it

Vector2d on_circle(const Vector2d& centre, double radius, int k, int steps) {
  const double angle = 2.0 * std::numbers::pi * k / steps;
  return centre + radius * Vector2d(std::cos(angle), std::sin(angle));
}

/// How much the front varies within `radius_m`; nothing where it ends.
std::optional<double> variation(const ClosedObject& object, const Vector2d& centre, double radius_m) {
  const std::optional<double> middle = object.front_m(centre.x(), centre.y());
  if (!middle) return std::nullopt;
  double low = *middle, high = *middle;
  for (const double share : {0.35, 0.7, 1.0}) {
    for (int k = 0; k < 12; ++k) {
      const Vector2d p = on_circle(centre, share * radius_m, k, 12);
      const std::optional<double> z = object.front_m(p.x(), p.y());
      if (!z) return std::nullopt;
      low = std::min(low, *z);
      high = std::max(high, *z);
    }
  }
  return high - low;
}

std::optional<Hole> place_hole(const ClosedObject& object, double radius_m, double margin_m) {
  constexpr int kCandidates = 40;
  const auto [x0, y0, x1, y1] = object.bounds_m();
  std::optional<Hole> best;
  double least = 2.0 * radius_m;  // steeper ones would not be holes in a front
  for (int i = 0; i < kCandidates; ++i) {
    for (int j = 0; j < kCandidates; ++j) {
      const Vector2d centre(x0 + (x1 - x0) * (i + 0.5) / kCandidates, y0 + (y1 - y0) * (j + 0.5) / kCandidates);
      const std::optional<double> varies = variation(object, centre, radius_m + margin_m);
      if (!varies || *varies >= least) continue;
      least = *varies;
      best = Hole{centre, radius_m};
    }
  }
  return best;
}

double distance_to(const Hole& hole, double x, double y) {
  return std::hypot(x - hole.centre_m.x(), y - hole.centre_m.y());
}

bool is_smooth(const ClosedObject& object, double x, double y, double z, double spacing_m) {
  for (int k = 0; k < 8; ++k) {
    const Vector2d p = on_circle({x, y}, kSmoothReach * spacing_m, k, 8);
    const std::optional<double> beside = object.front_m(p.x(), p.y());
    if (!beside || std::abs(*beside - z) >= kWrong * spacing_m) return false;
  }
  return true;
}

double share(std::size_t part, std::size_t whole) {
  return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace

ObjectScan scan_object(const ClosedObject& object, const ScanOptions& options) {
  ObjectScan scan;
  scan.spacing_m = std::sqrt(object.area_m2() / static_cast<double>(options.points));
  scan.noise_m = options.noise_spacings * scan.spacing_m;
  if (options.hole_spacings > 0.0) {
    scan.hole = place_hole(object, options.hole_spacings * scan.spacing_m, kHoleMargin * scan.spacing_m);
  }
  std::mt19937_64 random(options.seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::normal_distribution<double> normal(0.0, 1.0);
  const auto [x0, y0, x1, y1] = object.bounds_m();
  scan.points.reserve(options.points);
  scan.normals.reserve(options.points);
  for (std::size_t made = 0; made < options.points;) {
    const SurfacePoint p = object.sample(random);
    if (options.density_ratio != 1.0) {
      const double across = (p.position_m.x() - x0) / (x1 - x0);
      if (unit(random) > std::pow(options.density_ratio, -across)) continue;
    }
    if (options.lines > 0.0) {
      constexpr double kThick = 0.02;  // half of it, of the distance of the lines
      const double line = p.position_m.dot(options.across) / (std::sqrt(options.lines) * scan.spacing_m);
      if (std::abs(line - std::round(line)) > kThick) continue;
    }
    ++made;
    if (scan.hole && distance_to(*scan.hole, p.position_m.x(), p.position_m.y()) < scan.hole->radius_m) {
      const std::optional<double> front = object.front_m(p.position_m.x(), p.position_m.y());
      if (front && p.position_m.z() > *front - kFrontDepth * scan.spacing_m) continue;
    }
    const Vector3d q = p.position_m + scan.noise_m * normal(random) * p.normal;
    scan.points.push_back({q.x(), q.y(), q.z()});
    scan.normals.push_back(p.normal);
  }
  return scan;
}

std::vector<Eigen::Matrix4d> six_views() {
  std::vector<Eigen::Matrix4d> views;
  for (const auto& [about_x, about_y] : std::vector<std::array<double, 2>>{
           {0.0, 0.0}, {180.0, 0.0}, {0.0, -90.0}, {0.0, 90.0}, {90.0, 0.0}, {-90.0, 0.0}}) {
    Eigen::Matrix4d view = Eigen::Matrix4d::Identity();
    view.topLeftCorner<3, 3>() = turned(about_x, about_y);
    views.push_back(view);
  }
  return views;
}

Judgement judge_object(std::span<const Vector3d> nodes, double step_m, const ClosedObject& object,
                       const ObjectScan& scan) {
  Judgement result;
  result.nodes = nodes.size();
  std::vector<double> errors, smooth_errors;
  std::size_t beyond = 0, wrong = 0, smooth = 0, wrong_smooth = 0;
  const double margin = kHoleMargin * scan.spacing_m;
  if (scan.hole) {
    const double radius = scan.hole->radius_m - margin;
    result.hole_nodes = static_cast<std::size_t>(std::numbers::pi * radius * radius / (step_m * step_m));
  }
  for (const Vector3d& p : nodes) {
    const std::optional<double> truth = object.front_m(p.x(), p.y());
    if (!truth) {
      ++beyond;
      continue;
    }
    const double error = std::abs(p.z() - *truth) / scan.spacing_m;
    const bool is_wrong = !(error <= kWrong);
    if (scan.hole && distance_to(*scan.hole, p.x(), p.y()) < scan.hole->radius_m + margin) {
      const bool within = distance_to(*scan.hole, p.x(), p.y()) < scan.hole->radius_m - margin;
      result.hole_through += within && is_wrong ? 1 : 0;
      continue;
    }
    errors.push_back(error);
    wrong += is_wrong ? 1 : 0;
    if (!is_smooth(object, p.x(), p.y(), *truth, scan.spacing_m)) continue;
    ++smooth;
    smooth_errors.push_back(error);
    wrong_smooth += is_wrong ? 1 : 0;
  }
  result.beyond = share(beyond, result.nodes);
  result.smooth = share(smooth, errors.size());
  result.wrong = share(wrong, errors.size());
  result.wrong_smooth = share(wrong_smooth, smooth);
  if (!smooth_errors.empty()) {
    const auto middle = smooth_errors.begin() + static_cast<std::ptrdiff_t>(smooth_errors.size() / 2);
    std::nth_element(smooth_errors.begin(), middle, smooth_errors.end());
    result.median_spacings = *middle;
  }
  return result;
}

Judgement judge_object(const scene::DepthGrid& grid, const ClosedObject& object, const ObjectScan& scan) {
  const scene::Lattice& lattice = grid.lattice;
  std::vector<Vector3d> nodes;
  std::size_t in_silhouette = 0, measured = 0;
  for (int j = 0; j < lattice.ny; ++j) {
    for (int i = 0; i < lattice.nx; ++i) {
      const std::size_t k = lattice.index(i, j);
      const double x = lattice.x_m(i), y = lattice.y_m(j);
      const bool is_measured = grid.state[k] == scene::NodeState::measured;
      if (is_measured) nodes.emplace_back(x, y, lattice.origin_m.z() + static_cast<double>(grid.height_m[k]));
      const bool in_hole =
          scan.hole && distance_to(*scan.hole, x, y) < scan.hole->radius_m + kHoleMargin * scan.spacing_m;
      if (in_hole || !object.front_m(x, y)) continue;
      ++in_silhouette;
      measured += is_measured ? 1 : 0;
    }
  }
  Judgement result = judge_object(nodes, lattice.spacing_m, object, scan);
  result.covered = share(measured, in_silhouette);
  return result;
}

}  // namespace sparsha::test
