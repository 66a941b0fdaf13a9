// Finds the words: watches State and says what a visitor who cannot see needs to know.
#pragma once

#include <cstdint>
#include <string>

#include "haptics/state/requests.h"
#include "haptics/state/state.h"
#include "scene/scene.h"

namespace sparsha::haptics {

/// Session's thread only.
class Announcer {
 public:
  Announcer(AnnouncementBoard& board, pipeline::ScenePointer scene);

  void set_scene(pipeline::ScenePointer scene);
  /// Compares with what was said last: parts, unknown areas, edges of the scene.
  void watch(const State& state);
  /// "Level 2 of 4, 12 centimetres across"; nearer views add how many times the stone's size is felt.
  /// `scale`: device metres per grid metre.
  void say_level(int level, double width_m, double scale);
  /// A part that the window goes to, and its way from the hand, grid frame: "Lotus, 12 centimetres, two o'clock".
  void say_part(const pipeline::PartConfig& part, const Eigen::Vector2d& way_m);
  /// Where the hand is, at length.
  void describe(const State& state, double width_m);
  void say(std::string text, Announcement::Priority priority = Announcement::Priority::information);

 private:
  [[nodiscard]] const pipeline::PartConfig* part_at(const State& state) const;

  AnnouncementBoard& board_;
  pipeline::ScenePointer scene_;
  std::string part_;           // name of the part last spoken
  double part_left_s_ = -1e9;  // when the hand was last on it
  bool unknown_ = false;
  double unknown_left_s_ = -1e9;
  bool outside_ = false;
  double outside_left_s_ = -1e9;
};

}  // namespace sparsha::haptics
