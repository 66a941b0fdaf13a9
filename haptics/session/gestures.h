// Gestures on the buttons and the requests that they stand for.
#pragma once

#include <optional>

#include "haptics/session/buttons.h"
#include "haptics/state/requests.h"

namespace sparsha::haptics {

[[nodiscard]] Request request_of(Gesture gesture);
/// What a key does as a button does it, so that the tour is learnt with either; nothing for other requests.
[[nodiscard]] std::optional<Gesture> gesture_of(const Request& request);

}  // namespace sparsha::haptics
