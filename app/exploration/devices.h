// The devices that this program knows.
#pragma once

#include <span>
#include <string>

#include "haptics/device/kind.h"

namespace sparsha::app {

/// In the order in which `device list` tells them.
[[nodiscard]] std::span<const haptics::DeviceKind> device_kinds();

struct NamedKind {
  const haptics::DeviceKind* kind = nullptr;
  std::string argument;
};
/// The kind that `name` or `name:ARGUMENT` means, and its argument. Throws Error{usage}, which names all, for another
/// name and for an argument that is missing or too much.
[[nodiscard]] NamedKind kind_of(const std::string& name);
/// The same, made. Throws what the kind throws.
[[nodiscard]] std::unique_ptr<haptics::Device> make_device(const std::string& name, haptics::DeviceRequest request);
/// Throws Error{usage} where a firmware image is named and `device` is none that takes one: neither a Falcon nor
/// `auto`.
void require_use_of_firmware(const std::string& device, const std::string& firmware);
/// "auto | falcon | pointer | ...": what --device may be.
[[nodiscard]] std::string device_names();
/// The same without `auto`, for what is asked of one device.
[[nodiscard]] std::string named_devices();

}  // namespace sparsha::app
