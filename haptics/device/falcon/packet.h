// The Falcon's conversation: 16 printable bytes each way, one answer to each question.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace sparsha::haptics::falcon {

inline constexpr std::size_t kPacketBytes = 16;
using Packet = std::array<std::uint8_t, kPacketBytes>;

/// The motors take 12 bits and a sign; positive pushes inwards, away from the user.
inline constexpr int kMostMotorCounts = 4095;

enum Led : std::uint8_t { kLedGreen = 0x02, kLedBlue = 0x04, kLedRed = 0x08 };

struct Question {
  std::array<int, 3> motors{};  ///< within +-kMostMotorCounts
  std::uint8_t leds = 0;        ///< Led bits
  bool homing = false;          ///< asks the device to look for its encoders' index marks
};

struct Answer {
  std::array<int, 3> encoders{};  ///< counts
  std::uint8_t buttons = 0;       ///< 1 plus, 2 forward, 4 centre, 8 minus
  std::uint8_t homed = 0;         ///< one bit an encoder
};

[[nodiscard]] Packet encode(const Question& question) noexcept;
[[nodiscard]] Packet encode(const Answer& answer) noexcept;  ///< what the device says; for its emulator
/// Empty when the bytes are not a well-formed packet.
[[nodiscard]] std::optional<Answer> decode_answer(std::span<const std::uint8_t, kPacketBytes> bytes) noexcept;
[[nodiscard]] std::optional<Question> decode_question(std::span<const std::uint8_t, kPacketBytes> bytes) noexcept;

/// Finds packets in a stream of bytes that may come in any pieces, with rubbish between them. No allocation.
class PacketStream {
 public:
  /// Takes bytes; whole packets come out of next(). What does not fit is dropped, oldest first.
  void add(std::span<const std::uint8_t> bytes) noexcept;
  /// The next packet, '<' first and '>' last.
  [[nodiscard]] std::optional<Packet> next() noexcept;
  void clear() noexcept { size_ = 0; }

 private:
  std::array<std::uint8_t, 1024> bytes_{};
  std::size_t size_ = 0;
};

}  // namespace sparsha::haptics::falcon
