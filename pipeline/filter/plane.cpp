// PCL finds the plane in a sample; least squares in double precision give its last digits.
#include "pipeline/filter/plane.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "base/error.h"
#include "base/text/text.h"
#include "pipeline/filter/plane_doubt.h"

namespace sparsha::pipeline {
namespace {

constexpr std::size_t kFewest = 3;
constexpr std::size_t kFewestPlaces = 50;  // of the sample: fewer are planes by chance
constexpr double kLeastShare = 0.005;      // of the surface: less is found in any scan by chance
// RMS distance over the tolerated one: 0.58 where a sphere passes through, 0.45 for a cylinder; noise of half of it
// leaves 0.44, of 0.7 of it 0.5. So what is above the lower bound must not be a quadric.
constexpr double kMostSpread = 0.5;
constexpr double kMostBent = 0.4;
constexpr double kQuadric = 0.7;  // RMS distance to the quadric over that to the plane
constexpr int kMostFits = 20;

struct Fit {
  Eigen::Vector3d normal;
  double offset = 0.0;
  std::size_t inliers = 0;
  double rms = 0.0;
};

double height(const Fit& fit, const Eigen::Vector3f& p) { return fit.normal.dot(p.cast<double>()) + fit.offset; }

/// Least squares over what lies within the distance of `fit`.
Fit fitted_again(const std::vector<Eigen::Vector3f>& points, const Fit& fit, double distance) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
  Fit next = fit;
  next.inliers = 0;
  double squares = 0.0;
  for (const Eigen::Vector3f& p : points) {
    const double h = height(fit, p);
    if (std::abs(h) > distance) continue;
    const Eigen::Vector3d d = p.cast<double>();  // centred by the caller
    sum += d;
    products += d * d.transpose();
    squares += h * h;
    ++next.inliers;
  }
  const double n = static_cast<double>(next.inliers);
  next.rms = next.inliers > 0 ? std::sqrt(squares / n) : 0.0;
  if (next.inliers < kFewest) return next;
  const Eigen::Vector3d centre = sum / n;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(products / n - centre * centre.transpose());
  if (!(solver.eigenvalues()[1] > 1e-12 * solver.eigenvalues()[2])) return next;  // on a line: any plane fits
  next.normal = solver.eigenvectors().col(0);
  if (next.normal.dot(fit.normal) < 0.0) next.normal = -next.normal;
  next.offset = -next.normal.dot(centre);
  return next;
}

/// RMS height of what lies within the distance over a quadric of the place in the plane.
double rms_over_quadric(const std::vector<Eigen::Vector3f>& points, const Fit& fit, double distance) {
  using Row = Eigen::Matrix<double, 6, 1>;
  const Eigen::Vector3d u = fit.normal.unitOrthogonal();
  const Eigen::Vector3d v = fit.normal.cross(u);
  Eigen::Matrix<double, 6, 6> products = Eigen::Matrix<double, 6, 6>::Zero();
  Row heights = Row::Zero();
  double squares = 0.0;
  for (const Eigen::Vector3f& p : points) {
    const double h = height(fit, p);
    if (std::abs(h) > distance) continue;
    const double x = u.dot(p.cast<double>());
    const double y = v.dot(p.cast<double>());
    const Row row = (Row() << 1.0, x, y, x * x, x * y, y * y).finished();
    products += row * row.transpose();
    heights += h * row;
    squares += h * h;
  }
  const Row quadric = products.ldlt().solve(heights);
  const double rest = squares - quadric.dot(heights);
  return std::sqrt(std::max(0.0, rest) / std::max(1.0, products(0, 0)));
}

double angle_deg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180.0 / std::numbers::pi;
}

Error no_plane(const scene::RemovePlaneConfig& config, const std::string& found, const std::string& expected) {
  return {ErrorKind::input,
          {},
          fmt::format("the filter 'remove_plane' finds no plane within {:.3g} degrees of the normal [{:.4g}, {:.4g}, "
                      "{:.4g}]: {}",
                      config.max_angle_deg, config.normal.x(), config.normal.y(), config.normal.z(), found),
          expected};
}

}  // namespace

bool PlaneSample::before(const Chosen& a, const Chosen& b) {
  if (a.hash != b.hash) return a.hash < b.hash;
  return std::lexicographical_compare(a.point.begin(), a.point.end(), b.point.begin(), b.point.end());
}

void PlaneSample::offer(const Chosen& chosen) {
  const std::size_t known = table_.size();
  const std::uint32_t number = table_.number(chosen.key);
  if (number == known || before(chosen, table_[number])) table_[number] = chosen;
}

void PlaneSample::add(const Eigen::Vector3f& point) {
  constexpr double kFar = 1e18;
  Chosen chosen;
  chosen.point = point;
  for (Eigen::Index k = 0; k < 3; ++k) {
    const double cell = std::floor(static_cast<double>(point[k]) * per_m_);
    chosen.key[static_cast<std::size_t>(k)] = static_cast<std::int64_t>(std::clamp(cell, -kFar, kFar));
  }
  const auto bits = [&](Eigen::Index k) { return std::uint64_t{std::bit_cast<std::uint32_t>(point[k] + 0.0F)}; };
  chosen.hash = hash_word(hash_words(std::array<std::uint64_t, 3>{bits(0), bits(1), bits(2)}));
  offer(chosen);
  while (table_.size() > kMost) {
    per_m_ *= 0.5;
    // A cube of twice the width holds eight of these, whatever their sign.
    for (Chosen& old : table_.take()) {
      for (std::int64_t& k : old.key) k >>= 1;
      offer(old);
    }
  }
}

std::vector<Eigen::Vector3f> PlaneSample::take() {
  std::vector<Chosen> chosen = table_.take();
  std::sort(chosen.begin(), chosen.end(), before);
  std::vector<Eigen::Vector3f> points;
  points.reserve(chosen.size());
  for (const Chosen& c : chosen) points.push_back(c.point);
  return points;
}

std::string to_string(const FoundPlane& plane) {
  const Eigen::Vector3d n = (1e4 * plane.cut.normal).array().round() / 1e4 + 0.0;  // no "-0.0000"
  return fmt::format(
      "a plane with the normal [{:.4f}, {:.4f}, {:.4f}], {:.2f} degrees from the one given; {:.1f} % of the surface "
      "lies within {} of it, {} RMS",
      n.x(), n.y(), n.z(), plane.angle_deg, 100.0 * plane.share, length_text(plane.cut.distance_m),
      length_text(plane.rms_m));
}

FoundPlane find_plane(PlaneSample& sample, const scene::RemovePlaneConfig& config, const Context& context) {
  context.progress.throw_if_cancelled();
  std::vector<Eigen::Vector3f> points = sample.take();
  const Eigen::Vector3d direction = config.normal.normalized();
  if (points.size() < kFewestPlaces) {
    throw no_plane(config,
                   fmt::format("the scan fills {} cube{} of twice distance_mm, {}", points.size(),
                               points.size() == 1 ? "" : "s", length_text(2.0 * config.distance_m)),
                   fmt::format("a scan that fills {} or more: a smaller distance_mm, or more points", kFewestPlaces));
  }
  // Centred and scaled, since PCL computes planes in float32.
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3f& p : points) centre += p.cast<double>() / static_cast<double>(points.size());
  double size = 0.0;
  for (Eigen::Vector3f& p : points) {
    p = (p.cast<double>() - centre).cast<float>();
    size += static_cast<double>(p.cwiseAbs().maxCoeff()) / static_cast<double>(points.size());
  }
  for (Eigen::Vector3f& p : points) p = (p.cast<double>() / size).cast<float>();
  const double distance = config.distance_m / size;

  const Eigen::Vector4d found = plane_by_pcl(points, direction, config.max_angle_deg, distance);
  if (!(found.head<3>().norm() > 0.0)) {
    throw no_plane(config, "no three points have one", "another normal, or a larger max_angle_deg");
  }
  Fit fit;
  fit.normal = found.head<3>().normalized();
  fit.offset = found[3] / found.head<3>().norm();
  if (fit.normal.dot(direction) < 0.0) {
    fit.normal = -fit.normal;
    fit.offset = -fit.offset;
  }
  for (int k = 0; k < kMostFits; ++k) {
    const Fit next = fitted_again(points, fit, distance);
    const bool same = (next.normal - fit.normal).norm() < 1e-12 && std::abs(next.offset - fit.offset) < 1e-12;
    fit = next;
    if (same) break;
  }
  context.progress.throw_if_cancelled();

  FoundPlane plane;
  plane.cut = {fit.normal, fit.offset * size - fit.normal.dot(centre), config.distance_m, config.side};
  plane.angle_deg = angle_deg(fit.normal, direction);
  plane.share = static_cast<double>(fit.inliers) / static_cast<double>(points.size());
  plane.rms_m = fit.rms * size;
  if (plane.share < kLeastShare || fit.inliers < kFewest || plane.angle_deg > config.max_angle_deg) {
    throw no_plane(config, "the best is " + to_string(plane), "another normal, or a larger max_angle_deg");
  }
  const bool bent =
      plane.rms_m > kMostBent * config.distance_m && rms_over_quadric(points, fit, distance) < kQuadric * fit.rms;
  if (bent || plane.rms_m > kMostSpread * config.distance_m) {
    throw no_plane(config, "what comes nearest is curved or rough, " + to_string(plane),
                   "a larger distance_mm where the floor itself is uneven, or no 'remove_plane'");
  }
  plane.of_object = share_of_object(points, {fit.normal, fit.offset, distance, config.side});
  return plane;
}

}  // namespace sparsha::pipeline
