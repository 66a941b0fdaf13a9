#include "haptics/session/announcer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/text/text.h"
#include "haptics/around/object_surface.h"
#include "haptics/state/stone_gives.h"
#include "haptics/state/vectors.h"
#include "scene/area/regions.h"
#include "scene/scene.h"

namespace sparsha::haptics {
namespace {

constexpr double kSilence_s = 1.0;  // the same thing is said again only after so long an absence

/// Of the sides of an object the one that looks most in a direction of the grid frame.
scene::Side nearest_side(const Eigen::Vector3d& direction) {
  Eigen::Index axis = 0;
  direction.cwiseAbs().maxCoeff(&axis);
  return static_cast<scene::Side>(2 * axis + (direction[axis] < 0.0 ? 1 : 0));
}

Phrase side_of(const Eigen::Vector3d& direction) {
  constexpr std::array<Phrase, scene::kSides> kSides{"side_right", "side_left",  "side_up",
                                                     "side_down",  "side_front", "side_back"};
  return kSides.at(static_cast<std::size_t>(nearest_side(direction)));
}

/// A side as somebody sees it who has it before him, grid frame: of the top the front is below, of the bottom above.
struct Seen {
  Eigen::Vector3d right, up;

  [[nodiscard]] static Seen of(scene::Side side) {
    using Eigen::Vector3d;
    switch (side) {
      case scene::Side::right:
        return {-Vector3d::UnitZ(), Vector3d::UnitY()};
      case scene::Side::left:
        return {Vector3d::UnitZ(), Vector3d::UnitY()};
      case scene::Side::up:
        return {Vector3d::UnitX(), -Vector3d::UnitZ()};
      case scene::Side::down:
        return {Vector3d::UnitX(), Vector3d::UnitZ()};
      case scene::Side::front:
        break;
      case scene::Side::back:
        return {-Vector3d::UnitX(), Vector3d::UnitY()};
    }
    return {Vector3d::UnitX(), Vector3d::UnitY()};
  }
};

/// By the thirds, each 0 to 2, in which a place lies across and up.
Phrase place_in_thirds(std::size_t across, std::size_t up) {
  constexpr std::array<std::array<Phrase, 3>, 3> kPlaces{{{"place_lower_left", "place_lower", "place_lower_right"},
                                                          {"place_left", "place_middle", "place_right"},
                                                          {"place_upper_left", "place_upper", "place_upper_right"}}};
  return kPlaces.at(up).at(across);
}

std::size_t third(double at, double from, double to) {
  const double share = (at - from) / (to - from);
  return share < 1.0 / 3.0 ? 0 : share <= 2.0 / 3.0 ? 1 : 2;
}

/// Of a whole object, grid frame.
Eigen::AlignedBox3d object_box(const scene::SceneDescription& scene) {
  return scene.charts ? box_of(*scene.charts).translated(scene.charts->origin_m) : Eigen::AlignedBox3d();
}

}  // namespace

Announcer::Announcer(AnnouncementBoard& board, scene::ScenePointer scene, Phrases phrases)
    : board_(board),
      scene_(std::move(scene)),
      object_m_(object_box(scene_->description())),
      phrases_(std::move(phrases)) {}

const scene::PartConfig& Announcer::part(std::size_t index) const {
  return scene_->description().config.parts.at(index);
}

void Announcer::set_scene(scene::ScenePointer scene) {
  scene_ = std::move(scene);
  object_m_ = object_box(scene_->description());
  parts_.forget();
  described_.reset();
  unknown_ = false;
  outside_ = false;
}

void Announcer::say(Phrase phrase, const PhraseValues& values, Priority priority) {
  say_as_is(phrases_.text(phrase, values), priority);
}

void Announcer::say_as_is(std::string text, Priority priority, Announcement::Place place) {
  last_ = text;
  ++said_;
  board_.say(std::move(text), priority, Announcement::Control::none, place);
}

void Announcer::repeat() {
  if (last_.empty()) return;
  ++said_;
  board_.say(last_);
}

void Announcer::control(Announcement::Control control, Phrase phrase) {
  ++said_;
  board_.say(phrases_.text(phrase), Priority::information, control);
}

std::optional<std::size_t> Announcer::part_at(const std::array<double, 3>& place_m) const {
  const scene::PartConfig* const part = scene::part_at(scene_->description(), place_m);
  if (part == nullptr) return std::nullopt;
  return static_cast<std::size_t>(part - scene_->description().config.parts.data());
}

void Announcer::watch(const State& state) {
  constexpr double kOffTheStone_s = 1.0;  // since the last touch; a hand that flies across says nothing
  const bool touching = stone_gives(state);
  const bool fallen = !touching && (state.flags & (kFlagUnknownArea | kFlagOutside)) != 0 &&
                      state.time_s - state.touched_s < kOffTheStone_s;
  if (touching) watch_parts(state);
  if (touching || fallen) watch_ground(state);
}

void Announcer::watch_parts(const State& state) {
  constexpr double kWellInside_m = 0.002;  // from a border, at the hand
  const auto part_here = [&](const Eigen::Vector2d& at_m) { return part_at({at_m.x(), at_m.y(), state.place_m[2]}); };
  if (const std::optional<std::size_t> here =
          parts_.watch({state.place_m[0], state.place_m[1]}, kWellInside_m / state.scale, state.time_s, part_here)) {
    say_as_is(part(*here).say, Priority::information, Announcement::Place::part);
    described_ = here;  // the next press tells more
  }
}

// A hand that has fallen off the stone is told of it, too.
void Announcer::watch_ground(const State& state) {
  const auto say_here = [this](Phrase phrase, Announcement::Place place) {
    say_as_is(phrases_.text(phrase), Priority::information, place);
  };
  const bool outside = (state.flags & kFlagOutside) != 0;
  if (outside && !outside_ && state.time_s - outside_left_s_ > kSilence_s)
    say_here(way_back(state), Announcement::Place::edge);
  if (outside) outside_left_s_ = state.time_s;
  outside_ = outside;
  const bool unknown = (state.flags & kFlagUnknownArea) != 0 && !outside;
  if (unknown && !unknown_ && state.time_s - unknown_left_s_ > kSilence_s)
    say_here("not_measured", Announcement::Place::unmeasured);
  if (unknown) unknown_left_s_ = state.time_s;
  unknown_ = unknown;
}

// From the edge that the hand has passed the farthest; from a rim inside the grid, towards the grid's middle.
Phrase Announcer::way_back(const State& state) const {
  const scene::Lattice& lattice = scene_->description().levels.front();
  const double left_m = lattice.x_m(0) - state.proxy_m[0];
  const double right_m = state.proxy_m[0] - lattice.x_m(lattice.nx - 1);
  const double below_m = lattice.y_m(0) - state.proxy_m[1];
  const double above_m = state.proxy_m[1] - lattice.y_m(lattice.ny - 1);
  // Distances beyond an edge; inside, the nearest edge has the largest of four negative numbers.
  if (std::max(left_m, right_m) >= std::max(below_m, above_m))
    return left_m > right_m ? Phrase("edge_go_right") : Phrase("edge_go_left");
  return below_m > above_m ? Phrase("edge_go_up") : Phrase("edge_go_down");
}

std::string Announcer::view_text(const View& view) const {
  constexpr double kOwnSize = 0.05;  // a few nodes cannot be exactly 1:1
  std::string size;                  // none for a view that is smaller than the stone
  if (view.scale >= 1.0 + kOwnSize)
    size = phrases_.text("size_times", {{"times", value_text(view.scale, view.scale < 9.5 ? 2 : 1)}});
  else if (view.scale >= 1.0 - kOwnSize)
    size = phrases_.text("size_own");
  constexpr std::array<Phrase, 5> kViews{"view_whole", "view_closest", "view_closer", "view_farther", "view_present"};
  return phrases_.text(kViews.at(static_cast<std::size_t>(view.kind)),
                       {{"distance", phrases_.distance(view.width_m)}, {"size", size}});
}

void Announcer::say_turned(const Eigen::Quaterniond& device_from_grid, const Eigen::Quaterniond* from) {
  const auto shown = [this](const Eigen::Quaterniond& turn) {
    return phrases_.text(side_of(turn.conjugate() * Eigen::Vector3d::UnitZ()));
  };
  const std::string side = shown(device_from_grid);
  if (from == nullptr || shown(*from) != side) say("turned", {{"side", side}});
}

void Announcer::say_view(const View& view) { say_as_is(view_text(view)); }

void Announcer::say_first(const View& view) { say("first_words", {{"view", view_text(view)}}); }

void Announcer::say_part(std::size_t index, const Eigen::Vector2d& way_m, bool under_hand) {
  described_ = index;
  const PhraseValues values{{"part", part(index).say}};
  if (under_hand) return say("part_under", values);
  say_way("part_way", "part_under", way_m, values);
}

void Announcer::say_way(Phrase there, Phrase here, const Eigen::Vector2d& way_m, PhraseValues values) {
  constexpr std::array<Phrase, 12> kClock{"clock_12", "clock_1", "clock_2", "clock_3", "clock_4",  "clock_5",
                                          "clock_6",  "clock_7", "clock_8", "clock_9", "clock_10", "clock_11"};
  constexpr double kHere_m = 0.0005;
  if (way_m.norm() < kHere_m) return say(here, values);
  const double turns = std::atan2(way_m.x(), way_m.y()) / (2.0 * std::numbers::pi);  // from twelve o'clock, clockwise
  const auto hour = static_cast<std::size_t>(std::lround(12.0 * (turns + 1.0))) % kClock.size();
  values.emplace_back("distance", phrases_.distance(way_m.norm()));
  values.emplace_back("clock", phrases_.text(kClock.at(hour)));
  say(there, values);
}

// In thirds of the grid.
Phrase Announcer::place_on_stone(const State& state) const {
  if ((state.flags & kFlagAround) != 0 && !object_m_.isEmpty()) return place_on_object(state);
  const scene::Lattice& lattice = scene_->description().levels.front();
  return place_in_thirds(third(state.proxy_m[0], lattice.x_m(0), lattice.x_m(lattice.nx - 1)),
                         third(state.proxy_m[1], lattice.y_m(0), lattice.y_m(lattice.ny - 1)));
}

// In thirds of the object, as the side is seen that the hand is on, or, in the air, that is before the visitor.
Phrase Announcer::place_on_object(const State& state) const {
  const Eigen::Quaterniond turn(state.turn[3], state.turn[0], state.turn[1], state.turn[2]);
  const Eigen::Vector3d towards =
      state.contact != 0 ? to_vector(state.normal) : Eigen::Vector3d(turn.conjugate() * Eigen::Vector3d::UnitZ());
  const Seen seen = Seen::of(nearest_side(towards));
  const auto third_along = [&](const Eigen::Vector3d& axis) {
    const double a_m = axis.dot(object_m_.min()), b_m = axis.dot(object_m_.max());
    return third(axis.dot(to_vector(state.proxy_m)), std::min(a_m, b_m), std::max(a_m, b_m));
  };
  return place_in_thirds(third_along(seen.right), third_along(seen.up));
}

void Announcer::describe(const State& state, const View& view) {
  const std::optional<std::size_t> here = part_at(state.place_m);
  const bool again = here && here == described_ && !part(*here).more.empty();
  described_ = again ? std::nullopt : here;
  if (again) return say_as_is(part(*here).more);
  const Phrase touching = stone_gives(state) ? Phrase("touching") : Phrase("touching_without_force");
  std::string contact = phrases_.text(state.contact != 0 ? touching : Phrase("in_the_air"));
  if ((state.flags & kFlagOutside) != 0)
    contact += ", " + phrases_.text("outside");
  else if ((state.flags & kFlagUnknownArea) != 0)
    contact += ", " + phrases_.text("not_measured");
  std::string place = phrases_.text(place_on_stone(state));
  if ((state.flags & kFlagAround) != 0 && state.contact != 0)
    place =
        phrases_.text("place_on_side", {{"side", phrases_.text(side_of(to_vector(state.normal)))}, {"place", place}});
  const PhraseValues values{{"part", here ? part(*here).say : std::string()},
                            {"place", place},
                            {"view", view_text(view)},
                            {"contact", contact}};
  say(here ? Phrase("where_part") : Phrase("where"), values);
}

}  // namespace sparsha::haptics
