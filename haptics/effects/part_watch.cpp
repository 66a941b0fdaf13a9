#include "haptics/effects/part_watch.h"

#include <algorithm>

namespace sparsha::haptics {
namespace {

constexpr double kSilence_s = 1.0;   // a part that the hand has left for so long is told of again
constexpr double kRecently_s = 8.0;  // one that the hand was in since then is told of again only to a hand that stays
constexpr double kPause_s = 1.5;     // after any part
constexpr double kLong_s = 1.0;      // of a stay near a border, or in a part that was told of recently
constexpr double kLongest_s = 4.0;   // in one that was told of time and again

}  // namespace

PartWatch::Told& PartWatch::told_of(std::size_t part) noexcept {
  Told* oldest = told_.data();
  for (Told& told : told_) {
    if (told.part == part) return told;
    if (told.here_s < oldest->here_s) oldest = &told;
  }
  *oldest = Told{};
  oldest->part = part;
  return *oldest;
}

// How long the hand has to stay before it is told.
double PartWatch::patience_s(const Told& told, double time_s) const noexcept {
  if (!told.fresh && told.patience_s > 0.0) return told.patience_s;
  return time_s - spoke_s_ < kPause_s ? kShort_s : 0.0;
}

std::optional<double> PartWatch::stays(const std::optional<std::size_t>& here, double time_s) noexcept {
  const bool comes = here != there_;
  if (comes) since_s_ = time_s;
  there_ = here;
  if (!here) return std::nullopt;
  Told& told = told_of(*here);
  if (comes) told.fresh = time_s - told.here_s > kRecently_s;
  const bool left = time_s - told.here_s > kSilence_s;
  told.here_s = time_s;
  if (here == part_ && !left && inside_) {
    left_s_ = time_s;
    return std::nullopt;
  }
  const double stay_s = time_s - since_s_;
  return stay_s < patience_s(told, time_s) ? std::nullopt : std::optional<double>(stay_s);
}

bool PartWatch::borders(double stay_s, std::size_t here, double time_s) const noexcept {
  return stay_s < kLong_s && part_ && here != *part_ && time_s - left_s_ < kSilence_s;
}

std::size_t PartWatch::tell(std::size_t here, double time_s) noexcept {
  Told& told = told_of(here);
  told.patience_s = told.fresh ? kLong_s : std::clamp(2.0 * told.patience_s, kLong_s, kLongest_s);
  part_ = here;
  inside_ = true;
  left_s_ = spoke_s_ = time_s;
  return here;
}

}  // namespace sparsha::haptics
