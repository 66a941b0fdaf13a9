// The wire to a Falcon: an FTDI serial bridge on USB, or its emulator.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace sparsha::haptics::falcon {

/// Vendor requests of the FTDI bridge (bmRequestType 0x40, index 0, no data).
enum class Request : std::uint8_t {
  reset = 0,
  modem = 1,
  flow = 2,
  baud = 3,
  data = 4,
  event_character = 6,
  latency = 9
};
namespace value {
inline constexpr std::uint16_t kPurgeReceive = 1, kPurgeTransmit = 2;
inline constexpr std::uint16_t kDtrLow = 0x0100, kDtrHigh = 0x0101, kRtsLow = 0x0200;
inline constexpr std::uint16_t kBaud9600 = 0x4138, kBaudUpload = 0x0015, kBaudRun = 0x0002;
inline constexpr std::uint16_t kData8N1 = 0x0008;
inline constexpr std::uint16_t kEventNone = 0x0000, kEventAnswer = 0x013E;  ///< off; the '>' that ends an answer
}  // namespace value

/// Every packet from the bridge begins with this many bytes of modem status.
inline constexpr std::size_t kModemBytes = 2;
inline constexpr std::size_t kUsbPacketBytes = 64;
using UsbPacket = std::array<std::uint8_t, kUsbPacketBytes>;

enum class TransportStatus : std::uint8_t {
  ok,
  nothing,
  gone
};  ///< done; nothing within the time, or it failed and may be tried again; unplugged or failed for a second

/// Where on USB a device is; zeros when it is not on USB.
struct UsbAddress {
  std::uint32_t bus = 0;
  std::uint32_t address = 0;
};

/// Two ways to talk: blocking calls while opening, and the servo's calls, which never throw or lock. One thread, except
/// urgent().
class Transport {
 public:
  Transport() = default;
  virtual ~Transport() = default;
  Transport(const Transport&) = delete;
  Transport& operator=(const Transport&) = delete;

  // Opening; milliseconds.
  virtual TransportStatus control(Request request, std::uint16_t value) noexcept = 0;
  virtual TransportStatus write(std::span<const std::uint8_t> bytes, int timeout_ms) noexcept = 0;
  /// One USB packet, modem bytes included; `size` its length (kModemBytes = no data yet, still `ok`).
  virtual TransportStatus read(UsbPacket& packet, std::size_t& size, int timeout_ms) noexcept = 0;

  // Running.
  /// Hands the bytes over without waiting; `nothing` when the last ones are still on their way.
  virtual TransportStatus post(std::span<const std::uint8_t> bytes) noexcept = 0;
  /// Waits for the next USB packet that carries data, at most `timeout_s`; with 0 takes only what is there.
  virtual TransportStatus receive(UsbPacket& packet, std::size_t& size, double timeout_s) noexcept = 0;
  /// Like post(), from any thread, past whatever the servo is doing.
  virtual void urgent(std::span<const std::uint8_t> bytes) noexcept = 0;
  [[nodiscard]] virtual UsbAddress address() const noexcept { return {}; }
  /// False once the device has left the bus; `gone` alone may also mean that its transfers fail.
  [[nodiscard]] virtual bool present() const noexcept = 0;
};

}  // namespace sparsha::haptics::falcon
