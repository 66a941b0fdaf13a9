#include "haptics/device/falcon/packet.h"

#include <algorithm>

namespace sparsha::haptics::falcon {
namespace {

constexpr std::uint8_t kFirst = '<';
constexpr std::uint8_t kLast = '>';
constexpr std::uint8_t kZero = 'A';  // nibbles travel as 'A' to 'P'
constexpr std::size_t kControlByte = 13;
constexpr std::uint8_t kHomingBit = 0x01;
constexpr std::uint8_t kLedBits = kLedGreen | kLedBlue | kLedRed;

void put(Packet& packet, std::size_t at, int value) noexcept {
  const auto bits = static_cast<unsigned>(value) & 0xFFFFU;
  for (unsigned nibble = 0; nibble < 4; ++nibble)
    packet[at + nibble] = static_cast<std::uint8_t>(kZero + ((bits >> (4 * nibble)) & 0xFU));
}

Packet packet_of(const std::array<int, 3>& values, std::uint8_t control) noexcept {
  Packet packet;
  packet.fill(kZero);
  packet.front() = kFirst;
  packet.back() = kLast;
  for (std::size_t i = 0; i < 3; ++i) put(packet, 1 + 4 * i, values[i]);
  packet[kControlByte] = static_cast<std::uint8_t>(kZero + control);
  return packet;
}

bool get(std::span<const std::uint8_t, kPacketBytes> bytes, std::array<int, 3>& values) noexcept {
  if (bytes.front() != kFirst || bytes.back() != kLast) return false;
  for (std::size_t i = 0; i < 3; ++i) {
    unsigned bits = 0;
    for (unsigned nibble = 0; nibble < 4; ++nibble) {
      const unsigned value = static_cast<unsigned>(bytes[1 + 4 * i + nibble]) - kZero;
      if (value > 0xFU) return false;
      bits |= value << (4 * nibble);
    }
    values[i] = bits < 0x8000U ? static_cast<int>(bits) : static_cast<int>(bits) - 0x10000;
  }
  return bytes[kControlByte] >= kZero && bytes[kControlByte] - kZero <= 0x7F;
}

}  // namespace

Packet encode(const Question& question) noexcept {
  const unsigned control = (question.leds & kLedBits) | (question.homing ? kHomingBit : 0U);
  return packet_of(question.motors, static_cast<std::uint8_t>(control));
}

Packet encode(const Answer& answer) noexcept {
  return packet_of(answer.encoders, static_cast<std::uint8_t>((answer.buttons & 0xFU) | ((answer.homed & 0x7U) << 4U)));
}

std::optional<Answer> decode_answer(std::span<const std::uint8_t, kPacketBytes> bytes) noexcept {
  Answer answer;
  if (!get(bytes, answer.encoders)) return std::nullopt;
  const unsigned control = static_cast<unsigned>(bytes[kControlByte]) - kZero;
  answer.buttons = static_cast<std::uint8_t>(control & 0xFU);
  answer.homed = static_cast<std::uint8_t>((control >> 4U) & 0x7U);
  return answer;
}

std::optional<Question> decode_question(std::span<const std::uint8_t, kPacketBytes> bytes) noexcept {
  Question question;
  if (!get(bytes, question.motors)) return std::nullopt;
  const unsigned control = static_cast<unsigned>(bytes[kControlByte]) - kZero;
  question.leds = static_cast<std::uint8_t>(control & kLedBits);
  question.homing = (control & kHomingBit) != 0;
  return question;
}

void PacketStream::add(std::span<const std::uint8_t> bytes) noexcept {
  if (bytes.size() > bytes_.size()) bytes = bytes.last(bytes_.size());
  const std::size_t room = bytes_.size() - size_;
  if (bytes.size() > room) {
    const std::size_t drop = bytes.size() - room;
    std::copy(bytes_.begin() + static_cast<std::ptrdiff_t>(drop), bytes_.begin() + static_cast<std::ptrdiff_t>(size_),
              bytes_.begin());
    size_ -= drop;
  }
  std::copy(bytes.begin(), bytes.end(), bytes_.begin() + static_cast<std::ptrdiff_t>(size_));
  size_ += bytes.size();
}

std::optional<Packet> PacketStream::next() noexcept {
  std::size_t at = 0;
  std::optional<Packet> found;
  while (at < size_ && !found) {
    if (bytes_[at] != kFirst) {
      ++at;
      continue;
    }
    if (size_ - at < kPacketBytes) break;  // the rest of it is on its way
    if (bytes_[at + kPacketBytes - 1] != kLast) {
      ++at;
      continue;
    }
    found.emplace();
    std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(at), kPacketBytes, found->begin());
    at += kPacketBytes;
  }
  std::copy(bytes_.begin() + static_cast<std::ptrdiff_t>(at), bytes_.begin() + static_cast<std::ptrdiff_t>(size_),
            bytes_.begin());
  size_ -= at;
  return found;
}

}  // namespace sparsha::haptics::falcon
