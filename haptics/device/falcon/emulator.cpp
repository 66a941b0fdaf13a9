// The emulated firmware and boot loader.
#include "haptics/device/falcon/emulator.h"

#include <algorithm>

#include <Eigen/LU>

namespace sparsha::haptics::falcon {
namespace {

constexpr std::size_t kMostData = kUsbPacketBytes - kModemBytes;
constexpr std::size_t kHeld = 64;  ///< packets that nobody fetches; then the oldest goes
/// Homing ends once the grip has been pulled out beyond the first and pushed in beyond the second, metres.
constexpr double kPulledOut = 0.160, kPushedIn = 0.115;

}  // namespace

FalconEmulator::FalconEmulator(const EmulatorOptions& options)
    : options_(options), loaded_(options.firmware_loaded), homed_(options.homed) {
  if (const auto angles = inverse(position_m_)) power_up_counts_ = counts_from_angles(*angles);
}

void FalconEmulator::set_hand(Hand hand) {
  const std::lock_guard lock(mutex_);
  hand_ = std::move(hand);
}

void FalconEmulator::set_position(const Eigen::Vector3d& position_m) {
  const std::lock_guard lock(mutex_);
  hand_ = nullptr;
  position_m_ = position_m;
}

void FalconEmulator::set_buttons(std::uint8_t buttons) {
  const std::lock_guard lock(mutex_);
  buttons_ = buttons;
}

void FalconEmulator::unplug() {
  const std::lock_guard lock(mutex_);
  plugged_ = false;
}

void FalconEmulator::power_cycle() {
  const std::lock_guard lock(mutex_);
  loaded_ = homed_ = pulled_out_ = false;
  command_ = {};
  force_n_.setZero();
  outgoing_.clear();
  partial_.clear();
  if (const auto angles = inverse(position_m_)) power_up_counts_ = counts_from_angles(*angles);
}

void FalconEmulator::control(Request request, std::uint16_t value) {
  const std::lock_guard lock(mutex_);
  if (request == Request::reset) {
    outgoing_.clear();
    partial_.clear();
  } else if (request == Request::modem) {
    if (value == value::kDtrHigh && dtr_was_low_ && baud_ == value::kBaud9600) {  // reset into the boot loader
      mode_ = Mode::greeting;
      loaded_ = homed_ = pulled_out_ = false;
      uploaded_.clear();
    }
    dtr_was_low_ = value == value::kDtrLow;
  } else if (request == Request::baud) {
    baud_ = value;
    if (value == value::kBaudRun && mode_ == Mode::upload) {
      loaded_ = uploaded_.size() >= options_.image_bytes;
      if (const auto angles = inverse(position_m_)) power_up_counts_ = counts_from_angles(*angles);
    }
    if (value == value::kBaudRun) mode_ = Mode::run;
  }
}

void FalconEmulator::boot(std::span<const std::uint8_t> bytes) {
  constexpr std::array<std::uint8_t, 3> kHello{0x0A, 0x43, 0x0D};
  if (mode_ == Mode::greeting) {
    if (baud_ == value::kBaudUpload && bytes.size() == 1 && bytes.front() == 0x41) {
      mode_ = Mode::upload;
      outgoing_.push_back({0x41});
    } else if (std::equal(bytes.begin(), bytes.end(), kHello.begin(), kHello.end()) &&
               ++greetings_ > options_.deaf_handshakes) {
      outgoing_.push_back({0x0A, 0x44, 0x2C, 0x0D});
    }
    return;
  }
  std::vector<std::uint8_t> echo(bytes.begin(), bytes.end());
  const auto wrong = static_cast<std::size_t>(options_.corrupt_echo_byte) - uploaded_.size();
  if (options_.corrupt_echo_byte >= 0 && !corrupted_ && wrong < echo.size()) {
    corrupted_ = true;
    echo[wrong] ^= 0x10U;
  }
  uploaded_.insert(uploaded_.end(), bytes.begin(), bytes.end());
  // The echo comes split, as the real one does.
  const auto half = echo.begin() + static_cast<std::ptrdiff_t>(echo.size() / 2);
  if (half != echo.begin()) outgoing_.emplace_back(echo.begin(), half);
  outgoing_.emplace_back(half, echo.end());
}

void FalconEmulator::move(double time_s) {
  if (hand_) position_m_ = hand_(time_s, force_n_);
  if ((flags_ & kHomingRequest) == 0 || homed_) return;
  pulled_out_ = pulled_out_ || position_m_.z() > kPulledOut;
  homed_ = pulled_out_ && position_m_.z() < kPushedIn;
}

void FalconEmulator::answer(const Packet& packet, double time_s) {
  const auto command = decode_command(packet);
  if (!command) return;
  ++packets_;
  flags_ = static_cast<std::uint8_t>(packet[13] - 'A');
  command_ = *command;
  if (!homed_ && *command != MotorCommand{}) ++unsafe_;
  const auto rates = jacobian(position_m_);
  if (rates) {
    const Eigen::Vector3d torque =
        -Eigen::Vector3d(command_[0], command_[1], command_[2]) / options_.counts_per_newton_metre;
    force_n_ = rates->transpose() * torque;
  }
  move(time_s);
  if (options_.lose_every > 0 && packets_ % static_cast<std::uint64_t>(options_.lose_every) == 0) return;
  const auto angles = inverse(position_m_);
  Counts counts = angles ? counts_from_angles(*angles) : Counts{};
  if (!homed_)
    for (std::size_t i = 0; i < 3; ++i) counts[i] -= power_up_counts_[i];
  while (outgoing_.size() >= kHeld) outgoing_.pop_front();
  Packet reply = encode_answer(counts, buttons_, homed_ ? 7 : 0);
  ++answers_;
  if (options_.garble_every > 0 && answers_ % static_cast<std::uint64_t>(options_.garble_every) == 0) reply[3] = 0xFF;
  if (options_.split_answers) {
    outgoing_.emplace_back(reply.begin(), reply.begin() + 5);
    outgoing_.emplace_back(reply.begin() + 5, reply.end());
  } else {
    outgoing_.emplace_back(reply.begin(), reply.end());
  }
}

void FalconEmulator::serve(std::span<const std::uint8_t> bytes, double time_s) {
  if (!loaded_ || baud_ != value::kBaudRun) return;
  partial_.insert(partial_.end(), bytes.begin(), bytes.end());
  while (partial_.size() >= kPacketBytes) {
    if (partial_.front() != '<') {
      partial_.erase(partial_.begin());
      continue;
    }
    Packet packet;
    std::copy_n(partial_.begin(), kPacketBytes, packet.begin());
    partial_.erase(partial_.begin(), partial_.begin() + kPacketBytes);
    answer(packet, time_s);
  }
}

void FalconEmulator::write(std::span<const std::uint8_t> bytes, double time_s) {
  const std::lock_guard lock(mutex_);
  if (!plugged_ || !options_.powered) return;
  if (mode_ == Mode::run)
    serve(bytes, time_s);
  else
    boot(bytes);
}

std::vector<std::uint8_t> FalconEmulator::read() {
  const std::lock_guard lock(mutex_);
  if (outgoing_.empty()) return {};
  std::vector<std::uint8_t> next = std::move(outgoing_.front());
  outgoing_.pop_front();
  if (next.size() > kMostData) {
    outgoing_.emplace_front(next.begin() + kMostData, next.end());
    next.resize(kMostData);
  }
  return next;
}

bool FalconEmulator::plugged() const {
  const std::lock_guard lock(mutex_);
  return plugged_;
}
MotorCommand FalconEmulator::command() const {
  const std::lock_guard lock(mutex_);
  return command_;
}
Eigen::Vector3d FalconEmulator::force_n() const {
  const std::lock_guard lock(mutex_);
  return force_n_;
}
Eigen::Vector3d FalconEmulator::position_m() const {
  const std::lock_guard lock(mutex_);
  return position_m_;
}
std::uint64_t FalconEmulator::packets() const {
  const std::lock_guard lock(mutex_);
  return packets_;
}
std::uint64_t FalconEmulator::force_before_homing() const {
  const std::lock_guard lock(mutex_);
  return unsafe_;
}
std::uint8_t FalconEmulator::flags() const {
  const std::lock_guard lock(mutex_);
  return flags_;
}
bool FalconEmulator::firmware_loaded() const {
  const std::lock_guard lock(mutex_);
  return loaded_;
}
const std::vector<std::uint8_t>& FalconEmulator::uploaded() const { return uploaded_; }

}  // namespace sparsha::haptics::falcon
