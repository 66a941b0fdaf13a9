// The stroke of the validation figures: over z = 0.05 sin(2 pi x) sin(2 pi y), 1 m^2, with grains on it. Metres, grid
// frame of the surface.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "bench/haptics/lines.h"
#include "haptics/surface/monge_surface.h"

namespace sparsha::bench {

inline constexpr double kStrokeTick_s = 0.001;
inline constexpr double kStrokeDepth_m = 0.004;   // under the untextured surface, along its normal
inline constexpr double kStrokeScale = 0.1;       // device metres per grid metre
inline constexpr double kStrokeGrain_m = 0.03;    // wavelength of the texture
inline constexpr double kStrokeSettled_s = 0.1;   // after that the slip is steady
inline constexpr double kStrokeApproach_s = 0.1;  // through free space and into the surface

/// Whole ticks in a time of the stroke: every count and index of ticks is this one.
[[nodiscard]] constexpr std::size_t stroke_ticks(double seconds) {
  return static_cast<std::size_t>(seconds / kStrokeTick_s + 0.5);
}

[[nodiscard]] double stroke_envelope(double x, double y);
/// Rounded grains that differ in height, at most 0.9 mm.
[[nodiscard]] double stroke_texture(double x, double y);

/// The hand once a tick: 0.9 m in 2 s (9 cm in a 10 cm workspace); with `approach` it comes down from 10 mm above
/// first.
[[nodiscard]] std::vector<Eigen::Vector3d> stroke_hands(bool approach);
/// Mean speed along the way, m/s, without the approach.
[[nodiscard]] double stroke_speed();

struct Stroke {
  std::vector<double> t;        ///< s
  std::vector<double> z_mm;     ///< of the proxy
  std::vector<double> force_n;  ///< 800 N/m at the device
};

/// The exact solver on sharp creases over `hands`, grid frame.
[[nodiscard]] Stroke render_stroke(const haptics::MongeSurface& surface, const std::vector<Eigen::Vector3d>& hands);

/// Ticks by which `late` comes after `early` from tick `first` on: where their correlation is largest, refined by a
/// parabola; within 60.
[[nodiscard]] double lag_ticks(const std::vector<double>& early, const std::vector<double>& late, std::size_t first);

/// Strokes above each other, whole and in a detail from `detail_from` to `detail_to` seconds.
[[nodiscard]] std::vector<Panel> stroke_panels(const std::vector<Stroke>& strokes, const char* unit,
                                               std::vector<double> Stroke::*value, double detail_from,
                                               double detail_to);

}  // namespace sparsha::bench
