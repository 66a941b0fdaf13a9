// A device in software: the simulated hand explores, feels the force one tick late, and is read through its encoder.
#include <atomic>
#include <memory>
#include <utility>
#include <vector>

#include "haptics/device/simulated/exploration_script.h"
#include "haptics/device/simulated/hand.h"
#include "haptics/device/simulated/simulated_device.h"

namespace sparsha::haptics {
namespace {

constexpr double kLongestStep_s = 0.1;  // a longer silence of the servo is simulated as this much

class SimulatedDevice final : public Device {
 public:
  SimulatedDevice(std::uint64_t seed, double duration_s, std::vector<TourStop> tour)
      : script_(seed, pipeline::kDeskWorkspace_m, std::move(tour)),
        hand_(parameters_, script_.target_m()),
        duration_s_(duration_s) {}

  [[nodiscard]] DeviceInfo info() const override {
    DeviceInfo info;
    info.name = "simulated";
    info.planned_time = true;
    info.limits.max_force_n = parameters_.max_force_n;
    info.limits.least_damping_n_s_per_m = parameters_.damping_n_s_per_m;
    return info;
  }

  [[nodiscard]] DeviceSample read(double time_s, double) noexcept override {
    if (started_ && time_s > time_s_) {
      if (zeroed_.exchange(false, std::memory_order_acquire)) {
        held_n_.setZero();
        next_n_.setZero();
      }
      const double dt_s = std::min(time_s - time_s_, kLongestStep_s);
      hand_.advance(script_.advance(held_n_, hand_.position_m(), dt_s), held_n_, dt_s);
      held_n_ = next_n_;
    }
    started_ = true;
    time_s_ = time_s;
    DeviceSample sample;
    sample.position_m = hand_.measured_m();
    sample.buttons = script_.buttons();
    sample.time_s = time_s;
    sample.fresh = true;
    sample.finished = duration_s_ > 0.0 && time_s >= duration_s_;
    return sample;
  }

  void write(const Eigen::Vector3d& force_n) noexcept override {
    next_n_ = deliverable(force_n, parameters_.max_force_n);
  }
  void zero() noexcept override { zeroed_.store(true, std::memory_order_release); }

 private:
  HandParameters parameters_;
  ExplorationScript script_;
  SimulatedHand hand_;
  double duration_s_;
  bool started_ = false;
  double time_s_ = 0.0;
  Eigen::Vector3d held_n_ = Eigen::Vector3d::Zero();  // what the motors hold
  Eigen::Vector3d next_n_ = Eigen::Vector3d::Zero();  // what they will hold from the next tick on
  std::atomic<bool> zeroed_{false};
};

}  // namespace

std::unique_ptr<Device> make_simulated_device(std::uint64_t seed, double duration_s, std::vector<TourStop> tour) {
  return std::make_unique<SimulatedDevice>(seed, duration_s, std::move(tour));
}

}  // namespace sparsha::haptics
