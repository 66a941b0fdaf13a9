// What two motors that shake can tell of a force: that the stone was met, and how rough it is.
#pragma once

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

namespace sparsha::haptics {

/// Servo thread; no allocation. Newtons, seconds; shares of full shaking, 0 to 1.
class Vibration {
 public:
  static constexpr double kMet_n = 1.0;    ///< a force that comes within kSoon_s: the strong motor's full share
  static constexpr double kRough_n = 0.1;  ///< a force that changes so within kTexture_s: the weak motor's
  static constexpr double kSoon_s = 0.020, kTexture_s = 0.005, kFades_s = 0.030;

  void feel(const Eigen::Vector3d& force_n, double dt_s) noexcept {
    const double size_n = force_n.norm();
    slow_n_ += (size_n - slow_n_) * weight(dt_s, kSoon_s);
    smooth_n_ += (force_n - smooth_n_) * weight(dt_s, kTexture_s);
    const double keeps = std::exp(-dt_s / kFades_s);
    strong_ = std::max(strong_ * keeps, std::clamp((size_n - slow_n_) / kMet_n, 0.0, 1.0));
    weak_ = std::max(weak_ * keeps, std::clamp((force_n - smooth_n_).norm() / kRough_n, 0.0, 1.0));
  }
  void stop() noexcept { *this = {}; }
  [[nodiscard]] double strong() const noexcept { return strong_; }
  [[nodiscard]] double weak() const noexcept { return weak_; }

 private:
  [[nodiscard]] static double weight(double dt_s, double time_s) noexcept { return 1.0 - std::exp(-dt_s / time_s); }
  double slow_n_ = 0.0, strong_ = 0.0, weak_ = 0.0;
  Eigen::Vector3d smooth_n_ = Eigen::Vector3d::Zero();
};

}  // namespace sparsha::haptics
