// A hand that is led: its mechanics, its clock and its energy account share no code with the guide or the governor.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <functional>
#include <utility>
#include <vector>

#include "haptics/servo/haptic_renderer.h"
#include "tests/support/servo_parts.h"

namespace sparsha::test {

/// Polygons of a plane, and distances to them, by brute force.
using Polygon = std::vector<Eigen::Vector2d>;

inline double distance_to(const Polygon& corners, bool closed, const Eigen::Vector2d& p) {
  double least = HUGE_VAL;
  for (std::size_t k = 0; k + (closed ? 0 : 1) < corners.size(); ++k) {
    const Eigen::Vector2d& a = corners[k];
    const Eigen::Vector2d way = corners[(k + 1) % corners.size()] - a;
    const double share = std::min(1.0, std::max(0.0, (p - a).dot(way) / way.dot(way)));
    least = std::min(least, std::hypot(p.x() - a.x() - share * way.x(), p.y() - a.y() - share * way.y()));
  }
  return least;
}

/// Places along a polygon, `step` apart or closer.
inline Polygon along(const Polygon& corners, bool closed, double step) {
  Polygon places;
  for (std::size_t k = 0; k + (closed ? 0 : 1) < corners.size(); ++k) {
    const Eigen::Vector2d way = corners[(k + 1) % corners.size()] - corners[k];
    const int pieces = std::max(1, static_cast<int>(std::ceil(way.norm() / step)));
    for (int i = 0; i < pieces; ++i) places.push_back(corners[k] + way * (static_cast<double>(i) / pieces));
  }
  return places;
}

/// A star of so many points around a place; `inner` = `outer` is a regular polygon.
inline Polygon star(int points, double outer, double inner, const Eigen::Vector2d& centre = {0.0, 0.0}) {
  Polygon corners;
  for (int k = 0; k < 2 * points; ++k) {
    const double angle = 0.3 + 3.14159265358979323846 * k / points;
    const double radius = k % 2 == 0 ? outer : inner;
    corners.push_back(centre + radius * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  }
  return corners;
}

struct GuidedHand {
  double mass_kg = 0.15;
  double damping_n_s_per_m = 2.0;
  double friction_n = 0.05;  ///< Coulomb, of the device
  double delay_s = 0.001;    ///< from the writing of a force to the hand
  double encoder_step_m = 20e-6;
  double height_m = 0.005;            ///< that it keeps over the stone; negative: it presses that deep
  Eigen::Vector2d start_m{0.0, 0.0};  ///< device frame
  /// What the hand itself wants across the stone, newtons, of time and place.
  std::function<Eigen::Vector2d(double, const Eigen::Vector2d&)> own_n = {};
};

struct GuidedRun {
  std::vector<Eigen::Vector2d> places_m;  ///< of the hand, every millisecond, device frame
  std::vector<haptics::State> states;     ///< likewise
  double strongest_n = 0.0;               ///< of the force that the hand got across the stone, the stone's included
  double delivered_j = 0.0;               ///< most that the hand got of it beyond `most_w`, from any moment on
};

/// Steps of a loop of 1 kHz; `between` may give commands.
inline GuidedRun run(haptics::HapticRenderer& renderer, const GuidedHand& hand, double duration_s, double most_w,
                     const std::function<void(int tick)>& between = {}) {
  constexpr double kStep = 20e-6;
  constexpr int kSteps = 50;
  GuidedRun result;
  std::deque<std::pair<double, Eigen::Vector3d>> on_the_way;
  Eigen::Vector3d held = Eigen::Vector3d::Zero();
  Eigen::Vector2d place = hand.start_m;
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();
  double work_j = 0.0;
  double least_j = 0.0;
  for (int tick = 0; tick < static_cast<int>(duration_s * 1000.0); ++tick) {
    const double now = 0.001 * tick;
    // Comes down from free space, so that forces are armed.
    const double down = std::min(1.0, tick / 200.0);
    const double z = (1.0 - down) * 0.01 + down * hand.height_m;
    Eigen::Vector3d measured(place.x(), place.y(), z);
    for (double& x : measured) x = hand.encoder_step_m * std::round(x / hand.encoder_step_m);
    if (between) between(tick);
    renderer.update(haptics::sample_at(measured, now), 0.001);
    const auto& told = renderer.state().commanded_force_n;
    on_the_way.emplace_back(now + hand.delay_s, Eigen::Vector3d(told[0], told[1], told[2]));
    result.places_m.push_back(place);
    result.states.push_back(renderer.state());
    for (int step = 0; step < kSteps; ++step) {
      const double t = now + step * kStep;
      while (!on_the_way.empty() && on_the_way.front().first <= t) {
        held = on_the_way.front().second;
        on_the_way.pop_front();
      }
      const Eigen::Vector2d across = held.head<2>();
      Eigen::Vector2d pull = across - hand.damping_n_s_per_m * velocity;
      if (hand.own_n) pull += hand.own_n(t, place);
      const double speed = velocity.norm();
      if (speed > 1e-4)
        pull -= hand.friction_n * velocity / speed;
      else
        pull = pull.norm() > hand.friction_n ? Eigen::Vector2d(pull * (1.0 - hand.friction_n / pull.norm()))
                                             : Eigen::Vector2d(-velocity * (hand.mass_kg / kStep));
      velocity += pull * (kStep / hand.mass_kg);
      place += velocity * kStep;
      work_j += across.dot(velocity) * kStep - most_w * kStep;
      least_j = std::min(least_j, work_j);
      result.delivered_j = std::max(result.delivered_j, work_j - least_j);
      result.strongest_n = std::max(result.strongest_n, across.norm());
    }
  }
  return result;
}

}  // namespace sparsha::test
