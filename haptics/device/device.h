// The one real interface: a thing with a hand position, buttons and a force.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>

#include <Eigen/Core>

#include "haptics/governor/governor.h"
#include "scene/frame/workspace.h"

namespace sparsha::haptics {

/// One reading. Device frame, metres.
struct DeviceSample {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  std::uint64_t buttons = 0;
  double time_s = 0.0;   ///< when it was measured, on the servo's clock
  double delay_s = 0.0;  ///< from a force's writing to a position that shows it, if measured; else 0
  /// Of the grip, a unit quaternion w, x, y, z in the device frame; all zero where the device does not measure it.
  std::array<double, 4> orientation{};
  Eigen::Vector3d applied_n = Eigen::Vector3d::Zero();  ///< on the motors then, where the device tells it
  bool tells_applied = false;
  double force_share = 1.0;  ///< Device::force_share() then; filled in by the servo
  bool fresh = false;        ///< false: nothing new; the force of before goes on until it is stale, then it is zero
  bool homed = true;         ///< false: positions are not absolute yet; the servo then commands zero
  bool connected = true;     ///< false: unplugged
  bool finished = false;     ///< no more samples will come; one that is not fresh is none itself
};

/// The turn that a device means, of unit length; zeros for what is no turn. One that is of unit length stays to the
/// bit.
[[nodiscard]] inline std::array<double, 4> unit_or_none(std::array<double, 4> turn) noexcept {
  const double norm = std::sqrt(turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2] + turn[3] * turn[3]);
  if (!(norm > 0.5 && norm < 2.0)) return {};
  for (double& part : turn) part = std::clamp(std::abs(norm - 1.0) < 1e-12 ? part : part / norm, -1.0, 1.0);
  return turn;
}

struct DeviceInfo {
  std::string name;  ///< "simulated", "Novint Falcon", ...
  double workspace_width_m = scene::kDeskWorkspace_m;
  DeviceLimits limits;
  bool paced = false;  ///< true: wait() paces the loop by the device's answers, else the servo's clock does
  /// true, and not paced: read() is told the planned time of its tick instead of that at which the servo woke. For
  /// hands that are computed, whose run is then the same each time.
  bool planned_time = false;
  double rate_hz = 0.0;  ///< of samples that come at a rate of their own whatever the servo's; 0 = none
  /// Faster than this no hand moves it: a position farther from the last one is a fault. 0 = any position is believed
  /// (a mouse, a path that is played back).
  double fastest_m_per_s = 0.0;
  std::string warning;  ///< to be told when a session begins; empty = nothing
};

/// What the person at the device should know now.
struct DeviceAdvice {
  const char* phrase;  ///< key of the text in every language (configs/speech), or words of the driver's own
  bool needed;         ///< false: good to know; true: nothing goes on before it is done
  bool warns = false;  ///< only where it is not needed: told as a warning, since the hand gets another force
};

/// All calls but open-time ones come from the servo thread and must not allocate, lock or throw.
class Device {
 public:
  virtual ~Device() = default;
  [[nodiscard]] virtual DeviceInfo info() const = 0;
  /// Paced devices: returns when an answer is there or after `timeout_s`; the only call that may block.
  virtual void wait(double timeout_s) noexcept { static_cast<void>(timeout_s); }
  /// The newest hand position. `time_s`: when the servo woke for this tick, `period_s` the tick's planned length.
  [[nodiscard]] virtual DeviceSample read(double time_s, double period_s) noexcept = 0;
  /// Force to hold until the next call, newtons, device frame.
  virtual void write(const Eigen::Vector3d& force_n) noexcept = 0;
  /// What becomes of the force that is written, 0 to 1: motors that have become warm are spared.
  [[nodiscard]] virtual double force_share() const noexcept { return 1.0; }
  /// Zero force now; may be called from the watchdog's thread while the servo is silent.
  virtual void zero() noexcept = 0;
  /// From any thread; null when there is nothing to say. What it points to stays.
  [[nodiscard]] virtual const DeviceAdvice* advice() const noexcept { return nullptr; }
};

}  // namespace sparsha::haptics
