#include "haptics/session/button_tour.h"

#include <algorithm>
#include <string>
#include <utility>

namespace sparsha::haptics {
namespace {

constexpr double kPatience_s = 11.0;  // five steps in a minute, done or not
constexpr double kLongest_s = 60.0;   // among other words

}  // namespace

void ButtonTour::start(double time_s, bool has_parts, bool grip) {
  steps_ = {{grip ? Phrase("tour_closer") : Phrase("tour_keys_closer"), Gesture::zoom_in, Gesture::zoom_in},
            {grip ? Phrase("tour_farther") : Phrase("tour_keys_farther"), Gesture::zoom_out, Gesture::whole_scene}};
  if (has_parts)
    steps_.push_back(
        {grip ? Phrase("tour_parts") : Phrase("tour_keys_parts"), Gesture::next_part, Gesture::previous_part});
  if (grip) steps_.push_back({"tour_drag", Gesture::let_go, Gesture::let_go});
  steps_.push_back({grip ? Phrase("tour_where") : Phrase("tour_keys_where"), Gesture::describe, Gesture::help});
  step_ = 0;
  since_s_ = done_s_ = time_s;
  tell(grip ? Phrase("tour_begin") : Phrase("tour_keys_begin"), steps_.front().words);
}

void ButtonTour::tell(std::optional<Phrase> first, Phrase words) {
  const Phrases& phrases = announcer_.phrases();
  announcer_.say_as_is((first ? phrases.text(*first) + " " : std::string()) + phrases.text(words));
  said_ = announcer_.said();
}

void ButtonTour::go_on(double time_s, std::optional<Phrase> praise) {
  ++step_;
  since_s_ = time_s;
  tell(praise, running() ? steps_[step_].words : Phrase("tour_end"));
}

void ButtonTour::watch(const std::vector<Gesture>& gestures, double time_s) {
  if (!running()) return;
  const Step& step = steps_[step_];
  const auto made = [&](Gesture one, Gesture other) {
    return std::ranges::any_of(gestures, [&](Gesture gesture) { return gesture == one || gesture == other; });
  };
  if (made(step.awaited, step.also)) {
    done_s_ = time_s;
    return go_on(time_s, Phrase("tour_good"));
  }
  // The hold that began the tour was a call for help, too.
  const bool asks = time_s > done_s_ && made(Gesture::help, Gesture::guide);
  if (asks || time_s - done_s_ > kLongest_s) return stop();
  if (std::exchange(said_, announcer_.said()) != said_) since_s_ = time_s;
  if (time_s - since_s_ > kPatience_s) go_on(time_s, std::nullopt);
}

}  // namespace sparsha::haptics
