// Parts in parts under a hand that goes over their borders: what is said of them, and what is not.
#include "haptics/effects/part_watch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <random>
#include <vector>

namespace sparsha::haptics {
namespace {

using Eigen::Vector2d;

constexpr double kLook_s = 0.01, kMargin_m = 0.002;

/// A figure (2) with a head (1) with an eye (0), the smallest first; nothing around.
std::optional<std::size_t> figure(const Vector2d& at) {
  if ((at - Vector2d(0.0, 0.012)).norm() < 0.006) return 0;
  if ((at - Vector2d(0.0, 0.01)).norm() < 0.016) return 1;
  if (std::abs(at.x()) < 0.03 && std::abs(at.y()) < 0.04) return 2;
  return std::nullopt;
}

struct Said {
  std::size_t part;
  double time_s;
};

template <class Way>
std::vector<Said> follow(PartWatch& watch, double seconds, const Way& way, double begin_s = 100.0) {
  std::vector<Said> said;
  for (double t = 0.0; t < seconds; t += kLook_s)
    if (const auto part = watch.watch(way(t), kMargin_m, begin_s + t, figure)) said.push_back({*part, begin_s + t});
  return said;
}

Vector2d around(double t, double period_s, double radius_m) {
  const double angle = 2.0 * std::numbers::pi * t / period_s;
  return Vector2d(0.0, 0.002) + radius_m * Vector2d(std::cos(angle), std::sin(angle));
}

TEST(PartWatch, AHandThatCirclesOverBordersHearsFewWords) {
  // Told at every entry it would be 8 to 60 in this half minute.
  for (const double period_s : {1.0, 2.0, 4.0, 7.0})
    for (const double radius_m : {0.006, 0.01, 0.015}) {
      PartWatch watch;
      std::size_t entries = 0;
      std::optional<std::size_t> before;
      const auto said = follow(watch, 29.0, [&](double t) {
        const Vector2d at = around(t, period_s, radius_m);
        const auto here = figure(at);
        entries += here && here != before ? 1 : 0;
        before = here;
        return at;
      });
      EXPECT_LE(said.size(), 8U) << period_s << " s, " << radius_m << " m, entries " << entries;
      if (entries >= 20) {
        EXPECT_LE(4 * said.size(), entries) << period_s << " s, " << radius_m << " m";
      }
      EXPECT_GE(said.size(), 1U);
    }
}

TEST(PartWatch, AHandThatTremblesOnABorderHearsOnePart) {
  std::mt19937 random(7);
  std::normal_distribution<double> tremble(0.0, 0.0004);
  PartWatch watch;
  const auto said = follow(watch, 29.0, [&](double) { return Vector2d(0.016 + tremble(random), 0.01); });
  EXPECT_EQ(said.size(), 1U);
}

TEST(PartWatch, AHandThatStaysIsToldAtOnceInAPartThatIsNewToItAndSoonInAnyOther) {
  std::mt19937 random(20261125);
  std::uniform_real_distribution<double> x(-0.025, 0.025), y(-0.035, 0.035), pause(1.5, 6.0);
  PartWatch watch;
  double time_s = 100.0;
  std::optional<std::size_t> last;
  std::vector<double> first(3, -1.0);
  for (int k = 0; k < 300; ++k) {
    const Vector2d at(x(random), y(random));
    const auto here = figure(at);
    const double stay_s = pause(random);
    const auto said = follow(
        watch, 5.0, [&](double) { return at; }, time_s);
    ASSERT_TRUE(here.has_value());
    if (here != last) {
      ASSERT_EQ(said.size(), 1U) << k;
      EXPECT_EQ(said.front().part, *here);
      // Within a second, unless it was told again and again; at once where it was not known.
      EXPECT_LE(said.front().time_s - time_s, 4.0 + kLook_s) << k;
      if (first[*here] < 0.0) {
        const double near_s = 1.0 + kLook_s;  // beside the border of the one before
        EXPECT_LE(said.front().time_s - time_s, near_s) << k;
      }
      first[*here] = time_s;
    } else {
      EXPECT_TRUE(said.empty()) << k;
    }
    last = here;
    time_s += 5.0 + 1e-9 * stay_s;
  }
}

TEST(PartWatch, ASmallPartWithinIsToldWhereTheHandStaysHoweverNearItsBorder) {
  PartWatch watch;
  EXPECT_EQ(follow(watch, 2.0, [](double) { return Vector2d(0.0, -0.03); }).size(), 1U);
  const auto said = follow(
      watch, 2.0, [](double) { return Vector2d(0.0, 0.0065); }, 102.0);  // half a millimetre inside
  ASSERT_EQ(said.size(), 1U);
  EXPECT_EQ(said.front().part, 0U);
  EXPECT_LE(said.front().time_s, 103.0 + 2.0 * kLook_s);
}

TEST(PartWatch, APartIsSaidAgainToAHandThatComesBackAfterAWhile) {
  PartWatch watch;
  EXPECT_EQ(follow(watch, 1.0, [](double) { return Vector2d(0.0, -0.03); }).size(), 1U);
  const auto again = follow(
      watch, 1.0, [](double) { return Vector2d(0.0, -0.03); }, 120.0);
  ASSERT_EQ(again.size(), 1U);
  EXPECT_EQ(again.front().time_s, 120.0);
  watch.forget();
  EXPECT_EQ(follow(
                watch, 0.05, [](double) { return Vector2d(0.0, -0.03); }, 121.0)
                .size(),
            1U)
      << "another scene";
}

}  // namespace
}  // namespace sparsha::haptics
