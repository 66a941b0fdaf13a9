#include "haptics/device/falcon/keeper.h"

#include <chrono>
#include <utility>

#include "base/error.h"
#include "haptics/device/falcon/link.h"

namespace sparsha::haptics::falcon {
namespace {

constexpr std::chrono::milliseconds kLook{20};
constexpr int kLooksBetweenTries = 25;

constexpr DeviceAdvice kPlugIn{"device_plug_in", true};
constexpr DeviceAdvice kNoFirmware{"device_needs_firmware", true};
constexpr DeviceAdvice kLoads{"device_gets_firmware", false};
constexpr DeviceAdvice kDoesNotStart{"device_does_not_start", true};

}  // namespace

Keeper::Keeper(std::function<std::unique_ptr<Transport>()> open, std::vector<std::uint8_t> image)
    : open_(std::move(open)), image_(std::move(image)), thread_([this] { run(); }) {}

Keeper::~Keeper() {
  stopping_.store(true);
  thread_.join();
  close(given_back_.exchange(nullptr));
  close(offered_.exchange(nullptr));
}

void Keeper::give_back(Transport* wire) noexcept {
  given_back_.store(wire);
  wanted_.store(true);
}

Transport* Keeper::take() noexcept {
  if (offered_.load(std::memory_order_relaxed) == nullptr) return nullptr;
  return offered_.exchange(nullptr);
}

void Keeper::close(Transport* wire) const {
  if (wire == nullptr) return;
  while (users_.load() != 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  delete wire;
}

std::unique_ptr<Transport> Keeper::find() {
  std::unique_ptr<Transport> wire;
  try {
    wire = open_();
  } catch (const Error&) {
    advice_.store(&kPlugIn);
    return nullptr;
  }
  try {
    advice_.store(&kLoads);
    bring_up(*wire, image_, 1);
    advice_.store(nullptr);
    return wire;
  } catch (const Error&) {
    advice_.store(image_.empty() ? &kNoFirmware : &kDoesNotStart);
    return nullptr;
  }
}

void Keeper::run() {
  int looks = 0;
  while (!stopping_.load()) {
    if (wanted_.load()) {
      close(given_back_.exchange(nullptr));
      if (looks-- <= 0) {
        looks = kLooksBetweenTries;
        if (std::unique_ptr<Transport> wire = find()) {
          wanted_.store(false);
          looks = 0;
          offered_.store(wire.release());
        }
      }
    }
    std::this_thread::sleep_for(kLook);
  }
}

}  // namespace sparsha::haptics::falcon
