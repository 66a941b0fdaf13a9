// Heights in words: steps, slopes, and what is too small or too soon to be said.
#include "haptics/session/relief_words.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "tests/support/scenes.h"
#include "tests/support/soft_stone.h"

namespace sparsha::haptics {
namespace {

class Relief : public ::testing::Test {
 protected:
  /// Along x over a height, at the hand's size, in so many seconds.
  void go(double to_m, double seconds, const std::function<double(double)>& height_m) {
    const double from_m = x_m_;
    const int looks = static_cast<int>(seconds / 0.01);
    for (int k = 1; k <= looks; ++k) {
      x_m_ = from_m + (to_m - from_m) * k / looks;
      State state;
      state.time_s = time_s_ += 0.01;
      state.contact = 1;
      state.scale = scale_;
      const Eigen::Vector3d proxy_m =
          turn_.conjugate() * Eigen::Vector3d(x_m_ / scale_, 0.0, height_m(x_m_) / scale_ + off_m_);
      state.proxy_m = {proxy_m.x(), proxy_m.y(), proxy_m.z()};
      state.turn = {turn_.x(), turn_.y(), turn_.z(), turn_.w()};
      words_.watch(state);
    }
  }
  std::vector<std::string> said() {
    std::vector<std::string> texts;
    for (const Announcement& announcement : board_.since(0)) texts.push_back(announcement.text);
    return texts;
  }
  using Texts = std::vector<std::string>;

  double scale_ = 0.5, x_m_ = 0.0, time_s_ = 100.0, off_m_ = 5.4e6;
  Eigen::Quaterniond turn_ = Eigen::Quaterniond::Identity();
  AnnouncementBoard board_;
  Announcer announcer_{board_, sparsha::test::flat_scene()};
  ReliefWords words_{announcer_, board_};
};

TEST_F(Relief, AStepIsOneHoweverManyLooksItTakesAndIsSaidInTheStonesSize) {
  const auto step = [](double x) { return 0.004 * std::clamp((x - 0.01) / 0.001, 0.0, 1.0); };
  go(0.02, 1.0, step);
  go(0.02, 1.0, step);
  EXPECT_EQ(said(), (Texts{"Step up, 8 millimetres"}));
  go(0.0, 1.0, step);
  go(0.0, 1.0, step);
  EXPECT_EQ(said(), (Texts{"Step up, 8 millimetres", "Step down, 8 millimetres"}));
}

TEST_F(Relief, OfAWholeObjectItIsTowardsTheVisitorHoweverTheObjectIsTurned) {
  const auto step = [](double x) { return 0.004 * std::clamp((x - 0.01) / 0.001, 0.0, 1.0); };
  const std::vector<Eigen::AngleAxisd> turns{Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitY()),
                                             Eigen::AngleAxisd(-0.5 * M_PI, Eigen::Vector3d::UnitY()),
                                             Eigen::AngleAxisd(1.0, Eigen::Vector3d(1.0, 2.0, 3.0).normalized())};
  off_m_ = 0.3;
  Texts wanted;
  for (const Eigen::AngleAxisd& turn : turns) {
    turn_ = turn;
    x_m_ = 0.0;
    go(0.02, 1.0, step);
    go(0.02, 1.0, step);
    wanted.emplace_back("Step up, 8 millimetres");
    EXPECT_EQ(said(), wanted) << "and nothing of the turn itself";
  }
}

TEST_F(Relief, ASlopeIsSaidWhereTheHandRestsAndOnTheWayWhereItIsHigh) {
  const auto slope = [](double x) { return 0.3 * x; };
  go(0.015, 0.5, slope);
  EXPECT_EQ(said(), Texts{});
  go(0.015, 1.0, slope);
  EXPECT_EQ(said(), (Texts{"Up 9 millimetres"}));
  go(0.085, 2.5, slope);
  EXPECT_GE(said().size(), 2U) << "on the way";
  EXPECT_LE(said().size(), 3U);
}

TEST_F(Relief, TextureRoughPlanesAndRestAreNotSaid) {
  const auto rough = [](double x) { return 0.0008 * std::sin(2.0 * M_PI * x / 0.003); };
  go(0.04, 4.0, rough);
  go(0.04, 3.0, rough);
  go(-0.04, 4.0, rough);
  EXPECT_EQ(said(), Texts{});
}

TEST_F(Relief, WordsOfOthersAreHeardToTheirEnd) {
  const auto slope = [](double x) { return 0.4 * x; };
  go(0.001, 0.2, slope);
  announcer_.say_as_is("Lotus medallion, carved about the year 1000");  // takes some three seconds
  go(0.02, 1.0, slope);
  go(0.02, 1.0, slope);
  EXPECT_EQ(said().size(), 1U);
  go(0.02, 2.0, slope);
  ASSERT_EQ(said().size(), 2U);
  EXPECT_EQ(said().back(), "Up 2 centimetres") << "the whole way since";
}

TEST_F(Relief, SmallHeightsUnderAMagnifiedViewAreNoMillimetre) {
  scale_ = 20.0;
  const auto step = [](double x) { return x > 0.01 ? 0.006 : 0.0; };
  go(0.02, 1.0, step);
  go(0.02, 1.0, step);
  EXPECT_EQ(said(), (Texts{"Step up, 0.3 millimetres"}));
}

TEST_F(Relief, StoneThatGivesNoForceIsNotSpokenOf) {
  const auto ramp = [](double x, double) { return 0.3 * std::max(0.0, x - 0.055); };
  const auto scene = sparsha::test::scene_of(ramp, 201, 0.1, 201, Eigen::Vector3d::Zero(), [](auto& description) {
    scene::PartConfig part;
    part.say = "Upper step";
    part.box_m = {0.062, 0.0, 0.1, 0.1};
    description.config.parts.push_back(part);
  });
  sparsha::test::SoftStone stone(window_on(scene));
  Announcer announcer(board_, scene);
  const auto stroke = [&](double height_m) {
    for (int k = 0; k < 3000; ++k) {
      const State& state = height_m == 0.0 ? stone.stroke(1e-5 * k) : stone.go({1e-5 * k, 0.0, height_m});
      announcer.watch(state);
      words_.watch(state);
    }
  };
  stroke(0.0);
  EXPECT_EQ(stone.state().contact, 1U);
  EXPECT_EQ(said(), Texts{});
  announcer.describe(stone.state(), View{});
  EXPECT_NE(said().back().find("touching without a force: lift your hand"), std::string::npos) << said().back();
  const std::size_t before = said().size();
  for (int k = 0; k < 100; ++k) stone.go({0.0, 0.0, 0.02});
  stroke(-0.001);
  EXPECT_GT(said().size(), before) << "once it has been lifted, the same stroke is told";
}

}  // namespace
}  // namespace sparsha::haptics
