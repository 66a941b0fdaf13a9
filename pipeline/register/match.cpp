// Nearest elements with similar normals.
#include "pipeline/register/match.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

namespace sparsha::pipeline {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

Vector6d screw(const Eigen::Vector3d& arm, const Eigen::Vector3d& normal) {
  Vector6d row;
  row << arm.cross(normal), normal;
  return row;
}

// Arms from the matches' mean in units of their RMS length.
class Arms {
 public:
  explicit Arms(const std::vector<Match>& pairs) {
    for (const Match& pair : pairs) mean_ += pair.place;
    mean_ /= static_cast<double>(pairs.size());
    double reach = 0.0;
    for (const Match& pair : pairs) reach += (pair.place - mean_).squaredNorm();
    reach_ = std::sqrt(reach / static_cast<double>(pairs.size()));
  }
  [[nodiscard]] Vector6d from(const Match& pair) const {
    return screw((pair.place - mean_) / reach_, pair.from_normal);
  }
  [[nodiscard]] Vector6d to(const Match& pair) const { return screw((pair.place - mean_) / reach_, pair.to_normal); }

  [[nodiscard]] const Eigen::Vector3d& mean() const { return mean_; }
  [[nodiscard]] double reach() const { return reach_; }

 private:
  Eigen::Vector3d mean_ = Eigen::Vector3d::Zero();
  double reach_ = 0.0;
};

// Mean of the products.
Matrix6d information(const std::vector<Match>& pairs, const Arms& arms) {
  Matrix6d sum = Matrix6d::Zero();
  for (const Match& pair : pairs) sum += arms.from(pair) * arms.to(pair).transpose();
  return (sum + sum.transpose()) / (2.0 * static_cast<double>(pairs.size()));
}

// What matches tell of one motion.
double told(const std::vector<Match>& pairs, const Arms& arms, const Vector6d& motion) {
  double sum = 0.0;
  for (const Match& pair : pairs) sum += arms.from(pair).dot(motion) * arms.to(pair).dot(motion);
  return sum;
}

}  // namespace

Matches match(const StationSurface& from, const Eigen::Isometry3d& from_pose, const StationSurface& to,
              const Eigen::Isometry3d& to_pose, const MatchLimits& limits, const std::vector<std::size_t>* among) {
  Matches result;
  const Eigen::Isometry3d to_from = to_pose.inverse() * from_pose;
  const double limit2 = limits.distance_m * limits.distance_m;
  const bool both_signed = !limits.any_sign && from.signed_normals() && to.signed_normals();
  const auto& all = from.elements();
  const std::size_t step = limits.most == 0 ? 1 : std::max<std::size_t>(1, all.size() / limits.most);
  const std::size_t count = among != nullptr ? among->size() : (all.size() + step - 1) / step;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t i = among != nullptr ? (*among)[k] : k * step;
    const StationSurface::Element& a = all[i];
    if (a.normal.isZero(0.0)) continue;
    ++result.tried;
    const StationSurface::Nearest nearest = to.nearest(to_from * a.point, limits.distance_m);
    if (nearest.index >= to.elements().size() || nearest.distance2 > limit2) continue;
    const StationSurface::Element& b = to.elements()[nearest.index];
    if (b.border || b.normal.isZero(0.0)) continue;
    Match pair;
    pair.from_normal = from_pose.linear() * a.normal;
    pair.to_normal = to_pose.linear() * b.normal;
    double cosine = pair.from_normal.dot(pair.to_normal);
    if (!both_signed && cosine < 0.0) {
      pair.to_normal = -pair.to_normal;
      cosine = -cosine;
    }
    if (cosine < limits.least_cosine) continue;
    const Eigen::Vector3d x = from_pose * a.point;
    const Eigen::Vector3d y = to_pose * b.point;
    pair.place = 0.5 * (x + y);
    pair.distance_m = pair.normal().dot(x - y);
    pair.from = i;
    pair.to = nearest.index;
    result.pairs.push_back(pair);
  }
  return result;
}

Agreement agreement(const StationSurface& a, const Eigen::Isometry3d& a_pose, const StationSurface& b,
                    const Eigen::Isometry3d& b_pose, const MatchLimits& limits) {
  Agreement result;
  Matches there = match(a, a_pose, b, b_pose, limits);
  const Matches back = match(b, b_pose, a, a_pose, limits);
  result.overlap = std::max(there.share(), back.share());
  there.pairs.insert(there.pairs.end(), back.pairs.begin(), back.pairs.end());
  result.matches = there.pairs.size();
  if (there.pairs.empty()) return result;
  double sum = 0.0;
  for (const Match& pair : there.pairs) sum += pair.distance_m * pair.distance_m;
  result.residual_m = std::sqrt(sum / static_cast<double>(there.pairs.size()));
  if (there.pairs.size() < 6) return result;
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(information(there.pairs, Arms(there.pairs)),
                                                       Eigen::EigenvaluesOnly);
  result.least_information = solver.eigenvalues()[0];
  return result;
}

Eigen::Isometry3d Hold::moved(double by_m) const {
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.translate(middle + by_m * shift_m);
  if (const double angle = turn.norm(); angle > 0.0) motion.rotate(Eigen::AngleAxisd(by_m * angle, turn / angle));
  motion.translate(-middle);
  return motion;
}

Hold hold_of(const std::vector<Match>& met, double near_m) {
  Hold result;
  std::vector<Match> tight;
  for (const Match& pair : met)
    if (std::fabs(pair.distance_m) <= near_m) tight.push_back(pair);
  result.matches = tight.size();
  if (tight.size() < 6) return result;
  result.share = static_cast<double>(tight.size()) / static_cast<double>(met.size());
  const Arms arms(tight);
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(information(tight, arms));
  result.least_information = solver.eigenvalues()[0];
  const Vector6d motion = solver.eigenvectors().col(0);
  result.middle = arms.mean();
  result.turn = motion.head<3>() / arms.reach();
  result.shift_m = motion.tail<3>();
  const double all = told(met, arms, motion);
  result.least_share = all > 0.0 ? std::max(0.0, told(tight, arms, motion)) / all : 0.0;
  return result;
}

}  // namespace sparsha::pipeline
