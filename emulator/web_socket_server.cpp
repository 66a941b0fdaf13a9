#include "emulator/web_socket_server.h"

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <utility>

#include "base/text/base64.h"
#include "base/text/lower_case.h"

namespace sparsha::emulator {
namespace {

constexpr double kHello_s = 2.0;
constexpr std::size_t kLongest = 1U << 20U;

std::string frame(unsigned head, std::string_view payload) {
  std::string bytes(1, static_cast<char>(head));
  if (payload.size() < 126) {
    bytes += static_cast<char>(payload.size());
  } else if (payload.size() < 65536) {
    bytes += static_cast<char>(126);
    bytes += static_cast<char>(payload.size() >> 8U);
    bytes += static_cast<char>(payload.size() & 0xFFU);
  } else {
    bytes += static_cast<char>(127);
    for (int shift = 56; shift >= 0; shift -= 8)
      bytes += static_cast<char>(static_cast<std::uint64_t>(payload.size()) >> static_cast<unsigned>(shift) & 0xFFU);
  }
  return bytes.append(payload);
}

/// A header's value; names are of any case.
std::string header(const std::string& head, const std::string& name) {
  const std::string lower = lower_case(head);
  const std::size_t at = lower.find("\r\n" + name + ":");
  if (at == std::string::npos) return {};
  const std::size_t begin = head.find_first_not_of(' ', at + name.size() + 3);
  return head.substr(begin, head.find("\r\n", begin) - begin);
}

}  // namespace

std::string sha1(std::string_view text) {
  std::array<std::uint32_t, 5> h{0x67452301U, 0xEFCDAB89U, 0x98BADCFEU, 0x10325476U, 0xC3D2E1F0U};
  std::string padded(text);
  padded += static_cast<char>(0x80);
  while (padded.size() % 64 != 56) padded += '\0';
  for (int shift = 56; shift >= 0; shift -= 8)
    padded += static_cast<char>(static_cast<std::uint64_t>(text.size()) * 8 >> static_cast<unsigned>(shift) & 0xFFU);
  for (std::size_t block = 0; block < padded.size(); block += 64) {
    std::array<std::uint32_t, 80> w{};
    for (std::size_t i = 0; i < 64; ++i) w[i / 4] = w[i / 4] << 8U | static_cast<unsigned char>(padded[block + i]);
    for (std::size_t i = 16; i < 80; ++i) w[i] = std::rotl(w[i - 3] ^ w[i - 8] ^ w[i - 14] ^ w[i - 16], 1);
    auto [a, b, c, d, e] = h;
    for (std::size_t i = 0; i < 80; ++i) {
      const std::uint32_t f = i < 20   ? ((b & c) | (~b & d)) + 0x5A827999U
                              : i < 40 ? (b ^ c ^ d) + 0x6ED9EBA1U
                              : i < 60 ? ((b & c) | (b & d) | (c & d)) + 0x8F1BBCDCU
                                       : (b ^ c ^ d) + 0xCA62C1D6U;
      const std::uint32_t next = std::rotl(a, 5) + f + e + w[i];
      e = d;
      d = c;
      c = std::rotl(b, 30);
      b = a;
      a = next;
    }
    const std::array<std::uint32_t, 5> sum{a, b, c, d, e};
    for (std::size_t i = 0; i < 5; ++i) h[i] += sum[i];
  }
  std::string digest;
  for (const std::uint32_t word : h)
    for (int shift = 24; shift >= 0; shift -= 8)
      digest += static_cast<char>(word >> static_cast<unsigned>(shift) & 0xFFU);
  return digest;
}

std::unique_ptr<WebSocketPeer> WebSocketPeer::greet(std::unique_ptr<system::Stream> stream) {
  std::unique_ptr<WebSocketPeer> peer(new WebSocketPeer(std::move(stream)));
  const auto began = std::chrono::steady_clock::now();
  std::size_t end = std::string::npos;
  while ((end = peer->bytes_.find("\r\n\r\n")) == std::string::npos) {
    const double passed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    if (peer->gone_ || passed_s > kHello_s || peer->bytes_.size() > kLongest) return nullptr;
    peer->fill(kHello_s - passed_s);
  }
  const std::string key = header(peer->bytes_.substr(0, end + 2), "sec-websocket-key");
  peer->bytes_.erase(0, end + 4);
  if (key.empty()) {
    peer->send_raw("HTTP/1.1 400 Bad Request\r\nContent-Length: 0\r\n\r\n");
    return nullptr;
  }
  const std::string accept = to_base64(sha1(key + "258EAFA5-E914-47DA-95CA-C5AB0DC85B11"));
  const bool sent = peer->send_raw("HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n" +
                                   ("Sec-WebSocket-Accept: " + accept) + "\r\n\r\n");
  return sent ? std::move(peer) : nullptr;
}

bool WebSocketPeer::fill(double timeout_s) {
  std::array<char, 4096> more{};
  std::size_t size = 0;
  const auto status = stream_->read(more, size, std::max(0.0, timeout_s));
  if (status == system::StreamStatus::closed) gone_ = true;
  bytes_.append(more.data(), size);
  return status == system::StreamStatus::ok;
}

WebSocketPeer::Got WebSocketPeer::receive(std::string& text, double timeout_s) {
  for (;;) {
    const auto byte = [this](std::size_t i) { return static_cast<unsigned>(static_cast<unsigned char>(bytes_[i])); };
    std::uint64_t size = 0;
    std::size_t begin = 2;
    bool whole = bytes_.size() >= 2;
    if (whole) {
      size = byte(1) & 0x7FU;
      const std::size_t more = size == 126 ? 2 : size == 127 ? 8 : 0;
      whole = bytes_.size() >= 2 + more + 4;
      if (whole && more > 0) size = 0;
      for (std::size_t i = 0; whole && i < more; ++i) size = size << 8U | byte(2 + i);
      begin = 2 + more + 4;
      if (whole && ((byte(1) & 0x80U) == 0 || size > kLongest)) return Got::closed;  // clients mask
      whole = whole && bytes_.size() >= begin + size;
    }
    if (!whole) {
      if (gone_) return Got::closed;
      if (!fill(timeout_s)) return gone_ ? Got::closed : Got::nothing;
      continue;
    }
    const unsigned kind = byte(0) & 0x0FU;
    const bool last = (byte(0) & 0x80U) != 0;
    std::string payload = bytes_.substr(begin, static_cast<std::size_t>(size));
    for (std::size_t i = 0; i < payload.size(); ++i)
      payload[i] = static_cast<char>(static_cast<unsigned char>(payload[i]) ^ byte(begin - 4 + i % 4));
    bytes_.erase(0, begin + static_cast<std::size_t>(size));
    if (kind == 8) {
      send_raw(frame(0x88U, payload));
      return Got::closed;
    }
    if (kind == 9) send_raw(frame(0x8AU, payload));
    if (kind >= 8) continue;
    message_ += payload;
    if (!last) continue;
    text = std::exchange(message_, {});
    return Got::text;
  }
}

std::string WebSocketPeer::frames_of(std::string_view text, int pieces) {
  std::string bytes;
  const std::size_t each = text.size() / static_cast<std::size_t>(std::max(1, pieces)) + 1;
  for (std::size_t begin = 0; begin == 0 || begin < text.size(); begin += each) {
    const bool last = begin + each >= text.size();
    bytes += frame((last ? 0x80U : 0U) | (begin == 0 ? 1U : 0U), text.substr(begin, each));
  }
  return bytes;
}

bool WebSocketPeer::send(std::string_view text, int pieces) { return send_raw(frames_of(text, pieces)); }

bool WebSocketPeer::send_raw(std::string_view bytes) {
  if (!gone_ && stream_->write(bytes) == system::StreamStatus::closed) gone_ = true;
  return !gone_;
}

void WebSocketPeer::close() {
  stream_->shut();
  gone_ = true;
}

}  // namespace sparsha::emulator
