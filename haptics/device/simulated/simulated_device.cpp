// A device in software: the simulated hand explores, feels the force one tick late, and is read through its encoder.
#include <memory>
#include <utility>
#include <vector>

#include "haptics/device/simulated/exploration_script.h"
#include "haptics/device/simulated/feeling_hand.h"
#include "haptics/device/simulated/simulated_device.h"

namespace sparsha::haptics {
namespace {

class SimulatedDevice final : public Device {
 public:
  SimulatedDevice(std::uint64_t seed, double duration_s, std::vector<TourStop> tour)
      : script_(seed, scene::kDeskWorkspace_m, std::move(tour)),
        hand_({}, script_.target_m()),
        duration_s_(duration_s) {}

  [[nodiscard]] DeviceInfo info() const override { return hand_.info("simulated"); }

  [[nodiscard]] DeviceSample read(double time_s, double) noexcept override {
    DeviceSample sample = hand_.read(time_s, [this](const Eigen::Vector3d& felt_n, const Eigen::Vector3d& hand_m,
                                                    double dt_s) { return script_.advance(felt_n, hand_m, dt_s); });
    sample.buttons = script_.buttons();
    sample.finished = duration_s_ > 0.0 && time_s >= duration_s_;
    return sample;
  }

  void write(const Eigen::Vector3d& force_n) noexcept override { hand_.write(force_n); }
  void zero() noexcept override { hand_.zero(); }

 private:
  ExplorationScript script_;
  FeelingHand hand_;
  double duration_s_;
};

}  // namespace

std::unique_ptr<Device> make_simulated_device(std::uint64_t seed, double duration_s, std::vector<TourStop> tour) {
  return std::make_unique<SimulatedDevice>(seed, duration_s, std::move(tour));
}

}  // namespace sparsha::haptics
