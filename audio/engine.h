// Sound from touch: modal notes or clips of regions, struck at first contact, and the scrape of friction.
// Two sinks of the same synthesiser: a PortAudio stream, or a WAV file whose time 0 is the servo's.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "haptics/state/seqlock.h"
#include "haptics/state/spsc_queue.h"
#include "haptics/state/state.h"
#include "scene/scene.h"

namespace sparsha::audio {

struct EngineOptions {
  std::filesystem::path wav;  ///< --audio-out; empty = none
  bool live = true;           ///< open a PortAudio stream; without a sound device a warning and silence
  int wav_bits = 16;          ///< 16 (dithered) or 24
};

/// Loads clips into memory and makes the voices. Throws Error{input} for an unreadable clip, Error{failure} when the
/// WAV file cannot be begun. A scene without `audio:` opens no device; its WAV file is silence of the run's length.
class Engine {
 public:
  /// `state` must outlive the engine; the engine is the one consumer of `contacts`.
  Engine(pipeline::ScenePointer scene, std::shared_ptr<haptics::ContactQueue> contacts,
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
  /// Empty, or why there is no live sound and which regions stay silent.
  [[nodiscard]] std::string warning() const;
  /// Strikes so far that made a sound.
  [[nodiscard]] std::uint64_t strikes() const;
  /// True once a sound device plays.
  [[nodiscard]] bool playing() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace sparsha::audio
