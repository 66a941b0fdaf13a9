// Finds, opens and brings up the Falcon that is plugged in again, on a thread of its own, and hands it to the servo.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "haptics/device/device.h"
#include "haptics/device/falcon/transport.h"
#include "haptics/device/falcon/usb_transport.h"
#include "haptics/device/hot_plug.h"

namespace sparsha::haptics::falcon {

class Keeper {
 public:
  /// A Falcon that is free, or null and why there is none.
  using Open = std::function<std::unique_ptr<Transport>(OpenProblem& problem)>;
  Keeper(Open open, std::vector<std::uint8_t> image);

  // Servo thread; no lock, no allocation.
  /// Ownership of a wire that is of no use any more; the keeper closes it and looks for another. `why` is the advice
  /// until something else is known.
  void give_back(Transport* wire, const DeviceAdvice* why = nullptr) noexcept;
  /// A Falcon in run mode, or null.
  [[nodiscard]] Transport* take() noexcept { return plug_.take(); }

  /// Why there is none. Any thread.
  [[nodiscard]] const DeviceAdvice* advice() const noexcept { return advice_.load(); }

  /// Another thread uses a wire only between enter() and leave(): none is closed meanwhile.
  void enter() noexcept { plug_.enter(); }
  void leave() noexcept { plug_.leave(); }

 private:
  [[nodiscard]] std::unique_ptr<Transport> find();
  [[nodiscard]] bool start(Transport& wire);

  Open open_;
  std::vector<std::uint8_t> image_;
  std::atomic<const DeviceAdvice*> advice_{nullptr};
  HotPlug<Transport> plug_;  // the last: its thread uses what stands above
};

}  // namespace sparsha::haptics::falcon
