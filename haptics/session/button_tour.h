// A minute in which a first-time visitor learns the buttons of the grip, or the keys, by using them.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "haptics/session/announcer.h"
#include "haptics/session/buttons.h"

namespace sparsha::haptics {

/// Says what to do, waits until it is done or for some seconds without other words, and goes on. It ends when the
/// visitor asks for help or the guide in between, and a minute after the last step that was done. Session's thread
/// only.
class ButtonTour {
 public:
  explicit ButtonTour(Announcer& announcer) : announcer_(announcer) {}

  /// Begins, or begins anew. Without named parts their step is left out. `grip`: the buttons of one, else the keys.
  void start(double time_s, bool has_parts, bool grip = true);
  void stop() { step_ = steps_.size(); }
  [[nodiscard]] bool running() const { return step_ < steps_.size(); }
  void watch(const std::vector<Gesture>& gestures, double time_s);

 private:
  struct Step {
    Phrase words;
    Gesture awaited;
    Gesture also;
  };
  void go_on(double time_s, std::optional<Phrase> praise);
  void tell(std::optional<Phrase> first, Phrase words);

  Announcer& announcer_;
  std::vector<Step> steps_;
  std::size_t step_ = 0;
  double since_s_ = 0.0;  // of the last words, the tour's or others
  double done_s_ = 0.0;   // of the last step that was done
  std::size_t said_ = 0;  // Announcer::said() then
};

}  // namespace sparsha::haptics
