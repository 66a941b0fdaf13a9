// The firmware's side of the conversation: commands in, answers out, byte by byte as the serial line brings them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace sparsha::emulator {

/// What the host asks for.
struct Command {
  std::array<int, 3> motors{};  ///< amplifier counts; positive turns the arm inwards
  std::uint8_t flags = 0;       ///< 1 homing; lights 2 green, 4 blue, 8 red
};

/// Finds commands in any bytes. A '<' always begins anew; what is malformed is passed over.
class CommandParser {
 public:
  [[nodiscard]] std::optional<Command> feed(std::uint8_t byte);
  void reset() { size_ = kOutside; }

 private:
  static constexpr std::size_t kOutside = 99;
  std::array<std::uint8_t, 14> body_{};
  std::size_t size_ = kOutside;
};

using Answer = std::array<std::uint8_t, 16>;
/// `counts` as 16 bits each; `buttons` bits 0 to 3; `homed` one bit an encoder.
[[nodiscard]] Answer answer_bytes(const std::array<int, 3>& counts, unsigned buttons, unsigned homed);

}  // namespace sparsha::emulator
