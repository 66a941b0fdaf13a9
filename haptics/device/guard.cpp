#include "haptics/device/guard.h"

#include <chrono>
#include <memory>
#include <thread>
#include <utility>

namespace sparsha::haptics {
namespace {

using Steady = std::chrono::steady_clock;
enum Word : std::size_t { kDevice, kBeats, kForce };
constexpr int kLook_ms = 4;
/// The watchdog thread acts after 10 ms where it still runs.
constexpr std::chrono::milliseconds kSilence{20};
/// A port whose transfers fail comes to its senses within a second or two, or is dead.
constexpr std::chrono::seconds kLastTries{2};

/// The guard's own process.
class Watcher {
 public:
  explicit Watcher(ForceGuard::Zero zero) : zero_(std::move(zero)) {}

  void look(system::SharedWords& words, bool alive) {
    if (const std::uint64_t device = words[kDevice].load(); device != device_) {
      device_ = device;
      static_cast<void>(zero_(device, false));
    }
    const Steady::time_point now = Steady::now();
    const std::uint64_t beats = words[kBeats].load();
    const bool force = words[kForce].load() != 0;
    if (beats != beats_ || !force) {
      beats_ = beats;
      heard_ = now;
    }
    if (!force || device_ == 0 || (alive && now - heard_ < kSilence)) return;
    // Again as long as nothing is heard. This is the last look at a program that has ended: a port may need more.
    while (!zero_(device_, true) && !alive && Steady::now() - now < kLastTries)
      std::this_thread::sleep_for(std::chrono::milliseconds(kLook_ms));
    heard_ = now;
  }

 private:
  ForceGuard::Zero zero_;
  std::uint64_t device_ = 0, beats_ = 0;
  Steady::time_point heard_ = Steady::now();
};

system::Companion::Watch watch_over(const ForceGuard::Zero& zero) {
  auto watcher = std::make_shared<Watcher>(zero);
  return [watcher](system::SharedWords& words, bool alive) { watcher->look(words, alive); };
}

}  // namespace

ForceGuard::ForceGuard(const Zero& zero) : companion_(watch_over(zero), kLook_ms) {}

void ForceGuard::watch(std::uint64_t device) noexcept { companion_.words()[kDevice].store(device); }
void ForceGuard::beat() noexcept { companion_.words()[kBeats].fetch_add(1, std::memory_order_relaxed); }
void ForceGuard::set_force(bool on) noexcept { companion_.words()[kForce].store(on ? 1 : 0); }

}  // namespace sparsha::haptics
