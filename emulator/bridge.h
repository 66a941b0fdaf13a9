// The emulated FTDI chip between USB and the serial line: baud rates, latency timer, event character, packets of 62
// bytes behind two of modem status, USB frames. Time is given by the caller, in seconds, and never runs backwards.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

namespace sparsha::emulator {

/// Vendor requests of the chip.
struct BridgeRequest {
  static constexpr std::uint8_t kReset = 0, kModem = 1, kFlow = 2, kBaud = 3, kEventCharacter = 6, kData = 4,
                                kLatency = 9;
};

class Bridge {
 public:
  /// False for a request that the chip does not know.
  bool control(std::uint8_t request, std::uint16_t value, double time_s);

  /// When each of `count` bytes that the host hands over at `time_s` has arrived at the other end: the last one's time.
  /// They follow each other and those before.
  [[nodiscard]] double send(std::size_t count, double time_s);
  [[nodiscard]] double byte_s() const;
  [[nodiscard]] std::uint16_t divisor() const { return divisor_; }
  [[nodiscard]] std::uint8_t latency_ms() const { return static_cast<std::uint8_t>(latency_s_ * 1e3 + 0.5); }

  /// A byte from the other end, which leaves there at `time_s` at the earliest. Lost when the buffer is full.
  void receive(std::uint8_t byte, double time_s);
  /// What follows begins a packet of its own.
  void break_packet() { breaks_ = true; }

  /// When the next packet is with the host that waits for one.
  [[nodiscard]] double packet_s() const;
  /// That packet, modem status first, once it is there.
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> take(double time_s);

 private:
  struct Byte {
    std::uint8_t value;
    double time_s;     ///< in the chip's buffer
    bool ends_packet;  ///< the event character, or the end of a piece
  };
  struct Due {
    double time_s;
    std::size_t size;
  };
  [[nodiscard]] Due next() const;

  std::uint16_t divisor_ = 0x4138;
  double latency_s_ = 0.016;
  std::optional<std::uint8_t> event_;
  std::deque<Byte> held_;
  double line_out_s_ = 0.0, line_in_s_ = 0.0;  // free again
  double timer_s_ = 0.0;                       // began
  bool breaks_ = false;
};

}  // namespace sparsha::emulator
