// Announcements as speech: espeak-ng as a child process, when present.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "haptics/state/requests.h"

namespace sparsha::audio {

struct SpeechOptions {
  std::vector<std::string> programs{"espeak-ng", "espeak"};  ///< the first one on PATH speaks; text comes on its stdin
  int words_per_minute = 170;
  /// Plays spoken words (one channel, and its rate) in the stream of the other sounds, for no words ends what it plays;
  /// false when there is no such stream: then the program plays them itself. Called from a thread of Speech's own.
  std::function<bool(std::vector<float> words, double rate_hz)> play;
  std::string voice;  ///< espeak's voice, of its column Language, e.g. "en" or "hi"; empty = its default
  /// Spoken with when the program refuses `voice`, with the same variant ("+f3"); empty = its default.
  std::string language;
};

/// Newer words interrupt older ones; faults come first and are spoken to their end. Never blocks the caller. The
/// program is started for each announcement, directly and without a shell; it is killed when the object goes.
class Speech {
 public:
  explicit Speech(const SpeechOptions& options = {});
  ~Speech();
  Speech(const Speech&) = delete;
  Speech& operator=(const Speech&) = delete;
  /// False when no speech program is installed. Starts nothing.
  [[nodiscard]] bool available() const;
  void say(const haptics::Announcement& announcement);
  /// From the next words on; 80 to 450 words a minute.
  void set_words_per_minute(int words_per_minute);
  void set_voice(const std::string& voice);
  /// Why words are spoken otherwise than asked for, or not at all: a voice that the program refuses, a program that
  /// fails. Each is returned once; else empty.
  [[nodiscard]] std::string take_problem();
  /// What is being said ends, and what waits is forgotten.
  void be_silent();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace sparsha::audio
