// One tick's row for the recorder: the State and what a replay needs besides.
#pragma once

#include <array>
#include <cstdint>
#include <type_traits>

#include "haptics/state/state.h"

namespace sparsha::haptics {

struct Record {
  State state;
  std::array<double, 3> raw_device_m{};  ///< as the device gave it, NaN included
  /// What the motors had when the hand was measured, newtons, device frame: by the device's own word, else what was
  /// commanded a tick before times its share.
  std::array<double, 3> applied_force_n{};
  double measured_delay_s = 0.0;        ///< DeviceSample::delay_s as the servo took it
  double device_share = 1.0;            ///< of the commanded force that the device lets through to the hand
  double period_s = 0.0;                ///< that the governor saw
  double nominal_period_s = 0.0;        ///< of the servo's plan
  std::int32_t cell_i = 0, cell_j = 0;  ///< the proxy's cell in its level
  double cell_m = 0.0;                  ///< and the cells' size, grid frame
};
static_assert(std::is_trivially_copyable_v<Record>);

/// Takes a row per tick from the servo's thread.
class RecordSink {
 public:
  virtual ~RecordSink() = default;
  /// Neither waits nor allocates. False: the row is lost, and counted.
  virtual bool push(const Record& record) noexcept = 0;
  /// Rows lost so far; any thread.
  [[nodiscard]] virtual std::uint64_t dropped() const noexcept = 0;
};

}  // namespace sparsha::haptics
