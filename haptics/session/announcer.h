// Finds the words: watches State and says what a visitor who cannot see needs to know, in the visitor's language.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include <Eigen/Geometry>

#include "base/phrases/phrases.h"
#include "haptics/effects/part_watch.h"
#include "haptics/state/requests.h"
#include "haptics/state/state.h"
#include "scene/config/parts.h"
#include "scene/scene_fwd.h"

namespace sparsha::haptics {

/// What the window shows, among all the views that there are.
struct View {
  enum class Kind { whole, closest, closer, farther, present };
  Kind kind = Kind::present;
  double width_m = 0.0;  ///< of the window, grid frame
  double scale = 1.0;    ///< device metres per grid metre
};

/// Session's thread only.
class Announcer {
 public:
  using Priority = Announcement::Priority;
  Announcer(AnnouncementBoard& board, scene::ScenePointer scene, Phrases phrases = Phrases::of("en"));

  void set_scene(scene::ScenePointer scene);
  /// Another language, from the next words on.
  void set_phrases(Phrases phrases) { phrases_ = std::move(phrases); }
  /// Compares with what was said last: parts, unknown areas, edges of the scene.
  void watch(const State& state);
  /// "Closer, 12 centimetres across"; nearer views add how many times the stone's size is felt.
  void say_view(const View& view);
  /// The same with how to get help, where speech begins.
  void say_first(const View& view);
  /// A part that the window goes to, by its index in the scene's list, and the way that leads the hand there, device
  /// frame: "Lotus, 3 centimetres, two o'clock", or "Lotus is under your hand".
  void say_part(std::size_t index, const Eigen::Vector2d& way_m, bool under_hand);
  /// Distance and hour of a way of the hand, device frame; `here` where there is none.
  void say_way(Phrase there, Phrase here, const Eigen::Vector2d& way_m, PhraseValues values = {});
  /// A whole object has been turned: what it shows now; after a small turn, whose start is `from`, only another side.
  void say_turned(const Eigen::Quaterniond& device_from_grid, const Eigen::Quaterniond* from = nullptr);
  /// Where the hand is, at length; asked again on the same part, what else there is to say about it.
  void describe(const State& state, const View& view);
  /// What was said last, once more.
  void repeat();
  void say(Phrase phrase, const PhraseValues& values = {}, Priority priority = Priority::information);
  /// What a driver has to say, in its own words.
  void say_as_is(std::string text, Priority priority = Priority::information,
                 Announcement::Place place = Announcement::Place::anywhere);
  /// Tells speech to become something, and says so.
  void control(Announcement::Control control, Phrase phrase);
  /// How often something was said.
  [[nodiscard]] std::size_t said() const { return said_; }
  [[nodiscard]] const Phrases& phrases() const { return phrases_; }

 private:
  void watch_parts(const State& state);
  void watch_ground(const State& state);
  /// Index into the scene's list.
  [[nodiscard]] std::optional<std::size_t> part_at(const std::array<double, 3>& place_m) const;
  [[nodiscard]] const scene::PartConfig& part(std::size_t index) const;
  [[nodiscard]] std::string view_text(const View& view) const;
  [[nodiscard]] Phrase place_on_stone(const State& state) const;
  [[nodiscard]] Phrase place_on_object(const State& state) const;
  [[nodiscard]] Phrase way_back(const State& state) const;

  AnnouncementBoard& board_;
  scene::ScenePointer scene_;
  Eigen::AlignedBox3d object_m_;  // the whole object, grid frame; empty of one view
  Phrases phrases_;
  std::string last_;  // said
  std::size_t said_ = 0;
  PartWatch parts_;
  std::optional<std::size_t> described_;  // that more can be told about
  bool unknown_ = false;
  double unknown_left_s_ = -1e9;
  bool outside_ = false;
  double outside_left_s_ = -1e9;
};

}  // namespace sparsha::haptics
