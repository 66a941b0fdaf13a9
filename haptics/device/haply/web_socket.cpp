#include "haptics/device/haply/web_socket.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <string>

#include "base/text/utf8.h"

namespace sparsha::haptics::haply {
namespace {

constexpr unsigned kContinuation = 0, kText = 1, kBinary = 2, kClose = 8, kPing = 9, kPong = 10;
constexpr std::size_t kMostControl = 125;
// Of the RFC's own example (section 1.3): on the loopback address no cache stands between that a fresh one would show.
constexpr const char* kKey = "dGhlIHNhbXBsZSBub25jZQ==";
constexpr const char* kAccept = "s3pPLMBiTxaQ9kYGzzhZRbK+xOo=";

using Steady = std::chrono::steady_clock;

double since(Steady::time_point then) { return std::chrono::duration<double>(Steady::now() - then).count(); }

}  // namespace

FrameReader::FrameReader(std::size_t most_bytes) : bytes_(most_bytes + 16), message_(most_bytes) {}

void FrameReader::make_room() noexcept {
  if (begin_ == 0) return;
  std::memmove(bytes_.data(), bytes_.data() + begin_, end_ - begin_);
  end_ -= begin_;
  begin_ = 0;
}

std::span<char> FrameReader::room() noexcept {
  if (begin_ == end_) begin_ = end_ = 0;
  if (bytes_.size() - end_ < bytes_.size() / 2) make_room();
  return {bytes_.data() + end_, bytes_.size() - end_};
}

FrameReader::Found FrameReader::fail() noexcept {
  malformed_ = true;
  return Found::malformed;
}

FrameReader::Found FrameReader::next(std::string_view& text) noexcept {
  if (malformed_) return Found::malformed;
  while (end_ - begin_ >= 2) {
    const auto* const head = reinterpret_cast<const unsigned char*>(bytes_.data() + begin_);
    const bool last = (head[0] & 0x80U) != 0;
    const unsigned kind = head[0] & 0x0FU;
    std::uint64_t size = head[1] & 0x7FU;
    // Nothing was agreed that gives the reserved bits a meaning, and servers do not mask.
    if ((head[0] & 0x70U) != 0 || (head[1] & 0x80U) != 0) return fail();
    std::size_t header = 2;
    const std::size_t more = size == 126 ? 2 : size == 127 ? 8 : 0;
    if (end_ - begin_ < header + more) return Found::nothing;
    if (more > 0) size = 0;
    for (std::size_t i = 0; i < more; ++i) size = size << 8U | head[header + i];
    header += more;
    if (size > message_.size()) return fail();
    if (end_ - begin_ < header + size) return Found::nothing;
    const std::string_view payload(bytes_.data() + begin_ + header, static_cast<std::size_t>(size));
    begin_ += header + static_cast<std::size_t>(size);
    if (kind >= kClose) {
      if (!last || size > kMostControl || kind > kPong) return fail();
      text = payload;
      if (kind == kClose) return Found::closed;
      if (kind == kPing) return Found::ping;
      continue;  // a pong that nobody asked for
    }
    if (kind == kBinary || kind > kBinary || (kind == kContinuation) != in_message_) return fail();
    if (!in_message_) message_size_ = 0;
    if (!in_message_ && last) {
      text = payload;
      return is_utf8(text) ? Found::text : fail();
    }
    if (payload.size() > message_.size() - message_size_) return fail();
    std::memcpy(message_.data() + message_size_, payload.data(), payload.size());
    message_size_ += payload.size();
    in_message_ = !last;
    if (!last) continue;
    text = {message_.data(), message_size_};
    return is_utf8(text) ? Found::text : fail();
  }
  return Found::nothing;
}

std::size_t write_frame(std::span<char> frame, unsigned kind, std::string_view payload, std::uint32_t mask) noexcept {
  const std::size_t extended = payload.size() < 126 ? 0 : payload.size() < 65536 ? 2 : 8;
  const std::size_t header = 2 + extended + 4;
  if (frame.size() < header + payload.size()) return 0;
  frame[0] = static_cast<char>(0x80U | kind);
  const std::size_t shown = extended == 0 ? payload.size() : extended == 2 ? 126 : 127;
  frame[1] = static_cast<char>(0x80U | shown);
  for (std::size_t i = 0; i < extended; ++i)
    frame[2 + i] = static_cast<char>(static_cast<std::uint64_t>(payload.size()) >> 8U * (extended - 1 - i) & 0xFFU);
  char key[4];
  for (unsigned i = 0; i < 4; ++i) key[i] = static_cast<char>(mask >> 8U * i & 0xFFU);
  std::memcpy(frame.data() + 2 + extended, key, sizeof key);
  for (std::size_t i = 0; i < payload.size(); ++i)
    frame[header + i] =
        static_cast<char>(static_cast<unsigned char>(payload[i]) ^ static_cast<unsigned char>(key[i % 4]));
  return header + payload.size();
}

std::unique_ptr<WebSocket> WebSocket::open(std::uint16_t port, double timeout_s) {
  auto stream = system::connect_here(port, timeout_s);
  if (!stream) return nullptr;
  std::unique_ptr<WebSocket> socket(new WebSocket(std::move(stream)));
  return socket->shake_hands(port, timeout_s) ? std::move(socket) : nullptr;
}

// What comes behind the answer's empty line is frames already.
bool WebSocket::shake_hands(std::uint16_t port, double timeout_s) {
  const std::string hello = "GET / HTTP/1.1\r\nHost: localhost:" + std::to_string(port) +
                            "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Key: " + kKey +
                            "\r\nSec-WebSocket-Version: 13\r\n\r\n";
  if (stream_->write(hello) != system::StreamStatus::ok) return false;
  const Steady::time_point began = Steady::now();
  std::string answer;
  std::array<char, 1024> bytes{};
  while (answer.find("\r\n\r\n") == std::string::npos) {
    std::size_t size = 0;
    const auto status = stream_->read(bytes, size, timeout_s - since(began));
    if (status != system::StreamStatus::ok || answer.size() > 8192) return false;
    answer.append(bytes.data(), size);
  }
  const std::size_t end = answer.find("\r\n\r\n") + 4;
  const std::string head = answer.substr(0, end);
  if (!head.starts_with("HTTP/1.1 101") || head.find(kAccept) == std::string::npos) return false;
  const std::string rest = answer.substr(end);
  const std::span<char> room = reader_.room();
  if (rest.size() > room.size()) return false;
  std::copy(rest.begin(), rest.end(), room.begin());
  reader_.add(rest.size());
  return true;
}

WebSocket::Status WebSocket::receive(std::string_view& text, double timeout_s) noexcept {
  const Steady::time_point began = Steady::now();
  for (;;) {
    switch (reader_.next(text)) {
      case FrameReader::Found::text:
        return Status::ok;
      case FrameReader::Found::ping:
        if (send_frame(kPong, text) == Status::closed) return Status::closed;
        continue;
      case FrameReader::Found::closed:
        return Status::closed;
      case FrameReader::Found::malformed:
        return Status::malformed;
      case FrameReader::Found::nothing:
        break;
    }
    std::size_t size = 0;
    const std::span<char> room = reader_.room();
    if (room.empty()) return Status::malformed;
    const auto status = stream_->read(room, size, std::max(0.0, timeout_s - since(began)));
    if (status == system::StreamStatus::closed) return Status::closed;
    if (status == system::StreamStatus::nothing) return Status::nothing;
    reader_.add(size);
  }
}

WebSocket::Status WebSocket::send(std::string_view text) noexcept { return send_frame(kText, text); }

WebSocket::Status WebSocket::send_frame(unsigned kind, std::string_view text) noexcept {
  mask_ = mask_ * 1664525U + 1013904223U;  // so that no proxy sees a pattern; there is none on the loopback address
  const std::size_t size = write_frame(frame_, kind, text, mask_);
  if (size == 0) return Status::malformed;
  const auto status = stream_->write({frame_.data(), size});
  if (status == system::StreamStatus::closed) return Status::closed;
  return status == system::StreamStatus::ok ? Status::ok : Status::nothing;
}

}  // namespace sparsha::haptics::haply
