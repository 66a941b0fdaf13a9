#include "haptics/device/gamepad/gamepad.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <string>
#include <thread>
#include <utility>

#include <Eigen/Geometry>

#include "base/error.h"
#include "haptics/device/gamepad/vibration.h"
#include "haptics/device/hot_plug.h"
#include "haptics/device/simulated/feeling_hand.h"

namespace sparsha::haptics {
namespace {

using system::PadKind;
using system::PadState;

// A soft grip: a trigger held half way presses with about a newton.
constexpr HandParameters kHand{.stiffness_n_per_m = 150.0, .damping_n_s_per_m = 4.0, .max_force_n = 4.0};
constexpr double kHover_m = 0.012, kDeepest_m = -0.020;
constexpr double kSpeed_m_per_s = 0.06, kDeadZone = 0.12;
constexpr double kHatSpeed_m_per_s = 0.015;
constexpr double kTriggerDeadZone = 0.06;  // of a trigger that does not come back whole
constexpr double kReach = 0.48;            // of the workspace's width, from the middle
constexpr std::chrono::milliseconds kShake{20};
constexpr double kShakes_s = 0.060;  // without news the motors stop by themselves
constexpr double kNoticed = 0.02;

double beyond_dead_zone(double stick) {
  const double size = std::abs(stick);
  return size <= kDeadZone ? 0.0 : std::copysign((size - kDeadZone) / (1.0 - kDeadZone), stick);
}

double beyond_trigger_dead_zone(double trigger) {
  return std::max(0.0, trigger - kTriggerDeadZone) / (1.0 - kTriggerDeadZone);
}

/// The least turn that takes the upright pen to where it leans; its far end comes towards the person.
std::array<double, 4> leaning(const PadState& state) {
  const Eigen::Vector3d axis(std::tan(state.tilt_x_rad), std::tan(state.tilt_y_rad), 1.0);
  const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), axis);
  return {turn.w(), turn.x(), turn.y(), turn.z()};
}

constexpr DeviceAdvice kPlugIn{"device_pad", true};

class PadDevice final : public Device {
 public:
  PadDevice(std::unique_ptr<system::Pad> pad, PadKind kind, std::function<std::unique_ptr<system::Pad>()> reopen)
      : pad_(pad.release()),
        kind_(kind),
        hand_(kHand, {0.0, 0.0, kHover_m}),
        plug_([reopen = std::move(reopen)] { return reopen ? reopen() : nullptr; }),
        shaker_([this] { shake(); }) {
    if (pad_.load() == nullptr) plug_.give_back(nullptr);
  }
  ~PadDevice() override {
    stopping_.store(true);
    shaker_.join();
    delete pad_.load();
  }

  [[nodiscard]] DeviceInfo info() const override {
    DeviceInfo info = hand_.info(kind_ == PadKind::gamepad ? "gamepad" : "tablet");
    info.planned_time = false;
    return info;
  }

  [[nodiscard]] DeviceSample read(double time_s, double) noexcept override {
    if (pad() == nullptr) pad_.store(plug_.take());
    if (pad() != nullptr) pad()->read(state_);
    if (pad() == nullptr || !state_.connected) leave();
    DeviceSample sample = hand_.read(time_s, [this](const Eigen::Vector3d&, const Eigen::Vector3d&, double dt_s) {
      wish(dt_s);
      return wish_m_;
    });
    feel(time_s);
    sample.buttons = buttons();
    if (kind_ == PadKind::tablet && state_.pen_near && state_.has_tilt) sample.orientation = leaning(state_);
    sample.connected = pad() != nullptr;
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
  [[nodiscard]] const DeviceAdvice* advice() const noexcept override { return pad() == nullptr ? &kPlugIn : nullptr; }

 private:
  [[nodiscard]] system::Pad* pad() const noexcept { return pad_.load(std::memory_order_relaxed); }

  // Nothing that was pressed stays so.
  void leave() noexcept {
    state_ = {};
    if (system::Pad* const gone = pad_.exchange(nullptr)) plug_.give_back(gone);
  }

  void wish(double dt_s) noexcept {
    const double reach_m = kReach * scene::kDeskWorkspace_m;
    double press = 0.0;
    if (kind_ == PadKind::tablet) {
      if (pad() != nullptr) {  // unplugged, the hand stays where it was
        wish_m_.x() = (2.0 * state_.pen_x - 1.0) * reach_m;
        wish_m_.y() = (2.0 * state_.pen_y - 1.0) * reach_m;
      }
      press = state_.pen_near ? state_.pressure : 0.0;
    } else {
      wish_m_.x() += kSpeed_m_per_s * dt_s * beyond_dead_zone(state_.left_x);
      wish_m_.y() += kSpeed_m_per_s * dt_s * beyond_dead_zone(state_.left_y);
      wish_m_.x() += kHatSpeed_m_per_s * dt_s * state_.hat_x;
      wish_m_.y() += kHatSpeed_m_per_s * dt_s * state_.hat_y;
      press = beyond_trigger_dead_zone(state_.right_trigger);
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
      if (noticed || shakes) rumble(noticed ? strong : 0.0, noticed ? weak : 0.0);
      shakes = noticed;
      std::this_thread::sleep_for(kShake);
    }
    if (shakes) rumble(0.0, 0.0);
  }

  void rumble(double strong, double weak) {
    plug_.enter();
    if (system::Pad* const pad = pad_.load()) pad->rumble(strong, weak, kShakes_s);
    plug_.leave();
  }

  std::atomic<system::Pad*> pad_;  // the servo's, which alone takes it and gives it back; null while unplugged
  PadKind kind_;
  FeelingHand hand_;
  PadState state_;
  Eigen::Vector3d wish_m_{0.0, 0.0, kHover_m};
  Eigen::Vector3d force_n_ = Eigen::Vector3d::Zero();
  double felt_s_ = 0.0;
  Vibration vibration_;
  std::atomic<double> strong_{0.0}, weak_{0.0};
  std::atomic<bool> stopping_{false};
  HotPlug<system::Pad> plug_;
  std::thread shaker_;
};

std::vector<FoundDevice> find(PadKind kind) {
  std::string problem;
  std::vector<FoundDevice> found;
  for (const system::FoundPad& pad : system::find_pads(kind, problem))
    found.push_back({pad.node + " (" + pad.name + ")", true, "", {}});
  return found.empty() ? std::vector<FoundDevice>{{"", false, problem, {}}} : found;
}

/// The named one; where none is named, the first, and afterwards whichever is there.
std::unique_ptr<Device> make(PadKind kind, const DeviceRequest& request) {
  std::string problem;
  auto pad = system::open_pad(kind, request.argument, problem);
  if (!pad && !request.wait_for_device)
    throw Error(ErrorKind::device, {}, problem, "one that Linux shows in /dev/input, and that this user may open");
  return make_pad_device(std::move(pad), kind, [kind, node = request.argument] {
    std::string why;
    return system::open_pad(kind, node, why);
  });
}

DeviceKind kind_of(const char* name, const char* what, PadKind kind) {
  return {name,
          "[NODE]",
          what,
          [kind](const DeviceRequest&) { return find(kind); },
          [kind](const DeviceRequest& request) { return make(kind, request); },
          {}};
}

}  // namespace

std::unique_ptr<Device> make_pad_device(std::unique_ptr<system::Pad> pad, PadKind kind,
                                        std::function<std::unique_ptr<system::Pad>()> reopen) {
  return std::make_unique<PadDevice>(std::move(pad), kind, std::move(reopen));
}

DeviceKind gamepad_kind() {
  return kind_of("gamepad", "its stick and trigger move a hand, its motors shake", PadKind::gamepad);
}
DeviceKind tablet_kind() { return kind_of("tablet", "its pen is the hand, its pressure the depth", PadKind::tablet); }

}  // namespace sparsha::haptics
