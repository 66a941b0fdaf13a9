// The front told by triangles, by the scanner's place, by the thinnest direction, else by custom.
#include "pipeline/suggest/view.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/statistics.h"
#include "pipeline/orient/face.h"
#include "pipeline/suggest/range_image.h"

namespace sparsha::pipeline {
namespace {

constexpr std::size_t kSample = 200'000;  // points of a scan

/// Thinnest direction, and how thin beside the next one.
struct Thinness {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();
  double flatness = 1.0;
};

Thinness thinness_of(const std::vector<Eigen::Vector3d>& points_m, const InnerBox& box) {
  const Eigen::Vector3d centre = 0.5 * (box.low + box.high);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  std::size_t inside = 0;
  for (const Eigen::Vector3d& point : points_m) {
    if (!((point.array() >= box.low.array()).all() && (point.array() <= box.high.array()).all())) continue;
    covariance += (point - centre) * (point - centre).transpose();
    ++inside;
  }
  covariance /= std::max<double>(1.0, static_cast<double>(inside));
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(covariance);
  const double thin = std::max(0.0, axes.eigenvalues()[0]);
  return {axes.eigenvectors().col(0), std::sqrt(thin / std::max(axes.eigenvalues()[1], 1e-300))};
}

// The coordinate axis within 25 degrees, else the direction rounded to three digits.
Eigen::Vector3d snapped(const Eigen::Vector3d& direction) {
  const Eigen::Vector3d unit = direction.normalized();
  Eigen::Index axis = 0;
  unit.cwiseAbs().maxCoeff(&axis);
  constexpr double kCos25 = 0.9063;
  if (std::abs(unit[axis]) > kCos25) {
    Eigen::Vector3d snap = Eigen::Vector3d::Zero();
    snap[axis] = unit[axis] > 0 ? 1.0 : -1.0;
    return snap;
  }
  return (unit * 1000.0).array().round() / 1000.0 + 0.0;
}

// Of a place over its distance along the view, within 60 degrees: survey coordinates lie far aside of their zero.
constexpr double kSteepest = 2.0;

bool before_a_lens(const InnerBox& box) {
  const Eigen::Vector3d centre = 0.5 * (box.low + box.high);
  return box.low.z() > 0.1 * (box.high - box.low).norm() && centre.norm() < kSteepest * centre.z();
}

// The up of a camera that looks along z: such frames are right-handed with x to the right, so that y goes down.
constexpr double kFacing = 0.7;

bool is_camera_view(const View& view, const SeenScans& seen, const InnerBox& box) {
  const Eigen::Vector3d centre = 0.5 * (box.low + box.high);
  return !seen.z_up_format && view.look_from.normalized().z() < -kFacing && before_a_lens(box) &&
         origin_is_a_scanner(view.look_from.normalized(), centre, (box.high - box.low).norm());
}

View guess_view(const SeenScans& seen, const InnerBox& box, const Thinness& thin) {
  const Eigen::Vector3d centre = 0.5 * (box.low + box.high);
  const double size = (box.high - box.low).norm();
  View guess;
  guess.evident = true;
  if (seen.rasters) {
    guess.reason = "a grid of heights over x and y is seen from above";
    return guess;
  }
  if (seen.area > 0.0 && seen.facing.norm() > 0.3 * seen.area) {
    guess.look_from = snapped(seen.facing);
    guess.reason =
        fmt::format("the triangles face this way ({:.0f} % of the area, net)", 100.0 * seen.facing.norm() / seen.area);
  } else if ((seen.depth_camera_format || seen.range_images) && before_a_lens(box)) {
    guess.look_from = {0, 0, -1};
    guess.up = {0, -1, 0};
    guess.reason = seen.range_images
                       ? "an image of a camera in the origin, whose rays are its raster: x right, y down, "
                         "z away"
                       : "all points lie before the origin along z, as depth cameras see them: x right, "
                         "y down, z away";
    return guess;
  } else if (thin.flatness < 0.3) {
    const bool scanner_side = origin_is_a_scanner(thin.direction, centre, size);
    guess.look_from = snapped(seen_side(thin.direction, centre, size));
    guess.reason = fmt::format("the points are flat ({:.0f} % as thick as wide) across this direction{}",
                               100.0 * thin.flatness, scanner_side ? ", and the scan's origin lies on this side" : "");
  } else if (seen.area == 0.0 && centre.norm() > size && centre.norm() < 100.0 * size) {
    guess.evident = false;  // an origin may be anywhere
    guess.look_from = snapped(-centre);
    guess.reason = "the scan's origin, where scanners stand, lies on this side";
  } else if (seen.z_up_format) {
    guess.evident = false;
    guess.look_from = {0, -1, 0};
    guess.reason = "a solid object in a format whose z is up: its front is a guess, look at it and turn it";
  } else {
    guess.evident = false;
    guess.reason = "a solid object, y up by custom: its front is a guess, look at it and turn it";
  }
  guess.up = customary_up(guess.look_from, seen.z_up_format);
  if (is_camera_view(guess, seen, box)) {
    guess.up = {0, -1, 0};
    guess.reason += "; all lies before it along z, as cameras have it: x right, y down, z away";
  }
  return guess;
}

}  // namespace

void SeenScans::look_at(const RawScan& scan, double metres) {
  const std::size_t stride = std::max<std::size_t>(1, scan.points.size() / kSample);
  for (std::size_t i = 0; i < scan.points.size(); i += stride) points_m.push_back(scan.points[i] * metres);
  for (const auto& face : scan.faces) {
    const Eigen::Vector3d& a = scan.points[face[0]];
    const Eigen::Vector3d normal = (scan.points[face[1]] - a).cross(scan.points[face[2]] - a);
    facing += normal;
    area += normal.norm();
  }
  if (is_z_up(scan.format)) z_up_format = true;
  range_images = (range_images || !any_) && is_range_image(scan);
  rasters = (rasters || !any_) && scan.cell.has_value();
  any_ = true;
  if (scan.format.starts_with("PCD")) depth_camera_format = true;
}

void SeenScans::crop(const CropConfig& box) {
  std::erase_if(points_m, [&](const Eigen::Vector3d& p) {
    return (p.array() < box.min_m.array()).any() || (p.array() > box.max_m.array()).any();
  });
}

InnerBox inner_box(const std::vector<Eigen::Vector3d>& points_m) {
  InnerBox box;
  std::vector<double> values(points_m.size());
  for (int axis = 0; axis < 3; ++axis) {
    std::transform(points_m.begin(), points_m.end(), values.begin(), [axis](const auto& p) { return p[axis]; });
    const auto at = [&](double share) {
      const double place = share * static_cast<double>(values.size() - 1);
      return value_of_rank(values, static_cast<std::size_t>(share < 0.5 ? std::floor(place) : std::ceil(place)));
    };
    box.low[axis] = at(0.01);
    box.high[axis] = at(0.99);
  }
  return box;
}

std::vector<View> likely_views(const SeenScans& seen) {
  const InnerBox box = inner_box(seen.points_m);
  const Thinness thin = thinness_of(seen.points_m, box);
  std::vector<View> views{guess_view(seen, box, thin)};
  const auto add = [&](const Eigen::Vector3d& direction, const std::string& reason) {
    View view;
    view.look_from = snapped(direction);
    view.up = customary_up(view.look_from, seen.z_up_format);
    view.reason = reason;
    const auto same = [&](const View& v) {
      return v.look_from.normalized().dot(view.look_from.normalized()) > 1.0 - 1e-9;
    };
    if (std::none_of(views.begin(), views.end(), same)) views.push_back(view);
  };
  for (const double side : {1.0, -1.0}) {
    for (const int axis : {2, 0, 1}) add(side * Eigen::Vector3d::Unit(axis), "along an axis of the scan");
  }
  for (const double side : {1.0, -1.0})
    add(side * thin.direction, "along the direction in which the points are thinnest");
  return views;
}

}  // namespace sparsha::pipeline
