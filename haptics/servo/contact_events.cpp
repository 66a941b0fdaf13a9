#include "haptics/servo/contact_events.h"

#include <algorithm>
#include <cmath>

namespace sparsha::haptics {
namespace {

// A straight line fitted to so much of the approach: one encoder step of 0.02 mm then errs by 1 mm/s.
constexpr double kVelocityWindowS = 0.016;
// A hand that rests at the surface flickers in and out of contact by encoder steps: shorter gaps are not lifts.
constexpr double kShortestLiftS = 0.005;
constexpr double kShortestSlipPauseS = 0.02;

}  // namespace

ContactEvents::ContactEvents(double rate_hz, double hand_mass_kg) noexcept
    : hand_mass_kg_(hand_mass_kg),
      length_(static_cast<std::size_t>(std::clamp(std::lround(kVelocityWindowS * rate_hz), 4L, long{kLongest}))) {}

void ContactEvents::reset() noexcept {
  count_ = 0;
  next_ = 0;
}

// Least-squares slope: low-pass with linear phase, so that the strike does not depend on where in a tick it fell.
Eigen::Vector3d ContactEvents::velocity() const noexcept {
  if (count_ < 2) return Eigen::Vector3d::Zero();
  const std::size_t newest = (next_ + kLongest - 1) % kLongest;
  const double zero_s = places_[newest].time_s;
  const Eigen::Vector3d zero_m = places_[newest].position_m;
  double sum_t = 0.0;
  double sum_tt = 0.0;
  Eigen::Vector3d sum_x = Eigen::Vector3d::Zero();
  Eigen::Vector3d sum_tx = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < count_; ++i) {
    const Place& place = places_[(next_ + kLongest - 1 - i) % kLongest];
    const double t = place.time_s - zero_s;
    const Eigen::Vector3d x = place.position_m - zero_m;
    sum_t += t;
    sum_tt += t * t;
    sum_x += x;
    sum_tx += t * x;
  }
  const auto n = static_cast<double>(count_);
  const double spread = n * sum_tt - sum_t * sum_t;
  if (!(spread > 0.0)) return Eigen::Vector3d::Zero();
  return (n * sum_tx - sum_t * sum_x) / spread;
}

std::optional<ContactEvent> ContactEvents::update(const Input& input) noexcept {
  std::optional<ContactEvent> event;
  const auto say = [&](ContactEvent::Kind kind) {
    ContactEvent result;
    result.kind = kind;
    result.time_s = input.time_s;
    result.proxy_m = {input.proxy_m.x(), input.proxy_m.y(), input.proxy_m.z()};
    result.place_m = input.place_m;
    result.level = input.level;
    event = result;
  };
  if (input.contact) {
    if (!touching_) {
      touching_ = true;
      say(ContactEvent::Kind::touch);
      // The touching sample itself is left out: the surface has already pushed.
      const double speed = std::max(0.0, -velocity().dot(input.normal));
      event->normal_speed_m_per_s = speed;
      event->peak_force_n = speed * std::sqrt(input.stiffness_n_per_m * hand_mass_kg_);
    } else if (was_sticking_ && !input.sticking && input.time_s - last_slip_s_ > kShortestSlipPauseS) {
      say(ContactEvent::Kind::slip);
      last_slip_s_ = input.time_s;
    }
    last_contact_s_ = input.time_s;
    last_proxy_m_ = input.proxy_m;
    last_place_m_ = input.place_m;
  } else if (touching_ && input.time_s - last_contact_s_ >= kShortestLiftS) {
    touching_ = false;
    say(ContactEvent::Kind::lift);
    event->time_s = last_contact_s_;
    event->proxy_m = {last_proxy_m_.x(), last_proxy_m_.y(), last_proxy_m_.z()};
    event->place_m = last_place_m_;
    reset();
  }
  was_sticking_ = input.contact && input.sticking;
  if (!input.contact) {
    places_[next_] = {input.time_s, input.hand_m};
    next_ = (next_ + 1) % kLongest;
    count_ = std::min(count_ + 1, length_);
  }
  return event;
}

}  // namespace sparsha::haptics
