// Covariance and quadric of a few points, in double.
#include "pipeline/projection/surface_plane.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace sparsha::pipeline {
namespace {

template <class Relative>
Eigen::Matrix3d covariance(std::size_t count, const Relative& relative) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  for (std::size_t k = 0; k < count; ++k) {
    const std::array<double, 3> at = relative(k);
    const Eigen::Vector3d p(at[0], at[1], at[2]);
    mean += p;
    second += p * p.transpose();
  }
  mean /= static_cast<double>(count);
  return second / static_cast<double>(count) - mean * mean.transpose();
}

}  // namespace

std::size_t Neighbourhood::take(std::size_t index, std::size_t count, double most_m, const Sheet* sheet) {
  centre_ = index;
  const SpacePoint& p = points_[index];
  near_.clear();
  const auto most2 = static_cast<float>(most_m * most_m);
  for (std::size_t k = 0; k < points_.size(); ++k) {
    const float dx = points_[k].x - p.x;
    const float dy = points_[k].y - p.y;
    const float dz = points_[k].z - p.z;
    const float distance2 = dx * dx + dy * dy + dz * dz;
    if (!(distance2 <= most2)) continue;
    if (sheet) {
      const double across = sheet->normal[0] * static_cast<double>(dx) + sheet->normal[1] * static_cast<double>(dy) +
                            sheet->normal[2] * static_cast<double>(dz);
      if (across < sheet->below_m || across > sheet->above_m) continue;
    }
    near_.push_back({distance2, k});
  }
  const auto nearer = [](const Near& a, const Near& b) {
    return a.distance2 != b.distance2 ? a.distance2 < b.distance2 : a.index < b.index;
  };
  count = std::min(count, near_.size());
  if (count == 0) return 0;
  const auto last = near_.begin() + static_cast<std::ptrdiff_t>(count);
  std::nth_element(near_.begin(), last - 1, near_.end(), nearer);
  near_.erase(last, near_.end());
  std::sort(near_.begin(), near_.end(), nearer);
  return count;
}

double Neighbourhood::radius_m(std::size_t count) const {
  return std::sqrt(static_cast<double>(near_[count - 1].distance2));
}

std::array<double, 3> Neighbourhood::relative(std::size_t k) const {
  const SpacePoint& p = points_[near_[k].index];
  const SpacePoint& c = points_[centre_];
  return {static_cast<double>(p.x - c.x), static_cast<double>(p.y - c.y), static_cast<double>(p.z - c.z)};
}

bool Neighbourhood::narrow(std::size_t count) const {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes;  // the direct way is exact enough for a ratio
  axes.computeDirect(covariance(count, [&](std::size_t k) { return relative(k); }), Eigen::EigenvaluesOnly);
  SurfacePlane strip;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    strip.variance_m2[axis] = axes.eigenvalues()[static_cast<Eigen::Index>(axis)];
  }
  return strip.narrow();
}

SurfacePlane Neighbourhood::plane() const {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(
      covariance(near_.size(), [&](std::size_t k) { return relative(k); }));
  SurfacePlane plane;
  const Eigen::Vector3d normal = axes.eigenvectors().col(0) * (axes.eigenvectors()(2, 0) < 0.0 ? -1.0 : 1.0);
  plane.normal = {normal.x(), normal.y(), normal.z()};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    plane.variance_m2[axis] = std::max(0.0, axes.eigenvalues()[static_cast<Eigen::Index>(axis)]);
  }
  plane.radius_m = std::sqrt(static_cast<double>(near_.back().distance2));
  return plane;
}

std::optional<Sheet> Neighbourhood::sheet(const SurfacePlane& plane) const {
  constexpr double kGap = 3.0;  // standard deviations on its sides
  constexpr int kRounds = 3;
  constexpr double kSpacings = 0.3;
  if (near_.size() < 6) return std::nullopt;
  const double least_gap_m =
      kSpacings * plane.radius_m * std::sqrt(std::numbers::pi / static_cast<double>(near_.size()));
  // One point of the other face makes the spread across the plane as large already.
  if (plane.variance_m2[0] < least_gap_m * least_gap_m) return std::nullopt;
  // A plane through both faces leans towards where they overlap. One slope for both, and a step between them, is what
  // they have in common: the widest gap tells the faces, these the slope, and that the gap.
  Eigen::Vector3d normal(plane.normal[0], plane.normal[1], plane.normal[2]);
  std::vector<std::pair<double, std::size_t>> across(near_.size());
  std::size_t widest = 0;
  const auto cut = [&](std::size_t begin, std::size_t end) {
    widest = begin + 1;
    for (std::size_t k = begin + 1; k < end; ++k) {
      if (across[k].first - across[k - 1].first > across[widest].first - across[widest - 1].first) widest = k;
    }
  };
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t k = 0; k < near_.size(); ++k) across[k] = {Eigen::Vector3d(relative(k).data()).dot(normal), k};
    std::sort(across.begin(), across.end());
    cut(0, across.size());
    if (round + 1 == kRounds) break;
    const Eigen::Vector3d u = normal.unitOrthogonal();
    const Eigen::Vector3d v = normal.cross(u);
    Eigen::Matrix4d products = Eigen::Matrix4d::Zero();
    Eigen::Vector4d right = Eigen::Vector4d::Zero();
    for (std::size_t k = 0; k < across.size(); ++k) {
      const Eigen::Vector3d at(relative(across[k].second).data());
      const Eigen::Vector4d row(1.0, k < widest ? 0.0 : 1.0, at.dot(u) / plane.radius_m, at.dot(v) / plane.radius_m);
      products += row * row.transpose();
      right += row * across[k].first;
    }
    const Eigen::Vector4d found = products.ldlt().solve(right);
    if (!found.allFinite()) return std::nullopt;
    normal = (normal - (found[2] * u + found[3] * v) / plane.radius_m).normalized();
  }
  const auto squares_about_mean = [&](std::size_t begin, std::size_t end) {
    double sum = 0.0;
    double squares = 0.0;
    for (std::size_t k = begin; k < end; ++k) {
      sum += across[k].first;
      squares += across[k].first * across[k].first;
    }
    return squares - sum * sum / static_cast<double>(end - begin);
  };
  // The widest gap of what is left, until that is one face.
  std::size_t begin = 0;
  std::size_t end = across.size();
  Sheet sheet{{normal.x(), normal.y(), normal.z()}, -plane.radius_m, plane.radius_m};
  while (end - begin > 2) {
    cut(begin, end);
    const double gap_m = across[widest].first - across[widest - 1].first;
    const double scatter2 =
        (squares_about_mean(begin, widest) + squares_about_mean(widest, end)) / static_cast<double>(end - begin);
    if (gap_m <= least_gap_m || gap_m * gap_m <= kGap * kGap * scatter2) break;
    const double middle_m = 0.5 * (across[widest].first + across[widest - 1].first);
    (middle_m < 0.0 ? begin : end) = widest;
    (middle_m < 0.0 ? sheet.below_m : sheet.above_m) = middle_m;
  }
  if (end - begin == across.size()) return std::nullopt;
  return sheet;
}

std::optional<double> Neighbourhood::residual_m(const SurfacePlane& plane) const {
  using Row = Eigen::Matrix<double, 6, 1>;
  const Eigen::Vector3d normal(plane.normal[0], plane.normal[1], plane.normal[2]);
  const Eigen::Vector3d u = normal.unitOrthogonal();
  const Eigen::Vector3d v = normal.cross(u);
  if (!(plane.radius_m > 0.0)) return std::nullopt;
  std::vector<Row> rows;
  std::vector<double> heights;
  Eigen::Matrix<double, 6, 6> normal_matrix = Eigen::Matrix<double, 6, 6>::Zero();
  Row right = Row::Zero();
  for (std::size_t k = 0; k < near_.size(); ++k) {
    const std::array<double, 3> at = relative(k);
    const Eigen::Vector3d p(at[0], at[1], at[2]);
    const double a = p.dot(u) / plane.radius_m;
    const double b = p.dot(v) / plane.radius_m;
    rows.emplace_back((Row() << 1.0, a, b, a * a, a * b, b * b).finished());
    heights.push_back(p.dot(normal));
    normal_matrix += rows.back() * rows.back().transpose();
    right += rows.back() * heights.back();
  }
  const Eigen::LDLT<Eigen::Matrix<double, 6, 6>> solver(normal_matrix);
  if (!(solver.vectorD().minCoeff() > 1e-9 * solver.vectorD().maxCoeff())) return std::nullopt;
  const Row quadric = solver.solve(right);
  double sum = 0.0;
  for (std::size_t k = 0; k < rows.size(); ++k) sum += std::pow(heights[k] - rows[k].dot(quadric), 2);
  return std::sqrt(sum / (static_cast<double>(rows.size()) - 6.0));
}

}  // namespace sparsha::pipeline
