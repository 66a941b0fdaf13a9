// Announcements as speech that visitors control: on and off, slower, faster, another voice.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "audio/speech/speech.h"
#include "haptics/state/requests.h"
#include "scene/config/speech.h"

namespace sparsha::app {

/// One thread. Starts no process before it is on.
class Speaker {
 public:
  /// Where spoken words are played; see audio::SpeechOptions.
  using Play = std::function<bool(std::vector<float>, double)>;
  Speaker(const scene::SpeechConfig& config, bool on, Play play);

  /// Another scene's: its language, voice and rate, where they differ from the present ones, from the next words on.
  /// `first_on`: whether the next visitor finds it on, where that is not `on`.
  void use(const scene::SpeechConfig& config, bool on, std::optional<bool> first_on = {});
  /// Does what the announcement asks of speech, and says it while speech is on. "Speech off" is the last that is said.
  void hear(const haptics::Announcement& announcement);
  /// False when speech is on and no speech program is installed.
  [[nodiscard]] bool available() const { return !speech_ || speech_->available(); }
  /// See audio::Speech::take_problem().
  [[nodiscard]] std::string take_problem() { return speech_ ? speech_->take_problem() : std::string(); }
  [[nodiscard]] bool on() const { return on_; }
  [[nodiscard]] int words_per_minute() const { return words_per_minute_; }
  [[nodiscard]] const std::string& voice() const { return voices_[voice_]; }

 private:
  void start();
  void take(const scene::SpeechConfig& config);

  Play play_;
  scene::SpeechConfig config_;
  int words_per_minute_ = 0;
  std::vector<std::string> voices_;
  std::size_t voice_ = 0;
  bool on_ = false;
  bool first_on_ = false;
  std::optional<audio::Speech> speech_;
};

}  // namespace sparsha::app
