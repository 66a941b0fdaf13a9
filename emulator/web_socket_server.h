// A server's end of a WebSocket (RFC 6455), written for this room alone.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "base/system/stream_socket.h"

namespace sparsha::emulator {

/// One thread receives; others may send meanwhile, one at a time.
class WebSocketPeer {
 public:
  enum class Got : std::uint8_t { text, nothing, closed };

  /// Takes the client's hello and answers it; null when it is none within two seconds.
  [[nodiscard]] static std::unique_ptr<WebSocketPeer> greet(std::unique_ptr<system::Stream> stream);

  /// The next message; answers pings and a close.
  Got receive(std::string& text, double timeout_s);
  /// `pieces` > 1: as so many frames that belong together. False when the client has gone.
  bool send(std::string_view text, int pieces = 1);
  /// Bytes as they are, for what no server would send.
  bool send_raw(std::string_view bytes);
  /// The frames of a message, not sent.
  [[nodiscard]] static std::string frames_of(std::string_view text, int pieces);
  void close();

 private:
  explicit WebSocketPeer(std::unique_ptr<system::Stream> stream) : stream_(std::move(stream)) {}
  bool fill(double timeout_s);

  std::unique_ptr<system::Stream> stream_;
  std::string bytes_;
  std::string message_;
  std::atomic<bool> gone_{false};  ///< a thread that sends and one that receives both learn it
};

/// SHA-1 (RFC 3174), 20 bytes: the handshake asks for it.
[[nodiscard]] std::string sha1(std::string_view text);

}  // namespace sparsha::emulator
