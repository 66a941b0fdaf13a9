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
constexpr DeviceAdvice kNotPermitted{"device_not_permitted", true};
constexpr DeviceAdvice kBusy{"device_busy", true};
constexpr DeviceAdvice kNoFirmware{"device_needs_firmware", true};
constexpr DeviceAdvice kLoads{"device_gets_firmware", false};
constexpr DeviceAdvice kDoesNotStart{"device_does_not_start", true};

const DeviceAdvice& advice_on(OpenProblem problem) {
  if (problem == OpenProblem::not_permitted) return kNotPermitted;
  return problem == OpenProblem::busy ? kBusy : kPlugIn;
}

/// False when the device has no power, or has gone.
bool loader_answers(Transport& wire) {
  try {
    return boot_loader_answers(wire);
  } catch (const Error&) {
    return false;
  }
}

}  // namespace

Keeper::Keeper(Open open, std::vector<std::uint8_t> image)
    : open_(std::move(open)), image_(std::move(image)), thread_([this] { run(); }) {}

Keeper::~Keeper() {
  stopping_.store(true);
  thread_.join();
  close(given_back_.exchange(nullptr));
  close(offered_.exchange(nullptr));
}

void Keeper::give_back(Transport* wire, const DeviceAdvice* why) noexcept {
  advice_.store(why);
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
  OpenProblem problem{};
  std::unique_ptr<Transport> wire = open_(problem);
  if (!wire) {
    advice_.store(&advice_on(problem));
    return nullptr;
  }
  if (!start(*wire)) return nullptr;
  advice_.store(nullptr);
  return wire;
}

// Each change of the advice is spoken: while one device fails to start again and again, what was said first stays.
bool Keeper::start(Transport& wire) {
  const DeviceAdvice* const before = advice_.load();
  const bool opens = before == nullptr || before == &kPlugIn || before == &kNotPermitted || before == &kBusy;
  if (opens) advice_.store(&kLoads);
  try {
    bring_up(wire, image_, 1);
    return true;
  } catch (const Error&) {  // what fails is said below
  }
  if (image_.empty() && loader_answers(wire))
    advice_.store(&kNoFirmware);
  else if (opens || before == &kNoFirmware)
    advice_.store(&kDoesNotStart);
  return false;
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
