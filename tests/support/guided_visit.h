// A whole visit without sight: named parts are found by the grip's buttons, and the outline of the last is followed
// with the guide. Who acts knows only what is announced; who judges knows only the stone, what was said, the contacts
// and what the motors were told.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/support/visitor.h"

namespace sparsha::haptics::test {

struct Placed {
  std::string say;
  Vector2d middle_m;
};
/// A stone of 1 m with a disc 8 mm high in the middle of each part.
struct DiscStone {
  std::vector<Placed> parts{{"A leaf", {0.75, 0.8}}, {"The left flower", {0.2, 0.4}}, {"A lotus", {0.6, 0.3}}};
  double radius_m = 0.04;
  double guide_n = 1.2;

  [[nodiscard]] double height_m(double x, double y) const {
    return std::any_of(parts.begin(), parts.end(),
                       [&](const Placed& part) { return (Vector2d(x, y) - part.middle_m).norm() < radius_m; })
               ? 0.008
               : 0.0;
  }
};

/// Finds all parts by the grip's buttons and words alone, and follows the outline of the last with the guide.
inline void visit(Visitor& visitor, const DiscStone& stone) {
  ASSERT_TRUE(visitor.ticks(200));
  for (std::size_t k = 0; k < stone.parts.size(); ++k) {
    const Placed& part = stone.parts[k];
    const std::size_t before = visitor.words.size();
    const std::size_t touches = visitor.states.size();
    const bool last = k + 1 == stone.parts.size();
    visitor.hand().press(kRight);
    ASSERT_TRUE(visitor.hears(part.say, before)) << "under the hand, or its way: distance and hour";
    if (last) {
      ASSERT_TRUE(visitor.hears("Guide on", before)) << "held on, the guide";
    }
    visitor.hand().press(0);
    ASSERT_TRUE(visitor.ticks(300));
    ASSERT_TRUE(visitor.touch()) << part.say;
    ASSERT_TRUE(visitor.hears(part.say, before + 1));
    // The judge: the stone was touched inside the part.
    const bool felt = std::any_of(
        visitor.states.begin() + static_cast<std::ptrdiff_t>(touches), visitor.states.end(), [&](const State& s) {
          const Vector2d off = Vector2d(s.place_m[0], s.place_m[1]) - part.middle_m;
          return s.contact != 0 && s.commanded_force_n[2] > 0.0 && off.cwiseAbs().maxCoeff() < 0.05;
        });
    EXPECT_TRUE(felt) << part.say;
    if (!last) {
      ASSERT_TRUE(visitor.lift());
    }
  }

  // Towards the hour that the guide has named, until it has the hand.
  const auto guide_words = std::find_if(visitor.words.begin(), visitor.words.end(), [](const std::string& text) {
    return text.find("Guide on") != std::string::npos;
  });
  ASSERT_NE(guide_words, visitor.words.end());
  visitor.hand().push(0.03 * direction_of(*guide_words));
  ASSERT_TRUE(visitor.hears("The guide leads your hand", 0)) << ::testing::PrintToString(visitor.words);
  visitor.hand().push(Vector2d::Zero());
  const std::size_t begin = visitor.states.size();
  ASSERT_TRUE(visitor.hears("Once around", 0)) << ::testing::PrintToString(visitor.words);

  // The judge: nearly all of the outline was felt, and the guide was never stronger than it may be.
  int covered = 0;
  for (int degree = 0; degree < 360; ++degree) {
    const double angle = degree * 3.14159265358979 / 180.0;
    const Vector2d place = stone.parts.back().middle_m + stone.radius_m * Vector2d(std::cos(angle), std::sin(angle));
    covered += std::any_of(visitor.states.begin() + static_cast<std::ptrdiff_t>(begin), visitor.states.end(),
                           [&](const State& s) {
                             const Vector2d hand(s.hip_m[0], s.hip_m[1]);
                             return s.scale * (hand - place).norm() < 0.0035;  // states are seen every few milliseconds
                           })
                   ? 1
                   : 0;
  }
  EXPECT_GE(covered, 342) << "95 %";
  for (const State& s : visitor.states) ASSERT_LE(std::hypot(s.guide_n[0], s.guide_n[1]), stone.guide_n + 1e-9);
  EXPECT_LE(visitor.hand().strongest_n(), DeviceLimits{}.max_force_n + 1e-9);
  for (const std::string& words : visitor.words) EXPECT_EQ(words.find('{'), std::string::npos) << words;
  const std::size_t before = visitor.words.size();
  visitor.hand().press(kRight);
  ASSERT_TRUE(visitor.hears("Guide off", before)) << "a hold of the same button ends it";
  visitor.hand().press(0);
}

}  // namespace sparsha::haptics::test
