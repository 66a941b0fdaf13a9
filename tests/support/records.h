// Rows for a recorder, by hand.
#pragma once

#include <cstdint>

#include "haptics/servo/record.h"

namespace sparsha::haptics {

inline Record record_at(std::uint64_t tick) {
  Record record;
  record.state.tick = tick;
  record.state.time_s = 0.001 * static_cast<double>(tick);
  record.state.flags = kFlagHomed;
  record.period_s = 0.001;
  record.nominal_period_s = 0.001;
  record.state.window = {0, 0, 10, 10};
  return record;
}

}  // namespace sparsha::haptics
