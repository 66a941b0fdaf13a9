// The guide as visitors know it: asked for, found, on, holding the hand, let go, off; and the words for each.
#pragma once

#include <future>
#include <memory>
#include <optional>
#include <vector>

#include "haptics/servo/command.h"
#include "haptics/session/announcer.h"
#include "haptics/session/guide_line.h"
#include "haptics/state/state.h"

namespace sparsha::haptics {

/// Session's thread only. Lines are looked for on a thread of their own.
class GuideControl {
 public:
  explicit GuideControl(Announcer& announcer) : announcer_(announcer) {}

  /// On or being looked for. What was dropped while it was looked for is not.
  [[nodiscard]] bool on() const { return on_ || next_ || (looking_.valid() && !dropped_); }
  /// Looks for the line; answered by poll(). A wish while one is looked for takes its place.
  void ask(GuideWish wish);
  /// No guide any more; said unless `silent`. The command for the servo.
  [[nodiscard]] Command stop(bool silent = false);
  /// What was found: a command for the servo, and words.
  [[nodiscard]] std::optional<Command> poll();
  /// Says what the guide does with the hand.
  void watch(const State& state);

 private:
  void look(GuideWish wish);
  void say_way(const GuideAnswer& answer);

  Announcer& announcer_;
  bool on_ = false;
  std::future<GuideAnswer> looking_;
  std::optional<GuideWish> next_;
  bool dropped_ = false;                             // what is looked for is not wanted any more
  std::vector<std::shared_ptr<const Guide>> given_;  // that the servo may still hold
  GuidePhase phase_ = GuidePhase::off;
  std::uint64_t rounds_ = 0;
};

}  // namespace sparsha::haptics
