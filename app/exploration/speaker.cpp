#include "app/exploration/speaker.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sparsha::app {
namespace {

constexpr double kStep = 1.2;  // of the rate
constexpr int kSlowest = 80;   // words a minute
constexpr int kFastest = 450;

}  // namespace

Speaker::Speaker(const scene::SpeechConfig& config, bool on, Play play) : play_(std::move(play)) {
  take(config);
  use(config, on);
}

void Speaker::take(const scene::SpeechConfig& config) {
  config_ = config;
  words_per_minute_ = config.words_per_minute;
  const std::string voice = config.voice.empty() ? config.language : config.voice;
  // espeak speaks any language with these variants.
  voices_ = {voice, voice + "+f3", voice + "+m3", voice + "+f2"};
  voice_ = 0;
}

void Speaker::use(const scene::SpeechConfig& config, bool on, std::optional<bool> first_on) {
  const bool same = config.language == config_.language && config.voice == config_.voice &&
                    config.words_per_minute == config_.words_per_minute;
  if (!same) {
    take(config);
    speech_.reset();  // ends what is being said
  }
  if (on_ && !on && speech_) speech_->be_silent();
  on_ = on;
  first_on_ = first_on.value_or(on);
  if (on_) start();
}

void Speaker::start() {
  if (speech_) return;
  audio::SpeechOptions options;
  options.words_per_minute = words_per_minute_;
  options.voice = voice();
  options.language = config_.language;
  options.play = play_;
  speech_.emplace(options);
}

void Speaker::hear(const haptics::Announcement& announcement) {
  using Control = haptics::Announcement::Control;
  switch (announcement.control) {
    case Control::none:
      break;
    case Control::slower:
    case Control::faster: {
      const double factor = announcement.control == Control::faster ? kStep : 1.0 / kStep;
      words_per_minute_ = std::clamp(static_cast<int>(std::lround(words_per_minute_ * factor)), kSlowest, kFastest);
      if (speech_) speech_->set_words_per_minute(words_per_minute_);
      break;
    }
    case Control::next_voice:
      voice_ = (voice_ + 1) % voices_.size();
      if (speech_) speech_->set_voice(voice());
      break;
    case Control::reset:
      words_per_minute_ = config_.words_per_minute;
      voice_ = 0;
      on_ = first_on_;
      if (on_) start();
      if (!speech_) return;
      speech_->be_silent();
      speech_->set_words_per_minute(words_per_minute_);
      speech_->set_voice(voice());
      return;
    case Control::toggle:
      on_ = !on_;
      start();
      // What was being said ends; the words that follow are the last.
      speech_->be_silent();
      speech_->say(announcement);
      return;
  }
  if (on_) speech_->say(announcement);
}

}  // namespace sparsha::app
