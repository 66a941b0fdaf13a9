// The Falcon forgets its firmware with its power: finding out, and loading an image that the user brings.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "haptics/device/falcon/port.h"

namespace sparsha::haptics::falcon {

/// Reads an image. It belongs to its maker and is never shipped with this program. Throws Error{device} when the file
/// is missing or its size is that of no image (2 kB to 64 kB).
[[nodiscard]] std::vector<std::uint8_t> read_firmware(const std::filesystem::path& file);

/// Puts the bridge in the servo's mode: 1.5 Mbaud, 1 ms latency, nothing left in its buffers.
[[nodiscard]] bool enter_run_mode(Port& port);

/// True when a well-formed answer comes back: some firmware is running.
[[nodiscard]] bool firmware_runs(Port& port);

/// One attempt at loading; empty when it went well, else what went wrong. Takes about three seconds on the wire.
[[nodiscard]] std::string load_firmware(Port& port, const std::vector<std::uint8_t>& image);

}  // namespace sparsha::haptics::falcon
