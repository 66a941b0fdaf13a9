// What the hand has come to: counts for whoever makes sounds of it, and a light tick of force.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <Eigen/Core>

#include "haptics/effects/part_watch.h"
#include "haptics/effects/surface_effects.h"
#include "scene/config/cues.h"

namespace sparsha::haptics {

/// Servo thread only; no allocation, no exceptions.
class Cues {
 public:
  struct Input {
    double period_s = 0.001;
    double pace_s = 0.001;  ///< of the loop: a gap is one tick
    double time_s = 0.0;
    Eigen::Vector3d place_m = Eigen::Vector3d::Zero();  ///< touched, frame of the scene's parts
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();   ///< unit; zero when free
    double pressed_n = 0.0;                             ///< by the surface: with the tick it never pulls
    double scale = 1.0;                                 ///< device metres per grid metre
    bool contact = false;
    bool outside = false;  ///< of the scene, in the last tick
    bool unknown = false;  ///< where nothing was measured, likewise
  };
  /// Newtons, device frame, to be added. A tick begins with a cue, lasts some hundredths of a second and is at most
  /// kTick_n strong. `effects` may be null: then there are no cues.
  [[nodiscard]] Eigen::Vector3d update(const Input& input, const SurfaceEffects* effects) noexcept;
  /// Ends the tick; the present view counts as known. After faults and homing.
  void reset() noexcept;
  /// So far, in the order of scene::Cue.
  [[nodiscard]] const std::array<std::uint64_t, scene::kCues>& counts() const noexcept { return counts_; }

  static constexpr double kTick_n = 0.3;

 private:
  void watch(const Input& input, const SurfaceEffects& effects) noexcept;
  void watch_parts(const Input& input, const SurfaceEffects& effects) noexcept;
  void tell(scene::Cue cue, const SurfaceEffects& effects) noexcept;
  [[nodiscard]] double tick(const Input& input) noexcept;

  /// Something that is so in contact, and is told of once.
  struct Watched {
    bool now = false;
    double last_s = -1e9;  // when it was so last
  };
  [[nodiscard]] static bool begins(Watched& watched, bool now, double time_s) noexcept;

  std::array<std::uint64_t, scene::kCues> counts_{};
  Watched outside_, unknown_;
  PartWatch parts_;
  double scale_ = 0.0;    // of the last tick; 0 before the first
  double tick_s_ = -1.0;  // since it began; negative: none
  double tick_hz_ = 0.0;
};

}  // namespace sparsha::haptics
