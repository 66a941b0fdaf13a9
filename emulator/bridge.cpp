#include "emulator/bridge.h"

#include <algorithm>
#include <cmath>

namespace sparsha::emulator {
namespace {

constexpr std::size_t kMostData = 62;
constexpr std::size_t kBuffer = 384;
constexpr double kFrame_s = 1e-3;
constexpr double kBitsPerByte = 10.0;
constexpr double kClock_hz = 3e6;

}  // namespace

bool Bridge::control(std::uint8_t request, std::uint16_t value, double time_s) {
  switch (request) {
    case BridgeRequest::kReset:
      if (value != 2) held_.clear();  // 2 = what is to be sent, which has gone already
      return true;
    case BridgeRequest::kBaud:
      divisor_ = value;
      return true;
    case BridgeRequest::kEventCharacter:
      event_ = (value & 0x100U) != 0 ? std::optional(static_cast<std::uint8_t>(value & 0xFFU)) : std::nullopt;
      return true;
    case BridgeRequest::kLatency:
      latency_s_ = std::max(1, value & 0xFF) * 1e-3;
      timer_s_ = time_s;
      return true;
    case BridgeRequest::kModem:
    case BridgeRequest::kFlow:
    case BridgeRequest::kData:
      return true;
    default:
      return false;
  }
}

double Bridge::byte_s() const {
  // Bits 14 and 15 add eighths; 9600 is 0x4138 = 312.5.
  constexpr double kEighths[] = {0.0, 0.5, 0.25, 0.125};
  const double divisor = (divisor_ & 0x3FFFU) + kEighths[divisor_ >> 14U];
  return kBitsPerByte * std::max(1.0, divisor) / kClock_hz;
}

double Bridge::send(std::size_t count, double time_s) {
  line_out_s_ = std::max(line_out_s_, time_s) + static_cast<double>(count) * byte_s();
  return line_out_s_;
}

void Bridge::receive(std::uint8_t byte, double time_s) {
  line_in_s_ = std::max(line_in_s_, time_s) + byte_s();
  if (breaks_ && !held_.empty()) held_.back().ends_packet = true;
  breaks_ = false;
  if (held_.size() < kBuffer) held_.push_back({byte, line_in_s_, event_ == byte});
}

Bridge::Due Bridge::next() const {
  // The timer reports what there is, be it nothing; a full packet or the event character do not wait for it.
  const double timer_s = timer_s_ + latency_s_;
  std::size_t size = 0;
  for (const Byte& byte : held_) {
    ++size;
    if (byte.ends_packet || size == kMostData)
      if (byte.time_s <= timer_s) return {byte.time_s, size};
    if (byte.time_s > timer_s) return {timer_s, size - 1};
    if (byte.ends_packet || size == kMostData) break;
  }
  return {timer_s, size};
}

double Bridge::packet_s() const {
  const double due_s = std::max(next().time_s, timer_s_);
  return std::ceil(due_s / kFrame_s - 1e-9) * kFrame_s;  // the host hears of it when the frame ends
}

std::optional<std::vector<std::uint8_t>> Bridge::take(double time_s) {
  if (time_s < packet_s()) return std::nullopt;
  Due due = next();
  // It went to a host that was waiting when it was due, or when that came to ask, in the last whole frame.
  const double went_s = std::max(due.time_s, (std::floor(time_s / kFrame_s + 1e-9) - 1.0) * kFrame_s);
  // A host that asks late finds what has come meanwhile in the same packet, unless the packet ended before.
  while (due.size < std::min(held_.size(), kMostData) && (due.size == 0 || !held_[due.size - 1].ends_packet) &&
         held_[due.size].time_s <= went_s)
    ++due.size;
  std::vector<std::uint8_t> packet{0x01, 0x60};
  for (std::size_t i = 0; i < due.size; ++i) {
    packet.push_back(held_.front().value);
    held_.pop_front();
  }
  timer_s_ = went_s;
  return packet;
}

}  // namespace sparsha::emulator
