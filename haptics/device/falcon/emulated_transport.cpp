// A wire whose other end is an emulator in this process.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>

#include "haptics/device/falcon/emulator.h"

namespace sparsha::haptics::falcon {
namespace {

using Steady = std::chrono::steady_clock;
/// USB full-speed frames allow one exchange a millisecond.
constexpr double kFrame_s = 1e-3;

class EmulatedTransport final : public Transport {
 public:
  EmulatedTransport(std::shared_ptr<FalconEmulator> emulator, Clock clock)
      : emulator_(std::move(emulator)), clock_(clock), began_(Steady::now()) {}

  TransportStatus control(Request request, std::uint16_t value) noexcept override {
    if (!emulator_->plugged()) return TransportStatus::gone;
    emulator_->control(request, value);
    return TransportStatus::ok;
  }
  TransportStatus write(std::span<const std::uint8_t> bytes, int) noexcept override {
    if (!emulator_->plugged()) return TransportStatus::gone;
    emulator_->write(bytes, now_s());
    return TransportStatus::ok;
  }
  TransportStatus read(UsbPacket& packet, std::size_t& size, int timeout_ms) noexcept override {
    const TransportStatus status = receive(packet, size, 0.0);
    if (status != TransportStatus::nothing) return status;
    // The bridge reports its modem lines when the latency timer runs out, data or none.
    pass(std::min(0.016, static_cast<double>(timeout_ms) * 1e-3));
    size = kModemBytes;
    return TransportStatus::ok;
  }
  TransportStatus post(std::span<const std::uint8_t> bytes) noexcept override {
    posted_s_ = now_s();
    return write(bytes, 0);
  }
  TransportStatus receive(UsbPacket& packet, std::size_t& size, double timeout_s) noexcept override {
    if (!emulator_->plugged()) return TransportStatus::gone;
    const std::vector<std::uint8_t> data = emulator_->read();
    if (data.empty()) {
      pass(timeout_s);
      return TransportStatus::nothing;
    }
    if (posted_s_ >= 0.0) pass(posted_s_ + kFrame_s - now_s());
    packet[0] = 0x01;
    packet[1] = 0x60;
    std::copy(data.begin(), data.end(), packet.begin() + kModemBytes);
    size = kModemBytes + data.size();
    return TransportStatus::ok;
  }
  void urgent(std::span<const std::uint8_t> bytes) noexcept override { emulator_->write(bytes, now_s()); }

 private:
  [[nodiscard]] double now_s() const {
    if (clock_ == Clock::virtual_time) return virtual_s_;
    return std::chrono::duration<double>(Steady::now() - began_).count();
  }
  void pass(double seconds) {
    if (seconds <= 0.0) return;
    if (clock_ == Clock::virtual_time)
      virtual_s_.store(virtual_s_.load() + seconds);
    else
      std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
  }

  std::shared_ptr<FalconEmulator> emulator_;
  Clock clock_;
  Steady::time_point began_;
  std::atomic<double> virtual_s_{0.0};
  double posted_s_ = -1.0;
};

}  // namespace

std::unique_ptr<Transport> make_emulated_transport(std::shared_ptr<FalconEmulator> emulator, Clock clock) {
  return std::make_unique<EmulatedTransport>(std::move(emulator), clock);
}

}  // namespace sparsha::haptics::falcon
