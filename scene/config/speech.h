// The configuration's block `speech`.
#pragma once

#include <string>

namespace sparsha::scene {

/// What is announced is spoken.
struct SpeechConfig {
  std::string language = "en";  ///< of configs/speech
  std::string voice;            ///< espeak's name; empty: the language's own
  int words_per_minute = 170;
};

}  // namespace sparsha::scene
