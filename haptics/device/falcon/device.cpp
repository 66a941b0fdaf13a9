// The servo's side: strict question and answer, homing gates, forces to motor commands.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <string>
#include <thread>
#include <utility>

#include "base/error.h"
#include "haptics/device/falcon/calibration.h"
#include "haptics/device/falcon/effort.h"
#include "haptics/device/falcon/falcon.h"
#include "haptics/device/falcon/guard.h"
#include "haptics/device/falcon/homing_advice.h"
#include "haptics/device/falcon/keeper.h"
#include "haptics/device/falcon/link.h"
#include "haptics/device/falcon/open_questions.h"
#include "haptics/device/falcon/usb_transport.h"
#include "haptics/governor/governor.h"

namespace sparsha::haptics::falcon {
namespace {

using Steady = std::chrono::steady_clock;
/// An answer is waited for as long as a hand of a kilohertz is not stale without it. Meanwhile the last force is held
/// and asked for again: on a link that is late but steady it would come and go otherwise. The watchdog acts at 10 ms.
constexpr double kPatience_s = kStale_s;
/// An answer that has not come by then may be lost: ask again.
constexpr double kLost_s = 0.5 * kPatience_s;
/// Without an answer for so long the firmware does not run any more, though the USB chip, which has power of its own,
/// is still there.
constexpr double kSilent_s = 1.0;
/// Without an answer for so long nobody knows what is still pressed. A program that has not asked for so long was
/// stopped.
constexpr double kUnheard_s = 0.1;
/// Homed flags must be missing in so many answers, so that one flipped bit does not un-home.
constexpr int kUnhomedAnswers = 3;
/// Homed flags must hold for this many answers, so that one flipped bit does not let forces through.
constexpr int kHomedAnswers = 10;
/// Encoders cannot move farther in a millisecond: 5 m/s.
constexpr double kLongestStep_m = 0.005;
constexpr int kFinalZeros = 8;
/// An answer may be that to an earlier question, and to the one before.
constexpr int kZerosAnswered = 3;
/// USB packets taken in one tick: a few come at once after a pause, more only from a damaged device.
constexpr int kMostPackets = 64;
/// For so long in a tick is more taken once there is an answer. On a slow bus the watchdog's zeros are answered faster
/// than their answers are taken: the tick would never end, and the watchdog never stop.
constexpr double kDrain_s = 0.001;
/// After an answer to the only question that is open nothing more can be there, but for what nobody asked for: that is
/// looked for so seldom. Each look is two calls of the system between the answer and the next question, which on a slow
/// machine then misses its frame of a millisecond: half the rate.
constexpr int kLookEvery = 64;
/// No question has its own answer so soon: that was one that nobody asked for, and there may be more.
constexpr double kAtOnce_s = 0.0002;
constexpr int kFailures = 4;

constexpr DeviceAdvice kComeForward{"homed_come_forward", true};
constexpr DeviceAdvice kReady{"device_ready", false};
constexpr DeviceAdvice kWarm{"device_warm", false, true};
constexpr DeviceAdvice kSilent{"device_silent", true};

class FalconDevice final : public Device {
 public:
  FalconDevice(std::unique_ptr<Transport> wire, const FalconOptions& options, std::unique_ptr<ForceGuard> guard = {},
               std::unique_ptr<Keeper> keeper = {})
      : guard_(std::move(guard)), keeper_(std::move(keeper)), options_(options), info_(falcon_info(options)) {
    options_.counts_per_newton_metre = counts_of(options);
    if (wire)
      adopt(wire.release());
    else if (keeper_)
      keeper_->give_back(nullptr);
  }

  ~FalconDevice() override {
    const std::unique_ptr<Transport> wire(shared_.exchange(nullptr));
    if (!wire) return;
    UsbPacket bytes{};
    std::size_t size = 0;
    int answered = 0;
    for (int i = 0; i < kFinalZeros; ++i) {
      if (wire->write(zero_, 20) == TransportStatus::gone) break;
      if (wire->receive(bytes, size, 0.002) == TransportStatus::ok && size > kModemBytes) ++answered;
    }
    if (answered >= kZerosAnswered || !wire->present()) mark_force(false);  // else the guard goes on from here
  }

  [[nodiscard]] DeviceInfo info() const override {
    DeviceInfo info = info_;
    if (keeper_ && !guard_)
      info.warning += std::string(info.warning.empty() ? "" : "; ") +
                      "No process of its own guards the Falcon: if this program is killed, its force may stay on";
    return info;
  }

  void wait(double timeout_s) noexcept override {
    if (guard_) guard_->beat();
    if (wire_ == nullptr && !find_again()) {  // keeps the servo's pace without a device
      std::this_thread::sleep_for(std::chrono::duration<double>(timeout_s));
      return;
    }
    const Steady::time_point began = Steady::now();
    if (since(waited_at_) > kUnheard_s) heard_at_ = began;  // the program was stopped, not the device
    waited_at_ = began;
    // A force is repeated only while this call waits, and not once the servo or others have made a zero of it.
    const bool zeroed = count_urgent_zeros();
    const bool holds_force = std::exchange(holds_force_, false) && !zeroed;
    if (may_ask()) ask({});
    const double patience_s = std::max(timeout_s, kPatience_s);
    bool answered = false;
    bool looks_on = ++waits_ % kLookEvery == 0;
    // A device that never stops talking must not hold the servo.
    for (int packets = 0; packets < kMostPackets && wire_ != nullptr; ++packets) {
      if (packets > 0 && since(began) > (answered ? kDrain_s : patience_s)) break;
      if (!answered && asked_ && since(asked_at_) > kLost_s)
        ask(holds_force && since(began) < patience_s && urgent_zeros_counted_ == urgent_zeros_.load() ? commanded_
                                                                                                      : MotorCommand{});
      if (wire_ == nullptr) return;
      // What came beside the answer (to a question asked twice, to a watchdog's zero) is taken too, or the hand would
      // be seen late for ever after.
      const double left_s = answered ? 0.0 : std::max(0.0, patience_s - since(began));
      UsbPacket bytes{};
      std::size_t size = 0;
      const TransportStatus status = wire_->receive(bytes, size, std::min(left_s, kLost_s));
      if (status == TransportStatus::gone) lose(nullptr);
      // A transfer that failed, or a question to be repeated, ends the waiting before its time.
      if (status == TransportStatus::nothing && left_s > 0.0 && packets < kFailures) continue;
      if (status != TransportStatus::ok) break;
      if (size <= kModemBytes) continue;
      if (const auto answer = stream_.feed(std::span(bytes).subspan(kModemBytes, size - kModemBytes))) {
        take(*answer);
        answered = true;
        if (!looks_on && delay_s_ > kAtOnce_s && !questions_.any()) break;
      } else {
        looks_on = true;  // a packet that is no answer: something has come out of step
      }
    }
    if (!answered) questions_.stays_silent(clock_s());
    if (wire_ != nullptr && since(heard_at_) > kSilent_s) lose(&kSilent);
  }

  [[nodiscard]] DeviceSample read(double time_s, double) noexcept override {
    effort_.add(commanded_, time_s - read_s_);
    read_s_ = time_s;
    DeviceSample sample;
    sample.position_m = position_m_ - options_.centre_m;
    sample.buttons = since(heard_at_) > kUnheard_s ? 0 : buttons_;
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
    if (released_ && unhomed_answers_ == 0 && !safe_n.isZero(0.0))
      if (const auto torque = torques(position_m_, safe_n))
        command = motor_command(*torque, options_.counts_per_newton_metre);
    // One question at a time; only a zero that must end a force does not wait for the answer.
    const bool stop = command == MotorCommand{} && commanded_ != MotorCommand{};
    holds_force_ = command != MotorCommand{};
    if (stop || may_ask()) ask(command);
  }

  [[nodiscard]] double force_share() const noexcept override { return effort_.share(); }
  void zero() noexcept override {
    if (keeper_) keeper_->enter();
    if (Transport* const wire = shared_.load()) {
      urgent_zeros_.fetch_add(1);  // first: whoever has not seen the zero must not repeat a force after it
      wire->urgent(zero_);
    }
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
  [[nodiscard]] static double clock_s() noexcept { return since(Steady::time_point{}); }
  [[nodiscard]] std::uint8_t lights() const noexcept {
    return static_cast<std::uint8_t>(kHomingRequest | (!homed_ ? kLightRed : released_ ? kLightBlue : kLightGreen));
  }
  [[nodiscard]] bool may_ask() noexcept { return asked_ ? since(asked_at_) > kLost_s : !questions_.holds(clock_s()); }
  void mark_force(bool on) noexcept {
    if (guard_) guard_->set_force(on);
  }

  // Nothing of an earlier device holds for this one.
  void adopt(Transport* wire) noexcept {
    stream_ = AnswerStream();
    position_m_ = kNeutral_m;
    commanded_ = {};
    buttons_ = 0;
    asked_ = holds_force_ = fresh_ = homed_ = released_ = known_ = false;
    homed_answers_ = unhomed_answers_ = jumps_ = 0;
    delay_s_ = 0.0;
    questions_.clear();
    heard_at_ = waited_at_ = Steady::now();
    homing_flags_ = 0;
    homing_since_ = Steady::now();
    advice_.store(homing_advice(0, false));
    wire_ = wire;
    if (guard_) guard_->watch(guarded(wire->address()));
    mark_force(false);
    shared_.store(wire);
  }
  bool find_again() noexcept {
    Transport* const wire = keeper_ ? keeper_->take() : nullptr;
    if (wire != nullptr) adopt(wire);
    return wire != nullptr;
  }
  /// `why`: what the person has to do; null when the keeper knows better.
  void lose(const DeviceAdvice* why) noexcept {
    Transport* const wire = wire_;
    wire_ = nullptr;
    released_ = fresh_ = false;
    commanded_ = {};
    // One that is still on the bus may hold its force: the guard watches until zeros are answered again.
    if (wire->present()) {
      wire->urgent(zero_);
    } else {
      mark_force(false);
      if (guard_) guard_->watch(0);
    }
    advice_.store(keeper_ ? nullptr : why);
    if (!keeper_) return;  // the wire stays to be closed with this
    shared_.store(nullptr);
    keeper_->give_back(wire, why);
  }
  // Each of them is answered too. True when there were some.
  bool count_urgent_zeros() noexcept {
    const unsigned sent = urgent_zeros_.load(std::memory_order_relaxed);
    const bool any = urgent_zeros_counted_ != sent;
    for (; urgent_zeros_counted_ != sent; ++urgent_zeros_counted_) questions_.ask(clock_s());
    return any;
  }

  void ask(const MotorCommand& command) noexcept {
    if (command != MotorCommand{}) {
      zeros_answered_ = 0;
      mark_force(true);
    }
    const TransportStatus status = wire_->post(encode(command, lights()));
    if (status == TransportStatus::gone) lose(nullptr);
    if (status != TransportStatus::ok) return;
    commanded_ = command;
    asked_ = true;
    asked_at_ = Steady::now();
    questions_.ask(clock_s());
  }

  void take(const Answer& answer) noexcept {
    // A force that is asked is felt, and the position of its answer known, within this time.
    if (const double took_s = questions_.answer(clock_s()); took_s > 0.0) delay_s_ = took_s;
    heard_at_ = Steady::now();
    asked_ = false;
    // A zero on its way would be lost with this process: only one that was answered has ended the force.
    if (commanded_ == MotorCommand{} && zeros_answered_ < kZerosAnswered && ++zeros_answered_ == kZerosAnswered)
      mark_force(false);
    buttons_ = answer.buttons;
    homed_answers_ = answer.homed == 7 ? std::min(homed_answers_ + 1, kHomedAnswers) : 0;
    unhomed_answers_ = answer.homed == 7 ? 0 : std::min(unhomed_answers_ + 1, kUnhomedAnswers);
    if (homed_ && unhomed_answers_ > 0 && unhomed_answers_ < kUnhomedAnswers) return;  // stale, and no force meanwhile
    const bool homed = homed_ ? unhomed_answers_ == 0 : homed_answers_ == kHomedAnswers;
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
  bool holds_force_ = false;  ///< the servo's last word was a force
  Steady::time_point asked_at_{};
  OpenQuestions questions_;
  std::atomic<unsigned> urgent_zeros_{0};
  unsigned urgent_zeros_counted_ = 0;
  int waits_ = 0;
  double delay_s_ = 0.0;           ///< from a question to its answer
  Steady::time_point heard_at_{};  ///< when the last answer came
  Steady::time_point waited_at_{};
  bool fresh_ = false;
  bool homed_ = false;
  bool released_ = false;   ///< homed, and pulled out since
  bool known_ = false;      ///< position_m_ is the last answer's
  int zeros_answered_ = 0;  ///< since the last force
  int homed_answers_ = 0;
  int unhomed_answers_ = 0;  ///< since the last that was homed
  int jumps_ = 0;
  std::uint8_t homing_flags_ = 0;
  Steady::time_point homing_since_{};
};

/// Each attempt opens the device anew: one that hangs after a failed upload comes to its senses.
std::unique_ptr<Transport> open_and_load(std::span<const std::uint8_t> image, const FalconOptions& options) {
  const int attempts = options.wait_for_device ? 1 : 10;
  const auto progress = loading(options);
  for (int attempt = 1;; ++attempt) {
    std::unique_ptr<Transport> wire = open_usb_transport();
    try {
      bring_up(*wire, image, 1, progress);
      return wire;
    } catch (const Cancelled&) {
      throw;
    } catch (const Error& error) {
      if (image.empty()) throw;
      if (attempt >= attempts)
        throw Error(ErrorKind::device, {}, error.wrong() + " (" + std::to_string(attempt) + " attempts)",
                    error.expected());
    }
  }
}

}  // namespace

std::unique_ptr<Device> make_falcon_device(std::unique_ptr<Transport> wire, const FalconOptions& options) {
  const std::vector<std::uint8_t> image = firmware_image(options);
  bring_up(*wire, image, 10, loading(options));
  return std::make_unique<FalconDevice>(std::move(wire), options);
}

std::unique_ptr<Device> make_falcon_device(const FalconOptions& asked) {
  FalconOptions options = asked;
  if (!(options.counts_per_newton_metre > 0.0)) options.counts_per_newton_metre = stored_calibration().value_or(0.0);
  std::unique_ptr<ForceGuard> guard;
  try {
    guard = std::make_unique<ForceGuard>(zero_by_usb());
  } catch (const Error&) {  // info() tells
  }
  std::vector<std::uint8_t> image = firmware_image(options);
  std::unique_ptr<Transport> wire;
  try {
    if (!options.wait_for_device || !find_falcons().empty()) wire = open_and_load(image, options);
  } catch (const Cancelled&) {
    throw;
  } catch (const Error&) {  // without power, not permitted, or busy: the keeper says so, and tries again
    if (!options.wait_for_device) throw;
  }
  auto keeper = std::make_unique<Keeper>(try_usb_transport, std::move(image));
  return std::make_unique<FalconDevice>(std::move(wire), options, std::move(guard), std::move(keeper));
}

}  // namespace sparsha::haptics::falcon
