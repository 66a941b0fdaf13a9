#include "haptics/device/falcon/guard.h"

#include <chrono>
#include <thread>

#include "haptics/device/falcon/packet.h"

namespace sparsha::haptics::falcon {
namespace {

using Steady = std::chrono::steady_clock;
enum Word : std::size_t { kDevice, kBeats, kForce };
constexpr int kLook_ms = 4;
/// The watchdog thread acts after 10 ms where it still runs.
constexpr std::chrono::milliseconds kSilence{20};
/// A port whose transfers fail comes to its senses within a second or two, or is dead.
constexpr std::chrono::seconds kLastTries{2};
/// A command that was cut off may swallow the first.
constexpr int kZeros = 3;
constexpr unsigned kInterface = 0, kOut = 0x02;

/// The guard's own process.
class Watcher {
 public:
  void look(system::SharedWords& words, bool alive) {
    const std::uint64_t device = words[kDevice].load();
    if (device != device_) {
      device_ = device;
      node_.reset();
      if (device != 0) node_.emplace(static_cast<unsigned>(device >> 32U), static_cast<unsigned>(device & 0xFFFFFFFFU));
    }
    const Steady::time_point now = Steady::now();
    const std::uint64_t beats = words[kBeats].load();
    const bool force = words[kForce].load() != 0;
    if (beats != beats_ || !force) {
      beats_ = beats;
      heard_ = now;
    }
    if (!force || !node_ || (alive && now - heard_ < kSilence)) return;
    // Again as long as nothing is heard. This is the last look at a program that has ended: a port may need more.
    while (!node_->write_taking_over(kInterface, kOut, zero_, kZeros) && !alive && Steady::now() - now < kLastTries)
      std::this_thread::sleep_for(std::chrono::milliseconds(kLook_ms));
    heard_ = now;
  }

 private:
  const Packet zero_ = encode({}, kHomingRequest | kLightRed);
  std::uint64_t device_ = 0, beats_ = 0;
  Steady::time_point heard_ = Steady::now();
  std::optional<system::UsbNode> node_;
};

system::Companion::Watch watch_over() {
  auto watcher = std::make_shared<Watcher>();
  return [watcher](system::SharedWords& words, bool alive) { watcher->look(words, alive); };
}

}  // namespace

ForceGuard::ForceGuard() : companion_(watch_over(), kLook_ms) {}

void ForceGuard::watch(const UsbAddress& device) noexcept {
  companion_.words()[kDevice].store((std::uint64_t{device.bus} << 32U) | device.address);
}
void ForceGuard::beat() noexcept { companion_.words()[kBeats].fetch_add(1, std::memory_order_relaxed); }
void ForceGuard::set_force(bool on) noexcept { companion_.words()[kForce].store(on ? 1 : 0); }

}  // namespace sparsha::haptics::falcon
