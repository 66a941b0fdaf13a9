// Streams of bytes between programs of this machine: TCP on the loopback address.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace sparsha::system {

enum class StreamStatus : std::uint8_t { ok, nothing, closed };  ///< done; nothing within the time; no longer

/// One end of a connection. No call allocates, throws or locks.
class Stream {
 public:
  explicit Stream(int file) noexcept : file_(file) {}
  ~Stream();
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  /// What is there, at most bytes.size(); waits for it for `timeout_s` at most.
  StreamStatus read(std::span<char> bytes, std::size_t& size, double timeout_s) noexcept;
  /// All of it; `nothing` when none could be taken at once. A part that could not be taken within a few milliseconds
  /// closes the stream: what follows would make no sense.
  StreamStatus write(std::span<const char> bytes) noexcept;
  /// The other end is told; safe from any thread.
  void shut() noexcept;

 private:
  int file_ = -1;
};

/// Null when nobody listens on that port of this machine, or not within `timeout_s`.
[[nodiscard]] std::unique_ptr<Stream> connect_here(std::uint16_t port, double timeout_s);

/// Listens on the loopback address.
class StreamListener {
 public:
  /// `port` 0: any that is free. Throws Error{failure} when it is taken.
  explicit StreamListener(std::uint16_t port);
  ~StreamListener();
  StreamListener(const StreamListener&) = delete;
  StreamListener& operator=(const StreamListener&) = delete;

  [[nodiscard]] std::uint16_t port() const noexcept { return port_; }
  /// Null when nobody came within `timeout_s`.
  [[nodiscard]] std::unique_ptr<Stream> accept(double timeout_s);

 private:
  int file_ = -1;
  std::uint16_t port_ = 0;
};

}  // namespace sparsha::system
