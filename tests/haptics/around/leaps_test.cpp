// A hand that presses beside a sharp edge and leaps to a place before the edge's other face, within a tick. A convex
// object does not hold it there. Lengths are in mean point spacings, h.
#include <gtest/gtest.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>

#include "haptics/around/around_proxy.h"
#include "tests/support/wandering_hand.h"

namespace sparsha::test {
namespace {

using Eigen::Vector3d;
using haptics::AroundState;
using haptics::AroundUpdate;

/// In the box's own frame.
struct Leap {
  Vector3d above;   ///< 6 h before the pressed face
  Vector3d within;  ///< 1 to 4 h behind it, and 0.5 to 6 h from the edge
  Vector3d out;     ///< of the pressed face, unit
  Vector3d side;    ///< of the edge's other face
  Vector3d beside;  ///< before the edge's other face, and behind the pressed one
};

Leap leap_over_edge(const Vector3d& half, double h, std::mt19937_64& random) {
  const auto among = [&](double low, double high) {
    return low + (high - low) * std::generate_canonical<double, 53>(random);
  };
  const auto sign = [&] { return random() % 2 == 0 ? 1.0 : -1.0; };
  const int pressed = static_cast<int>(random() % 3);
  int other = (pressed + 1 + static_cast<int>(random() % 2)) % 3;
  if (half[other] < 2.0 * h) other = 3 - pressed - other;  // the pressed face is not all edge
  const int along = 3 - pressed - other;
  const Vector3d out = sign() * Vector3d::Unit(pressed), side = sign() * Vector3d::Unit(other);
  Vector3d edge = half.cwiseProduct(out + side);
  edge[along] = among(-0.8, 0.8) * half[along];
  const Vector3d at = edge - among(0.5, std::min(6.0, half[other] / h - 0.3)) * h * side;
  const double depth = among(1.0, std::min(4.0, half[pressed] / h));
  const double behind = among(0.1, std::min(8.0, 2.0 * half[pressed] / h - 0.1));
  return {at + 6.0 * h * out, at - depth * h * out, out, side, edge + among(2.0, 4.0) * h * side - behind * h * out};
}

/// Does a proxy lie on the pressed face, and on no other but the edge's? Over a worn edge a hand may have pressed it
/// onto another face, which then holds the hand against what is thin.
bool is_on_pressed(const Leap& leap, const Vector3d& half, double h, const Vector3d& place) {
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0}) {
      const Vector3d normal = sign * Vector3d::Unit(axis);
      const double off = half[axis] - sign * place[axis];
      if (normal.dot(leap.out) > 0.5 ? std::abs(off) > 0.6 * h : normal.dot(leap.side) < 0.5 && off < 0.6 * h)
        return false;
    }
  return true;
}

struct Held {
  std::size_t leaps = 0, at_once = 0, after_20 = 0, after_400 = 0, unfinished = 0;
};

Held leap_over_edges(const Touched& on, const Vector3d& half, const Eigen::Matrix3d& view, std::size_t leaps,
                     const haptics::SolverOptions& options) {
  std::mt19937_64 random(1);
  Held held;
  while (held.leaps < leaps) {
    const Leap leap = leap_over_edge(half, on.h, random);
    AroundState state;
    const auto hand_at = [&](const Vector3d& place) {
      return update_around(*on.surface, view * place - on.surface->origin_m, state, options);
    };
    const int steps = std::max(1, static_cast<int>((leap.within - leap.above).norm() / (0.25 * on.h)));
    for (int k = 0; k <= steps; ++k)
      (void)hand_at(leap.above + (leap.within - leap.above) * (static_cast<double>(k) / steps));
    const AroundUpdate pressed = hand_at(leap.within);
    const Vector3d place = view.transpose() * (pressed.position_m + on.surface->origin_m);
    if (!pressed.contact || !is_on_pressed(leap, half, on.h, place)) continue;
    ++held.leaps;
    AroundUpdate found;
    for (int tick = 1; tick <= 400 && (tick == 1 || found.contact || found.unfinished); ++tick) {
      found = hand_at(leap.beside);
      const bool holds = found.contact || found.unfinished;
      held.at_once += holds && tick == 1 ? 1 : 0;
      held.after_20 += holds && tick == 20 ? 1 : 0;
      held.after_400 += holds && tick == 400 ? 1 : 0;
      held.unfinished += holds && found.unfinished && tick == 400 ? 1 : 0;
    }
  }
  return held;
}

TEST(Around, NoEdgeHoldsAHandThatLeapedPastIt) {
  const std::size_t leaps = std::getenv("SPARSHA_NIGHTLY") != nullptr ? 30'000 : 1'500;
  const double spacing = std::sqrt(8.0 / 20'000.0);
  for (const Eigen::Matrix3d& view :
       {Eigen::Matrix3d(Eigen::Matrix3d::Identity()), turned(35.3, 45.0), turned(20.0, 30.0)}) {
    for (const double thickness : {0.0, 5.0, 3.0}) {
      const Vector3d half = thickness > 0.0 ? Vector3d(1.0, 1.0, 0.5 * thickness * spacing) : Vector3d(0.6, 0.6, 0.6);
      const Touched on = touched("", make_box(half, view));
      for (const haptics::CellShape shape : {haptics::CellShape::bilinear, haptics::CellShape::rounded}) {
        const Held held = leap_over_edges(on, half, view, leaps, {.shape = shape});
        const std::string all = (thickness > 0.0 ? "plate of " + std::to_string(thickness) : std::string("cube")) +
                                ": of " + std::to_string(held.leaps) + " leaps " + std::to_string(held.at_once) +
                                " held at once, " + std::to_string(held.after_20) + " after 20 ticks, " +
                                std::to_string(held.after_400) + " after 400, " + std::to_string(held.unfinished) +
                                " of them unfinished";
        if (std::getenv("SPARSHA_FIGURES") != nullptr) std::printf("%s\n", all.c_str());
        // Of a night's 540 000 leaps 25 are held, none of them by a proxy that still moves.
        EXPECT_LE(held.after_20, held.leaps / 2'000) << all;
        EXPECT_LE(held.after_400, held.leaps / 2'000) << all;
      }
    }
  }
}

}  // namespace
}  // namespace sparsha::test
