// A hand that wanders over a whole object, judged by a god-object on its exact distance. Lengths are in mean point
// spacings, h.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "haptics/around/around_proxy.h"
#include "pipeline/charts/charts.h"
#include "tests/support/closed_scan.h"
#include "tests/support/clouds.h"
#include "tests/support/god_object.h"

namespace sparsha::test {

struct Touched {
  std::string name;
  ObjectPtr object;
  double h = 0.0;
  std::shared_ptr<const haptics::ObjectSurface> surface;
};

/// `hole_spacings`: radius of a hole in the scan, 0 for none.
inline Touched touched(const std::string& name, const ObjectPtr& object, std::size_t points = 20'000,
                       const haptics::AroundFriction& friction = {}, double hole_spacings = 0.0) {
  ScanOptions options;
  options.points = points;
  options.seed = 11;
  options.hole_spacings = hole_spacings;
  const ObjectScan scan = scan_object(*object, options);
  ThreadPool pool(2);
  Progress progress;
  scene::GridConfig grid;
  grid.spacing_m = scan.spacing_m;
  const auto charts =
      pipeline::make_charts(make_cloud(scan.points), Eigen::Matrix4d::Identity(), grid, 0.0, {pool, progress});
  return {name, object, scan.spacing_m, haptics::make_object_surface(charts.charts, friction)};
}

/// A hand that wanders over an object, outside and up to some depth below its surface, at changing speed.
class Wanderer {
 public:
  Wanderer(const Touched& on, double deepest, std::uint64_t seed) : on_(on), deepest_(deepest), random_(seed) {
    leap();
  }

  Eigen::Vector3d next() {
    if (++tick_ % 400 == 0) {
      speed_ = on_.h * std::exp(std::uniform_real_distribution<double>(std::log(0.01), std::log(2.0))(random_));
      depth_to_ = std::uniform_real_distribution<double>(-3.0, deepest_)(random_) * on_.h;
    }
    Eigen::Vector3d turn;
    std::normal_distribution<double> normal;
    for (int axis = 0; axis < 3; ++axis) turn[axis] = 0.1 * normal(random_);
    const Eigen::Vector3d n = judge().normal(place_);
    way_ = (way_ + turn - n * n.dot(way_ + turn)).normalized();
    place_ += speed_ * way_;
    for (int k = 0; k < 5; ++k) place_ -= on_.object->distance_m(place_) * judge().normal(place_);
    depth_ += std::clamp(depth_to_ - depth_, -speed_, speed_);
    return place_ - depth_ * judge().normal(place_);
  }
  [[nodiscard]] Eigen::Vector3d start() const { return place_ + 3.0 * on_.h * judge().normal(place_); }

 private:
  [[nodiscard]] GodObject judge() const { return {*on_.object, on_.h, place_}; }
  void leap() {
    place_ = on_.object->sample(random_).position_m;
    way_ = Eigen::Vector3d(0.3, 0.5, 0.7);
    depth_ = -3.0 * on_.h;
    depth_to_ = 2.0 * on_.h;
    speed_ = 0.1 * on_.h;
  }

  const Touched& on_;
  double deepest_;
  std::mt19937_64 random_;
  Eigen::Vector3d place_ = Eigen::Vector3d::Zero(), way_ = Eigen::Vector3d::Zero();
  double depth_ = 0.0, depth_to_ = 0.0, speed_ = 0.0;
  int tick_ = 0;
};

struct Outcome {
  std::size_t ticks = 0, contacts = 0, through = 0, not_a_number = 0, unfinished = 0, released = 0, hand_overs = 0,
              edges = 0, off_surface = 0, compared = 0, apart = 0;
  std::size_t forked = 0;  ///< not compared: proxy and judge lie on two sides of a hand that was in the middle of stone
  std::size_t trapped = 0;   ///< held although the hand is a spacing outside
  double force_error = 0.0;  ///< mean, of the force's magnitude
  double turn_deg = 0.0;     ///< mean, of its direction
  double ns_median = 0.0, ns_p99 = 0.0;
  double kick = 0.0;  ///< largest growth of the force's arm in a tick beyond the hand's own step
};

/// A hand about as far from two faces as from one: which of them holds it is decided by less than a scan's noise.
inline bool is_in_the_middle(const GodObject& judge, const Eigen::Vector3d& hand_m, double h) {
  constexpr double kAbout = 0.6;
  constexpr double kOtherFace = 0.5;  // cosine of 60 degrees
  const Eigen::Vector3d normal = judge.normal(hand_m);
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0})
      if (judge.normal(hand_m + sign * kAbout * h * Eigen::Vector3d::Unit(axis)).dot(normal) < kOtherFace) return true;
  return false;
}

/// `judged`: the god-object goes along, which takes most of the time; else the distance to the surface alone.
inline Outcome wander(const Touched& on, std::size_t ticks, double deepest, std::uint64_t seed,
                      const haptics::SolverOptions& options = {}, double through = 0.6, double longest_arm = 1e9,
                      bool judged = true) {
  Outcome out;
  Wanderer hand(on, deepest, seed);
  haptics::AroundState state;
  const Eigen::Vector3d origin = on.surface->origin_m;
  GodObject judge(*on.object, 0.5 * on.h, hand.start());
  (void)update_around(*on.surface, hand.start() - origin, state, options);
  double errors = 0.0, turns = 0.0;
  Eigen::Vector3d last_arm = Eigen::Vector3d::Zero(), last_hip = hand.start();
  std::vector<double> times;
  bool forked = false;
  for (; out.ticks < ticks; ++out.ticks) {
    const Eigen::Vector3d hip = hand.next();
    const auto begin = std::chrono::steady_clock::now();
    const haptics::AroundUpdate found = update_around(*on.surface, hip - origin, state, options);
    times.push_back(std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - begin).count());
    const Eigen::Vector3d place = found.position_m + origin;
    out.not_a_number += place.allFinite() ? 0 : 1;
    out.unfinished += found.unfinished ? 1 : 0;
    out.released += found.released ? 1 : 0;
    out.hand_overs += static_cast<std::size_t>(found.hand_overs);
    out.edges += static_cast<std::size_t>(found.edges);
    out.contacts += found.contact ? 1 : 0;
    const double d = on.object->distance_m(hip);
    if (!found.contact && !found.unfinished && d < -through * on.h) ++out.through;
    if (found.contact && std::abs(on.object->distance_m(place)) > 0.5 * on.h) ++out.off_surface;
    if (found.contact && d > on.h) ++out.trapped;
    const Eigen::Vector3d arm = found.contact ? Eigen::Vector3d(place - hip) : Eigen::Vector3d::Zero();
    const double kick = ((arm - last_arm).norm() - (hip - last_hip).norm()) / on.h;
    if (out.ticks > 0 && arm.norm() > last_arm.norm()) out.kick = std::max(out.kick, kick);
    last_arm = arm, last_hip = hip;
    if (arm.norm() > longest_arm * on.h) {  // no person goes on so
      (void)update_around(*on.surface, hand.start() - origin, state, options);
      last_arm = Eigen::Vector3d::Zero(), last_hip = hand.start();
    }
    if (!judged) continue;
    judge.move(hip);
    if (!found.contact || !judge.contact()) forked = false;
    if (!found.contact || !judge.contact() || d > -on.h) continue;
    const double between_m = (judge.place_m() - place).norm();
    if (forked) forked = between_m > on.h;
    if (!forked && between_m > on.h) forked = is_in_the_middle(judge, hip, on.h);
    if (forked) {
      ++out.forked;
      continue;
    }
    const Eigen::Vector3d want = judge.place_m() - hip;
    const Eigen::Vector3d force = place - hip;
    const double error = std::abs(force.norm() - want.norm()) / want.norm();
    turns += std::acos(std::clamp(force.dot(want) / (force.norm() * want.norm()), -1.0, 1.0)) * 180.0 / M_PI;
    ++out.compared;
    out.apart += error > 0.3 ? 1 : 0;
    errors += error;
  }
  out.force_error = errors / static_cast<double>(std::max<std::size_t>(1, out.compared));
  out.turn_deg = turns / static_cast<double>(std::max<std::size_t>(1, out.compared));
  std::sort(times.begin(), times.end());
  out.ns_median = times[times.size() / 2];
  out.ns_p99 = times[times.size() * 99 / 100];
  return out;
}

}  // namespace sparsha::test
