// What scenes may be made of, and what is invented of each for hand and ear: the one table of its strike, its grain and
// its sound.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace sparsha::scene {

enum class Material : std::uint8_t { granite, sandstone, marble, wood, bronze, terracotta };

/// Loss factors have the order that Cremer, Heckl & Petersson 2005 ("Structure-Borne Sound", ch. 3) give for metals,
/// stone and wood; that of a block which lies in sand or mortar is larger than the material's own. Chosen, not
/// measured.
struct MaterialSound {
  double frequency_hz = 0.0;  ///< of the lowest mode of a struck piece, a free plate some decimetres wide
  double damping = 0.0;       ///< loss factor: a mode of f Hz falls by 60 dB in 2.2 / (damping f) s
  double brightness = 0.0;    ///< loudness of each mode relative to the one below it, 0 to 1
};

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
  MaterialSound sound{};
};

inline constexpr std::array<MaterialTouch, 6> kMaterials = {{
    {"granite", 240.0, 45.0, 16.5, 1.0, {880.0, 0.010, 0.75}},
    {"sandstone", 170.0, 55.0, 12.0, 1.4, {560.0, 0.022, 0.60}},
    {"marble", 270.0, 38.0, 16.0, 0.5, {1050.0, 0.005, 0.80}},
    {"wood", 145.0, 45.0, 10.2, 0.8, {300.0, 0.030, 0.55}},
    {"bronze", 300.0, 27.0, 14.5, 0.35, {620.0, 0.0015, 0.90}},
    {"terracotta", 200.0, 48.0, 14.0, 1.1, {700.0, 0.014, 0.70}},
}};

/// No hand that holds a device is lighter: what a strike may give to any hand is what this one brings.
inline constexpr double kLightestHand_kg = 0.05;

[[nodiscard]] constexpr const MaterialTouch& touch_of(Material material) {
  return kMaterials[static_cast<std::size_t>(material)];
}

}  // namespace sparsha::scene
