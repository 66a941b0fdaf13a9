// The Falcon's conversation: 16 printable bytes each way, strictly one answer to one question.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include <Eigen/Core>

#include "haptics/device/falcon/kinematics.h"

namespace sparsha::haptics::falcon {

inline constexpr std::size_t kPacketBytes = 16;
using Packet = std::array<std::uint8_t, kPacketBytes>;

/// Amplifier counts of the three motors; positive turns the arm inwards, away from the user.
using MotorCommand = std::array<int, 3>;
/// The amplifiers take 12 bits and a sign.
inline constexpr int kMostCommand = 4095;

// Flags of a question.
inline constexpr std::uint8_t kHomingRequest = 0x01;
inline constexpr std::uint8_t kLightGreen = 0x02, kLightBlue = 0x04, kLightRed = 0x08;

struct Answer {
  Counts counts{};           ///< encoders
  std::uint8_t buttons = 0;  ///< 1 plus, 2 forward, 4 centre, 8 minus
  std::uint8_t homed = 0;    ///< one bit an encoder; 7 = all
};

/// A question; commands beyond the amplifiers' range are clamped.
[[nodiscard]] Packet encode(const MotorCommand& command, std::uint8_t flags) noexcept;
/// Empty when the bytes are not a well-formed packet.
[[nodiscard]] std::optional<Answer> decode_answer(const Packet& packet) noexcept;

/// Motor counts for torques at the arms, N m: the whole vector is scaled down to the range, so that a force keeps its
/// direction. Zero for what is not finite.
[[nodiscard]] MotorCommand motor_command(const Eigen::Vector3d& torque_n_m, double counts_per_newton_metre) noexcept;

/// Finds answers in bytes that come in any pieces, with rubbish between them. No allocation.
class AnswerStream {
 public:
  /// Takes bytes; the newest answer that they complete.
  [[nodiscard]] std::optional<Answer> feed(std::span<const std::uint8_t> bytes) noexcept;
  /// Bytes thrown away so far.
  [[nodiscard]] std::uint64_t rubbish() const noexcept { return rubbish_; }

 private:
  Packet held_{};
  std::size_t size_ = 0;
  std::uint64_t rubbish_ = 0;
};

}  // namespace sparsha::haptics::falcon
