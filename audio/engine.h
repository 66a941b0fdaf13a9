// Sound from touch: regions and materials that are struck or slid onto, the surface as it is stroked, and what tells a
// hand where it has come to.
// Two sinks of the same synthesiser: a PortAudio stream, or a WAV file whose time 0 is the servo's.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "haptics/state/seqlock.h"
#include "haptics/state/spsc_queue.h"
#include "haptics/state/state.h"
#include "scene/scene_fwd.h"

namespace sparsha::audio {

struct EngineOptions {
  std::filesystem::path wav;  ///< --audio-out; empty = none
  bool live = true;           ///< open a PortAudio stream; without a sound device a warning; tried again every 3 s
  std::string device;         ///< --audio-device, a number or a part of a name; empty: JACK, else the default
  int wav_bits = 16;          ///< 16 (dithered) or 24
};

/// Loads clips into memory and makes the voices. Throws Error{input} for an unreadable clip, Error{failure} when the
/// WAV file cannot be begun. A scene without `audio:` and `cues:` opens no device; its WAV file is silence of the run's
/// length.
class Engine {
 public:
  /// `state` must outlive the engine; the engine is the one consumer of `contacts`.
  Engine(scene::ScenePointer scene, std::shared_ptr<haptics::ContactQueue> contacts,
         const haptics::Seqlock<haptics::State>& state, const EngineOptions& options);
  /// Without stop() nothing is left of the WAV file.
  ~Engine();
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;

  /// Returns at once; the sound device is looked for in the background.
  void start();
  /// Call after the session's stop(). Fades and ends the stream and commits the WAV file: at least as long as the run,
  /// with what still rings (5 s at most). Throws Error{failure} when it could not be written.
  void stop();
  /// Empty, or which regions stay silent and, until a sound device plays, why there is no live sound.
  [[nodiscard]] std::string warning() const;
  /// Spoken words, one channel, in the stream that plays, over sounds that become 12 dB softer; none: what is spoken
  /// ends. False when no stream plays. One thread at a time.
  bool speak(const std::vector<float>& words, double rate_hz);
  /// After a new depth scan of the same object; its sounds stay what they are.
  void set_scene(scene::ScenePointer scene);
  /// Strikes so far that made a sound.
  [[nodiscard]] std::uint64_t strikes() const;
  /// True once a sound device plays.
  [[nodiscard]] bool playing() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace sparsha::audio
