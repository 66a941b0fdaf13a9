#include "haptics/servo/contact_events.h"

#include <algorithm>
#include <cmath>

namespace sparsha::haptics {
namespace {

// A hand that rests at the surface flickers in and out of contact by encoder steps: shorter gaps are not lifts.
constexpr double kShortestLift_s = 0.005;
constexpr double kShortestSlipPause_s = 0.02;

}  // namespace

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
      const double noise_m = input.encoder_step_m > 0.0 ? input.encoder_step_m : kLikelyEncoderStep_m;
      const double speed = std::max(0.0, -approach_.velocity(noise_m).dot(input.normal));
      event->normal_speed_m_per_s = speed;
      event->peak_force_n = speed * std::sqrt(input.stiffness_n_per_m * hand_mass_kg_);
    } else if (was_sticking_ && !input.sticking && input.time_s - last_slip_s_ > kShortestSlipPause_s) {
      say(ContactEvent::Kind::slip);
      last_slip_s_ = input.time_s;
    }
    last_contact_s_ = input.time_s;
    last_proxy_m_ = input.proxy_m;
    last_place_m_ = input.place_m;
  } else if (touching_ && input.time_s - last_contact_s_ >= kShortestLift_s) {
    touching_ = false;
    say(ContactEvent::Kind::lift);
    event->time_s = last_contact_s_;
    event->proxy_m = {last_proxy_m_.x(), last_proxy_m_.y(), last_proxy_m_.z()};
    event->place_m = last_place_m_;
    reset();
  }
  was_sticking_ = input.contact && input.sticking;
  if (!input.contact) {
    approach_.add(input.hand_m, input.time_s - approached_s_);
    approached_s_ = input.time_s;
  }
  return event;
}

}  // namespace sparsha::haptics
