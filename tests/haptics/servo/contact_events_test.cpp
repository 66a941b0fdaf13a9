#include "haptics/servo/contact_events.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace sparsha::haptics {
namespace {

/// A hand that falls straight down onto z = 0 at `speed`, sampled at `rate_hz` with a phase, read through an encoder.
ContactEvent strike(double speed, double phase, double rate_hz, double encoder_step_m) {
  ContactEvents events;
  for (int tick = 0;; ++tick) {
    const double t = (tick + phase) / rate_hz;
    double z = 0.02 - speed * t;
    z = std::round(z / encoder_step_m) * encoder_step_m;
    ContactEvents::Input input;
    input.time_s = tick / rate_hz;
    input.hand_m = {0.0, 0.0, z};
    input.normal = z < 0.0 ? Eigen::Vector3d(0.0, 0.0, 1.0) : Eigen::Vector3d::Zero();
    input.contact = z < 0.0;
    input.stiffness_n_per_m = 800.0;
    input.encoder_step_m = encoder_step_m;
    if (const auto event = events.update(input)) return *event;
  }
}

TEST(ContactEvents, TheSameStrikeAtAHundredPhasesOfTheTickIsAsLoudWithinOneDecibel) {
  for (const double rate_hz : {1000.0, 4000.0, 10000.0})
    for (const double speed : {0.03, 0.1, 0.4}) {
      double softest = 1e9;
      double loudest = 0.0;
      for (int phase = 0; phase < 100; ++phase) {
        const double peak = strike(speed, phase / 100.0, rate_hz, 0.00005).peak_force_n;
        softest = std::min(softest, peak);
        loudest = std::max(loudest, peak);
      }
      EXPECT_LE(20.0 * std::log10(loudest / softest), 1.0) << speed << " m/s at " << rate_hz << " Hz";
      EXPECT_NEAR(loudest / (speed * std::sqrt(800.0 * 0.15)), 1.0, 0.06);
    }
}

TEST(ContactEvents, SaysTouchOnceAndLiftWhenTheHandHasReallyLeft) {
  ContactEvents events;
  std::vector<ContactEvent> said;
  const auto go = [&](int from_ms, int to_ms, bool contact) {
    for (int ms = from_ms; ms < to_ms; ++ms) {
      ContactEvents::Input input;
      input.time_s = ms * 0.001;
      input.contact = contact;
      input.normal = {0.0, 0.0, 1.0};
      if (const auto event = events.update(input)) said.push_back(*event);
    }
  };
  go(0, 100, false);
  go(100, 200, true);
  go(200, 203, false);  // an encoder step, not a lift
  go(203, 300, true);
  go(300, 400, false);
  ASSERT_EQ(said.size(), 2U);
  EXPECT_EQ(said[0].kind, ContactEvent::Kind::touch);
  EXPECT_NEAR(said[0].time_s, 0.100, 1e-9);
  EXPECT_EQ(said[1].kind, ContactEvent::Kind::lift);
  EXPECT_NEAR(said[1].time_s, 0.299, 1e-9);
}

TEST(ContactEvents, SaysWhenAStickingFingerSlips) {
  ContactEvents events;
  std::vector<ContactEvent::Kind> said;
  for (int ms = 0; ms < 100; ++ms) {
    ContactEvents::Input input;
    input.time_s = ms * 0.001;
    input.contact = ms >= 10;
    input.sticking = ms >= 10 && ms < 60;
    if (const auto event = events.update(input)) said.push_back(event->kind);
  }
  EXPECT_EQ(said, (std::vector{ContactEvent::Kind::touch, ContactEvent::Kind::slip}));
}

}  // namespace
}  // namespace sparsha::haptics
