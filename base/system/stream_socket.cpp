// POSIX sockets.
#include "base/system/stream_socket.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

#include "base/error.h"

#if !defined(_WIN32)
#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#endif

namespace sparsha::system {

#if defined(_WIN32)

Stream::~Stream() = default;
StreamStatus Stream::read(std::span<char>, std::size_t&, double) noexcept { return StreamStatus::closed; }
StreamStatus Stream::write(std::span<const char>) noexcept { return StreamStatus::closed; }
void Stream::shut() noexcept {}
std::unique_ptr<Stream> connect_here(std::uint16_t, double) { return nullptr; }
StreamListener::StreamListener(std::uint16_t) {
  throw Error(ErrorKind::failure, {}, "this system has no sockets here", "a POSIX system");
}
StreamListener::~StreamListener() = default;
std::unique_ptr<Stream> StreamListener::accept(double) { return nullptr; }

#else

namespace {

#if defined(MSG_NOSIGNAL)
constexpr int kQuietly = MSG_NOSIGNAL;
#else
constexpr int kQuietly = 0;
#endif
constexpr double kRestOfAWrite_s = 0.005;

sockaddr_in here(std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return address;
}

int new_socket() {
  const int file = ::socket(AF_INET, SOCK_STREAM, 0);
  if (file < 0) return file;
  ::fcntl(file, F_SETFD, FD_CLOEXEC);
  ::fcntl(file, F_SETFL, ::fcntl(file, F_GETFL) | O_NONBLOCK);
  return file;
}

void send_at_once(int file) {
  const int on = 1;
  ::setsockopt(file, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
#if defined(SO_NOSIGPIPE)
  ::setsockopt(file, SOL_SOCKET, SO_NOSIGPIPE, &on, sizeof on);
#endif
}

bool ready(int file, short what, double timeout_s) noexcept {
  pollfd one{file, what, 0};
#if defined(__linux__)
  const double whole_s = std::floor(std::max(0.0, timeout_s));
  const timespec time{static_cast<time_t>(whole_s), static_cast<long>((std::max(0.0, timeout_s) - whole_s) * 1e9)};
  return ::ppoll(&one, 1, &time, nullptr) > 0;
#else
  return ::poll(&one, 1, static_cast<int>(std::ceil(std::max(0.0, timeout_s) * 1e3))) > 0;
#endif
}

}  // namespace

Stream::~Stream() {
  if (file_ >= 0) ::close(file_);
}

void Stream::shut() noexcept { ::shutdown(file_, SHUT_RDWR); }

StreamStatus Stream::read(std::span<char> bytes, std::size_t& size, double timeout_s) noexcept {
  size = 0;
  if (bytes.empty()) return StreamStatus::nothing;
  for (int attempt = 0; attempt < 2; ++attempt) {
    const ssize_t got = ::recv(file_, bytes.data(), bytes.size(), 0);
    if (got > 0) {
      size = static_cast<std::size_t>(got);
      return StreamStatus::ok;
    }
    if (got == 0 || (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR)) return StreamStatus::closed;
    if (attempt > 0 || !(timeout_s > 0.0) || !ready(file_, POLLIN, timeout_s)) return StreamStatus::nothing;
  }
  return StreamStatus::nothing;
}

StreamStatus Stream::write(std::span<const char> bytes) noexcept {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t sent = ::send(file_, bytes.data() + done, bytes.size() - done, kQuietly);
    if (sent > 0) {
      done += static_cast<std::size_t>(sent);
      continue;
    }
    if (errno == EINTR) continue;
    if (errno != EAGAIN && errno != EWOULDBLOCK) return StreamStatus::closed;
    if (done == 0) return StreamStatus::nothing;
    if (ready(file_, POLLOUT, kRestOfAWrite_s)) continue;
    shut();
    return StreamStatus::closed;
  }
  return StreamStatus::ok;
}

std::unique_ptr<Stream> connect_here(std::uint16_t port, double timeout_s) {
  const int file = new_socket();
  if (file < 0) return nullptr;
  auto stream = std::make_unique<Stream>(file);
  const sockaddr_in address = here(port);
  if (::connect(file, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    if (errno != EINPROGRESS || !ready(file, POLLOUT, timeout_s)) return nullptr;
    int error = 0;
    socklen_t size = sizeof error;
    if (::getsockopt(file, SOL_SOCKET, SO_ERROR, &error, &size) != 0 || error != 0) return nullptr;
  }
  send_at_once(file);
  return stream;
}

StreamListener::StreamListener(std::uint16_t port) : file_(new_socket()) {
  const auto fail = [&](const char* what) {
    const std::string why = std::strerror(errno);
    if (file_ >= 0) ::close(file_);
    throw Error(ErrorKind::failure, {},
                std::string(what) + " port " + std::to_string(port) + " of this machine: " + why,
                "a port that no other program holds");
  };
  if (file_ < 0) fail("no socket for");
  const int on = 1;
  ::setsockopt(file_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  sockaddr_in address = here(port);
  if (::bind(file_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) fail("cannot have");
  if (::listen(file_, 8) != 0) fail("cannot listen on");
  socklen_t size = sizeof address;
  if (::getsockname(file_, reinterpret_cast<sockaddr*>(&address), &size) == 0) port_ = ntohs(address.sin_port);
}

StreamListener::~StreamListener() { ::close(file_); }

std::unique_ptr<Stream> StreamListener::accept(double timeout_s) {
  if (!ready(file_, POLLIN, timeout_s)) return nullptr;
  const int file = ::accept(file_, nullptr, nullptr);
  if (file < 0) return nullptr;
  ::fcntl(file, F_SETFD, FD_CLOEXEC);
  ::fcntl(file, F_SETFL, ::fcntl(file, F_GETFL) | O_NONBLOCK);
  send_at_once(file);
  return std::make_unique<Stream>(file);
}

#endif

}  // namespace sparsha::system
