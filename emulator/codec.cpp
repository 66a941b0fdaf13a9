#include "emulator/codec.h"

namespace sparsha::emulator {

std::optional<Command> CommandParser::feed(std::uint8_t byte) {
  if (byte == '<') {
    size_ = 0;
    return std::nullopt;
  }
  if (size_ == kOutside) return std::nullopt;
  if (size_ < body_.size()) {
    body_[size_++] = byte;
    return std::nullopt;
  }
  size_ = kOutside;
  if (byte != '>') return std::nullopt;
  Command command;
  for (std::size_t motor = 0; motor < 3; ++motor) {
    int value = 0;
    for (std::size_t digit = 4; digit-- > 0;) {  // the least one comes first
      const int nibble = body_[4 * motor + digit] - 'A';
      if (nibble < 0 || nibble > 15) return std::nullopt;
      value = value * 16 + nibble;
    }
    command.motors[motor] = value >= 32768 ? value - 65536 : value;
  }
  const int flags = body_[12] - 'A';
  if (flags < 0 || flags > 127) return std::nullopt;
  command.flags = static_cast<std::uint8_t>(flags);
  return command;
}

Answer answer_bytes(const std::array<int, 3>& counts, unsigned buttons, unsigned homed) {
  Answer bytes{};
  std::size_t at = 0;
  bytes[at++] = '<';
  for (const int count : counts) {
    int rest = ((count % 65536) + 65536) % 65536;
    for (int digit = 0; digit < 4; ++digit, rest /= 16) bytes[at++] = static_cast<std::uint8_t>('A' + rest % 16);
  }
  bytes[at++] = static_cast<std::uint8_t>('A' + (buttons % 16) + 16 * (homed % 8));
  bytes[at++] = 'A';
  bytes[at] = '>';
  return bytes;
}

}  // namespace sparsha::emulator
