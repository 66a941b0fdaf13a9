#include "haptics/guide/guidance.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sparsha::haptics {
namespace {

using Eigen::Vector3d;

constexpr double kWall_m = 0.002;   // from the line, where the walls are as strong as the guide
constexpr double kAsked_m = 0.020;  // from which a hand is taken up that has just asked
constexpr double kNear_m = 0.003;   // and any other
constexpr double kLeave_m = 0.005;  // beyond the walls' beginning: the hand has left
constexpr double kStrain_s = 0.4;   // of the whole force across the line: the hand wants to leave
constexpr double kLow_m = 0.012;    // above the stone, where a hand is taken up
constexpr double kHigh_m = 0.025;   // and let go
constexpr double kAgain_s = 0.5;    // after a hand was let go
constexpr double kRise_s = 0.25;    // of the force
constexpr double kFall_s = 0.12;
constexpr double kDamping_n_s_per_m = 2.0;
constexpr double kMostDamping = 0.5;  // of the guide's force
constexpr double kLookAhead_m = 0.001;
constexpr double kBrake_m = 0.004;   // before a sharp turn
constexpr double kSlowest = 0.4;     // of the speed, in it
constexpr double kSharp = 0.5;       // cosine of what turns the hand before it goes on
constexpr std::size_t kLooks = 128;  // pieces per tick
constexpr int kMostPieces = 64;      // that a hand passes in a tick

/// Of a spring that is no stronger than `most_n`.
double stored(double force_n, double stiffness_n_per_m, double stretch_m, double most_n) {
  if (force_n < most_n) return 0.5 * force_n * stretch_m;
  return most_n * (stretch_m - 0.5 * most_n / stiffness_n_per_m);
}

/// What of a vector lies across a unit normal.
Vector3d across(const Vector3d& vector, const Vector3d& normal) { return vector - normal.dot(vector) * normal; }

}  // namespace

void Guidance::set(std::shared_ptr<const Guide> guide) noexcept {
  guide_ = std::move(guide);
  interrupt();
  asked_ = guide_ != nullptr;
  phase_ = guide_ ? GuidePhase::waiting : GuidePhase::off;
  direction_ = 1.0;
  rounds_ = 0;
  travelled_m_ = 0.0;
}

void Guidance::interrupt() noexcept {
  if (phase_ == GuidePhase::leading) phase_ = GuidePhase::waiting;
  looked_at_ = 0;
  lead_m_ = share_ = strained_s_ = let_go_s_ = 0.0;
}

void Guidance::let_go() noexcept {
  phase_ = GuidePhase::let_go;
  looked_at_ = 0;
  let_go_s_ = 0.0;
}

Guidance::Offset Guidance::offset(const Input& input, const GuidePath::Place& place) const noexcept {
  const Vector3d way_m = input.scale * (guide_->path.point_m(place) - input.hand_m);
  if (!guide_->path.in_space()) return {way_m, input.height_m};
  const Vector3d normal = guide_->path.normal(place);
  return {across(way_m, normal), -normal.dot(way_m)};
}

// Some pieces per tick, so that a long line costs no more than a short one.
void Guidance::look_for_line(const Input& input) noexcept {
  const GuidePath& path = guide_->path;
  if (looked_at_ == 0) nearest_m_ = HUGE_VAL;
  const GuidePath::Place place = path.nearest_among(looked_at_, kLooks, input.hand_m);
  if (const double distance_m = input.scale * (path.point_m(place) - input.hand_m).norm(); distance_m < nearest_m_) {
    nearest_m_ = distance_m;
    nearest_ = place;
  }
  looked_at_ += kLooks;
  if (looked_at_ < path.pieces()) return;
  looked_at_ = 0;
  nearest_ = path.nearest_on(nearest_.piece, input.hand_m);  // the hand has moved on since
  const Offset from_hand = offset(input, nearest_);
  const double distance_m = from_hand.across_m.norm();
  const bool again = phase_ != GuidePhase::let_go || let_go_s_ > kAgain_s;
  if (again && from_hand.height_m < kLow_m && distance_m < (asked_ ? kAsked_m : kNear_m)) take_up(nearest_, distance_m);
}

void Guidance::take_up(const GuidePath::Place& place, double distance_m) noexcept {
  phase_ = GuidePhase::leading;
  asked_ = false;
  place_ = place;
  walls_m_ = distance_m;
  lead_m_ = share_ = strained_s_ = 0.0;
}

/// The piece after (step 1) or before (step -1) a piece; false at the line's ends.
bool Guidance::neighbour(std::size_t piece, int step, std::size_t& next) const noexcept {
  const std::size_t count = guide_->path.pieces();
  if (!guide_->path.closed() && (step > 0 ? piece + 1 == count : piece == 0)) return false;
  next = step > 0 ? (piece + 1) % count : (piece + count - 1) % count;
  return true;
}

// Downhill along the line. At a corner both of its pieces may be the nearer one.
void Guidance::follow(const Input& input) noexcept {
  const GuidePath& path = guide_->path;
  const auto distance = [&](const GuidePath::Place& place) { return (path.point_m(place) - input.hand_m).norm(); };
  const double before_m = path.along_m(place_);
  GuidePath::Place best = path.nearest_on(place_.piece, input.hand_m);
  double least = distance(best);
  int moved = 0;  // pieces
  const auto consider = [&](int step) {
    std::size_t next = 0;
    if (!neighbour(best.piece, step, next)) return false;
    const GuidePath::Place place = path.nearest_on(next, input.hand_m);
    const double at = distance(place);
    if (!(at < least)) return false;
    best = place;
    least = at;
    moved += step;
    return true;
  };
  const bool at_corner = place_.share >= 1.0 || place_.share <= 0.0;
  if (at_corner) consider(place_.share >= 1.0 ? 1 : -1);
  for (int k = 0; k < kMostPieces; ++k)
    if (!(best.share >= 1.0 && consider(1)) && !(best.share <= 0.0 && consider(-1))) break;
  double gone_m = path.along_m(best) - before_m;
  if (path.closed() && moved > 0 && gone_m < 0.0) gone_m += path.length_m();
  if (path.closed() && moved < 0 && gone_m > 0.0) gone_m -= path.length_m();
  place_ = best;
  travelled_m_ += direction_ * gone_m;
  lead_m_ -= direction_ * gone_m * input.scale;
  if (travelled_m_ < path.length_m()) return;
  travelled_m_ = 0.0;
  ++rounds_;
}

void Guidance::turn_at_end() noexcept {
  const GuidePath& path = guide_->path;
  if (path.closed()) return;
  const bool end = direction_ > 0.0 ? place_.piece + 1 == path.pieces() && place_.share >= 1.0
                                    : place_.piece == 0 && place_.share <= 0.0;
  if (!end) return;
  direction_ = -direction_;
  lead_m_ = 0.0;
}

/// From the hand's place on the line to the line ahead, grid frame; not beyond a sharp turn, which is `room_m` away.
Vector3d Guidance::way_ahead(double reach_m, double& room_m) const noexcept {
  const GuidePath& path = guide_->path;
  const int step = direction_ > 0.0 ? 1 : -1;
  const Vector3d from = path.point_m(place_);
  std::size_t piece = place_.piece;
  Vector3d at = from;
  if (direction_ > 0.0 ? place_.share >= 1.0 : place_.share <= 0.0)
    if (std::size_t next = 0; neighbour(piece, step, next)) piece = next;
  const Vector3d first = direction_ * path.direction(piece);
  Vector3d aim = from + reach_m * first;
  room_m = 0.0;
  bool aimed = false;
  const double scaled_brake_m = reach_m * (kBrake_m / kLookAhead_m);
  for (int k = 0; k < kMostPieces; ++k) {
    const Vector3d& end = path.corner(direction_ > 0.0 ? piece + 1 : piece);
    const double length_m = (end - at).norm();
    if (!aimed && room_m + length_m >= reach_m) {
      aim = at + (reach_m - room_m) * direction_ * path.direction(piece);
      aimed = true;
    }
    room_m += length_m;
    at = end;
    if (room_m >= scaled_brake_m) break;
    std::size_t next = 0;
    const bool goes_on = neighbour(piece, step, next);
    if (goes_on && direction_ * path.direction(next).dot(first) >= kSharp) {
      piece = next;
      continue;
    }
    if (!aimed) aim = at;
    break;
  }
  room_m = std::min(room_m, scaled_brake_m);
  const Vector3d way = path.in_space() ? across(aim - from, path.normal(place_)) : Vector3d(aim - from);
  return way.norm() > 0.0 ? way.normalized() : first;
}

bool Guidance::leaves(double step_s, double height_m, double beyond_m, double across_n) noexcept {
  strained_s_ = across_n >= 0.98 * guide_->force_n ? strained_s_ + step_s : 0.0;
  return beyond_m > kLeave_m || strained_s_ > kStrain_s || height_m > kHigh_m;
}

Guidance::Output Guidance::lead(const Input& input) noexcept {
  const Guide& guide = *guide_;
  const double most_n = guide.force_n;
  const double stiffness = std::min(most_n / kWall_m, input.stiffness_n_per_m);
  if (!(stiffness > 0.0)) return {};
  const double step_m = guide.speed_m_per_s * input.step_s;
  follow(input);
  turn_at_end();

  const auto [offset_m, height_m] = offset(input, place_);
  const double distance_m = offset_m.norm();
  // Walls that still stand apart follow a hand that comes nearer by itself.
  const double walls_before_m = std::min(walls_m_, distance_m);
  // They wait for a hand that does not follow, as what leads does.
  const double yields = share_ * std::clamp(2.0 * (1.0 - (distance_m - walls_before_m) / kWall_m), 0.0, 1.0);
  walls_m_ = std::max(0.0, walls_before_m - yields * step_m);
  const double beyond_m = std::max(0.0, distance_m - walls_m_);
  const double across_n = std::min(most_n, stiffness * beyond_m);
  if (phase_ == GuidePhase::leading && leaves(input.step_s, height_m, beyond_m, across_n)) let_go();
  const bool holds = phase_ == GuidePhase::leading;
  share_ = holds ? std::min(1.0, share_ + input.step_s / kRise_s) : std::max(0.0, share_ - input.step_s / kFall_s);

  double room_m = 0.0;
  const Vector3d ahead = way_ahead(kLookAhead_m / input.scale, room_m);
  const double most_lead_m = most_n / stiffness;
  const double lead_before_m = std::clamp(lead_m_, 0.0, most_lead_m);
  // What leads waits for a hand that does not follow, for one that is off the line, and is slow in sharp turns.
  const double follows = std::clamp(3.0 * (1.0 - lead_before_m / most_lead_m), 0.0, 1.0);
  const double keeps = std::clamp(2.0 * (1.0 - distance_m / kWall_m), 0.0, 1.0);
  const double turns = kSlowest + (1.0 - kSlowest) * std::min(1.0, room_m * input.scale / kBrake_m);
  const double advanced_m = holds ? step_m * follows * keeps * turns : 0.0;
  lead_m_ = std::min(most_lead_m, lead_before_m + advanced_m);
  const double leads_m_per_s = input.step_s > 0.0 ? advanced_m / input.step_s : 0.0;
  const Vector3d velocity_m_per_s =
      guide.path.in_space() ? across(input.velocity_m_per_s, guide.path.normal(place_)) : input.velocity_m_per_s;
  const double lags_m_per_s = leads_m_per_s - velocity_m_per_s.dot(ahead);
  const double free_n = std::sqrt(std::max(0.0, most_n * most_n - across_n * across_n));
  const double along_n = std::clamp(stiffness * lead_m_ + std::clamp(kDamping_n_s_per_m * lags_m_per_s,
                                                                     -kMostDamping * most_n, kMostDamping * most_n),
                                    0.0, free_n);

  const Vector3d inwards = distance_m > 0.0 ? Vector3d(offset_m / distance_m) : Vector3d::Zero();
  const Vector3d across_m_per_s = velocity_m_per_s - velocity_m_per_s.dot(ahead) * ahead;
  const double damped_n = std::min(kDamping_n_s_per_m * across_m_per_s.norm(), kMostDamping * most_n);
  Vector3d force_n = across_n * inwards + along_n * ahead;
  if (across_m_per_s.norm() > 0.0 && walls_m_ <= 0.0) force_n -= damped_n * across_m_per_s.normalized();
  if (force_n.norm() > most_n) force_n *= most_n / force_n.norm();

  Output output;
  output.force_n = share_ * force_n;
  const double wound_j = 0.5 * stiffness * lead_m_ * lead_m_;
  output.stored_j = share_ * (stored(across_n, stiffness, beyond_m, most_n) + wound_j);
  output.supplied_j =
      share_ * (along_n * advanced_m + across_n * (walls_before_m - walls_m_)) + output.force_n.dot(input.scrolled_m);
  output.supplied_j = std::min(output.supplied_j, most_n * step_m);
  return output;
}

Guidance::Output Guidance::update(const Input& input) noexcept {
  if (!guide_ || !input.hand_m.allFinite() || !(input.scale > 0.0) || !std::isfinite(input.height_m) ||
      !input.velocity_m_per_s.allFinite())
    return {};
  let_go_s_ += input.step_s;
  if (phase_ == GuidePhase::leading || share_ > 0.0) return lead(input);
  look_for_line(input);
  return {};
}

}  // namespace sparsha::haptics
