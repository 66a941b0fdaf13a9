#include "pipeline/scan/straight.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/text/text.h"

namespace sparsha::pipeline {
namespace {

/// Of points near zero: the direction in which they spread most, through their mean.
struct Axis {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();

  explicit Axis(const std::vector<Eigen::Vector3d>& points) {
    for (const Eigen::Vector3d& p : points) middle += p / static_cast<double>(points.size());
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (const Eigen::Vector3d& p : points) covariance += (p - middle) * (p - middle).transpose();
    if (covariance.norm() > 0.0) {
      direction = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvectors().col(2);
    }
  }
  [[nodiscard]] double along(const Eigen::Vector3d& p) const { return direction.dot(p - middle); }
  [[nodiscard]] double across(const Eigen::Vector3d& p) const { return (p - middle - along(p) * direction).norm(); }
};

/// The steps of float32 in x, y and z at the points farthest from zero, when all coordinates are float32; else 0.
Eigen::Vector3d float_steps(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3f largest = Eigen::Vector3f::Zero();
  for (const Eigen::Vector3d& p : points) {
    const Eigen::Vector3f single = p.cast<float>();
    if (single.cast<double>() != p) return Eigen::Vector3d::Zero();
    largest = largest.cwiseMax(single.cwiseAbs());
  }
  const auto step = [](float v) { return std::nextafter(v, std::numeric_limits<float>::infinity()) - v; };
  return largest.unaryExpr(step).cast<double>();
}

/// True when the line goes through the box of half widths `half` about `p`.
bool meets(const Axis& axis, const Eigen::Vector3d& p, const Eigen::Vector3d& half) {
  constexpr double kFlat = 1e-12;
  double low = -std::numeric_limits<double>::infinity(), high = -low;  // along the line, in the box
  for (int k = 0; k < 3; ++k) {
    const double off = p[k] - axis.middle[k], way = axis.direction[k];
    if (std::abs(way) < kFlat) {
      if (std::abs(off) > half[k]) return false;
      continue;
    }
    low = std::max(low, std::min((off - half[k]) / way, (off + half[k]) / way));
    high = std::min(high, std::max((off - half[k]) / way, (off + half[k]) / way));
  }
  return low <= high;
}

/// True when `points`, relative to one of them, may be points of the line of `length` that were rounded to `steps`: no
/// farther from it than three quarters of a step each way, and what the rounding turns the line itself.
bool are_rounded(const std::vector<Eigen::Vector3d>& points, const Axis& axis, double length,
                 const Eigen::Vector3d& steps) {
  constexpr double kOfStep = 0.75, kTurned = 0.5, kFewestSteps = 4.0;
  if (!(length > kFewestSteps * steps.maxCoeff())) return false;  // what is as short may be anything
  const double turned = kTurned * steps.maxCoeff() / std::sqrt(static_cast<double>(points.size()));
  const Eigen::Vector3d half = (kOfStep * steps.array() + turned).matrix();
  return std::all_of(points.begin(), points.end(), [&](const Eigen::Vector3d& p) { return meets(axis, p, half); });
}

}  // namespace

std::optional<StraightLine> straight_line(const std::vector<Eigen::Vector3d>& sample, std::uint64_t points) {
  constexpr double kThin = 2e-5;       // of the length
  constexpr double kRounded = 0.05;    // of the distance between points
  constexpr double kBroad = 1e-3;      // of the length
  constexpr double kSame = 1e-12;      // of the coordinates: what doubles cannot tell apart after a sum
  constexpr std::size_t kOneIn = 500;  // strays
  if (sample.empty()) return std::nullopt;
  // Relative to one of them: survey coordinates leave few digits to their differences.
  std::vector<Eigen::Vector3d> near;
  near.reserve(sample.size());
  double largest = 0.0;
  for (const Eigen::Vector3d& p : sample) {
    near.emplace_back(p - sample.front());
    largest = std::max(largest, p.cwiseAbs().maxCoeff());
  }
  const std::size_t kept = near.size() - near.size() / kOneIn;
  for (int round = 0; round < 3; ++round) {
    const Axis axis({near.begin(), near.begin() + static_cast<std::ptrdiff_t>(kept)});
    std::nth_element(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(kept) - 1, near.end(),
                     [&](const auto& a, const auto& b) { return axis.across(a) < axis.across(b); });
  }
  near.resize(kept);
  const Axis axis(near);
  double low = 0.0, high = 0.0, squares = 0.0;
  for (const Eigen::Vector3d& p : near) {
    low = std::min(low, axis.along(p));
    high = std::max(high, axis.along(p));
    squares += axis.across(p) * axis.across(p);
  }
  StraightLine line{high - low, std::sqrt(squares / static_cast<double>(kept))};
  if (line.length <= kSame * largest) return StraightLine{};
  const double apart = line.length / static_cast<double>(std::max<std::uint64_t>(points, 1));
  const Eigen::Vector3d steps = float_steps(sample);
  if (steps.maxCoeff() > 0.0 && are_rounded(near, axis, line.length, steps)) return line;
  if (line.across > std::max(kThin * line.length, std::min(kRounded * apart, kBroad * line.length)))
    return std::nullopt;
  return line;
}

std::string described(const StraightLine& line, const std::function<std::string(double)>& length) {
  if (line.length == 0.0) return "all points are in one place";
  return "the points lie on a straight line, " + length(line.length) + " long and " + length(line.across) + " across";
}

void require_surface(const std::string& file, std::size_t files, const std::vector<Eigen::Vector3d>& sample_m,
                     std::uint64_t points) {
  if (const auto line = straight_line(sample_m, points)) {
    throw input_error(file, described(*line, [](double metres) { return length_text(metres); }),
                      files < 2 ? "points that spread over a surface"
                                : "points that spread over a surface, and files of one frame: one with the coordinates "
                                  "of a survey and one with local ones lie far apart");
  }
}

}  // namespace sparsha::pipeline
