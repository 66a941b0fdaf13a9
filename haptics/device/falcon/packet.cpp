#include "haptics/device/falcon/packet.h"

#include <algorithm>
#include <cmath>

namespace sparsha::haptics::falcon {
namespace {

constexpr std::uint8_t kFirst = '<';
constexpr std::uint8_t kLast = '>';
constexpr std::uint8_t kZero = 'A';  // nibbles travel as 'A' to 'P', low one first
constexpr std::size_t kFlags = 13;

Packet packet_of(const std::array<int, 3>& values, unsigned flags) noexcept {
  Packet packet;
  packet.fill(kZero);
  packet.front() = kFirst;
  packet.back() = kLast;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto bits = static_cast<unsigned>(values[i]) & 0xFFFFU;
    for (unsigned nibble = 0; nibble < 4; ++nibble)
      packet[1 + 4 * i + nibble] = static_cast<std::uint8_t>(kZero + ((bits >> (4 * nibble)) & 0xFU));
  }
  packet[kFlags] = static_cast<std::uint8_t>(kZero + (flags & 0x7FU));
  return packet;
}

std::optional<std::array<int, 3>> values_of(const Packet& packet) noexcept {
  if (packet.front() != kFirst || packet.back() != kLast) return std::nullopt;
  if (packet[kFlags] < kZero || packet[kFlags] - kZero > 0x7F) return std::nullopt;
  std::array<int, 3> values{};
  for (std::size_t i = 0; i < 3; ++i) {
    unsigned bits = 0;
    for (unsigned nibble = 0; nibble < 4; ++nibble) {
      const unsigned value = static_cast<unsigned>(packet[1 + 4 * i + nibble]) - kZero;
      if (value > 0xFU) return std::nullopt;
      bits |= value << (4 * nibble);
    }
    values[i] = bits < 0x8000U ? static_cast<int>(bits) : static_cast<int>(bits) - 0x10000;
  }
  return values;
}

}  // namespace

Packet encode(const MotorCommand& command, std::uint8_t flags) noexcept {
  MotorCommand clamped = command;
  for (int& counts : clamped) counts = std::clamp(counts, -kMostCommand, kMostCommand);
  return packet_of(clamped, flags);
}

std::optional<Answer> decode_answer(const Packet& packet) noexcept {
  const auto counts = values_of(packet);
  if (!counts) return std::nullopt;
  const unsigned flags = static_cast<unsigned>(packet[kFlags]) - kZero;
  return Answer{*counts, static_cast<std::uint8_t>(flags & 0xFU), static_cast<std::uint8_t>((flags >> 4U) & 0x7U)};
}

MotorCommand motor_command(const Eigen::Vector3d& torque_n_m, double counts_per_newton_metre) noexcept {
  const Eigen::Vector3d counts = -counts_per_newton_metre * torque_n_m;
  if (!counts.allFinite()) return {};
  const double most = counts.cwiseAbs().maxCoeff();
  const double scale = most > kMostCommand ? kMostCommand / most : 1.0;
  MotorCommand command{};
  for (std::size_t i = 0; i < 3; ++i)
    command[i] = std::clamp(static_cast<int>(std::lround(scale * counts[static_cast<Eigen::Index>(i)])), -kMostCommand,
                            kMostCommand);
  return command;
}

std::optional<Answer> AnswerStream::feed(std::span<const std::uint8_t> bytes) noexcept {
  std::optional<Answer> newest;
  for (const std::uint8_t byte : bytes) {
    held_[size_++] = byte;
    // Whatever cannot be the beginning of an answer goes, up to the next byte that can.
    while (size_ > 0 && (held_.front() != kFirst || size_ == kPacketBytes)) {
      if (size_ == kPacketBytes) {
        if (const auto answer = decode_answer(held_)) {
          newest = answer;
          size_ = 0;
          break;
        }
      }
      const auto end = held_.begin() + static_cast<std::ptrdiff_t>(size_);
      const auto next = std::find(held_.begin() + 1, end, kFirst);
      rubbish_ += static_cast<std::uint64_t>(next - held_.begin());
      size_ = static_cast<std::size_t>(std::copy(next, end, held_.begin()) - held_.begin());
    }
  }
  return newest;
}

}  // namespace sparsha::haptics::falcon
