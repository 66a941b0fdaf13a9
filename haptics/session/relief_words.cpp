#include "haptics/session/relief_words.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "haptics/state/stone_gives.h"
#include "haptics/state/vectors.h"

namespace sparsha::haptics {
namespace {

constexpr double kTravel_m = 0.003;     // along the stone, over which a slope is judged
constexpr double kSteep = 1.0;          // rise over travel
constexpr double kLeastStep_m = 0.002;  // lower ones are texture
constexpr double kLeastRise_m = 0.002;
constexpr double kLargeRise_m = 0.012;  // is said on the way
constexpr double kStill_m = 0.0005, kStill_s = 0.35;
constexpr double kPause_s = 1.2;  // between words on the way
constexpr double kLost_s = 0.5;   // a shorter jump is none

}  // namespace

void ReliefWords::begin(const Place& here, const State& state) {
  known_ = true;
  scene_ = state.scene;
  scale_ = state.scale;
  turn_ = state.turn;
  foot_ = told_ = still_ = here;
  step_m_ = 0.0;
}

// Words of others are heard to their end.
void ReliefWords::listen(double time_s) {
  constexpr double kBegin_s = 0.4, kCharacter_s = 0.06;
  for (const Announcement& announcement : board_.since(heard_)) {
    heard_ = announcement.sequence;
    if (!announcement.text.empty())
      quiet_until_s_ = time_s + kBegin_s + kCharacter_s * static_cast<double>(announcement.text.size());
  }
}

void ReliefWords::say(Phrase up, Phrase down, double rise_m, double scale, double time_s) {
  said_s_ = time_s;
  announcer_.say(rise_m > 0.0 ? up : down, {{"distance", announcer_.phrases().height(rise_m / scale)}});
  heard_ = board_.newest();
}

// Steep ground is one step, however wide: it is said when it ends, or when the hand rests on it.
void ReliefWords::watch_step(const Place& here, double scale) {
  const double travel_m = (here.at_m - foot_.at_m).norm();
  const double rise_m = here.height_m - foot_.height_m;
  const bool steep = std::abs(rise_m) >= std::max(kLeastStep_m, kSteep * travel_m);
  const bool rests = here.time_s - still_.time_s > kStill_s;
  if (steep) {
    if (step_m_ * rise_m < 0.0) step_m_ = 0.0;
    step_m_ += rise_m;
    foot_ = here;
  } else if (travel_m >= kTravel_m || rests) {
    // One that could not be said at once is part of the way up or down.
    if (step_m_ * rise_m > 0.0) step_m_ += rise_m;  // its last bit is less than steep over the travel
    if (std::abs(step_m_) >= kLeastStep_m && here.time_s >= quiet_until_s_) {
      say("step_up", "step_down", step_m_, scale, here.time_s);
      told_ = here;
    }
    step_m_ = 0.0;
    foot_ = here;
  }
}

void ReliefWords::watch_rest(const Place& here, double scale) {
  const double rise_m = here.height_m - told_.height_m;
  const bool rests = here.time_s - still_.time_s > kStill_s && std::abs(rise_m) >= kLeastRise_m;
  const bool large = std::abs(rise_m) >= kLargeRise_m && here.time_s - said_s_ > kPause_s;
  if (step_m_ != 0.0 || (!rests && !large) || here.time_s < quiet_until_s_) return;
  say("height_up", "height_down", rise_m, scale, here.time_s);
  told_ = here;
}

void ReliefWords::watch(const State& state) {
  if (!stone_gives(state) || (state.flags & kFlagDragged) != 0 || !(state.scale > 0.0)) return;
  // A whole object may be turned under the hand.
  const Eigen::Quaterniond turn(state.turn[3], state.turn[0], state.turn[1], state.turn[2]);
  const Eigen::Vector3d proxy_m = state.scale * (turn * to_vector(state.proxy_m));
  const Place here{proxy_m.head<2>(), proxy_m.z(), state.time_s};
  listen(here.time_s);
  const bool away = known_ && here.time_s - touched_s_ > kLost_s;
  touched_s_ = here.time_s;
  if (!known_ || state.scene != scene_ || state.scale != scale_ || state.turn != turn_) return begin(here, state);
  if (away) announcer_.say("hand_touches");
  if ((here.at_m - still_.at_m).norm() > kStill_m || std::abs(here.height_m - still_.height_m) > kStill_m)
    still_ = here;
  watch_step(here, state.scale);
  watch_rest(here, state.scale);
}

}  // namespace sparsha::haptics
