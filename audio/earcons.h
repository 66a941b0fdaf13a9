// Short sounds that tell what the hand has come to, and a tone that leads a hand which has lost the stone back to it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "haptics/state/state.h"
#include "scene/config/cues.h"

namespace sparsha::audio {

/// One channel. After construction nothing allocates, locks or throws. One thread.
///
/// Each of scene::Cue has a figure of its own: a view that comes closer glides up, one that goes away glides down; a
/// part that is entered is two notes up, one that is left two notes down; the stone's edge is two low knocks; what was
/// never measured flutters. A hand more than kLost_m from the stone for kLostFor_s hears a beep that comes the sooner
/// and the higher the nearer the stone is, until it is within kFound_m; while it rests there is none.
class Earcons {
 public:
  /// Absent: silence, at no cost. `sample_rate_hz` 8000 or more.
  Earcons(const std::optional<scene::CuesConfig>& config, int sample_rate_hz);

  /// States in order of frames; of one whose frame has passed the sounds begin now. What the first one counts is past.
  void state(const haptics::State& state, std::uint64_t frame) noexcept;
  /// There is no hand from `frame` on.
  void leave(std::uint64_t frame) noexcept;
  /// Adds `count` samples from `frame` on.
  void render(double* out, std::size_t count, std::uint64_t frame) noexcept;
  /// Something is heard, waits, or will beep.
  [[nodiscard]] bool sounding() const noexcept { return playing_ > 0 || waiting_ > 0 || lost_; }

  /// Metres of the device frame, and seconds.
  static constexpr double kLost_m = 0.025;
  static constexpr double kFound_m = 0.005;
  static constexpr double kLostFor_s = 1.5;
  static constexpr double kRests_s = 8.0;  ///< a hand that moves less than kRests_m for so long rests
  static constexpr double kRests_m = 0.002;
  /// Largest sample of each sound.
  static constexpr double kLevel = 0.11;

 private:
  enum class Kind : std::uint8_t { level_closer, level_farther, edge, unmeasured, part_entered, part_left, beep };
  static constexpr std::size_t kKinds = 7;
  static constexpr std::size_t kMostEvents = 1024;
  struct Event {
    std::uint64_t frame = 0;
    std::uint32_t begins = 0;  ///< bits of Kind
    bool lost = false;
    double away_m = 0.0;
  };
  struct Voice {
    bool playing = false;
    double at_s = 0.0;
    double pitch_hz = 0.0;  ///< of a beep
  };

  [[nodiscard]] std::uint32_t told(const haptics::State& state) noexcept;
  [[nodiscard]] bool loses(const haptics::State& state) noexcept;
  void push(const Event& event) noexcept;
  void take(const Event& event) noexcept;
  void begin(Kind kind, double pitch_hz = 0.0) noexcept;

  std::optional<scene::CuesConfig> config_;
  double step_s_;

  // What states have told, at their times.
  bool seen_ = false;
  std::array<std::uint64_t, scene::kCues> counts_{};
  double scale_ = 1.0;
  bool away_ = false;
  double away_since_s_ = 0.0;
  double moved_s_ = 0.0;
  std::array<double, 3> rests_at_m_{};
  bool told_lost_ = false;

  std::array<Event, kMostEvents> events_{};  ///< a ring
  std::size_t first_ = 0, waiting_ = 0;

  // What is heard, at frames.
  std::array<Voice, kKinds> voices_{};
  std::size_t playing_ = 0;
  bool lost_ = false;
  double away_m_ = 0.0;
  double next_beep_s_ = 0.0;
};

}  // namespace sparsha::audio
