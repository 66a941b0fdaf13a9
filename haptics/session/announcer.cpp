#include "haptics/session/announcer.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/text.h"
#include "scene/regions.h"

namespace sparsha::haptics {
namespace {

constexpr double kSilenceS = 1.0;  // the same thing is said again only after so long an absence

/// Words for a view that shows the stone at its own size or larger; none for smaller ones.
std::string magnification_text(double scale) {
  constexpr double kOwnSize = 0.05;  // a few nodes cannot be exactly 1:1
  if (scale < 1.0 - kOwnSize) return {};
  if (scale < 1.0 + kOwnSize) return ", at its own size";
  const double whole = std::round(scale);
  if (std::abs(scale - whole) < kOwnSize * whole) return fmt::format(", {:.0f} times its size", whole);
  return fmt::format(", {:.1f} times its size", scale);
}

/// Where something is along one axis, seen from an edge.
std::string from_edge(double metres, const char* edge) {
  return fmt::format("{} {} the {} edge", length_text(std::abs(metres), TextStyle::spoken),
                     metres < 0.0 ? "beyond" : "from", edge);
}

}  // namespace

Announcer::Announcer(AnnouncementBoard& board, pipeline::ScenePointer scene)
    : board_(board), scene_(std::move(scene)) {}

void Announcer::set_scene(pipeline::ScenePointer scene) {
  scene_ = std::move(scene);
  part_.clear();
  unknown_ = false;
  outside_ = false;
}

void Announcer::say(std::string text, Announcement::Priority priority) { board_.say(std::move(text), priority); }

const pipeline::PartConfig* Announcer::part_at(const State& state) const {
  return pipeline::part_at(scene_->description(), state.place_m);
}

void Announcer::watch(const State& state) {
  if (state.contact == 0) return;
  if (const pipeline::PartConfig* part = part_at(state)) {
    if (part->name != part_ || state.time_s - part_left_s_ > kSilenceS) say(part->say.empty() ? part->name : part->say);
    part_ = part->name;
    part_left_s_ = state.time_s;
  }
  const bool outside = (state.flags & kFlagOutside) != 0;
  if (outside && !outside_ && state.time_s - outside_left_s_ > kSilenceS) say("Edge of the scene");
  if (outside) outside_left_s_ = state.time_s;
  outside_ = outside;
  const bool unknown = (state.flags & kFlagUnknownArea) != 0 && !outside;
  if (unknown && !unknown_ && state.time_s - unknown_left_s_ > kSilenceS) say("Not measured here");
  if (unknown) unknown_left_s_ = state.time_s;
  unknown_ = unknown;
}

void Announcer::say_level(int level, double width_m, double scale) {
  const std::size_t count = scene_->description().levels.size();
  say(fmt::format("Level {} of {}, {} across{}", level + 1, count, length_text(width_m, TextStyle::spoken),
                  magnification_text(scale)));
}

void Announcer::say_part(const pipeline::PartConfig& part, const Eigen::Vector2d& way_m) {
  constexpr std::array<const char*, 12> kHours{"twelve", "one",   "two",   "three", "four", "five",
                                               "six",    "seven", "eight", "nine",  "ten",  "eleven"};
  const double turns = std::atan2(way_m.x(), way_m.y()) / (2.0 * std::numbers::pi);  // from twelve o'clock, clockwise
  const auto hour = static_cast<std::size_t>(std::lround(12.0 * (turns + 1.0))) % kHours.size();
  say(fmt::format("{}, {}, {} o'clock", part.say.empty() ? part.name : part.say,
                  length_text(way_m.norm(), TextStyle::spoken), kHours[hour]));
}

void Announcer::describe(const State& state, double width_m) {
  const pipeline::Lattice& lattice = scene_->description().levels.front();
  std::string text =
      fmt::format("{}, {}, level {} of {}, {} across", from_edge(state.proxy_m[0] - lattice.origin_m.x(), "left"),
                  from_edge(state.proxy_m[1] - lattice.origin_m.y(), "lower"), state.level + 1,
                  scene_->description().levels.size(), length_text(width_m, TextStyle::spoken));
  if (const pipeline::PartConfig* part = part_at(state))
    text = (part->say.empty() ? part->name : part->say) + ". " + text;
  if ((state.flags & kFlagOutside) != 0)
    text += ", outside the scene";
  else if ((state.flags & kFlagUnknownArea) != 0)
    text += ", not measured here";
  text += state.contact != 0 ? ", touching" : ", in the air";
  say(std::move(text));
}

}  // namespace sparsha::haptics
