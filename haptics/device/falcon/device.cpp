// The servo's side: strict question and answer, homing gates, forces to motor commands.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <thread>

#include "haptics/device/falcon/falcon.h"
#include "haptics/device/falcon/link.h"
#include "haptics/device/falcon/usb_transport.h"

namespace sparsha::haptics::falcon {
namespace {

using Steady = std::chrono::steady_clock;
/// An answer that has not come by then never will: ask again.
constexpr double kLost_s = 0.0035;
/// USB frames make answers late by a millisecond or two now and then; giving up sooner would make the hand stale, and
/// the force zero, for nothing. The watchdog bites at 10 ms.
constexpr double kPatience_s = 0.004;
/// Homed flags must hold for this many answers, so that one flipped bit does not let forces through.
constexpr int kHomedAnswers = 10;
/// Encoders cannot move farther in a millisecond: 5 m/s.
constexpr double kLongestStep_m = 0.005;
constexpr int kFinalZeros = 8;
/// What every direction has at 10000 counts a newton metre, over the workspace; more would saturate the amplifiers.
constexpr double kMostForce_n = 5.0;
/// USB packets taken in one tick: a few come at once after a pause, more only from a damaged device.
constexpr int kMostPackets = 64;

class FalconDevice final : public Device {
 public:
  FalconDevice(std::unique_ptr<Transport> wire, const FalconOptions& options)
      : wire_(std::move(wire)), options_(options) {}

  ~FalconDevice() override {
    const Packet off = encode({}, kHomingRequest | kLightRed);
    UsbPacket bytes{};
    std::size_t size = 0;
    for (int i = 0; i < kFinalZeros; ++i) {
      if (wire_->write(off, 20) == TransportStatus::gone) break;
      static_cast<void>(wire_->receive(bytes, size, 0.002));
    }
  }

  [[nodiscard]] DeviceInfo info() const override { return falcon_info(); }

  void wait(double timeout_s) noexcept override {
    if (!connected_) {  // keeps the servo's pace without a device
      std::this_thread::sleep_for(std::chrono::duration<double>(timeout_s));
      return;
    }
    const Steady::time_point began = Steady::now();
    if (!asked_ || since(asked_at_) > kLost_s) ask({});
    bool answered = false;
    // A device that never stops talking must not hold the servo.
    for (int packets = 0; packets < kMostPackets; ++packets) {
      // What came beside the answer (to a question asked twice, to a watchdog's zero) is taken too, or the hand would
      // be seen late for ever after.
      const double left = answered ? 0.0 : std::max(timeout_s, kPatience_s) - since(began);
      UsbPacket bytes{};
      std::size_t size = 0;
      const TransportStatus status = wire_->receive(bytes, size, std::max(0.0, left));
      if (status == TransportStatus::gone) connected_ = false;
      if (status != TransportStatus::ok) return;
      if (size <= kModemBytes) continue;
      if (const auto answer = stream_.feed(std::span(bytes).subspan(kModemBytes, size - kModemBytes))) {
        take(*answer);
        answered = true;
      }
    }
  }

  [[nodiscard]] DeviceSample read(double time_s, double) noexcept override {
    DeviceSample sample;
    sample.position_m = position_m_ - options_.centre_m;
    sample.buttons = buttons_;
    sample.time_s = time_s;
    sample.delay_s = delay_s_;
    sample.fresh = fresh_ && connected_;
    sample.homed = released_;
    sample.connected = connected_;
    fresh_ = false;
    return sample;
  }

  void write(const Eigen::Vector3d& force_n) noexcept override {
    if (!connected_) return;
    MotorCommand command{};
    const Eigen::Vector3d safe_n = deliverable(force_n, kMostForce_n);
    if (released_ && !safe_n.isZero(0.0))
      if (const auto torque = torques(position_m_, safe_n))
        command = motor_command(*torque, options_.counts_per_newton_metre);
    // One question at a time; only a zero that must end a force does not wait for the answer.
    const bool stop = command == MotorCommand{} && commanded_ != MotorCommand{};
    if (!asked_ || stop || since(asked_at_) > kLost_s) ask(command);
  }

  void zero() noexcept override { wire_->urgent(zero_); }

 private:
  [[nodiscard]] static double since(Steady::time_point then) noexcept {
    return std::chrono::duration<double>(Steady::now() - then).count();
  }
  [[nodiscard]] std::uint8_t lights() const noexcept {
    return static_cast<std::uint8_t>(kHomingRequest | (!homed_ ? kLightRed : released_ ? kLightBlue : kLightGreen));
  }

  void ask(const MotorCommand& command) noexcept {
    const TransportStatus status = wire_->post(encode(command, lights()));
    if (status == TransportStatus::gone) connected_ = false;
    if (status != TransportStatus::ok) return;
    commanded_ = command;
    asked_ = true;
    asked_at_ = Steady::now();
  }

  void take(const Answer& answer) noexcept {
    // A force that is asked is felt, and the position of its answer known, within this time.
    if (asked_) delay_s_ = since(asked_at_);
    asked_ = false;
    buttons_ = answer.buttons;
    homed_answers_ = answer.homed == 7 ? std::min(homed_answers_ + 1, kHomedAnswers) : 0;
    const bool homed = homed_answers_ == kHomedAnswers;
    if (homed != homed_) {  // coordinates jump: nothing of before holds
      homed_ = homed;
      released_ = false;
      known_ = false;
    }
    if (!homed_) {
      fresh_ = true;  // the link is alive; `homed` says that the position means nothing
      released_ = false;
      return;
    }
    const auto position = forward(angles_from_counts(answer.counts), known_ ? position_m_ : kNeutral_m);
    if (!position) return;  // garbled counts: stale until the next answer
    if (known_ && (*position - position_m_).norm() > kLongestStep_m && ++jumps_ < 3) return;
    jumps_ = 0;
    position_m_ = *position;
    known_ = true;
    fresh_ = true;
    if (position_m_.z() >= options_.release_z_m) released_ = true;
  }

  std::unique_ptr<Transport> wire_;
  FalconOptions options_;
  AnswerStream stream_;
  const Packet zero_ = encode({}, kHomingRequest | kLightRed);
  Eigen::Vector3d position_m_ = kNeutral_m;
  MotorCommand commanded_{};
  std::uint8_t buttons_ = 0;
  bool connected_ = true;
  bool asked_ = false;
  Steady::time_point asked_at_{};
  double delay_s_ = 0.0;  ///< from the last question to its answer
  bool fresh_ = false;
  bool homed_ = false;
  bool released_ = false;  ///< homed, and pulled out since
  bool known_ = false;     ///< position_m_ is the last answer's
  int homed_answers_ = 0;
  int jumps_ = 0;
};

}  // namespace

DeviceInfo falcon_info() {
  DeviceInfo info;
  info.name = "Novint Falcon";
  info.workspace_width_m = 0.070;
  info.limits.max_force_n = kMostForce_n;
  info.limits.least_damping_n_s_per_m = 2.0;
  info.paced = true;
  return info;
}

std::unique_ptr<Device> make_falcon_device(std::unique_ptr<Transport> wire, const FalconOptions& options) {
  const std::vector<std::uint8_t> image = firmware_image(options);
  bring_up(*wire, image);
  return std::make_unique<FalconDevice>(std::move(wire), options);
}

std::unique_ptr<Device> make_falcon_device(const FalconOptions& options) {
  return make_falcon_device(open_usb_transport(), options);
}

}  // namespace sparsha::haptics::falcon
