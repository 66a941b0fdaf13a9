// The hand is where the viewer's pointer is: pictures come 60 times a second, the servo a thousand times, so the hand
// follows the pointer through a critically damped second-order filter. Between two pictures the stone can come to the
// hand, as while the window moves: the hand then gives way to what is more than it presses with.
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "haptics/device/pointer/pointer_device.h"

namespace sparsha::haptics {
namespace {

constexpr double kFollow_s = 0.012;  // time constant: most of a frame, less than the eye notices
constexpr double kLongestStep_s = 0.1;
constexpr double kYieldShare = 0.5;    // of the way to the greatest force, in one tick
constexpr double kFastestYield = 2.0;  // metres a second

class PointerDevice final : public Device {
 public:
  explicit PointerDevice(std::shared_ptr<const Seqlock<PointerSample>> pointer) : pointer_(std::move(pointer)) {}

  [[nodiscard]] DeviceInfo info() const override {
    DeviceInfo info;
    info.name = "pointer";
    info.limits.least_damping_n_s_per_m = 10.0;  // it has no motors: nothing can oscillate
    info.limits.undeclared_s = 0.0;
    return info;
  }

  [[nodiscard]] DeviceSample read(double time_s, double) noexcept override {
    PointerSample wanted;
    if (pointer_->try_read(wanted)) newest_ = wanted;
    const bool known = newest_.sequence != 0;
    const Eigen::Vector3d goal_m(newest_.device_m[0], newest_.device_m[1], newest_.device_m[2]);
    // What is no place is passed on, for the servo to end the force, but the filter must not keep it.
    const bool usable_goal = goal_m.allFinite();
    if (known && usable_goal) {
      if (!known_) {
        position_m_ = goal_m;
        velocity_.setZero();
      } else if (time_s > time_s_) {
        const double dt_s = std::min(time_s - time_s_, kLongestStep_s);
        const Eigen::Vector3d before_m = position_m_;
        follow(goal_m, dt_s);
        give_way(before_m, dt_s);
      }
      known_ = true;
    }
    time_s_ = time_s;
    DeviceSample sample;
    sample.position_m = usable_goal ? position_m_ : goal_m;
    sample.buttons = newest_.buttons;
    sample.time_s = time_s;
    sample.fresh = known_;
    return sample;
  }

  void write(const Eigen::Vector3d& force_n) noexcept override { force_n_ = force_n; }
  void zero() noexcept override {}

 private:
  // Exact solution of x'' = (goal - x) / T^2 - 2 x' / T over one step.
  void follow(const Eigen::Vector3d& goal_m, double dt_s) noexcept {
    const double decay = std::exp(-dt_s / kFollow_s);
    const Eigen::Vector3d away = position_m_ - goal_m;
    const Eigen::Vector3d rise = velocity_ + away / kFollow_s;
    position_m_ = goal_m + (away + rise * dt_s) * decay;
    velocity_ = (velocity_ - rise * (dt_s / kFollow_s)) * decay;
  }

  // Against the force of the tick before, the hand goes no farther than what is left up to the greatest force; from a
  // greater one it goes back.
  void give_way(const Eigen::Vector3d& before_m, double dt_s) noexcept {
    const double force_n = force_n_.norm();
    if (!(newest_.most_force_n > 0.0 && newest_.stiffness_n_per_m > 0.0 && force_n > 0.0) || !std::isfinite(force_n))
      return;
    const Eigen::Vector3d out = force_n_ / force_n;
    const double least_m =
        std::min(kYieldShare * (force_n - newest_.most_force_n) / newest_.stiffness_n_per_m, kFastestYield * dt_s);
    const double moved_m = (position_m_ - before_m).dot(out);
    if (!(moved_m < least_m)) return;
    position_m_ += (least_m - moved_m) * out;
    velocity_ -= std::min(0.0, velocity_.dot(out)) * out;
  }

  std::shared_ptr<const Seqlock<PointerSample>> pointer_;
  PointerSample newest_;
  bool known_ = false;
  double time_s_ = 0.0;
  Eigen::Vector3d position_m_{0.0, 0.0, 0.03};
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d force_n_ = Eigen::Vector3d::Zero();  // of the last tick
};

}  // namespace

std::unique_ptr<Device> make_pointer_device(std::shared_ptr<const Seqlock<PointerSample>> pointer) {
  return std::make_unique<PointerDevice>(std::move(pointer));
}

}  // namespace sparsha::haptics
