// What scenes may be made of, and what is invented of each for the hand: the one table of its strike and its grain.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace sparsha::pipeline {

enum class Material : std::uint8_t { granite, sandstone, marble, wood, bronze, terracotta };

/// A first contact adds the force n v exp(-d t) sin(2 pi f t), v the speed of approach: the decaying sinusoid of
/// Okamura, Cutkosky & Dennerlein 2001 ("Reality-based models for vibration feedback in virtual environments") as an
/// event at contact (Kuchenbecker, Fiene & Niemeyer 2006, "Improving contact realism through event-based haptic
/// feedback"). Their taps give the order: wood lower and duller than stone, metal higher and longer. The values lie
/// between 100 and 300 Hz, where a hand is most sensitive; they are chosen, not measured. No half of a cycle, 2 n v / w
/// of impulse (w = 2 pi f), gives a hand that comes at v more than the lightest hand had: n < m w / 4.
struct MaterialTouch {
  std::string_view name;
  double frequency_hz = 0.0;
  double decay_per_s = 0.0;
  double force_per_speed_n_s_per_m = 0.0;
  double grain_gain = 1.0;  ///< of the extrapolated texture: below 1 for what is polished or cast
};

inline constexpr std::array<MaterialTouch, 6> kMaterials = {{
    {"granite", 240.0, 45.0, 16.5, 1.0},
    {"sandstone", 170.0, 55.0, 12.0, 1.4},
    {"marble", 270.0, 38.0, 16.0, 0.5},
    {"wood", 145.0, 45.0, 10.2, 0.8},
    {"bronze", 300.0, 27.0, 14.5, 0.35},
    {"terracotta", 200.0, 48.0, 14.0, 1.1},
}};

/// No hand that holds a device is lighter: what a strike may give to any hand is what this one brings.
inline constexpr double kLightestHandKg = 0.05;

[[nodiscard]] constexpr const MaterialTouch& touch_of(Material material) {
  return kMaterials[static_cast<std::size_t>(material)];
}

}  // namespace sparsha::pipeline
