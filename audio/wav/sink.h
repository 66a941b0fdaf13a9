// The sound of a run as a WAV file whose sample 0 is the servo's time 0.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "audio/synth.h"
#include "audio/wav/writer.h"

namespace sparsha::audio {

/// Fed while the run goes on; renders a quarter of a second behind it, so that what comes a little late is still placed
/// at its exact time. One thread.
class WavSink {
 public:
  WavSink(const std::shared_ptr<const SoundBank>& bank, const std::filesystem::path& target, int bits);

  /// True when it sounds. The onset is the sample nearest to event.time_s.
  bool contact(const haptics::ContactEvent& event);
  /// The newest state; renders what is old enough. True when the hand has slid onto what sounds. Throws Error{failure}.
  bool state(const haptics::State& state);
  /// The heights under the hand since then.
  void profile(std::shared_ptr<const Profile> profile, double time_s);
  /// Writes up to `end_s` and what still rings then (5 s at most, faded), and commits. Throws Error{failure}.
  void finish(double end_s);

 private:
  void render_until(std::uint64_t frame);
  [[nodiscard]] std::uint64_t frame_of(double time_s) const;

  Synth synth_;
  WavWriter writer_;
  bool has_state_ = false;
  std::uint64_t last_tick_ = 0;
  std::vector<float> block_;
};

}  // namespace sparsha::audio
