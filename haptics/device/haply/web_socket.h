// The client's end of a WebSocket (RFC 6455) over a stream: messages of text in both directions. After opening, no call
// allocates, throws or locks.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "base/system/stream_socket.h"

namespace sparsha::haptics::haply {

/// Puts messages together from bytes as they come: several frames in a read, a frame in several, messages in pieces.
class FrameReader {
 public:
  enum class Found : std::uint8_t { nothing, text, ping, closed, malformed };

  /// Longer messages are malformed.
  explicit FrameReader(std::size_t most_bytes = 64 * 1024);

  /// Room for what is read next; follow with add().
  [[nodiscard]] std::span<char> room() noexcept;
  void add(std::size_t size) noexcept { end_ += size; }
  /// The next message, or what else a frame was. `text` is that of a message or a ping, until the next call. Once
  /// malformed, always.
  Found next(std::string_view& text) noexcept;

 private:
  Found fail() noexcept;
  void make_room() noexcept;

  std::vector<char> bytes_;  // as they came
  std::size_t begin_ = 0, end_ = 0;
  std::vector<char> message_;  // of frames that belong together
  std::size_t message_size_ = 0;
  bool in_message_ = false, over_ = false, malformed_ = false;
};

/// A masked frame of a client: text (1), pong (10) or close (8), payload at most `frame.size()` - 14. Its size; 0 where
/// that does not fit.
[[nodiscard]] std::size_t write_frame(std::span<char> frame, unsigned kind, std::string_view payload,
                                      std::uint32_t mask) noexcept;

class WebSocket {
 public:
  enum class Status : std::uint8_t { ok, nothing, closed, malformed };

  /// Connects to this machine and says hello; null when nobody is there or it is no WebSocket.
  [[nodiscard]] static std::unique_ptr<WebSocket> open(std::uint16_t port, double timeout_s);

  /// The next message; waits `timeout_s` at most. Answers pings.
  Status receive(std::string_view& text, double timeout_s) noexcept;
  /// `nothing` where the system takes no more for the moment.
  Status send(std::string_view text) noexcept;

 private:
  explicit WebSocket(std::unique_ptr<system::Stream> stream) : stream_(std::move(stream)) {}
  bool shake_hands(std::uint16_t port, double timeout_s);
  Status send_frame(unsigned kind, std::string_view text) noexcept;

  std::unique_ptr<system::Stream> stream_;
  FrameReader reader_;
  std::array<char, 2048> frame_{};
  std::uint32_t mask_ = 0x9E3779B9U;
};

}  // namespace sparsha::haptics::haply
