// The last ten seconds of a touch: force, depth and speed.
#pragma once

#include <deque>
#include <filesystem>
#include <string>
#include <string_view>

#include "haptics/state/state.h"

namespace sparsha::viewer {

class Strip {
 public:
  struct Sample {
    double time_s = 0.0;         ///< of the servo
    double force_n = 0.0;        ///< commanded, magnitude
    double depth_m = 0.0;        ///< penetration, device frame; 0 when free
    double speed_m_per_s = 0.0;  ///< of the hand, device frame
  };
  static constexpr double kLength_s = 10.0;

  /// One sample a picture; nothing while paused or when the servo has not gone on.
  void add(const haptics::State& state);
  void pause(bool on) { paused_ = on; }
  [[nodiscard]] bool paused() const { return paused_; }
  [[nodiscard]] const std::deque<Sample>& samples() const { return samples_; }
  /// True when the picture of it changes as time goes on.
  [[nodiscard]] bool moves() const;
  /// t_s,force_n,depth_m,speed_m_per_s; atomically. Throws Error{failure} when it cannot be written.
  void write_csv(const std::filesystem::path& file) const;

 private:
  std::deque<Sample> samples_;
  haptics::State last_;
  bool paused_ = false;
};

/// "1.28 m/s": `value` in `unit`, and in metres from a thousand millimetres on.
[[nodiscard]] std::string full_scale_text(double value, std::string_view unit);

}  // namespace sparsha::viewer
