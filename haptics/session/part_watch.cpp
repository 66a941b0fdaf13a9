#include "haptics/session/part_watch.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sparsha::haptics {
namespace {

constexpr double kSilence_s = 1.0;   // a part that the hand has left for so long is said again
constexpr double kRecently_s = 8.0;  // one that the hand was in since then is said again only to a hand that stays
constexpr double kPause_s = 1.5;     // after any part
constexpr double kShort_s = 0.25;    // of a stay; words are faster than a decision to go elsewhere
constexpr double kLong_s = 1.0;      // of a stay near a border, or in a part that was said recently
constexpr double kLongest_s = 4.0;   // in one that was said time and again

}  // namespace

void PartWatch::forget() {
  told_.clear();
  part_.reset();
  there_.reset();
  left_s_ = spoke_s_ = -1e9;
}

// How long the hand has to stay before it is told.
double PartWatch::patience_s(const Told& told, double time_s) const {
  if (!told.fresh && told.patience_s > 0.0) return told.patience_s;
  return time_s - spoke_s_ < kPause_s ? kShort_s : 0.0;
}

std::optional<std::size_t> PartWatch::watch(const Eigen::Vector2d& place_m, double margin_m, double time_s,
                                            const PartAt& part_at) {
  const std::optional<std::size_t> here = part_at(place_m);
  const bool comes = here != there_;
  if (comes) since_s_ = time_s;
  there_ = here;
  if (!here) return std::nullopt;
  Told& told = told_[*here];
  if (comes) told.fresh = time_s - told.here_s > kRecently_s;
  const bool left = time_s - told.here_s > kSilence_s;
  told.here_s = time_s;
  const bool known = here == part_ && !left;
  if (known) {
    left_s_ = time_s;
    return std::nullopt;
  }
  const double stay_s = time_s - since_s_;
  if (stay_s < patience_s(told, time_s)) return std::nullopt;
  // Near the border of the part that was said last, the hand is still in that one.
  if (stay_s < kLong_s && part_ && here != part_ && time_s - left_s_ < kSilence_s) {
    constexpr std::size_t kDirections = 8;
    for (std::size_t k = 0; k < kDirections; ++k) {
      const double angle = 2.0 * std::numbers::pi * static_cast<double>(k) / kDirections;
      if (part_at(place_m + margin_m * Eigen::Vector2d(std::cos(angle), std::sin(angle))) == part_) return std::nullopt;
    }
  }
  told.patience_s = told.fresh ? kLong_s : std::clamp(2.0 * told.patience_s, kLong_s, kLongest_s);
  part_ = here;
  left_s_ = spoke_s_ = time_s;
  return here;
}

}  // namespace sparsha::haptics
