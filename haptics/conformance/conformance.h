// What a device would do to a hand: its own conduct, watched, and the servo's answer to what its driver might do wrong.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "haptics/conformance/faulty_device.h"
#include "haptics/device/device.h"

namespace sparsha::haptics {

struct ConformanceStep {
  enum class Result { passed, failed, skipped };
  std::string name;
  Result result = Result::skipped;
  std::string found;      ///< with figures
  std::string to_a_hand;  ///< what somebody at the device would feel of it; empty = nothing
};

struct ConformanceOptions {
  double watch_s = 2.0;     ///< how long the device is watched by itself
  double rate_hz = 1000.0;  ///< the servo's
  double patience_s = 0.010;
  bool with_force = false;     ///< forces reach the device; else it is only ever told zero
  std::vector<Fault> faults;   ///< to be tried with the servo; empty = all
  std::function<bool()> stop;  ///< asked between steps; true skips the rest
};

struct ConformanceReport {
  std::vector<ConformanceStep> steps;
  [[nodiscard]] bool passed() const;
};

[[nodiscard]] const char* name_of(Fault fault);

/// Watches the device under a servo's calls with zero force: what info() says, when wait() returns, which positions
/// come how often, how long each call takes. Then a servo with the device's timing and a hand in software touches a
/// plane, and each fault is put between them. About fifteen seconds. A call that does not return is given up: the
/// device then stays in the hands of a thread that never ends.
[[nodiscard]] ConformanceReport check_conformance(const std::shared_ptr<Device>& device,
                                                  const ConformanceOptions& options = {});

/// The two halves.
[[nodiscard]] std::vector<ConformanceStep> watch_device(const std::shared_ptr<Device>& device,
                                                        const ConformanceOptions& options);
[[nodiscard]] std::vector<ConformanceStep> try_faults(Device& device, const ConformanceOptions& options);

}  // namespace sparsha::haptics
