#include "haptics/session/button_tour.h"

#include <algorithm>
#include <string>

namespace sparsha::haptics {
namespace {

constexpr double kPatience_s = 11.0;  // five steps in a minute, done or not

}  // namespace

void ButtonTour::start(double time_s, bool has_parts) {
  steps_ = {{"tour_closer", Gesture::zoom_in, Gesture::zoom_in},
            {"tour_farther", Gesture::zoom_out, Gesture::whole_scene},
            {"tour_parts", Gesture::next_part, Gesture::previous_part},
            {"tour_drag", Gesture::let_go, Gesture::let_go},
            {"tour_where", Gesture::describe, Gesture::help}};
  if (!has_parts) steps_.erase(steps_.begin() + 2);
  step_ = 0;
  since_s_ = time_s;
  tell(Phrase("tour_begin"), steps_.front().words);
}

void ButtonTour::tell(std::optional<Phrase> first, Phrase words) {
  const Phrases& phrases = announcer_.phrases();
  announcer_.say_as_is((first ? phrases.text(*first) + " " : std::string()) + phrases.text(words));
}

void ButtonTour::go_on(double time_s, std::optional<Phrase> praise) {
  ++step_;
  since_s_ = time_s;
  tell(praise, running() ? steps_[step_].words : Phrase("tour_end"));
}

void ButtonTour::watch(const std::vector<Gesture>& gestures, double time_s) {
  if (!running()) return;
  const Step& step = steps_[step_];
  const bool done = std::any_of(gestures.begin(), gestures.end(),
                                [&](Gesture gesture) { return gesture == step.awaited || gesture == step.also; });
  if (done)
    go_on(time_s, Phrase("tour_good"));
  else if (time_s - since_s_ > kPatience_s)
    go_on(time_s, std::nullopt);
}

}  // namespace sparsha::haptics
