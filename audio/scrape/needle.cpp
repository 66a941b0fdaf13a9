// For every sample, in this order: path, height, drive, modes, level.
#include "audio/scrape/needle.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "audio/decibel.h"
#include "audio/levels.h"

namespace sparsha::audio {
namespace {

constexpr double kPi = std::numbers::pi;
/// A needle on a string of this length, at the hand: an encoder that flickers by a step draws nothing.
constexpr double kString_m = 0.0001;
constexpr double kPath_s = 0.004;
constexpr double kSpeed_s = 0.010;
constexpr double kPress_s = 0.006;
/// What is slower is the stone's form and no sound.
constexpr double kHighPass_hz = 18.0;
/// Points further apart than this are two strokes.
constexpr double kPause_s = 0.08;
/// Shorter waves of the grain are smaller than what a finger follows, at the hand.
constexpr double kFinger_m = 0.00005;
/// Closer than a nanometre the needle has arrived.
constexpr double kArrived_m = 1e-9;
constexpr double kSilence = 1e-7;
/// A finger on the stone damps what rings under it.
constexpr double kMostQuality = 9.0;
constexpr double kDry = 0.35;  ///< share of the drive that is heard as it is
/// A stroke at this speed on a path whose slope has a root mean square of kSlope is half as loud as a stroke can be.
constexpr double kBrisk_m_per_s = 0.1;
constexpr double kSlope = 0.08;
constexpr double kSlowest_m_per_s = 1e-4;
constexpr double kReferenceGain = 0.5;
constexpr std::uint64_t kSettleEvery = 64;  ///< frames
constexpr double kAttack_s = 0.004;
constexpr double kRelease_s = 0.12;

double share(double time_s, double rate_hz) { return 1.0 - std::exp(-1.0 / (time_s * rate_hz)); }

}  // namespace

ScrapeBank::ScrapeBank(const Modes& modes, double sample_rate_hz) : count_(modes.count) {
  for (std::size_t n = 0; n < count_; ++n) {
    const Partial& mode = modes.partials[n];
    Band& band = bands_[n];
    const double own_quality = kPi * mode.frequency_hz * mode.t60_s / std::log(1000.0);
    band.damping = 1.0 / std::clamp(own_quality, 0.6, kMostQuality);
    band.warped = std::tan(kPi * mode.frequency_hz / sample_rate_hz);
    band.normalise = 1.0 / (1.0 + band.warped * (band.damping + band.warped));
    band.gain = mode.gain;
  }
}

double ScrapeBank::next(double in) noexcept {
  double sum = 0.0;
  for (std::size_t n = 0; n < count_; ++n) {
    Band& band = bands_[n];
    const double high = (in - (band.damping + band.warped) * band.state_1 - band.state_2) * band.normalise;
    const double middle = band.warped * high + band.state_1;
    band.state_1 = 2.0 * band.warped * high + band.state_1;
    band.state_2 = 2.0 * band.warped * middle + band.state_2;
    sum += band.gain * band.damping * middle;
  }
  return sum;
}

bool ScrapeBank::settle() noexcept {
  double most = 0.0;
  for (std::size_t n = 0; n < count_; ++n)
    most = std::max({most, std::abs(bands_[n].state_1), std::abs(bands_[n].state_2)});
  if (most >= kSilence) return true;
  for (std::size_t n = 0; n < count_; ++n) bands_[n].state_1 = bands_[n].state_2 = 0.0;
  return false;
}

Needle::Needle(const SoundBank& bank)
    : bank_(bank),
      level_(kStrokeLevel * std::min(bank.scrape_gain / kReferenceGain, kMostStrokeGain)),
      rate_hz_(bank.sample_rate_hz),
      path_share_(share(kPath_s, rate_hz_)),
      speed_share_(share(kSpeed_s, rate_hz_)),
      press_share_(share(kPress_s, rate_hz_)),
      high_share_(share(1.0 / (2.0 * kPi * kHighPass_hz), rate_hz_)),
      attack_share_(share(kAttack_s, rate_hz_)),
      release_share_(share(kRelease_s, rate_hz_)),
      weights_(bank.scrapes.size(), 0.0),
      ringing_(bank.scrapes.size(), false) {
  for (const ScrapeSound& sound : bank.scrapes) banks_.emplace_back(sound.modes, rate_hz_);
}

void Needle::set_profile(std::shared_ptr<const Profile> profile, std::uint64_t frame) noexcept {
  if (changes_waiting_ == kMostProfiles) {
    change_ = (change_ + 1) % kMostProfiles;
    --changes_waiting_;
  }
  changes_[(change_ + changes_waiting_) % kMostProfiles] = {std::move(profile), frame};
  ++changes_waiting_;
  awake_ = true;
}

void Needle::move(const Point& given) noexcept {
  Point point = given;
  point.press_level = strike_level(point.press_n);
  if (point.touching && !point.place_m.allFinite()) point.touching = false;
  if (!point.touching) {
    if (!anchored_) return;  // in the air before as well
    anchored_ = false;
  } else {
    // Near the origin of the numbers: grids may lie thousands of kilometres away from theirs.
    if (!has_origin_) origin_m_ = point.place_m;
    has_origin_ = true;
    point.place_m -= origin_m_;
    const Eigen::Vector3d away_m = point.place_m - anchor_m_;
    const double string_m = kString_m / point.scale;
    if (!anchored_) {
      anchor_m_ = point.place_m;
    } else if (away_m.norm() > string_m) {
      anchor_m_ = point.place_m - away_m * (string_m / away_m.norm());
    }
    point.place_m = anchor_m_;
    anchored_ = true;
  }
  if (waiting_ == kMostPoints) {
    first_ = (first_ + 1) % kMostPoints;
    --waiting_;
  }
  points_[(first_ + waiting_) % kMostPoints] = point;
  ++waiting_;
  awake_ = true;
}

void Needle::seat(const Point& point) noexcept {
  seated_ = true;
  lifted_ = false;
  at_m_ = before_m_ = half_way_m_ = point.place_m;
  speed_m_per_s_ = 0.0;
  last_height_m_ = height_m(0.0);
}

/// The needle comes to rest where it is while the press fades: to stop at once would click.
void Needle::lift(std::uint64_t frame) noexcept {
  lifted_ = seated_;
  reached_.frame = frame;
  reached_.touching = false;
  reached_.press_level = 0.0;
}

/// Takes what has been reached by `frame`.
void Needle::advance(std::uint64_t frame) noexcept {
  while (changes_waiting_ > 0 && changes_[change_].frame <= frame) {
    profile_ = changes_[change_].profile;  // the ring keeps its share, so that none is freed here
    change_ = (change_ + 1) % kMostProfiles;
    --changes_waiting_;
    find_sheet(reached_.place_m);
    if (seated_) last_height_m_ = height_m(0.0);  // no step is heard where one profile gives way to another
  }
  while (waiting_ > 0 && points_[first_].frame <= frame) {
    const Point& next = points_[first_];
    const bool pause = next.frame > reached_.frame + static_cast<std::uint64_t>(kPause_s * rate_hz_);
    if (next.touching) {
      find_sheet(next.place_m);
      if (!seated_ || lifted_ || (pause && next.place_m != reached_.place_m)) seat(next);
      reached_ = next;
    } else {
      lift(next.frame);
    }
    first_ = (first_ + 1) % kMostPoints;
    --waiting_;
  }
}

/// From the point that has been reached to the next one, 0 to 1; 0 as well where that is another stroke or in the air.
double Needle::share_of_way(std::uint64_t frame) const noexcept {
  if (waiting_ == 0 || lifted_ || !points_[first_].touching) return 0.0;
  const auto gap = static_cast<double>(points_[first_].frame - reached_.frame);
  return gap > kPause_s * rate_hz_ ? 0.0 : static_cast<double>(frame - reached_.frame) / gap;
}

Eigen::Vector3d Needle::target(double share) const noexcept {
  return share > 0.0 ? reached_.place_m + share * (points_[first_].place_m - reached_.place_m) : reached_.place_m;
}

/// Between the ticks as the place is: a press that comes in steps is not heard in steps.
double Needle::press_level(double share) const noexcept {
  if (!seated_) return 0.0;
  return share > 0.0 ? reached_.press_level + share * (points_[first_].press_level - reached_.press_level)
                     : reached_.press_level;
}

Eigen::Vector3d Needle::on_profile_m(const Eigen::Vector3d& place_m) const noexcept {
  return (origin_m_ - profile_->origin_m()) + place_m;
}

double Needle::height_m(double per_sample_m) const noexcept {
  if (!profile_) return 0.0;
  const Eigen::Vector3d place_m = on_profile_m(at_m_);
  return profile_->height_m(sheet_, place_m) +
         grain_gain_ * profile_->grain_m(sheet_, place_m, per_sample_m, kFinger_m / reached_.scale);
}

/// Of the last step, on the present sheet, without grain.
double Needle::leaning_rise_m() const noexcept {
  const Eigen::Vector3d from_m = on_profile_m(before_m_), to_m = on_profile_m(at_m_);
  return (profile_->height_m(sheet_, to_m) - profile_->height_m(sheet_, from_m)) * profile_->facing(sheet_, to_m);
}

double Needle::drive_of(double rise_m, double speed) const noexcept {
  const double rise_m_per_s = rise_m * reached_.scale * rate_hz_;
  return rise_m_per_s / std::sqrt(std::max({speed, speed_m_per_s_, kSlowest_m_per_s}) * kBrisk_m_per_s);
}

/// Heights of one sheet rise otherwise than those of another, since they lean otherwise: neither a step nor another
/// lean is heard where one gives way to the other.
void Needle::find_sheet(const Eigen::Vector3d& place_m) noexcept {
  if (!profile_) return;
  const std::size_t next = profile_->sheet_at(on_profile_m(place_m), sheet_);
  if (next == sheet_) return;
  const double before_rise_m = leaning_rise_m();
  sheet_ = next;
  last_height_m_ = height_m(0.0);
  const double more_m = leaning_rise_m() - before_rise_m;
  if (moves_ && std::isfinite(more_m))
    high_1_ += drive_of(more_m, (at_m_ - before_m_).norm() * reached_.scale * rate_hz_);
}

/// How steep the way rises where the needle is, times the root of how brisk it is.
double Needle::slope(double share) noexcept {
  const Eigen::Vector3d goal_m = target(share);
  before_m_ = at_m_;
  half_way_m_ += path_share_ * (goal_m - half_way_m_);
  at_m_ += path_share_ * (half_way_m_ - at_m_);
  if ((goal_m - at_m_).cwiseAbs().maxCoeff() < kArrived_m) at_m_ = half_way_m_ = goal_m;
  const double step_m = (at_m_ - before_m_).norm();
  moves_ = step_m > 0.0;
  const double speed = step_m * reached_.scale * rate_hz_;
  speed_m_per_s_ += speed_share_ * (speed - speed_m_per_s_);
  if (!moves_) return 0.0;
  const double height = height_m(step_m);
  const double rise_m = profile_ ? (height - last_height_m_) * profile_->facing(sheet_, on_profile_m(at_m_)) : 0.0;
  last_height_m_ = height;
  return std::isfinite(rise_m) ? drive_of(rise_m, speed) : 0.0;  // beyond a sheet's end, or back on it
}

/// The drive goes to the material under the hand; what rang in others rings on.
double Needle::ring(double drive) noexcept {
  double sum = kDry * drive;
  for (std::size_t b = 0; b < banks_.size(); ++b) {
    weights_[b] += press_share_ * ((b == reached_.sound ? 1.0 : 0.0) - weights_[b]);
    if (b == reached_.sound && drive != 0.0) ringing_[b] = true;
    if (ringing_[b]) sum += banks_[b].next(weights_[b] * drive);
  }
  return sum;
}

void Needle::render(double* out, std::size_t count, std::uint64_t frame) noexcept {
  for (std::size_t i = 0; i < count && awake_; ++i) {
    advance(frame + i);
    const double gain = bank_.scrapes[std::min(reached_.sound, banks_.size() - 1)].grain_gain;
    grain_gain_ += press_share_ * (gain - grain_gain_);
    const double share = share_of_way(frame + i);
    press_ += press_share_ * (press_level(share) - press_);
    const double drive = seated_ ? slope(share) : 0.0;
    high_1_ += high_share_ * (drive - high_1_);
    high_2_ += high_share_ * (drive - high_1_ - high_2_);
    const double sound = ring(drive - high_1_ - high_2_) / kSlope;
    const double power = sound * sound;
    power_ += (power > power_ ? attack_share_ : release_share_) * (power - power_);
    out[i] += level_ * press_ * sound / (1.0 + std::sqrt(power_));
    if ((frame + i + 1) % kSettleEvery == 0) settle();
  }
}

/// At whole multiples of kSettleEvery alone, so that the sound does not depend on how time is cut into blocks.
void Needle::settle() noexcept {
  const double left = std::abs(high_1_) + std::abs(high_2_);
  if (left < kSilence) high_1_ = high_2_ = 0.0;
  if (power_ < kSilence * kSilence) power_ = 0.0;
  if (press_ < kSilence && (lifted_ || !seated_)) {
    press_ = 0.0;
    seated_ = lifted_ = moves_ = false;
  }
  bool rings = left >= kSilence;
  for (std::size_t b = 0; b < banks_.size(); ++b) {
    if (ringing_[b]) ringing_[b] = banks_[b].settle();
    rings = rings || ringing_[b];
  }
  awake_ = rings || moves_ || lifted_ || waiting_ > 0 || changes_waiting_ > 0;
  if (!awake_) speed_m_per_s_ = 0.0;
}

}  // namespace sparsha::audio
