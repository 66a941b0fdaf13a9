#include "haptics/session/button_tour.h"

#include <algorithm>
#include <string>

namespace sparsha::haptics {
namespace {

constexpr double kPatienceS = 11.0;  // five steps in a minute, done or not

}  // namespace

const char* button_help() {
  return "Right button: closer. Left button: farther. Held, they go to the next and the previous part. "
         "Front button: hold it and move to drag the stone; a click shows the whole of it. "
         "Middle button: where am I. Hold the middle button again for a tour of the buttons.";
}

void ButtonTour::start(double time_s, bool has_parts) {
  steps_ = {{"Press the right button to come closer.", Gesture::zoom_in, Gesture::zoom_in},
            {"Press the left button to go farther away.", Gesture::zoom_out, Gesture::whole_scene},
            {"Hold the right button for the next part, the left one for the previous part.", Gesture::next_part,
             Gesture::previous_part},
            {"Hold the front button and move your hand: the stone comes with it. Then let go.", Gesture::let_go,
             Gesture::let_go},
            {"Press the middle button: it says where you are. Held, it helps.", Gesture::describe, Gesture::help}};
  if (!has_parts) steps_.erase(steps_.begin() + 2);
  step_ = 0;
  since_s_ = time_s;
  announcer_.say(std::string("The grip has four buttons. ") + steps_.front().words);
}

void ButtonTour::go_on(double time_s, const char* praise) {
  ++step_;
  since_s_ = time_s;
  announcer_.say(std::string(praise) + (running() ? steps_[step_].words : "That is all of them."));
}

void ButtonTour::watch(const std::vector<Gesture>& gestures, double time_s) {
  if (!running()) return;
  const Step& step = steps_[step_];
  const bool done = std::any_of(gestures.begin(), gestures.end(),
                                [&](Gesture gesture) { return gesture == step.awaited || gesture == step.also; });
  if (done)
    go_on(time_s, "Good. ");
  else if (time_s - since_s_ > kPatienceS)
    go_on(time_s, "");
}

}  // namespace sparsha::haptics
