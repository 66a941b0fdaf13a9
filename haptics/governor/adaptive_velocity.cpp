#include "haptics/governor/adaptive_velocity.h"

#include <algorithm>
#include <limits>

namespace sparsha::haptics {

void AdaptiveVelocity::add(const Eigen::Vector3d& position_m, double period_s) noexcept {
  if (!(period_s > 0.0)) count_ = 0;
  time_s_ = count_ == 0 ? 0.0 : time_s_ + period_s;
  if (count_ >= 2 && back(0).time_s - back(1).time_s < kClosest_s) {
    next_ = (next_ + kMost - 1) % kMost;
    --count_;
  }
  samples_[next_] = {position_m, time_s_};
  next_ = (next_ + 1) % kMost;
  count_ = std::min(count_ + 1, kMost);
}

/// The last sample before the newest that is not too close to it; the one before it where there is no other.
std::size_t AdaptiveVelocity::nearest() const noexcept {
  return count_ > 2 && back(0).time_s - back(1).time_s < kClosest_s ? 2 : 1;
}

/// Samples before the newest that its window reaches back. Each sample j in between lets the line have slopes from
/// (x_0 - x_j - noise) / t_j to (x_0 - x_j + noise) / t_j; a window is as long as its own slope lies in all of them.
std::size_t AdaptiveVelocity::window(Eigen::Index axis, double noise_m) const noexcept {
  const Sample& newest = back(0);
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();
  const std::size_t first = nearest();
  std::size_t longest = first;
  for (std::size_t j = first; j < count_; ++j) {
    const double back_s = newest.time_s - back(j).time_s;
    if (j > first && back_s > kLongest_s) break;
    const double way_m = newest.position_m[axis] - back(j).position_m[axis];
    const double slope = way_m / back_s;
    if (slope < least || slope > most) break;
    longest = j;
    least = std::max(least, (way_m - noise_m) / back_s);
    most = std::min(most, (way_m + noise_m) / back_s);
  }
  return longest;
}

Eigen::Vector3d AdaptiveVelocity::velocity(double noise_m) const noexcept {
  Eigen::Vector3d result = Eigen::Vector3d::Zero();
  if (count_ < 2) return result;
  const Sample& newest = back(0);
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const std::size_t first = nearest();
    const std::size_t longest = window(axis, noise_m);
    double sum_t = 0.0;
    double sum_tt = 0.0;
    double sum_x = 0.0;
    double sum_tx = 0.0;
    for (std::size_t j = first; j <= longest; ++j) {
      const double t = back(j).time_s - newest.time_s;
      const double x = back(j).position_m[axis] - newest.position_m[axis];
      sum_t += t;
      sum_tt += t * t;
      sum_x += x;
      sum_tx += t * x;
    }
    const auto n = static_cast<double>(longest - first + 2);
    const double spread = n * sum_tt - sum_t * sum_t;
    if (spread > 0.0) result[axis] = (n * sum_tx - sum_t * sum_x) / spread;
  }
  return result;
}

}  // namespace sparsha::haptics
