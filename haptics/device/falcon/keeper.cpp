#include "haptics/device/falcon/keeper.h"

#include <utility>

#include "base/error.h"
#include "haptics/device/falcon/link.h"

namespace sparsha::haptics::falcon {
namespace {

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
    : open_(std::move(open)), image_(std::move(image)), plug_([this] { return find(); }) {}

void Keeper::give_back(Transport* wire, const DeviceAdvice* why) noexcept {
  advice_.store(why);
  plug_.give_back(wire);
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

}  // namespace sparsha::haptics::falcon
