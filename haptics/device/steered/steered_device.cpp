#include "haptics/device/steered/steered_device.h"

#include <utility>

#include "haptics/device/simulated/feeling_hand.h"

namespace sparsha::haptics {
namespace {

// A firm grip: friction holds it back by about a millimetre.
constexpr HandParameters kHand{.stiffness_n_per_m = 600.0, .damping_n_s_per_m = 10.0};

class SteeredDevice final : public Device {
 public:
  explicit SteeredDevice(std::shared_ptr<const Seqlock<SteeringSample>> wish)
      : wish_(std::move(wish)), script_(scene::kDeskWorkspace_m), hand_(kHand, script_.target_m()) {}

  [[nodiscard]] DeviceInfo info() const override { return hand_.info("keys"); }

  [[nodiscard]] DeviceSample read(double time_s, double) noexcept override {
    SteeringSample wish;
    if (wish_->try_read(wish)) newest_ = wish;
    return hand_.read(time_s, [this](const Eigen::Vector3d& felt_n, const Eigen::Vector3d& hand_m, double dt_s) {
      return script_.advance(newest_, felt_n, hand_m, dt_s);
    });
  }

  void write(const Eigen::Vector3d& force_n) noexcept override { hand_.write(force_n); }
  void zero() noexcept override { hand_.zero(); }

 private:
  std::shared_ptr<const Seqlock<SteeringSample>> wish_;
  SteeringSample newest_;
  SteeringScript script_;
  FeelingHand hand_;
};

}  // namespace

std::unique_ptr<Device> make_steered_device(std::shared_ptr<const Seqlock<SteeringSample>> wish) {
  return std::make_unique<SteeredDevice>(std::move(wish));
}

}  // namespace sparsha::haptics
