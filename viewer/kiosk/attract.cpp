// Counts the time in which nobody has touched the exhibit.
#include "viewer/kiosk/attract.h"

#include <cmath>
#include <numbers>

namespace sparsha::viewer {

Attract::Change Attract::update(double time_s, const haptics::State& state) {
  constexpr double kMoved_m = 0.002;  // a device at rest drifts less
  if (state.tick != 0) {
    double square = 0.0;
    for (std::size_t k = 0; k < 3; ++k) square += std::pow(state.device_m[k] - hand_m_[k], 2);
    if (!(square < kMoved_m * kMoved_m)) {
      hand_m_ = state.device_m;
      touched_ = touched_ || begun_;
    }
  }
  if (!begun_ || touched_) last_s_ = time_s;
  visited_ = visited_ || touched_;
  const bool ends = touched_ && shows_;
  begun_ = true;
  touched_ = false;
  if (ends) {
    shows_ = false;
    return Change::ends;
  }
  if (shows_ || time_s - last_s_ < idle_s_) return Change::none;
  shows_ = true;
  shows_since_s_ = time_s;
  return Change::begins;
}

KeyLight Attract::light(double time_s) const {
  constexpr double kRound_s = 180.0, kStep_rad = std::numbers::pi / 90.0;
  KeyLight light;
  const double way = 2.0 * std::numbers::pi * (time_s - shows_since_s_) / kRound_s;
  light.azimuth_rad -= kStep_rad * std::floor(way / kStep_rad);
  light.elevation_rad = 0.30;
  return light;
}

}  // namespace sparsha::viewer
