#include "haptics/session/gestures.h"

namespace sparsha::haptics {
namespace {

constexpr double kTurn_deg = 45.0;

}  // namespace

Request request_of(Gesture gesture) {
  using Kind = Request::Kind;
  switch (gesture) {
    case Gesture::zoom_in:
      return {Kind::zoom_in};
    case Gesture::zoom_out:
      return {Kind::zoom_out};
    case Gesture::next_part:
      return {Kind::next_part, 0.0, 0.0, true};
    case Gesture::previous_part:
      return {Kind::previous_part, 0.0, 0.0, true};
    case Gesture::whole_scene:
      return {Kind::whole_scene};
    case Gesture::drag:
      return {Kind::drag, 0.0, 0.0, true};
    case Gesture::let_go:
      return {Kind::drag, 0.0, 0.0, false};
    case Gesture::help:
      return {Kind::help};
    case Gesture::guide:
      return {Kind::guide, 0.0, 0.0, true};
    case Gesture::turn_right:
      return {Kind::turn, 0.0, kTurn_deg};
    case Gesture::turn_left:
      return {Kind::turn, 0.0, -kTurn_deg};
    case Gesture::tip:
      return {Kind::turn, kTurn_deg, 0.0};
    case Gesture::speech_on:
    case Gesture::speech_off:
      return {Kind::set_speech, 0.0, 0.0, gesture == Gesture::speech_on};
    case Gesture::describe:
      break;
  }
  return {Kind::describe};
}

std::optional<Gesture> gesture_of(const Request& request) {
  using Kind = Request::Kind;
  switch (request.kind) {
    case Kind::zoom_in:
      return Gesture::zoom_in;
    case Kind::zoom_out:
      return Gesture::zoom_out;
    case Kind::next_part:
      return Gesture::next_part;
    case Kind::previous_part:
      return Gesture::previous_part;
    case Kind::whole_scene:
      return Gesture::whole_scene;
    case Kind::drag:
      return request.on ? Gesture::drag : Gesture::let_go;
    case Kind::describe:
      return Gesture::describe;
    case Kind::guide:
      return Gesture::guide;
    case Kind::help:
    case Kind::help_keys:
      return Gesture::help;
    default:
      return std::nullopt;
  }
}

}  // namespace sparsha::haptics
