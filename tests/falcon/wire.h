// What went over the wire, read from the emulator's log by the published packet layout alone.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace wire {

struct Event {
  double time_s = 0.0;
  std::string kind;             ///< out, in, control, plugged, unplugged
  bool packet = false;          ///< 16 bytes from '<' to '>'
  std::array<int, 3> values{};  ///< motors, or encoder counts
  unsigned flags = 0;           ///< byte 13
  [[nodiscard]] bool force() const { return packet && values != std::array<int, 3>{}; }
};

/// All whole lines of the log so far.
[[nodiscard]] std::vector<Event> read(const std::filesystem::path& log);

}  // namespace wire
