// Finds, opens and brings up the Falcon that is plugged in again, on a thread of its own, and hands it to the servo.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

#include "haptics/device/device.h"
#include "haptics/device/falcon/transport.h"
#include "haptics/device/falcon/usb_transport.h"

namespace sparsha::haptics::falcon {

class Keeper {
 public:
  /// A Falcon that is free, or null and why there is none.
  using Open = std::function<std::unique_ptr<Transport>(OpenProblem& problem)>;
  Keeper(Open open, std::vector<std::uint8_t> image);
  ~Keeper();
  Keeper(const Keeper&) = delete;
  Keeper& operator=(const Keeper&) = delete;

  // Servo thread; no lock, no allocation.
  /// Ownership of a wire that is of no use any more; the keeper closes it and looks for another. `why` is the advice
  /// until something else is known.
  void give_back(Transport* wire, const DeviceAdvice* why = nullptr) noexcept;
  /// A Falcon in run mode, or null.
  [[nodiscard]] Transport* take() noexcept;

  /// Why there is none. Any thread.
  [[nodiscard]] const DeviceAdvice* advice() const noexcept { return advice_.load(); }

  /// Another thread uses a wire only between enter() and leave(): none is closed meanwhile.
  void enter() noexcept { users_.fetch_add(1); }
  void leave() noexcept { users_.fetch_sub(1); }

 private:
  void run();
  void close(Transport* wire) const;
  [[nodiscard]] std::unique_ptr<Transport> find();
  [[nodiscard]] bool start(Transport& wire);

  Open open_;
  std::vector<std::uint8_t> image_;
  std::atomic<Transport*> given_back_{nullptr}, offered_{nullptr};
  std::atomic<const DeviceAdvice*> advice_{nullptr};
  std::atomic<int> users_{0};
  std::atomic<bool> wanted_{false}, stopping_{false};
  std::thread thread_;
};

}  // namespace sparsha::haptics::falcon
