#include "app/terminal/terminal_keys.h"

#include <array>
#include <optional>

namespace sparsha::app {
namespace {

using haptics::Request;
using Kind = Request::Kind;

constexpr double kAgain_s = 0.6;  // a second press within is the same gesture; longer than keyboards wait to repeat
constexpr double kLong_s = 2.0, kLongest_s = 5.0;  // as on the grip
constexpr double kPanWindows = 0.25;

/// X, Y and Z turn a whole object about that axis of the device, with shift the other way; B shows its front again.
std::optional<Request> turn_of(char key) {
  constexpr double kTurn_deg = 45.0;
  switch (key) {
    case 'x':
    case 'X':
      return Request{Kind::turn, key == 'x' ? kTurn_deg : -kTurn_deg};
    case 'y':
    case 'Y':
      return Request{Kind::turn, 0.0, key == 'y' ? kTurn_deg : -kTurn_deg};
    case 'z':
    case 'Z':
      return Request{Kind::turn, 0.0, 0.0, false, key == 'z' ? kTurn_deg : -kTurn_deg};
    case 'b':
    case 'B':
      return Request{Kind::turn_back};
    default:
      return std::nullopt;
  }
}

std::optional<Request> arrow(TypedKey::Kind key) {
  switch (key) {
    case TypedKey::Kind::up:
      return Request{Kind::pan, 0.0, kPanWindows};
    case TypedKey::Kind::down:
      return Request{Kind::pan, 0.0, -kPanWindows};
    case TypedKey::Kind::right:
      return Request{Kind::pan, kPanWindows, 0.0};
    case TypedKey::Kind::left:
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
  constexpr std::array<Meaning, 22> kMeanings{
      {{'+', Kind::zoom_in},       {'=', Kind::zoom_in},      {'-', Kind::zoom_out},     {'n', Kind::next_part},
       {'p', Kind::previous_part}, {'w', Kind::whole_scene},  {' ', Kind::describe},     {'h', Kind::help_keys},
       {'?', Kind::help_keys},     {'t', Kind::tour},         {'r', Kind::repeat},       {'<', Kind::speak_slower},
       {',', Kind::speak_slower},  {'>', Kind::speak_faster}, {'.', Kind::speak_faster}, {'v', Kind::next_voice},
       {'s', Kind::toggle_speech}, {'g', Kind::guide},        {'5', Kind::describe},     {'q', Kind::quit},
       {'\r', Kind::describe},     {'\n', Kind::describe}}};
  if (const std::optional<Request> turn = turn_of(key)) return requests.push_back(*turn);
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

std::vector<Request> TerminalKeys::take(const std::vector<TypedKey>& typed, double time_s) {
  std::vector<Request> requests;
  if (time_s - last_s_ >= kAgain_s) end(requests);
  for (const TypedKey& key : typed) {
    if (key.kind == TypedKey::Kind::middle) {
      requests.push_back({Kind::describe});
    } else if (key.kind != TypedKey::Kind::letter) {
      if (const std::optional<Request> pan = arrow(key.kind)) requests.push_back(*pan);
    } else if (key.letter >= '1' && key.letter <= '4') {
      digit(static_cast<std::size_t>(key.letter - '1'), time_s, requests);
    } else {
      letter(key.letter, requests);
    }
  }
  return requests;
}

}  // namespace sparsha::app
