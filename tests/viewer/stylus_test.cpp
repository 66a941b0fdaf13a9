// The stylus of a grip whose orientation is measured, judged by the pixels that it changes.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>

#include "relief_scene.h"
#include "studio.h"

namespace sparsha::viewer::test {
namespace {

constexpr double kHalf = 0.70710678118654752;

/// Mean of the changed pixels relative to the ball, and how many there are; x to the right, y up.
struct Change {
  double x = 0.0, y = 0.0;
  int count = 0, orange = 0;
};

class Stylus : public testing::Test {
 protected:
  Stylus() : studio_(scene_of([](double, double) { return 0.0; }, {201, 201, 0.001, 1})) {
    state_ = touching(*studio_.picture().scene(), 0.1, 0.1, 0.0, 0.1, 0.1);
    state_.force_n = state_.commanded_force_n = {};
    studio_.settle(state_);
    without_ = studio_.shoot_bare(state_);
    const auto ball = [](const Pixel& p) { return p.b > p.r + 40; };
    const Image::Spot spot = without_.find(layout_of(1280, 720, {}).detail, ball);
    x_ = spot.x;
    y_ = spot.y;
  }
  Change with(const std::array<double, 4>& orientation) {
    haptics::State state = state_;
    state.orientation = orientation;
    const Image image = studio_.shoot_bare(state);
    Change change;
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        const Pixel a = image.at(x, y), b = without_.at(x, y);
        if (std::abs(a.r - b.r) + std::abs(a.g - b.g) + std::abs(a.b - b.b) < 24) continue;
        change.x += x - x_;
        change.y += y_ - y;
        ++change.count;
        if (a.r > 190 && a.g > 60 && a.g < 130 && a.b < 60) ++change.orange;
      }
    if (change.count > 0) {
      change.x /= change.count;
      change.y /= change.count;
    }
    return change;
  }

  Studio studio_;
  haptics::State state_;
  Image without_;
  double x_ = 0.0, y_ = 0.0;
};

TEST_F(Stylus, IsNotDrawnWithoutAMeasuredOrientation) { EXPECT_EQ(with({}).count, 0); }

TEST_F(Stylus, LiesWhereTheGripIsTurned) {
  // The pen's far end goes from the person (z) to the right, to the left, up and down.
  const Change right = with({kHalf, 0.0, kHalf, 0.0}), left = with({kHalf, 0.0, -kHalf, 0.0});
  const Change up = with({kHalf, -kHalf, 0.0, 0.0}), down = with({kHalf, kHalf, 0.0, 0.0});
  for (const Change& change : {right, left, up, down}) EXPECT_GT(change.count, 400);
  EXPECT_GT(right.x, 40.0);
  EXPECT_LT(std::abs(right.y), 0.3 * right.x);
  EXPECT_LT(left.x, -40.0);
  EXPECT_GT(up.y, 30.0);
  EXPECT_LT(std::abs(up.x), 0.3 * up.y);
  EXPECT_LT(down.y, -15.0) << "shortened, as the picture is seen from the front and below";
  // Between the axes: turned by 45 degrees about the line of sight from the right.
  const double c = std::cos(M_PI / 8), s = std::sin(M_PI / 8);
  const Change slanted = with({kHalf * c, -kHalf * s, kHalf * c, kHalf * s});
  EXPECT_GT(slanted.x, 20.0);
  EXPECT_GT(slanted.y, 20.0);
}

TEST_F(Stylus, ShowsItsRollByTheButtonOnItsSide) {
  // Along the stone to the right; its side to the person, or away from the person.
  const Change front = with({0.5, 0.5, 0.5, 0.5}), back = with({0.5, -0.5, 0.5, -0.5});
  EXPECT_GT(front.x, 40.0);
  EXPECT_GT(back.x, 40.0);
  EXPECT_GT(front.orange, 10);
  EXPECT_EQ(back.orange, 0) << "hidden by the pen";
}

TEST_F(Stylus, LeavesNoErrorOfOpenGl) {
  static_cast<void>(with({1.0, 0.0, 0.0, 0.0}));
  EXPECT_TRUE(studio_.gl_errors().empty());
}

}  // namespace
}  // namespace sparsha::viewer::test
