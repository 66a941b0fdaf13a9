#include "haptics/session/narrator.h"

#include <fmt/format.h>

#include <utility>

#include "pipeline/scene/regions.h"

namespace sparsha::haptics {
namespace {

constexpr double kSilenceS = 1.0;  // the same thing is said again only after so long an absence

}  // namespace

std::string spoken_length(double length_m) {
  if (length_m < 0.01) return fmt::format("{:.2g} millimetres", length_m * 1e3);
  if (length_m < 0.1) return fmt::format("{:.2g} centimetres", length_m * 1e2);
  if (length_m < 1.0) return fmt::format("{:.0f} centimetres", length_m * 1e2);
  return fmt::format("{:.3g} metres", length_m);
}

Narrator::Narrator(AnnouncementBoard& board, pipeline::ScenePointer scene) : board_(board), scene_(std::move(scene)) {}

void Narrator::set_scene(pipeline::ScenePointer scene) {
  scene_ = std::move(scene);
  part_.clear();
  unknown_ = false;
  outside_ = false;
}

void Narrator::say(std::string text, Announcement::Priority priority) { board_.say(std::move(text), priority); }

const pipeline::PartConfig* Narrator::part_at(const State& state) const {
  return pipeline::part_at(scene_->description(), state.place_m);
}

void Narrator::watch(const State& state) {
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

void Narrator::say_level(int level, double width_m) {
  const std::size_t count = scene_->description().levels.size();
  say(fmt::format("Level {} of {}, {} across", level + 1, count, spoken_length(width_m)));
}

void Narrator::describe(const State& state, double width_m) {
  const pipeline::Lattice& lattice = scene_->description().levels.front();
  std::string text = fmt::format("{} from the left edge, {} from the lower edge, level {} of {}, {} across",
                                 spoken_length(state.proxy_m[0] - lattice.origin_m.x()),
                                 spoken_length(state.proxy_m[1] - lattice.origin_m.y()), state.level + 1,
                                 scene_->description().levels.size(), spoken_length(width_m));
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
