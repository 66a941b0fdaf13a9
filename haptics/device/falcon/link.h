// Bringing a Falcon to life: run mode, firmware check, firmware upload.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "haptics/device/falcon/falcon.h"
#include "haptics/device/falcon/packet.h"
#include "haptics/device/falcon/transport.h"

namespace sparsha::haptics::falcon {

/// Reads a firmware image that the user names; its licence forbids that we ship one. Throws Error{device} when it is
/// missing or of impossible size.
[[nodiscard]] std::vector<std::uint8_t> read_firmware(const std::filesystem::path& file);

/// A file of this user's: ~/.config/sparsha/NAME, or where XDG_CONFIG_HOME puts it; empty without a home.
[[nodiscard]] std::filesystem::path own_file(const char* name);
/// own_file("falcon.bin").
[[nodiscard]] std::filesystem::path own_firmware();

/// The image that `options` or SPARSHA_FALCON_FIRMWARE name, else own_firmware() if it is there; empty when there is
/// none. Throws as read_firmware().
[[nodiscard]] std::vector<std::uint8_t> firmware_image(const FalconOptions& options);

/// 1.5 Mbaud, latency timer 1 ms, buffers purged. Throws Error{device} when the bridge does not apply.
void enter_run_mode(Transport& wire);

/// To be called while firmware answers. Where the bridge sends an answer at its event character, no answer waits for
/// the bridge's timer, and one of 1 ms does harm: it cuts answers in two, or reports nothing just before one, and
/// either costs a frame. Such a bridge gets 4 ms; one whose answers wait keeps 1 ms. Answers may be on their way
/// afterwards.
void lengthen_timer(Transport& wire);

/// Sends `packet` and waits for a well-formed answer, up to `tries` times 5 ms.
[[nodiscard]] bool exchange(Transport& wire, AnswerStream& stream, const Packet& packet, Answer& answer, int tries);

/// True when firmware answers in run mode (`tries` packets).
[[nodiscard]] bool firmware_answers(Transport& wire, int tries = 50);

/// True when the boot loader replies to its greeting. Resets the device: firmware must be loaded afterwards.
[[nodiscard]] bool boot_loader_answers(Transport& wire);

/// One attempt to load an image: handshake at 9600 baud, echo check at 142857 baud. Throws Error{device} that names the
/// step. `progress` gets the share done, 0 to 1, first 0; what it throws ends the attempt.
void load_firmware(Transport& wire, std::span<const std::uint8_t> image,
                   const std::function<void(double)>& progress = {});

/// What the options ask for while firmware is loaded: they are told once, and may end it by Cancelled.
[[nodiscard]] std::function<void(double)> loading(const FalconOptions& options);

/// Enters run mode; loads `image` when nothing answers, up to `attempts` times. Throws Error{device}: without an image,
/// how to name one; with one, the last attempt's reason. Cancelled ends all attempts.
void bring_up(Transport& wire, std::span<const std::uint8_t> image, int attempts = 10,
              const std::function<void(double)>& progress = {});

}  // namespace sparsha::haptics::falcon
