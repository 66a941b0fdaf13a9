// The USB serial bridge in front of the Falcon, as far as the driver needs it: libusb in the house, an emulator in
// tests.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace sparsha::haptics::falcon {

inline constexpr std::uint16_t kVendor = 0x0403;
inline constexpr std::uint16_t kProduct = 0xCB48;

class Port {
 public:
  virtual ~Port() = default;

  /// A vendor request to the bridge. False when it was refused.
  virtual bool control(std::uint8_t request, std::uint16_t value) = 0;
  /// Blocking, for the firmware. Bytes written, 0 on a time-out.
  virtual std::size_t write(std::span<const std::uint8_t> bytes, double timeout_s) = 0;
  /// Blocking, for the firmware. Bytes read without the bridge's two status bytes, 0 on a time-out.
  virtual std::size_t read(std::span<std::uint8_t> bytes, double timeout_s) = 0;

  /// Sends without waiting and keeps an answer on order; false when the last one is still on its way.
  virtual bool submit(std::span<const std::uint8_t> bytes) noexcept = 0;
  /// The same from another thread, whatever is on its way: the watchdog's zero.
  virtual void submit_urgent(std::span<const std::uint8_t> bytes) noexcept = 0;
  /// Waits for bytes that arrived since the last call, at most `timeout_s`; never for long.
  virtual std::size_t receive(std::span<std::uint8_t> bytes, double timeout_s) noexcept = 0;
  /// False once the device has been unplugged.
  [[nodiscard]] virtual bool connected() const noexcept = 0;
};

/// What is plugged in, and whether it may be opened.
struct UsbReport {
  bool usb = false;        ///< libusb works here
  int devices = 0;         ///< Falcons found
  bool permitted = false;  ///< the first one could be opened
  std::string error;       ///< why not
};
[[nodiscard]] UsbReport look_for_falcon();

/// Opens the first Falcon on the bus. Throws Error{device} with the remedy.
[[nodiscard]] std::unique_ptr<Port> open_usb_port();

}  // namespace sparsha::haptics::falcon
