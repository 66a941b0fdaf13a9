// Other programs, as the system starts them.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace sparsha::system {

/// This program's own file; empty when the system does not tell.
[[nodiscard]] std::filesystem::path program_file();

/// Runs a program to its end, with this one's standard streams, environment and the variables of `more`. Its exit code;
/// 128 and the signal's number when a signal has ended it. `stop` is asked a hundred times a second: when it returns
/// true the program is asked to end (SIGTERM, unless a terminal has told both), and ended (SIGKILL) ten seconds later.
/// Throws Error{usage} when there is no such program.
[[nodiscard]] int run_program(const std::vector<std::string>& command,
                              const std::vector<std::pair<std::string, std::string>>& more,
                              const std::function<bool()>& stop);

/// Memory that a process and its companion share.
using SharedWords = std::array<std::atomic<std::uint64_t>, 8>;

/// A process that watches over this one and outlives it: of a session of its own, with no open file of this one's, deaf
/// to the signals of a terminal. Start it before other threads exist: it is a copy of this process with the calling
/// thread alone. Where somebody kills it, it is started again.
class Companion {
 public:
  /// Called in the companion about every `look_ms`, `alive` until this process has ended, however that was. Its last
  /// call is the one with `alive` false.
  using Watch = std::function<void(SharedWords& words, bool alive)>;

  /// Throws Error{failure} when the system gives no process.
  Companion(const Watch& watch, int look_ms);
  /// Ends the companion, whose last call follows now.
  ~Companion();
  Companion(const Companion&) = delete;
  Companion& operator=(const Companion&) = delete;

  [[nodiscard]] SharedWords& words() noexcept { return *words_; }

 private:
  SharedWords* words_ = nullptr;
  int pipe_ = -1;
  long process_ = 0;
};

/// A USB device's node, open beside whoever holds the device. Linux; nothing elsewhere.
class UsbNode {
 public:
  UsbNode(unsigned bus, unsigned address) noexcept;
  ~UsbNode();
  UsbNode(const UsbNode&) = delete;
  UsbNode& operator=(const UsbNode&) = delete;

  /// Takes the interface from whoever holds it, writes to a bulk endpoint, `times` times, and lets go. True when all
  /// has been written.
  bool write_taking_over(unsigned interface_number, unsigned endpoint, std::span<const std::uint8_t> bytes,
                         int times) noexcept;

 private:
  int file_ = -1;
};

}  // namespace sparsha::system
