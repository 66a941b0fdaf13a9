// The hand is where the viewer's pointer is: pictures come 60 times a second, the servo a thousand times, so the hand
// follows the pointer through a critically damped second-order filter.
#include <cmath>
#include <memory>
#include <utility>

#include "haptics/device/pointer/pointer_device.h"

namespace sparsha::haptics {
namespace {

constexpr double kFollow_s = 0.012;  // time constant: most of a frame, less than the eye notices
constexpr double kLongestStep_s = 0.1;

class PointerDevice final : public Device {
 public:
  explicit PointerDevice(std::shared_ptr<const Seqlock<PointerSample>> pointer) : pointer_(std::move(pointer)) {}

  [[nodiscard]] DeviceInfo info() const override {
    DeviceInfo info;
    info.name = "pointer";
    info.limits.least_damping_n_s_per_m = 10.0;  // it has no motors: nothing can oscillate
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
        follow(goal_m, std::min(time_s - time_s_, kLongestStep_s));
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

  void write(const Eigen::Vector3d&) noexcept override {}
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

  std::shared_ptr<const Seqlock<PointerSample>> pointer_;
  PointerSample newest_;
  bool known_ = false;
  double time_s_ = 0.0;
  Eigen::Vector3d position_m_{0.0, 0.0, 0.03};
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();
};

}  // namespace

std::unique_ptr<Device> make_pointer_device(std::shared_ptr<const Seqlock<PointerSample>> pointer) {
  return std::make_unique<PointerDevice>(std::move(pointer));
}

}  // namespace sparsha::haptics
