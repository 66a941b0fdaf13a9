// A session under a hand that a test puts somewhere, and what the session has said.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "haptics/device/pointer/pointer_device.h"
#include "haptics/session/session.h"
#include "tests/support/servo_parts.h"

namespace sparsha::haptics {

/// A hand at a fixed place, moved by the test.
class Placed {
 public:
  Placed() : place(std::make_shared<Seqlock<PointerSample>>()) { put(0.0, 0.0, 0.02); }
  void put(double x, double y, double z, std::uint64_t buttons = 0) {
    place->publish({{x, y, z}, buttons, ++sequence});
  }
  std::shared_ptr<Seqlock<PointerSample>> place;
  std::uint64_t sequence = 0;
};

inline bool poll_until(Session& session, const std::function<bool()>& so) {
  return eventually([&] {
    session.poll();
    return so();
  });
}

/// Puts the hand down on level stone until `so`. A loop that was late gives no force until the hand has been in the air
/// for a while: it comes down only where forces are delivered, and is lifted wherever they end.
inline bool press_until(Session& session, Placed& hand, double x, double y, const std::function<bool()>& so) {
  hand.put(x, y, 0.02);
  if (!poll_until(session, [&] { return session.state().read().contact == 0; })) return false;
  return poll_until(session, [&] {
    if (so()) return true;
    hand.put(x, y, (session.state().read().flags & kFlagArmed) != 0 ? -0.004 : 0.02);
    return false;
  });
}

inline std::vector<std::string> words(Session& session) {
  std::vector<std::string> result;
  for (const Announcement& a : session.announcements().since(0)) result.push_back(a.text);
  return result;
}

inline bool said(Session& session, const std::string& text) {
  const auto all = words(session);
  return std::any_of(all.begin(), all.end(), [&](const std::string& w) { return w.find(text) != std::string::npos; });
}

}  // namespace sparsha::haptics
