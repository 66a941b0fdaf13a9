#include "protocol/score.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>

#include "base/numbers/statistics.h"

namespace sparsha::protocol {

using Eigen::Vector3d;

Score score_forces(std::span<const Vector3d> forces, std::span<const Vector3d> truth, std::size_t first,
                   std::size_t last) {
  constexpr double kFar = 1e9;  // the error of what is not a number
  std::vector<double> errors, sizes, angles;
  std::size_t lost = 0, felt = 0, jumps = 0;
  Score score;
  Vector3d off = Vector3d::Zero();  // of the tick before
  if (first > 0 && forces[first - 1].allFinite()) off = forces[first - 1] - truth[first - 1];
  for (std::size_t tick = first; tick < last; ++tick) {
    const Vector3d& force = forces[tick];
    const double right = truth[tick].norm();
    const bool finite = force.allFinite();
    const double error = finite ? (force - truth[tick]).norm() / right : kFar;
    if (errors.empty() || error > score.error_max) {
      score.error_max = error;
      score.worst = tick;
    }
    const double size = finite ? force.norm() / right : kFar;
    errors.push_back(error);
    sizes.push_back(std::abs(size - 1.0));
    angles.push_back(finite && size > 0.0 ? std::atan2(force.cross(truth[tick]).norm(), force.dot(truth[tick])) *
                                                180.0 / std::numbers::pi
                                          : 180.0);
    if (!(error < 1.0)) ++lost;
    if (!(error <= kFeltError)) ++felt;
    if (!finite || (force - truth[tick] - off).norm() > kFeltError * right) ++jumps;
    if (finite) off = force - truth[tick];
  }
  const auto count = static_cast<double>(errors.size());
  score.lost = static_cast<double>(lost) / count;
  score.felt = static_cast<double>(felt) / count;
  score.jumps = static_cast<double>(jumps) / count;
  score.error_median = median(errors);
  score.error_p99 = quantile(errors, 0.99);
  score.size_median = median(sizes);
  score.size_p99 = quantile(sizes, 0.99);
  score.angle_median_deg = median(angles);
  score.angle_p99_deg = quantile(angles, 0.99);
  return score;
}

double ghost_share(std::span<const Vector3d> forces, std::span<const Vector3d> truth, std::size_t first,
                   std::size_t last) {
  double most = 0.0;
  for (const Vector3d& force : truth) most = std::max(most, force.norm());
  std::size_t outside = 0, ghosts = 0;
  for (std::size_t tick = 0; tick < truth.size(); ++tick) {
    if (tick >= first && tick < last) continue;
    ++outside;
    const double allowed = truth[tick].squaredNorm() > 0.0 ? kFeltError : kGhost;
    if (!((forces[tick] - truth[tick]).norm() <= allowed * most)) ++ghosts;
  }
  return outside > 0 ? static_cast<double>(ghosts) / static_cast<double>(outside) : 0.0;
}

}  // namespace sparsha::protocol
