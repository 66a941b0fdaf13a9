// A hand that wanders within the stone about leaning walls, hollow corners of three faces and the ends of blocks: while
// a god-object on the exact distance holds it, it is held. Lengths are in mean point spacings, h, which are metres
// here.
#include <gtest/gtest.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "haptics/around/around_proxy.h"
#include "tests/support/faceted.h"
#include "tests/support/wandering_hand.h"

namespace sparsha::test {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// A place in the object's own frame, and how far along y the hand goes from it.
struct About {
  Vector3d place;
  double along = 0.0;
};

class Visit {
 public:
  Visit(const Touched& on, const Faceted& object, haptics::CellShape shape)
      : on_(on), object_(object), options_{.shape = shape} {}

  /// From outside to three places inside, at most six spacings deep: is the hand in the stone let go at one of them?
  [[nodiscard]] bool is_lost(const About& about, std::mt19937_64& random) {
    const Vector3d middle = about.place + unit(random) * about.along * Vector3d::UnitY();
    const double step = on_.h * std::exp(std::log(0.05) + 0.5 * (1.0 + unit(random)) * std::log(60.0));
    Vector3d hand = place_near(middle, 11.0, random, [&](double d) { return d >= 3.0; });
    GodObject judge(*on_.object, 0.5 * on_.h, object_.view() * hand);
    haptics::AroundState state;
    touch(hand, state);
    for (int k = 0; k < 3; ++k) {
      const Vector3d from = hand;
      const Vector3d to = place_near(middle, 6.0, random, [](double d) { return d <= -0.6 && d >= -6.0; });
      const int steps = std::max(1, static_cast<int>((to - from).norm() / step));
      haptics::AroundUpdate found;
      for (int tick = 1; tick <= steps + 5; ++tick) {
        hand = from + (to - from) * std::min(1.0, static_cast<double>(tick) / steps);
        found = touch(hand, state);
        judge.move(object_.view() * hand);
      }
      if (!found.contact && judge.contact()) return true;
    }
    return false;
  }

 private:
  static double unit(std::mt19937_64& random) { return 2.0 * std::generate_canonical<double, 53>(random) - 1.0; }
  haptics::AroundUpdate touch(const Vector3d& hand, haptics::AroundState& state) const {
    return update_around(*on_.surface, object_.view() * hand - on_.surface->origin_m, state, options_);
  }
  template <typename Takes>
  Vector3d place_near(const Vector3d& middle, double reach, std::mt19937_64& random, const Takes& takes) const {
    for (;;) {
      const Vector3d off(unit(random), unit(random), unit(random));
      Vector3d place = middle + reach * on_.h * off;
      if (off.norm() <= 1.0 && takes(object_.distance_m(object_.view() * place) / on_.h)) return place;
    }
  }

  const Touched& on_;
  const Faceted& object_;
  haptics::SolverOptions options_;
};

const std::vector<Eigen::Matrix3d>& views() {
  static const std::vector<Eigen::Matrix3d> all{Eigen::Matrix3d::Identity(), turned(5.0, 8.0), turned(20.0, 30.0),
                                                turned(35.3, 45.0)};
  return all;
}

struct Lost {
  std::size_t hands = 0, lost = 0;
};
Lost lost_about(const std::string& name, const FacetedPtr& object, const std::vector<About>& places) {
  const std::size_t hands = std::getenv("SPARSHA_NIGHTLY") != nullptr ? 1'000 : 60;
  const Touched on = touched(name, object, static_cast<std::size_t>(object->area_m2()));
  Lost lost;
  for (const haptics::CellShape shape : {haptics::CellShape::bilinear, haptics::CellShape::rounded}) {
    std::mt19937_64 random(5);
    for (const About& about : places)
      for (std::size_t k = 0; k < hands; ++k, ++lost.hands)
        lost.lost += Visit(on, *object, shape).is_lost(about, random) ? 1 : 0;
  }
  return lost;
}

void expect_few(const std::string& name, const Lost& lost, std::size_t per_thousand) {
  const std::string all = name + ": " + std::to_string(lost.lost) + " lost of " + std::to_string(lost.hands);
  if (std::getenv("SPARSHA_FIGURES") != nullptr) std::printf("%s\n", all.c_str());
  EXPECT_LE(1'000 * lost.lost, per_thousand * lost.hands) << all;
}

constexpr double kHalf = 14.0;  // of prisms

TEST(Around, TheFootOfALeaningWallLetsGoOfNoHandInTheStone) {
  for (const auto& [lean_deg, per_thousand] :
       std::vector<std::pair<double, std::size_t>>{{10.0, 1}, {20.0, 1}, {30.0, 1}, {40.0, 2}, {50.0, 6}}) {
    const double lean = lean_deg * M_PI / 180.0, wide = 8.0 / std::cos(lean), high = 14.0, off = high * std::tan(lean);
    const std::vector<Vector2d> floor_and_wall{{-16.0, -8.0},
                                               {16.0 + wide + off, -8.0},
                                               {16.0 + wide + off, 0.0},
                                               {wide, 0.0},
                                               {wide + off, high},
                                               {off, high},
                                               {0.0, 0.0},
                                               {-16.0, 0.0}};
    Lost all;
    for (const Eigen::Matrix3d& view : views()) {
      const Lost lost = lost_about("leaning wall", make_prism(floor_and_wall, kHalf, view),
                                   {{{0.0, 0.0, 0.0}, 10.0}, {{wide, 0.0, 0.0}, 10.0}});
      all.hands += lost.hands, all.lost += lost.lost;
    }
    expect_few("wall that leans by " + std::to_string(static_cast<int>(lean_deg)) + " degrees", all, per_thousand);
  }
}

TEST(Around, AcuteEdgesLetGoOfNoHandInTheStone) {
  for (const auto& [edge_deg, per_thousand] :
       std::vector<std::pair<double, std::size_t>>{{30.0, 12}, {45.0, 1}, {60.0, 1}}) {
    const double half = 24.0 * std::tan(0.5 * edge_deg * M_PI / 180.0);
    Lost all;
    for (const Eigen::Matrix3d& view : views()) {
      const Lost lost = lost_about("wedge", make_prism({{0.0, 0.0}, {24.0, -half}, {24.0, half}}, kHalf, view),
                                   {{{4.0, 0.0, 0.0}, 10.0}, {{8.0, kHalf, 0.0}}});
      all.hands += lost.hands, all.lost += lost.lost;
    }
    expect_few("edge of " + std::to_string(static_cast<int>(edge_deg)) + " degrees", all, per_thousand);
  }
}

TEST(Around, CornersOfThreeFacesLetGoOfNoHandInTheStone) {
  const auto cube = [](double low, double high) { return Bounds{Vector3d::Constant(low), Vector3d::Constant(high)}; };
  Lost room, pit, block, ends;
  const auto add = [](Lost& to, const Lost& lost) { to.hands += lost.hands, to.lost += lost.lost; };
  for (const Eigen::Matrix3d& view : views()) {
    add(room, lost_about("room", make_notched(cube(-10.0, 16.0), cube(0.0, 40.0), view), {{Vector3d::Zero()}}));
    add(pit, lost_about("pit",
                        make_notched({{-20.0, -20.0, -20.0}, {20.0, 20.0, 0.0}},
                                     {{-10.0, -10.0, -12.0}, {10.0, 10.0, 30.0}}, view),
                        {{{10.0, 10.0, -12.0}}}));
    add(block, lost_about("block",
                          make_two_boxes({{-20.0, -20.0, -8.0}, {20.0, 20.0, 0.0}},
                                         {{-8.0, -8.0, -5.0}, {8.0, 8.0, 12.0}}, view),
                          {{{8.0, 8.0, 0.0}}, {{8.0, 8.0, 12.0}}}));
    const std::vector<Vector2d> corner{{-16.0, -16.0}, {8.0, -16.0}, {8.0, 8.0},
                                       {-4.0, 8.0},    {-4.0, -4.0}, {-16.0, -4.0}};
    add(ends,
        lost_about("end of a block", make_prism(corner, kHalf, view), {{{-4.0, kHalf, -4.0}}, {{-4.0, kHalf, 8.0}}}));
  }
  expect_few("inner corner of a room", room, 6);
  expect_few("bottom of a pit", pit, 8);
  expect_few("foot and top of a block", block, 6);
  expect_few("ends of an L-shaped block", ends, 2);
}

}  // namespace
}  // namespace sparsha::test
