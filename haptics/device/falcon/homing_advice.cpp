#include "haptics/device/falcon/homing_advice.h"

namespace sparsha::haptics::falcon {

const DeviceAdvice* homing_advice(std::uint8_t homed, bool slow) noexcept {
  static constexpr DeviceAdvice kAll{"homing_all", true};
  static constexpr DeviceAdvice kTop{"homing_top", true};
  static constexpr DeviceAdvice kRight{"homing_right", true};
  static constexpr DeviceAdvice kLeft{"homing_left", true};
  static constexpr DeviceAdvice kNotTop{"homing_right_left", true};
  static constexpr DeviceAdvice kNotRight{"homing_top_left", true};
  static constexpr DeviceAdvice kNotLeft{"homing_top_right", true};
  static constexpr const DeviceAdvice* kByFlags[8] = {&kAll,     &kNotTop, &kNotRight, &kLeft,
                                                      &kNotLeft, &kRight,  &kTop,      &kAll};
  // In one pull and push the arms follow each other: no word about that.
  return slow ? kByFlags[homed & 7U] : &kAll;
}

}  // namespace sparsha::haptics::falcon
