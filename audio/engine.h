// Sound from touch: modal notes or clips of regions, struck at first contact, and the scrape of friction.
// Two sinks: a PortAudio stream, or a WAV file whose time 0 is the servo's.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "haptics/shared/seqlock.h"
#include "haptics/shared/spsc_queue.h"
#include "haptics/shared/state.h"
#include "pipeline/scene/scene.h"

namespace sparsha::audio {

struct EngineOptions {
  std::filesystem::path wav;   ///< --audio-out; empty = none
  bool live = true;            ///< open a PortAudio stream; without a sound device a warning and silence
};

/// Loads clips into memory and makes the voices. Throws Error{input} for an unreadable clip.
class Engine {
 public:
  Engine(pipeline::ScenePointer scene, std::shared_ptr<haptics::ContactQueue> contacts,
         const haptics::Seqlock<haptics::State>& state, const EngineOptions& options);
  ~Engine();
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;

  void start();
  /// Ends the stream and commits the WAV file. Throws Error{failure} when it could not be written.
  void stop();
  /// Empty, or why there is no live sound.
  [[nodiscard]] std::string warning() const;
  [[nodiscard]] std::uint64_t strikes() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace sparsha::audio
