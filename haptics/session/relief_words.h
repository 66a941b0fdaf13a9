// Heights in words, for a hand that others follow by ear: steps where they are, slopes when the hand rests.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "haptics/session/announcer.h"
#include "haptics/state/state.h"

namespace sparsha::haptics {

/// Session's thread only. Measures at the hand, where it counts what can be felt, and says it in the stone's own size.
class ReliefWords {
 public:
  ReliefWords(Announcer& announcer, const AnnouncementBoard& board) : announcer_(announcer), board_(board) {}
  /// Every tick that the session sees.
  void watch(const State& state);

 private:
  struct Place {
    Eigen::Vector2d at_m = Eigen::Vector2d::Zero();  // device metres across what is before the visitor
    double height_m = 0.0;                           // towards the visitor, likewise
    double time_s = 0.0;
  };
  void begin(const Place& here, const State& state);
  void watch_step(const Place& here, double scale);
  void watch_rest(const Place& here, double scale);
  void listen(double time_s);
  void say(Phrase up, Phrase down, double rise_m, double scale, double time_s);

  Announcer& announcer_;
  const AnnouncementBoard& board_;
  bool known_ = false;
  double touched_s_ = -1e9;  // when the stone was touched last
  std::uint64_t scene_ = 0;
  double scale_ = 0.0;
  std::array<double, 4> turn_{};  // of a whole object
  Place foot_;                    // where the present slope is measured from
  Place told_;                    // whose height was said last, or begun with
  Place still_;                   // where the hand came to rest
  double step_m_ = 0;             // of the steep ground so far
  double said_s_ = -1e9;
  std::uint64_t heard_ = 0;      // announcements
  double quiet_until_s_ = -1e9;  // others are speaking
};

}  // namespace sparsha::haptics
