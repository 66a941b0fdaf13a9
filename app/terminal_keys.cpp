#include "app/terminal_keys.h"

#include <array>
#include <optional>

namespace sparsha::app {
namespace {

using haptics::Request;
using Kind = Request::Kind;

constexpr double kAgain_s = 0.6;  // a second press within is the same gesture; longer than keyboards wait to repeat
constexpr double kLong_s = 2.0, kLongest_s = 5.0;  // as on the grip
constexpr double kPanWindows = 0.25;

std::optional<Request> arrow(char key) {
  switch (key) {
    case 'A':
      return Request{Kind::pan, 0.0, kPanWindows};
    case 'B':
      return Request{Kind::pan, 0.0, -kPanWindows};
    case 'C':
      return Request{Kind::pan, kPanWindows, 0.0};
    case 'D':
      return Request{Kind::pan, -kPanWindows, 0.0};
    default:
      return std::nullopt;
  }
}

}  // namespace

void TerminalKeys::letter(char key, std::vector<Request>& requests) {
  struct Meaning {
    char key;
    Kind kind;
  };
  constexpr std::array<Meaning, 21> kMeanings{
      {{'+', Kind::zoom_in},       {'=', Kind::zoom_in},      {'-', Kind::zoom_out},     {'n', Kind::next_part},
       {'p', Kind::previous_part}, {'w', Kind::whole_scene},  {' ', Kind::describe},     {'h', Kind::help_keys},
       {'?', Kind::help_keys},     {'t', Kind::tour},         {'r', Kind::repeat},       {'<', Kind::speak_slower},
       {',', Kind::speak_slower},  {'>', Kind::speak_faster}, {'.', Kind::speak_faster}, {'v', Kind::next_voice},
       {'s', Kind::toggle_speech}, {'g', Kind::guide},        {'q', Kind::quit},         {'\r', Kind::describe},
       {'\n', Kind::describe}}};
  const char small = key >= 'A' && key <= 'Z' ? static_cast<char>(key - 'A' + 'a') : key;
  for (const Meaning& meaning : kMeanings)
    if (meaning.key == small) requests.push_back({meaning.kind});
}

void TerminalKeys::end(std::vector<Request>& requests) {
  constexpr std::array<Kind, 4> kClicks{Kind::zoom_in, Kind::whole_scene, Kind::describe, Kind::zoom_out};
  if (pad_ == Pad::pressed) requests.push_back({kClicks.at(button_)});
  pad_ = Pad::idle;
}

void TerminalKeys::digit(std::size_t button, double time_s, std::vector<Request>& requests) {
  constexpr std::array<Kind, 4> kHolds{Kind::next_part, Kind::drag, Kind::help, Kind::previous_part};
  constexpr std::size_t kForward = 1;
  constexpr std::size_t kCentre = 2;
  if (pad_ != Pad::idle && button != button_) end(requests);  // another key ends it
  last_s_ = time_s;
  if (pad_ == Pad::idle && button == kForward && dragging_) {
    dragging_ = false;
    requests.push_back({Kind::drag, 0.0, 0.0, false});
    button_ = button;
    pad_ = Pad::held;  // its repetitions say nothing
    since_s_ = time_s;
    return;
  }
  if (pad_ == Pad::idle) {
    pad_ = Pad::pressed;
    button_ = button;
    since_s_ = time_s;
    longer_ = longest_ = false;
  } else if (pad_ == Pad::pressed) {
    pad_ = Pad::held;
    dragging_ = dragging_ || button == kForward;
    requests.push_back({kHolds.at(button), 0.0, 0.0, true});
  } else if (button != kForward && !longer_ && time_s - since_s_ >= kLong_s) {
    longer_ = true;
    requests.push_back({button == kCentre ? Kind::set_speech : Kind::guide, 0.0, 0.0, true});
  } else if (button == kCentre && !longest_ && time_s - since_s_ >= kLongest_s) {
    longest_ = true;
    requests.push_back({Kind::set_speech, 0.0, 0.0, false});
  }
}

std::vector<Request> TerminalKeys::take(std::string_view typed, double time_s) {
  std::vector<Request> requests;
  if (time_s - last_s_ >= kAgain_s) end(requests);
  for (std::size_t at = 0; at < typed.size(); ++at) {
    const char key = typed[at];
    if (key == '\x1b') {
      // An arrow, or a key that means nothing here: up to its final letter.
      if (at + 1 >= typed.size() || (typed[at + 1] != '[' && typed[at + 1] != 'O')) continue;
      at += 2;
      const std::size_t begin = at;
      while (at < typed.size() && (typed[at] < '@' || typed[at] > '~')) ++at;
      if (at == begin && at < typed.size())
        if (const std::optional<Request> pan = arrow(typed[at])) requests.push_back(*pan);
    } else if (key >= '1' && key <= '4') {
      digit(static_cast<std::size_t>(key - '1'), time_s, requests);
    } else {
      letter(key, requests);
    }
  }
  return requests;
}

}  // namespace sparsha::app
