// Touch of whole objects whose surface is known, judged by a god-object on their exact distance. Lengths are in mean
// point spacings, h.
#include "haptics/around/around_proxy.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "base/error.h"
#include "pipeline/charts/charts.h"
#include "tests/support/closed_scan.h"
#include "tests/support/clouds.h"
#include "tests/support/god_object.h"

namespace sparsha::test {
namespace {

using Eigen::Vector3d;
using haptics::AroundState;
using haptics::AroundUpdate;

struct Touched {
  std::string name;
  ObjectPtr object;
  double h = 0.0;
  std::shared_ptr<const haptics::ObjectSurface> surface;
};

Touched touched(const std::string& name, const ObjectPtr& object, std::size_t points = 20'000,
                const haptics::AroundFriction& friction = {}) {
  ScanOptions options;
  options.points = points;
  options.seed = 11;
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

  Vector3d next() {
    if (++tick_ % 400 == 0) {
      speed_ = on_.h * std::exp(std::uniform_real_distribution<double>(std::log(0.01), std::log(2.0))(random_));
      depth_to_ = std::uniform_real_distribution<double>(-3.0, deepest_)(random_) * on_.h;
    }
    Vector3d turn;
    std::normal_distribution<double> normal;
    for (int axis = 0; axis < 3; ++axis) turn[axis] = 0.1 * normal(random_);
    const Vector3d n = judge().normal(place_);
    way_ = (way_ + turn - n * n.dot(way_ + turn)).normalized();
    place_ += speed_ * way_;
    for (int k = 0; k < 5; ++k) place_ -= on_.object->distance_m(place_) * judge().normal(place_);
    depth_ += std::clamp(depth_to_ - depth_, -speed_, speed_);
    return place_ - depth_ * judge().normal(place_);
  }
  [[nodiscard]] Vector3d start() const { return place_ + 3.0 * on_.h * judge().normal(place_); }

 private:
  [[nodiscard]] GodObject judge() const { return {*on_.object, on_.h, place_}; }
  void leap() {
    place_ = on_.object->sample(random_).position_m;
    way_ = Vector3d(0.3, 0.5, 0.7);
    depth_ = -3.0 * on_.h;
    depth_to_ = 2.0 * on_.h;
    speed_ = 0.1 * on_.h;
  }

  const Touched& on_;
  double deepest_;
  std::mt19937_64 random_;
  Vector3d place_ = Vector3d::Zero(), way_ = Vector3d::Zero();
  double depth_ = 0.0, depth_to_ = 0.0, speed_ = 0.0;
  int tick_ = 0;
};

struct Outcome {
  std::size_t ticks = 0, contacts = 0, through = 0, not_a_number = 0, unfinished = 0, released = 0, hand_overs = 0,
              edges = 0, off_surface = 0, compared = 0, apart = 0;
  double force_error = 0.0;  ///< mean, of the force's magnitude
  double turn_deg = 0.0;     ///< mean, of its direction
  double ns_median = 0.0, ns_p99 = 0.0;
  double kick = 0.0;  ///< largest growth of the force's arm in a tick beyond the hand's own step
};

Outcome wander(const Touched& on, std::size_t ticks, double deepest, std::uint64_t seed,
               const haptics::SolverOptions& options = {}, double through = 0.6, double longest_arm = 1e9) {
  Outcome out;
  Wanderer hand(on, deepest, seed);
  AroundState state;
  const Vector3d origin = on.surface->origin_m;
  GodObject judge(*on.object, 0.5 * on.h, hand.start());
  (void)update_around(*on.surface, hand.start() - origin, state, options);
  double errors = 0.0, turns = 0.0;
  Vector3d last_arm = Vector3d::Zero(), last_hip = hand.start();
  std::vector<double> times;
  for (; out.ticks < ticks; ++out.ticks) {
    const Vector3d hip = hand.next();
    const auto begin = std::chrono::steady_clock::now();
    const AroundUpdate found = update_around(*on.surface, hip - origin, state, options);
    times.push_back(std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - begin).count());
    const Vector3d place = found.position_m + origin;
    out.not_a_number += place.allFinite() ? 0 : 1;
    out.unfinished += found.unfinished ? 1 : 0;
    out.released += found.released ? 1 : 0;
    out.hand_overs += static_cast<std::size_t>(found.hand_overs);
    out.edges += static_cast<std::size_t>(found.edges);
    out.contacts += found.contact ? 1 : 0;
    const double d = on.object->distance_m(hip);
    if (!found.contact && !found.unfinished && d < -through * on.h) ++out.through;
    if (found.contact && std::abs(on.object->distance_m(place)) > 0.5 * on.h) ++out.off_surface;
    const Vector3d arm = found.contact ? Vector3d(place - hip) : Vector3d::Zero();
    const double kick = ((arm - last_arm).norm() - (hip - last_hip).norm()) / on.h;
    if (out.ticks > 0 && arm.norm() > last_arm.norm()) out.kick = std::max(out.kick, kick);
    last_arm = arm, last_hip = hip;
    if (arm.norm() > longest_arm * on.h) {  // no person goes on so
      (void)update_around(*on.surface, hand.start() - origin, state, options);
      last_arm = Vector3d::Zero(), last_hip = hand.start();
    }
    judge.move(hip);
    if (!found.contact || !judge.contact() || d > -on.h) continue;
    const Vector3d want = judge.place_m() - hip;
    const Vector3d force = place - hip;
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

void expect_true(const Touched& on, const Outcome& o) {
  const std::string all = on.name + ": " + std::to_string(o.contacts) + " contacts, " + std::to_string(o.through) +
                          " through, " + std::to_string(o.unfinished) + " unfinished, " + std::to_string(o.hand_overs) +
                          " hand-overs, " + std::to_string(o.edges) + " edges, " + std::to_string(o.off_surface) +
                          " off, " + std::to_string(o.apart) + " of " + std::to_string(o.compared) + " apart, force " +
                          std::to_string(o.force_error) + ", " + std::to_string(o.turn_deg) + " degrees, " +
                          std::to_string(o.ns_median) + " and " + std::to_string(o.ns_p99) + " ns";
  if (std::getenv("SPARSHA_FIGURES") != nullptr) std::printf("%s\n", all.c_str());
  EXPECT_GT(o.contacts, o.ticks / 4) << all;
  EXPECT_GT(o.hand_overs, 5U) << all;
  EXPECT_EQ(o.through, 0U) << all;
  EXPECT_EQ(o.not_a_number, 0U) << all;
  EXPECT_EQ(o.released, 0U) << all;
  EXPECT_EQ(o.off_surface, 0U) << all;
  EXPECT_EQ(o.apart, 0U) << all;
  EXPECT_LE(o.unfinished, o.ticks / 1000) << all;
  EXPECT_LE(o.force_error, 0.025) << all;
  EXPECT_LE(o.turn_deg, 4.0) << all;
}

std::vector<Touched> smooth_objects() {
  return {touched("torus", make_torus()), touched("two spheres", make_two_spheres()),
          touched("vase", make_vase(turned(48.0, 0.0)), 100'000), touched("knot", make_knot())};
}

TEST(Around, AHandThatWandersFeelsTheTrueSurface) {
  const bool nightly = std::getenv("SPARSHA_NIGHTLY") != nullptr;
  for (const Touched& on : smooth_objects()) {
    for (const haptics::CellShape shape : {haptics::CellShape::bilinear, haptics::CellShape::rounded})
      expect_true(on, wander(on, nightly ? 200'000 : 4'000, 4.0, 7, {.shape = shape}));
  }
}

/// Where a straight way first enters the object, by small steps; nothing when it does not.
std::optional<Vector3d> entry(const ClosedObject& object, const Vector3d& from, const Vector3d& to, double step) {
  const double length = (to - from).norm();
  for (double way = 0.0; way <= length;) {
    const Vector3d at = from + (to - from) * (way / length);
    const double d = object.distance_m(at);
    if (d < 0.0) return at;
    way += std::max(step, 0.5 * d);
  }
  return std::nullopt;
}

TEST(Around, TheFirstCrossingOfAFastHandIsWhatItTouches) {
  for (const Touched& on : smooth_objects()) {
    std::mt19937_64 random(3);
    std::normal_distribution<double> normal;
    std::size_t entered = 0, missed = 0, made_up = 0, displaced = 0;
    for (int k = 0; k < 600; ++k) {
      const Vector3d from = 2.5 * Vector3d(normal(random), normal(random), normal(random)).normalized();
      const Vector3d to = on.object->sample(random).position_m - 0.3 * from.normalized();
      const auto flight = haptics::fly(*on.surface, from - on.surface->origin_m, to - on.surface->origin_m, false,
                                       haptics::CellShape::bilinear);
      const auto want = entry(*on.object, from, to, 0.05 * on.h);
      entered += want ? 1 : 0;
      if (want && !flight.crossing) ++missed;
      if (!flight.crossing) continue;
      const Vector3d at = from + flight.share * (to - from);
      if (!want) {
        made_up += on.object->distance_m(at) > 0.3 * on.h ? 1 : 0;
      } else if ((at - *want).norm() > 0.5 * on.h) {
        // A way that grazes the surface enters where noise lets it.
        const Vector3d n = GodObject(*on.object, on.h, at).normal(at);
        displaced += std::abs(n.dot((to - from).normalized())) > 0.3 ? 1 : 0;
      }
    }
    EXPECT_GT(entered, 400U) << on.name;
    EXPECT_LE(missed, 3U) << on.name;  // those that end within noise of the surface
    EXPECT_EQ(made_up, 0U) << on.name;
    EXPECT_EQ(displaced, 0U) << on.name;
  }
}

/// A plate of so many spacings between 2 m wide faces.
Touched plate(double spacings, const Eigen::Matrix3d& view) {
  const double spacing = std::sqrt(8.0 / 20'000.0);
  return touched("plate", make_box({1.0, 1.0, 0.5 * spacings * spacing}, view));
}

TEST(Around, AHandPushedThroughAThinPlateStaysOnTheSideThatItCameFrom) {
  for (const double spacings : {5.0, 3.5}) {
    const Eigen::Matrix3d view = turned(30.0, 20.0);
    const Touched on = plate(spacings, view);
    const Vector3d origin = on.surface->origin_m;
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> inner(-0.8, 0.8);
    for (int k = 0; k < 500; ++k) {
      const double side = k % 2 == 0 ? 1.0 : -1.0;
      const Vector3d at(inner(random), inner(random), 0.0);
      const double speed = on.h * std::exp(std::uniform_real_distribution<double>(-4.0, 2.0)(random));
      AroundState state;
      double depth = -3.0 * on.h;
      AroundUpdate found;
      for (; depth < 12.0 * on.h; depth += std::max(speed, 0.02 * on.h)) {
        const Vector3d hip = view * (at + side * Vector3d(0.0, 0.0, 0.5 * spacings * on.h - depth));
        found = update_around(*on.surface, hip - origin, state, {});
      }
      ASSERT_TRUE(found.contact) << spacings << " " << k;
      const Vector3d place = view.transpose() * (found.position_m + origin);
      EXPECT_NEAR(side * place.z(), 0.5 * spacings * on.h, 0.5 * on.h) << spacings << " " << k;
      EXPECT_FALSE(found.released);
    }
  }
}

/// Objects with sharp edges, and half of their sides in their own frame.
struct Sharp {
  Touched on;
  Vector3d half;
  Eigen::Matrix3d view;
};
std::vector<Sharp> sharp_objects() {
  std::vector<Sharp> all;
  const double spacing = std::sqrt(8.0 / 20'000.0);
  for (const Eigen::Matrix3d& view :
       {Eigen::Matrix3d(Eigen::Matrix3d::Identity()), turned(35.3, 45.0), turned(20.0, 30.0)}) {
    for (const Vector3d& half : {Vector3d(0.6, 0.6, 0.6), Vector3d(1.0, 1.0, 2.5 * spacing)})
      all.push_back({touched(half.z() < 0.1 ? "plate" : "cube", make_box(half, view)), half, view});
  }
  return all;
}

/// A place on an edge, and outwards of its two faces, in the object's own frame.
struct OnEdge {
  Vector3d at, first, second;
};
OnEdge place_on_edge(const Vector3d& half, std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const int along = static_cast<int>(random() % 3);
  const auto sign = [&] { return random() % 2 == 0 ? 1.0 : -1.0; };
  OnEdge edge{Vector3d::Zero(), sign() * Vector3d::Unit((along + 1) % 3), sign() * Vector3d::Unit((along + 2) % 3)};
  edge.at = half.cwiseProduct(edge.first + edge.second);
  edge.at[along] = unit(random) * half[along];
  return edge;
}

TEST(Around, SharpEdgesHaveNoGapForAHandThatComesFromOutside) {
  for (const Sharp& sharp : sharp_objects()) {
    const double h = sharp.on.h;
    std::mt19937_64 random(9);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    std::size_t missed = 0, early = 0, late = 0, asked = 0;
    for (int k = 0; k < 3'000; ++k) {
      const OnEdge edge = place_on_edge(sharp.half, random);
      const Vector3d along = edge.first.cross(edge.second).cwiseAbs();
      if (along.dot(sharp.half - edge.at.cwiseAbs()) < 2.0 * h) continue;  // a corner
      const Vector3d within = edge.at - (0.8 + std::abs(unit(random))) * h * (edge.first + edge.second);
      Vector3d from = edge.first * unit(random) + edge.second * unit(random);
      from = (from + 0.5 * unit(random) * edge.first.cross(edge.second)).normalized();
      const Vector3d begin = within + 12.0 * h * from;
      const Vector3d way = -15.0 * h * from;
      if ((begin.cwiseAbs() - sharp.half).maxCoeff() < 0.5 * h) continue;
      double deepest = 0.0;
      for (int step = 0; step <= 150; ++step)
        deepest = std::min(deepest, sharp.on.object->distance_m(sharp.view * (begin + step / 150.0 * way)));
      if (deepest > -0.8 * h) continue;
      ++asked;
      const auto flight =
          haptics::fly(*sharp.on.surface, sharp.view * begin - sharp.on.surface->origin_m,
                       sharp.view * (begin + way) - sharp.on.surface->origin_m, false, haptics::CellShape::bilinear);
      missed += flight.crossing ? 0 : 1;
      const double d = sharp.on.object->distance_m(sharp.view * (begin + flight.share * way)) / h;
      early += flight.crossing && d > 0.5 ? 1 : 0;
      late += flight.crossing && d < -1.2 ? 1 : 0;
    }
    const std::string all = sharp.on.name + ": " + std::to_string(asked) + " asked, " + std::to_string(missed) +
                            " missed, " + std::to_string(early) + " early, " + std::to_string(late) + " late";
    if (std::getenv("SPARSHA_FIGURES") != nullptr) std::printf("%s\n", all.c_str());
    EXPECT_GT(asked, 1'000U) << all;
    EXPECT_EQ(missed, 0U) << all;
    EXPECT_LE(early, asked / 50) << all;
    EXPECT_EQ(late, 0U) << all;
  }
}

TEST(Around, NoEdgeLetsAHandThrough) {
  const bool nightly = std::getenv("SPARSHA_NIGHTLY") != nullptr;
  for (const Sharp& sharp : sharp_objects()) {
    for (const haptics::CellShape shape : {haptics::CellShape::bilinear, haptics::CellShape::rounded}) {
      // Scans wear edges by some tenths of a spacing and corners by one.
      const Outcome o = wander(sharp.on, nightly ? 200'000 : 5'000, 4.0, 7, {.shape = shape}, 1.3, 8.0);
      const std::string all = sharp.on.name + ": " + std::to_string(o.contacts) + " contacts, " +
                              std::to_string(o.through) + " through, " + std::to_string(o.released) + " released, " +
                              std::to_string(o.off_surface) + " off, " + std::to_string(o.unfinished) +
                              " unfinished, " + std::to_string(o.edges) + " edges, kick " + std::to_string(o.kick);
      if (std::getenv("SPARSHA_FIGURES") != nullptr) std::printf("%s\n", all.c_str());
      EXPECT_GT(o.edges, 0U) << all;
      EXPECT_EQ(o.through, 0U) << all;
      EXPECT_EQ(o.not_a_number, 0U) << all;
      EXPECT_EQ(o.released, 0U) << all;
      EXPECT_LE(o.off_surface, o.ticks / 1'000) << all;
    }
  }
}

TEST(Around, AHandThatIsNoNumberChangesNothing) {
  const Touched on = touched("torus", make_torus());
  AroundState state;
  const Vector3d above(1.0, 0.0, 0.5);
  const Vector3d within = above - Vector3d(0.0, 0.0, 0.25);
  (void)update_around(*on.surface, above, state, {});
  (void)update_around(*on.surface, within, state, {});
  const AroundUpdate before = update_around(*on.surface, within, state, {});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Vector3d& bad : {Vector3d(nan, 0.0, 0.0), Vector3d(0.0, 0.0, std::numeric_limits<double>::infinity())})
    EXPECT_FALSE(update_around(*on.surface, bad, state, {}).contact);
  const AroundUpdate after = update_around(*on.surface, within, state, {});
  EXPECT_EQ(before.position_m, after.position_m);
  EXPECT_EQ(before.contact, after.contact);
}

TEST(Around, WithoutASheetThereIsNothingToTouch) { EXPECT_THROW((void)haptics::make_object_surface({}), Error); }

}  // namespace
}  // namespace sparsha::test
