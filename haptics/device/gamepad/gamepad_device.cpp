#include "haptics/device/gamepad/gamepad.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <string>
#include <thread>
#include <utility>

#include "base/error.h"
#include "haptics/device/gamepad/vibration.h"
#include "haptics/device/simulated/feeling_hand.h"

namespace sparsha::haptics {
namespace {

using system::PadKind;
using system::PadState;

// A soft grip: a trigger held half way presses with about a newton.
constexpr HandParameters kHand{.stiffness_n_per_m = 150.0, .damping_n_s_per_m = 4.0, .max_force_n = 4.0};
constexpr double kHover_m = 0.012, kDeepest_m = -0.020;
constexpr double kSpeed_m_per_s = 0.06, kDeadZone = 0.12;
constexpr double kReach = 0.48;  // of the workspace's width, from the middle
constexpr std::chrono::milliseconds kShake{20};
constexpr double kShakes_s = 0.060;  // without news the motors stop by themselves
constexpr double kNoticed = 0.02;

double beyond_dead_zone(double stick) {
  const double size = std::abs(stick);
  return size <= kDeadZone ? 0.0 : std::copysign((size - kDeadZone) / (1.0 - kDeadZone), stick);
}

class PadDevice final : public Device {
 public:
  PadDevice(std::unique_ptr<system::Pad> pad, PadKind kind)
      : pad_(std::move(pad)), kind_(kind), hand_(kHand, {0.0, 0.0, kHover_m}), shaker_([this] { shake(); }) {}
  ~PadDevice() override {
    stopping_.store(true);
    shaker_.join();
  }

  [[nodiscard]] DeviceInfo info() const override {
    DeviceInfo info = hand_.info(kind_ == PadKind::gamepad ? "gamepad" : "tablet");
    info.planned_time = false;
    return info;
  }

  [[nodiscard]] DeviceSample read(double time_s, double) noexcept override {
    pad_->read(state_);
    DeviceSample sample = hand_.read(time_s, [this](const Eigen::Vector3d&, const Eigen::Vector3d&, double dt_s) {
      wish(dt_s);
      return wish_m_;
    });
    feel(time_s);
    sample.buttons = buttons();
    sample.connected = state_.connected;
    return sample;
  }

  void write(const Eigen::Vector3d& force_n) noexcept override {
    force_n_ = force_n;
    hand_.write(force_n);
  }
  void zero() noexcept override {
    hand_.zero();
    strong_.store(0.0);
    weak_.store(0.0);
  }

 private:
  void wish(double dt_s) noexcept {
    const double reach_m = kReach * scene::kDeskWorkspace_m;
    double press = 0.0;
    if (kind_ == PadKind::tablet) {
      wish_m_.x() = (2.0 * state_.pen_x - 1.0) * reach_m;
      wish_m_.y() = (2.0 * state_.pen_y - 1.0) * reach_m;
      press = state_.pen_near ? state_.pressure : 0.0;
    } else {
      wish_m_.x() += kSpeed_m_per_s * dt_s * beyond_dead_zone(state_.left_x);
      wish_m_.y() += kSpeed_m_per_s * dt_s * beyond_dead_zone(state_.left_y);
      press = state_.right_trigger;
    }
    wish_m_.x() = std::clamp(wish_m_.x(), -reach_m, reach_m);
    wish_m_.y() = std::clamp(wish_m_.y(), -reach_m, reach_m);
    wish_m_.z() = kHover_m + press * (kDeepest_m - kHover_m);
  }

  // South is the centre, the others are where they lie.
  [[nodiscard]] std::uint64_t buttons() const noexcept {
    const auto is = [this](unsigned bit) { return std::uint64_t{state_.buttons >> bit & 1U}; };
    return is(0) << 2U | is(1) | is(2) << 3U | is(3) << 1U;
  }

  void feel(double time_s) noexcept {
    const double dt_s = std::clamp(time_s - felt_s_, 1e-5, 0.1);
    felt_s_ = time_s;
    vibration_.feel(force_n_, dt_s);
    strong_.store(vibration_.strong(), std::memory_order_relaxed);
    weak_.store(vibration_.weak(), std::memory_order_relaxed);
  }

  // The system's call for it may wait, and is none of the servo's.
  void shake() {
    bool shakes = false;
    while (!stopping_.load()) {
      const double strong = strong_.load(), weak = weak_.load();
      const bool noticed = std::max(strong, weak) > kNoticed;
      if (noticed || shakes) pad_->rumble(noticed ? strong : 0.0, noticed ? weak : 0.0, kShakes_s);
      shakes = noticed;
      std::this_thread::sleep_for(kShake);
    }
    if (shakes) pad_->rumble(0.0, 0.0, kShakes_s);
  }

  std::unique_ptr<system::Pad> pad_;
  PadKind kind_;
  FeelingHand hand_;
  PadState state_;
  Eigen::Vector3d wish_m_{0.0, 0.0, kHover_m};
  Eigen::Vector3d force_n_ = Eigen::Vector3d::Zero();
  double felt_s_ = 0.0;
  Vibration vibration_;
  std::atomic<double> strong_{0.0}, weak_{0.0};
  std::atomic<bool> stopping_{false};
  std::thread shaker_;
};

DeviceKind kind_of(const char* name, const char* what, PadKind kind) {
  return {name,
          nullptr,
          what,
          [kind](const DeviceRequest&) -> std::vector<FoundDevice> {
            std::string problem;
            const auto pad = system::open_pad(kind, problem);
            return {{pad ? pad->name() : "", pad != nullptr, pad ? "" : problem, {}}};
          },
          [kind](const DeviceRequest&) -> std::unique_ptr<Device> {
            std::string problem;
            auto pad = system::open_pad(kind, problem);
            if (!pad)
              throw Error(ErrorKind::device, {}, problem,
                          "one that Linux shows in /dev/input, and that this user may open");
            return make_pad_device(std::move(pad), kind);
          },
          {}};
}

}  // namespace

std::unique_ptr<Device> make_pad_device(std::unique_ptr<system::Pad> pad, PadKind kind) {
  return std::make_unique<PadDevice>(std::move(pad), kind);
}

DeviceKind gamepad_kind() {
  return kind_of("gamepad", "its stick and trigger move a hand, its motors shake", PadKind::gamepad);
}
DeviceKind tablet_kind() { return kind_of("tablet", "its pen is the hand, its pressure the depth", PadKind::tablet); }

}  // namespace sparsha::haptics
