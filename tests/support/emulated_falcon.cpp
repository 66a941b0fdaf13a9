#include "tests/support/emulated_falcon.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>
#include <utility>

namespace sparsha::test {
namespace {

using haptics::falcon::kModemBytes;
using haptics::falcon::Request;
using haptics::falcon::TransportStatus;
using haptics::falcon::UsbPacket;
using Steady = std::chrono::steady_clock;

class Wire final : public haptics::falcon::Transport {
 public:
  Wire(std::shared_ptr<emulator::Falcon> device, Clock clock)
      : device_(std::move(device)), clock_(clock), began_(Steady::now()) {}

  TransportStatus control(Request request, std::uint16_t value) noexcept override {
    if (!device_->plugged()) return TransportStatus::gone;
    return device_->control(static_cast<std::uint8_t>(request), value, now_s()) ? TransportStatus::ok
                                                                                : TransportStatus::nothing;
  }
  TransportStatus write(std::span<const std::uint8_t> bytes, int) noexcept override {
    if (!device_->plugged()) return TransportStatus::gone;
    device_->write(bytes, now_s());
    return TransportStatus::ok;
  }
  TransportStatus read(UsbPacket& packet, std::size_t& size, int timeout_ms) noexcept override {
    return next(packet, size, now_s() + timeout_ms * 1e-3);
  }
  TransportStatus post(std::span<const std::uint8_t> bytes) noexcept override { return write(bytes, 0); }
  TransportStatus receive(UsbPacket& packet, std::size_t& size, double timeout_s) noexcept override {
    const double limit_s = now_s() + timeout_s;
    for (;;) {
      const TransportStatus status = next(packet, size, limit_s);
      if (status != TransportStatus::ok || size > kModemBytes) return status;
    }
  }
  void urgent(std::span<const std::uint8_t> bytes) noexcept override { static_cast<void>(write(bytes, 0)); }
  [[nodiscard]] bool present() const noexcept override { return device_->plugged(); }

 private:
  TransportStatus next(UsbPacket& packet, std::size_t& size, double limit_s) noexcept {
    if (!device_->plugged()) return TransportStatus::gone;
    const double due_s = device_->packet_s();
    if (due_s > now_s()) wait_until(std::min(due_s, limit_s));
    if (due_s > limit_s) return TransportStatus::nothing;
    const auto bytes = device_->read(std::max(now_s(), due_s));
    if (!bytes) return TransportStatus::nothing;
    std::copy(bytes->begin(), bytes->end(), packet.begin());
    size = bytes->size();
    return TransportStatus::ok;
  }
  [[nodiscard]] double now_s() const {
    if (clock_ == Clock::virtual_time) return virtual_s_;
    return std::chrono::duration<double>(Steady::now() - began_).count();
  }
  void wait_until(double time_s) {
    if (clock_ == Clock::virtual_time)
      virtual_s_.store(std::max(virtual_s_.load(), time_s));
    else
      std::this_thread::sleep_until(
          began_ + std::chrono::duration_cast<Steady::duration>(std::chrono::duration<double>(time_s)));
  }

  std::shared_ptr<emulator::Falcon> device_;
  Clock clock_;
  Steady::time_point began_;
  std::atomic<double> virtual_s_{0.0};
};

}  // namespace

EmulatedFalcon::EmulatedFalcon(const EmulatorOptions& options) : device(std::make_shared<emulator::Falcon>(options)) {}

void EmulatedFalcon::set_hand(Hand hand) {
  device->set_hand([hand = std::move(hand)](const emulator::Felt& felt) {
    const Eigen::Vector3d place = hand(felt.time_s, {felt.force_n[0], felt.force_n[1], felt.force_n[2]});
    return emulator::Grip{{place.x(), place.y(), place.z()}, 0};
  });
}

void EmulatedFalcon::set_position(const Eigen::Vector3d& position_m) {
  device->set_place({position_m.x(), position_m.y(), position_m.z()});
}

Eigen::Vector3d EmulatedFalcon::force_n() const {
  const auto force = device->force_n();
  return {force[0], force[1], force[2]};
}

std::unique_ptr<haptics::falcon::Transport> make_wire(const EmulatedFalcon& falcon, Clock clock) {
  return std::make_unique<Wire>(falcon.device, clock);
}

}  // namespace sparsha::test
