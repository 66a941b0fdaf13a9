// The servo's side: strict question and answer, homing gates, forces to motor commands.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <string>
#include <thread>

#include "base/error.h"
#include "haptics/device/falcon/calibration.h"
#include "haptics/device/falcon/effort.h"
#include "haptics/device/falcon/falcon.h"
#include "haptics/device/falcon/guard.h"
#include "haptics/device/falcon/keeper.h"
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
/// Homing that has not come further for so long needs a more exact word.
constexpr double kSlowHoming_s = 4.0;
constexpr int kFinalZeros = 8;
/// An answer may be that to an earlier question, and to the one before.
constexpr int kZerosAnswered = 3;
/// More is not asked of a hand-held device of this size, whatever its motors have.
constexpr double kMostForce_n = 5.0;
constexpr double kForceRadius_m = 0.035;
/// USB packets taken in one tick: a few come at once after a pause, more only from a damaged device.
constexpr int kMostPackets = 64;
constexpr int kFailures = 4;

/// How the person makes all three encoders know their places.
const DeviceAdvice* homing_advice(std::uint8_t homed, bool slow) {
  static constexpr DeviceAdvice kAll{"homing_all", true};
  static constexpr DeviceAdvice kTop{"homing_top", true};
  static constexpr DeviceAdvice kRight{"homing_right", true};
  static constexpr DeviceAdvice kLeft{"homing_left", true};
  static constexpr DeviceAdvice kNotTop{"homing_right_left", true};
  static constexpr DeviceAdvice kNotRight{"homing_top_left", true};
  static constexpr DeviceAdvice kNotLeft{"homing_top_right", true};
  static constexpr const DeviceAdvice* kByFlags[8] = {&kAll,     &kNotTop, &kNotRight, &kLeft,
                                                      &kNotLeft, &kRight,  &kTop,      &kAll};
  // In one pull and push the arms follow each other: no word about that.
  return slow ? kByFlags[homed & 7U] : &kAll;
}
constexpr DeviceAdvice kComeForward{"homed_come_forward", true};
constexpr DeviceAdvice kReady{"device_ready", false};
constexpr DeviceAdvice kWarm{"device_warm", false};

/// The greatest force that the amplifiers deliver in every direction, anywhere within kForceRadius_m of the origin: no
/// motor's share of a newton in its worst direction may pass its range.
double force_everywhere_n(const FalconOptions& options) {
  constexpr int kSteps = 8;  // from the middle to the rim
  double least_n = kMostForce_n;
  for (int i = -kSteps; i <= kSteps; ++i)
    for (int j = -kSteps; j <= kSteps; ++j)
      for (int k = -kSteps; k <= kSteps; ++k) {
        const Eigen::Vector3d offset_m = Eigen::Vector3d(i, j, k) * (kForceRadius_m / kSteps);
        if (offset_m.norm() > kForceRadius_m * (1.0 + 1e-9)) continue;
        Eigen::Matrix3d torques_per_n;
        for (int axis = 0; axis < 3; ++axis) {
          const auto torque = torques(options.centre_m + offset_m, Eigen::Vector3d::Unit(axis));
          if (!torque) return 0.0;
          torques_per_n.col(axis) = *torque;
        }
        const double most = torques_per_n.rowwise().norm().maxCoeff() * options.counts_per_newton_metre;
        least_n = std::min(least_n, kMostCommand / most);
      }
  return least_n;
}

FalconOptions with_usual_counts(FalconOptions options) {
  if (!(options.counts_per_newton_metre > 0.0)) options.counts_per_newton_metre = kUsualCounts;
  return options;
}

class FalconDevice final : public Device {
 public:
  FalconDevice(std::unique_ptr<Transport> wire, const FalconOptions& options, std::unique_ptr<ForceGuard> guard = {},
               std::unique_ptr<Keeper> keeper = {})
      : guard_(std::move(guard)),
        keeper_(std::move(keeper)),
        options_(with_usual_counts(options)),
        info_(falcon_info(options_)) {
    if (wire)
      adopt(wire.release());
    else if (keeper_)
      keeper_->give_back(nullptr);
  }

  ~FalconDevice() override {
    const std::unique_ptr<Transport> wire(shared_.exchange(nullptr));
    if (!wire) return;
    const Packet off = encode({}, kHomingRequest | kLightRed);
    UsbPacket bytes{};
    std::size_t size = 0;
    for (int i = 0; i < kFinalZeros; ++i) {
      if (wire->write(off, 20) == TransportStatus::gone) break;
      static_cast<void>(wire->receive(bytes, size, 0.002));
    }
    mark_force(false);
  }

  [[nodiscard]] DeviceInfo info() const override {
    DeviceInfo info = info_;
    if (keeper_ && !guard_)
      info.warning = "No process of its own guards the Falcon: if this program is killed, its force may stay on";
    return info;
  }

  void wait(double timeout_s) noexcept override {
    if (guard_) guard_->beat();
    if (wire_ == nullptr && !find_again()) {  // keeps the servo's pace without a device
      std::this_thread::sleep_for(std::chrono::duration<double>(timeout_s));
      return;
    }
    const Steady::time_point began = Steady::now();
    if (!asked_ || since(asked_at_) > kLost_s) ask({});
    bool answered = false;
    // A device that never stops talking must not hold the servo.
    for (int packets = 0; packets < kMostPackets && wire_ != nullptr; ++packets) {
      // What came beside the answer (to a question asked twice, to a watchdog's zero) is taken too, or the hand would
      // be seen late for ever after.
      const double left = answered ? 0.0 : std::max(timeout_s, kPatience_s) - since(began);
      UsbPacket bytes{};
      std::size_t size = 0;
      const TransportStatus status = wire_->receive(bytes, size, std::max(0.0, left));
      if (status == TransportStatus::gone) lose();
      // A transfer that failed ends the waiting before its time: the next may bring the answer.
      if (status == TransportStatus::nothing && left > 0.0 && packets < kFailures && since(began) < kPatience_s)
        continue;
      if (status != TransportStatus::ok) return;
      if (size <= kModemBytes) continue;
      if (const auto answer = stream_.feed(std::span(bytes).subspan(kModemBytes, size - kModemBytes))) {
        take(*answer);
        answered = true;
      }
    }
  }

  [[nodiscard]] DeviceSample read(double time_s, double) noexcept override {
    effort_.add(commanded_, time_s - read_s_);
    read_s_ = time_s;
    DeviceSample sample;
    sample.position_m = position_m_ - options_.centre_m;
    sample.buttons = buttons_;
    sample.time_s = time_s;
    sample.delay_s = delay_s_;
    sample.fresh = fresh_ && wire_ != nullptr;
    sample.homed = released_;
    sample.connected = wire_ != nullptr;
    fresh_ = false;
    return sample;
  }

  void write(const Eigen::Vector3d& force_n) noexcept override {
    if (wire_ == nullptr) return;
    MotorCommand command{};
    const Eigen::Vector3d safe_n = effort_.share() * deliverable(force_n, info_.limits.max_force_n);
    if (released_ && !safe_n.isZero(0.0))
      if (const auto torque = torques(position_m_, safe_n))
        command = motor_command(*torque, options_.counts_per_newton_metre);
    // One question at a time; only a zero that must end a force does not wait for the answer.
    const bool stop = command == MotorCommand{} && commanded_ != MotorCommand{};
    if (!asked_ || stop || since(asked_at_) > kLost_s) ask(command);
  }

  [[nodiscard]] double force_share() const noexcept override { return effort_.share(); }
  void zero() noexcept override {
    if (keeper_) keeper_->enter();
    if (Transport* const wire = shared_.load()) wire->urgent(zero_);
    if (keeper_) keeper_->leave();
  }

  [[nodiscard]] const DeviceAdvice* advice() const noexcept override {
    if (const DeviceAdvice* const own = advice_.load()) return own;
    return keeper_ ? keeper_->advice() : nullptr;
  }

 private:
  [[nodiscard]] static double since(Steady::time_point then) noexcept {
    return std::chrono::duration<double>(Steady::now() - then).count();
  }
  [[nodiscard]] std::uint8_t lights() const noexcept {
    return static_cast<std::uint8_t>(kHomingRequest | (!homed_ ? kLightRed : released_ ? kLightBlue : kLightGreen));
  }
  void mark_force(bool on) noexcept {
    if (guard_) guard_->set_force(on);
  }

  // Nothing of an earlier device holds for this one.
  void adopt(Transport* wire) noexcept {
    stream_ = AnswerStream();
    position_m_ = kNeutral_m;
    commanded_ = {};
    buttons_ = 0;
    asked_ = fresh_ = homed_ = released_ = known_ = false;
    homed_answers_ = jumps_ = 0;
    delay_s_ = 0.0;
    homing_flags_ = 0;
    homing_since_ = Steady::now();
    advice_.store(homing_advice(0, false));
    wire_ = wire;
    if (guard_) guard_->watch(wire->address());
    mark_force(false);
    shared_.store(wire);
  }
  bool find_again() noexcept {
    Transport* const wire = keeper_ ? keeper_->take() : nullptr;
    if (wire != nullptr) adopt(wire);
    return wire != nullptr;
  }
  void lose() noexcept {
    Transport* const wire = wire_;
    wire_ = nullptr;
    released_ = fresh_ = false;
    commanded_ = {};
    mark_force(false);
    if (guard_) guard_->watch({});
    if (!keeper_) return;  // the wire stays to be closed with this
    advice_.store(nullptr);
    shared_.store(nullptr);
    keeper_->give_back(wire);
  }

  void ask(const MotorCommand& command) noexcept {
    if (command != MotorCommand{}) {
      zeros_answered_ = 0;
      mark_force(true);
    }
    const TransportStatus status = wire_->post(encode(command, lights()));
    if (status == TransportStatus::gone) lose();
    if (status != TransportStatus::ok) return;
    commanded_ = command;
    asked_ = true;
    asked_at_ = Steady::now();
  }

  void take(const Answer& answer) noexcept {
    // A force that is asked is felt, and the position of its answer known, within this time.
    if (asked_) delay_s_ = since(asked_at_);
    asked_ = false;
    // A zero on its way would be lost with this process: only one that was answered has ended the force.
    if (commanded_ == MotorCommand{} && zeros_answered_ < kZerosAnswered && ++zeros_answered_ == kZerosAnswered)
      mark_force(false);
    buttons_ = answer.buttons;
    homed_answers_ = answer.homed == 7 ? std::min(homed_answers_ + 1, kHomedAnswers) : 0;
    const bool homed = homed_answers_ == kHomedAnswers;
    if (homed != homed_) {  // coordinates jump: nothing of before holds
      homed_ = homed;
      released_ = false;
      known_ = false;
    }
    advise(answer.homed);
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

  void advise(std::uint8_t flags) noexcept {
    if (homed_) {
      const DeviceAdvice* const ready = effort_.reduces() ? &kWarm : &kReady;
      advice_.store(released_ ? ready : &kComeForward, std::memory_order_relaxed);
      return;
    }
    if (flags != homing_flags_) homing_since_ = Steady::now();
    homing_flags_ = flags;
    advice_.store(homing_advice(flags, since(homing_since_) > kSlowHoming_s), std::memory_order_relaxed);
  }

  std::unique_ptr<ForceGuard> guard_;
  std::unique_ptr<Keeper> keeper_;
  FalconOptions options_;
  DeviceInfo info_;
  MotorEffort effort_;   // of these motors: unplugging does not cool them
  double read_s_ = 0.0;  // when the position was asked for last
  AnswerStream stream_;
  const Packet zero_ = encode({}, kHomingRequest | kLightRed);
  Transport* wire_ = nullptr;                ///< null while unplugged; servo thread
  std::atomic<Transport*> shared_{nullptr};  ///< the one to close, and to send zero to
  std::atomic<const DeviceAdvice*> advice_{nullptr};
  Eigen::Vector3d position_m_ = kNeutral_m;
  MotorCommand commanded_{};
  std::uint8_t buttons_ = 0;
  bool asked_ = false;
  Steady::time_point asked_at_{};
  double delay_s_ = 0.0;  ///< from the last question to its answer
  bool fresh_ = false;
  bool homed_ = false;
  bool released_ = false;   ///< homed, and pulled out since
  bool known_ = false;      ///< position_m_ is the last answer's
  int zeros_answered_ = 0;  ///< since the last force
  int homed_answers_ = 0;
  int jumps_ = 0;
  std::uint8_t homing_flags_ = 0;
  Steady::time_point homing_since_{};
};

/// Each attempt opens the device anew: one that hangs after a failed upload comes to its senses.
std::unique_ptr<Transport> open_and_load(std::span<const std::uint8_t> image) {
  constexpr int kAttempts = 10;
  for (int attempt = 1;; ++attempt) {
    std::unique_ptr<Transport> wire = open_usb_transport();
    try {
      bring_up(*wire, image, 1);
      return wire;
    } catch (const Error& error) {
      if (image.empty()) throw;
      if (attempt >= kAttempts)
        throw Error(ErrorKind::device, {}, error.wrong() + " (" + std::to_string(attempt) + " attempts)",
                    error.expected());
    }
  }
}

}  // namespace

DeviceInfo falcon_info(const FalconOptions& options) {
  DeviceInfo info;
  info.name = "Novint Falcon";
  info.workspace_width_m = 0.070;
  info.limits.max_force_n = force_everywhere_n(with_usual_counts(options));
  info.limits.least_damping_n_s_per_m = 2.0;
  info.paced = true;
  return info;
}

std::unique_ptr<Device> make_falcon_device(std::unique_ptr<Transport> wire, const FalconOptions& options) {
  const std::vector<std::uint8_t> image = firmware_image(options);
  bring_up(*wire, image);
  return std::make_unique<FalconDevice>(std::move(wire), options);
}

std::unique_ptr<Device> make_falcon_device(const FalconOptions& asked) {
  FalconOptions options = asked;
  if (!(options.counts_per_newton_metre > 0.0))
    options.counts_per_newton_metre = stored_calibration().value_or(kUsualCounts);
  std::unique_ptr<ForceGuard> guard;
  try {
    guard = std::make_unique<ForceGuard>();
  } catch (const Error&) {  // info() tells
  }
  std::vector<std::uint8_t> image = firmware_image(options);
  std::unique_ptr<Transport> wire;
  if (!options.wait_for_device || !find_falcons().empty()) wire = open_and_load(image);
  auto keeper = std::make_unique<Keeper>(open_usb_transport, std::move(image));
  return std::make_unique<FalconDevice>(std::move(wire), options, std::move(guard), std::move(keeper));
}

}  // namespace sparsha::haptics::falcon
