// Collects samples of force, depth and speed, and writes them as a table.
#include "viewer/overlay/strip.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "base/files/files.h"

namespace sparsha::viewer {
namespace {

double length_of(const std::array<double, 3>& v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

}  // namespace

void Strip::add(const haptics::State& state) {
  if (paused_ || state.tick == 0) return;
  if (!samples_.empty() && !(state.time_s > last_.time_s)) {
    if (state.time_s == last_.time_s) return;
    samples_.clear();  // another run
  }
  Sample sample;
  sample.time_s = state.time_s;
  sample.force_n = length_of(state.commanded_force_n);
  sample.depth_m = state.contact != 0 ? state.penetration_m : 0.0;
  if (!samples_.empty()) {
    std::array<double, 3> moved{};
    for (std::size_t axis = 0; axis < 3; ++axis) moved[axis] = state.device_m[axis] - last_.device_m[axis];
    sample.speed_m_per_s = length_of(moved) / (state.time_s - last_.time_s);
  }
  last_ = state;
  if (std::isfinite(sample.force_n) && std::isfinite(sample.depth_m) && std::isfinite(sample.speed_m_per_s))
    samples_.push_back(sample);
  while (!samples_.empty() && samples_.front().time_s < state.time_s - kLength_s) samples_.pop_front();
}

bool Strip::moves() const {
  constexpr double kForce_n = 0.005, kDepth_m = 5e-6, kSpeed_m_per_s = 5e-4;  // less than a pixel
  return !paused_ && std::ranges::any_of(samples_, [&](const Sample& sample) {
    return sample.force_n > kForce_n || sample.depth_m > kDepth_m || sample.speed_m_per_s > kSpeed_m_per_s;
  });
}

void Strip::write_csv(const std::filesystem::path& file) const {
  std::string text = "t_s,force_n,depth_m,speed_m_per_s\n";
  for (const Sample& s : samples_)
    text += fmt::format("{:.17g},{:.17g},{:.17g},{:.17g}\n", s.time_s, s.force_n, s.depth_m, s.speed_m_per_s);
  write_file(file, text);
}

std::string full_scale_text(double value, std::string_view unit) {
  const bool metres = value >= 1000.0 && unit.starts_with("mm");
  return fmt::format("{:.3g} {}", metres ? 1e-3 * value : value, metres ? unit.substr(1) : unit);
}

}  // namespace sparsha::viewer
