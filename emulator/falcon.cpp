#include "emulator/falcon.h"

#include <algorithm>
#include <numbers>

namespace sparsha::emulator {
namespace {

constexpr std::uint16_t kBootDivisor = 0x4138, kUploadDivisor = 0x0015, kRunDivisor = 0x0002;
constexpr std::uint16_t kDtrLow = 0x0100, kDtrHigh = 0x0101;
constexpr std::array<std::uint8_t, 3> kGreeting{0x0A, 0x43, 0x0D};
constexpr std::array<std::uint8_t, 4> kGreetingReply{0x0A, 0x44, 0x2C, 0x0D};
constexpr std::uint8_t kBegin = 0x41;
constexpr std::uint8_t kHomingRequest = 0x01, kLights = 0x0E;
/// From a command's last byte to its answer's first.
constexpr double kThinking_s = 50e-6;
/// An encoder is homed once its arm has been beyond the first angle and then below the second.
constexpr double kPulledOut_rad = 56.0 * std::numbers::pi / 180.0, kPushedIn_rad = 20.0 * std::numbers::pi / 180.0;

}  // namespace

Falcon::Falcon(const FalconOptions& options) : options_(options), loaded_(options.firmware_loaded) {
  homed_.fill(options.homed);
  if (const auto angles = arm_angles(grip_.place_m))
    for (std::size_t i = 0; i < 3; ++i) power_up_counts_[i] = count_of((*angles)[i]);
}

void Falcon::set_hand(Hand hand) {
  const std::lock_guard lock(mutex_);
  hand_ = std::move(hand);
}
void Falcon::set_place(const Vec3& place_m) {
  const std::lock_guard lock(mutex_);
  hand_ = nullptr;
  grip_.place_m = place_m;
}
void Falcon::set_buttons(std::uint8_t buttons) {
  const std::lock_guard lock(mutex_);
  pressed_ = buttons;
}
void Falcon::set_log(Log log) {
  const std::lock_guard lock(mutex_);
  log_ = std::move(log);
}

void Falcon::tell(WireEvent::Kind kind, std::span<const std::uint8_t> bytes, double time_s) const {
  if (log_) log_({time_s, kind, {bytes.begin(), bytes.end()}});
}

void Falcon::lose_power() {
  loaded_ = false;
  homed_.fill(false);
  pulled_out_.fill(false);
  command_ = {};
  force_n_ = {};
  bridge_ = {};
  parser_.reset();
  mode_ = Mode::run;
  if (const auto angles = arm_angles(grip_.place_m))
    for (std::size_t i = 0; i < 3; ++i) power_up_counts_[i] = count_of((*angles)[i]);
}

void Falcon::unplug(bool power, double time_s) {
  const std::lock_guard lock(mutex_);
  plugged_ = false;
  tell(WireEvent::Kind::unplugged, {}, time_s);
  if (!power) lose_power();
}
void Falcon::plug(double time_s) {
  const std::lock_guard lock(mutex_);
  plugged_ = true;
  tell(WireEvent::Kind::plugged, {}, time_s);
}
void Falcon::power_cycle() {
  const std::lock_guard lock(mutex_);
  lose_power();
}

void Falcon::set_power(bool on, double time_s) {
  const std::lock_guard lock(mutex_);
  options_.powered = on;
  tell(on ? WireEvent::Kind::power_on : WireEvent::Kind::power_off, {}, time_s);
  const Bridge bridge = bridge_;
  lose_power();
  bridge_ = bridge;
}

bool Falcon::control(std::uint8_t request, std::uint16_t value, double time_s) {
  const std::lock_guard lock(mutex_);
  const std::array<std::uint8_t, 3> bytes{request, static_cast<std::uint8_t>(value & 0xFFU),
                                          static_cast<std::uint8_t>(value >> 8U)};
  tell(WireEvent::Kind::control, bytes, time_s);
  const bool heeds = request != BridgeRequest::kEventCharacter || options_.heeds_event_character;
  if (heeds && !bridge_.control(request, value, time_s)) return false;
  if (request == BridgeRequest::kModem) modem(value);
  if (request == BridgeRequest::kReset && value != 2) parser_.reset();
  if (request == BridgeRequest::kBaud && value == kRunDivisor && mode_ != Mode::run) {
    if (mode_ == Mode::upload && uploaded_.size() >= options_.image_bytes)
      loaded_ = static_cast<int>(++uploads_) > options_.failed_loads;
    mode_ = Mode::run;
    parser_.reset();
  }
  return true;
}

void Falcon::modem(std::uint16_t value) {
  if (value == kDtrHigh && dtr_low_ && bridge_.divisor() == kBootDivisor && options_.powered) {  // reset
    lose_power();
    // The bridge has power of its own.
    static_cast<void>(bridge_.control(BridgeRequest::kBaud, kBootDivisor, 0.0));
    mode_ = Mode::greeting;
    greeted_ = 0;
    uploaded_.clear();
  }
  dtr_low_ = value == kDtrLow;
}

void Falcon::write(std::span<const std::uint8_t> bytes, double time_s) {
  const std::lock_guard lock(mutex_);
  tell(WireEvent::Kind::to_device, bytes, time_s);
  if (!plugged_ || !options_.powered) return;
  for (const std::uint8_t byte : bytes) {
    const double arrived_s = bridge_.send(1, time_s);
    if (mode_ != Mode::run) {
      boot(byte, arrived_s);
    } else if (loaded_ && bridge_.divisor() == kRunDivisor) {
      if (const auto command = parser_.feed(byte)) serve(*command, arrived_s);
    }
  }
}

void Falcon::boot(std::uint8_t byte, double time_s) {
  if (mode_ == Mode::upload) return echo(byte, time_s);
  if (bridge_.divisor() == kUploadDivisor && mode_ == Mode::begin) {
    if (byte != kBegin) return;
    mode_ = Mode::upload;
    return say(std::array{kBegin}, time_s);
  }
  if (bridge_.divisor() != kBootDivisor) return;  // noise at another rate
  greeted_ = byte == kGreeting[greeted_] ? greeted_ + 1 : (byte == kGreeting[0] ? 1 : 0);
  if (greeted_ < kGreeting.size()) return;
  greeted_ = 0;
  if (++greetings_ <= options_.deaf_handshakes) return;
  mode_ = Mode::begin;
  say(kGreetingReply, time_s);
}

void Falcon::echo(std::uint8_t byte, double time_s) {
  uploaded_.push_back(byte);
  const bool wrong = !corrupted_ && static_cast<int>(uploaded_.size()) - 1 == options_.corrupt_echo_byte;
  corrupted_ = corrupted_ || wrong;
  say(std::array{static_cast<std::uint8_t>(wrong ? byte ^ 0x10U : byte)}, time_s);
}

void Falcon::hold(double time_s) {
  if (!hand_) return;
  grip_ = hand_({time_s, force_n_, static_cast<std::uint8_t>(command_.flags & kLights)});
}

void Falcon::home(const PerArm& angles, double time_s) {
  constexpr std::size_t kRight = 1;
  if (homing_since_s_ < 0.0) homing_since_s_ = time_s;
  for (std::size_t i = 0; i < 3; ++i) {
    if (i == kRight && time_s < homing_since_s_ + options_.arm_missing_s) continue;
    pulled_out_[i] = pulled_out_[i] || angles[i] > kPulledOut_rad;
    homed_[i] = homed_[i] || (pulled_out_[i] && angles[i] < kPushedIn_rad);
  }
}

std::array<int, 3> Falcon::counts() const {
  std::array<int, 3> counts{};
  const auto angles = arm_angles(grip_.place_m);
  if (!angles) return counts;
  for (std::size_t i = 0; i < 3; ++i) counts[i] = count_of((*angles)[i]) - (homed_[i] ? 0 : power_up_counts_[i]);
  return counts;
}

void Falcon::serve(const Command& command, double time_s) {
  ++commands_;
  hold(time_s);  // until now under the force of before
  command_ = command;
  const bool force = command.motors != std::array<int, 3>{};
  const bool homed = std::all_of(homed_.begin(), homed_.end(), [](bool one) { return one; });
  unsafe_ += force && !homed ? 1 : 0;
  PerArm torque{};
  for (std::size_t i = 0; i < 3; ++i) torque[i] = -command.motors[i] / options_.counts_per_newton_metre;
  force_n_ = force ? force_of(torque, grip_.place_m) : Vec3{};
  if ((command.flags & kHomingRequest) != 0)
    if (const auto angles = arm_angles(grip_.place_m)) home(*angles, time_s);
  if (options_.silent_every_s > 0.0 && time_s > last_silence_s_ + options_.silent_every_s) {
    if (last_silence_s_ > 0.0) silent_until_s_ = time_s + options_.silent_s;
    last_silence_s_ = time_s;
  }
  if (time_s < silent_until_s_) return;
  if (options_.lose_every > 0 && commands_ % static_cast<std::uint64_t>(options_.lose_every) == 0) return;
  answer(time_s + kThinking_s);
}

void Falcon::answer(double time_s) {
  unsigned homed = 0;
  for (unsigned i = 0; i < 3; ++i) homed |= homed_[i] ? 1U << i : 0U;
  Answer reply = answer_bytes(counts(), unsigned{grip_.buttons} | pressed_, homed);
  ++answers_;
  if (options_.garble_every > 0 && answers_ % static_cast<std::uint64_t>(options_.garble_every) == 0) reply[3] = 0xFF;
  if (options_.latest_answer_s >= options_.earliest_answer_s) {
    // A fixed, even spread over the range.
    const double share = static_cast<double>((answers_ * 7919) % 1000) / 1000.0;
    time_s += options_.earliest_answer_s + share * (options_.latest_answer_s - options_.earliest_answer_s);
  }
  if (options_.garbage && answers_ % 3 == 0) {
    constexpr std::array<std::uint8_t, 7> kNoise{0x00, '<', 0xFF, '>', '<', 'A', 0x7F};
    say(kNoise, time_s);
  }
  if (options_.split_answers) {
    say(std::span(reply).first(5), time_s);
    bridge_.break_packet();
    say(std::span(reply).subspan(5), time_s);
  } else {
    say(reply, time_s);
  }
}

void Falcon::say(std::span<const std::uint8_t> bytes, double time_s) {
  for (const std::uint8_t byte : bytes) {
    ++bytes_said_;
    if (mode_ == Mode::run && options_.lose_byte_every > 0 &&
        bytes_said_ % static_cast<std::uint64_t>(options_.lose_byte_every) == 0)
      continue;
    bridge_.receive(byte, time_s);
  }
}

double Falcon::packet_s() const {
  const std::lock_guard lock(mutex_);
  return bridge_.packet_s();
}

std::optional<std::vector<std::uint8_t>> Falcon::read(double time_s) {
  const std::lock_guard lock(mutex_);
  if (!plugged_) return std::nullopt;
  auto packet = bridge_.take(time_s);
  if (packet && packet->size() > 2) tell(WireEvent::Kind::to_host, *packet, time_s);
  return packet;
}

bool Falcon::plugged() const {
  const std::lock_guard lock(mutex_);
  return plugged_;
}
std::uint8_t Falcon::latency_ms() const {
  const std::lock_guard lock(mutex_);
  return bridge_.latency_ms();
}
bool Falcon::powered() const {
  const std::lock_guard lock(mutex_);
  return options_.powered;
}
std::array<int, 3> Falcon::motors() const {
  const std::lock_guard lock(mutex_);
  return command_.motors;
}
Vec3 Falcon::force_n() const {
  const std::lock_guard lock(mutex_);
  return force_n_;
}
std::uint64_t Falcon::commands() const {
  const std::lock_guard lock(mutex_);
  return commands_;
}
std::uint64_t Falcon::unsafe_commands() const {
  const std::lock_guard lock(mutex_);
  return unsafe_;
}
std::uint8_t Falcon::flags() const {
  const std::lock_guard lock(mutex_);
  return command_.flags;
}
bool Falcon::firmware_loaded() const {
  const std::lock_guard lock(mutex_);
  return loaded_;
}
bool Falcon::homed() const {
  const std::lock_guard lock(mutex_);
  return homed_[0] && homed_[1] && homed_[2];
}
std::vector<std::uint8_t> Falcon::uploaded() const {
  const std::lock_guard lock(mutex_);
  return uploaded_;
}

}  // namespace sparsha::emulator
