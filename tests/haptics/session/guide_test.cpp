// The guide as a visitor asks for it: lines larger than the workspace, the words for what it does, and where there is
// nothing to be led along.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/phrases/phrases.h"
#include "haptics/session/guide_control.h"
#include "haptics/session/guide_line.h"
#include "haptics/session/navigator.h"
#include "haptics/session/session.h"
#include "haptics/window/window.h"
#include "tests/support/guided_hand.h"
#include "tests/support/scenes.h"
#include "tests/support/servo_parts.h"

namespace sparsha::haptics {
namespace {

using Eigen::Vector2d;

/// A disc of radius 0.3 m, 20 mm high, on a stone of 1 m.
double disc_m(double x, double y) { return std::hypot(x - 0.5, y - 0.5) < 0.3 ? 0.02 : 0.0; }

scene::ScenePointer stone(const test::HeightFunction& height_m, const test::EditDescription& edit = {}) {
  return test::scene_of(height_m, 401, 1.0, 101, Eigen::Vector3d::Zero(), edit);
}

TEST(GuideLine, LargerThanTheWorkspaceIsLedAlongWhileTheWindowScrollsAndRenewsItsTiles) {
  const scene::ScenePointer scene = stone(disc_m);
  AnnouncementBoard board;
  Announcer announcer(board, scene);
  Navigator navigator(scene, 0.1, Effects{true, false}, announcer);
  // A view of a quarter of the stone's width around a place on the border.
  WindowPlan plan = plan_window(scene->description(), ZoomStep{0, 101}, {0.8, 0.5}, 0.1);
  plan.effects.friction = false;
  navigator.settle(plan);
  HapticRenderer renderer(DeviceInfo{}, RendererOptions{}, load_window(*scene, plan, 1));
  const GuideAnswer answer = find_guide({scene, plan.level, {0.8, 0.5, 0.0}, {}});
  ASSERT_NE(answer.guide, nullptr);
  EXPECT_NEAR(answer.guide->path.length_m(), 2.0 * 3.14159265 * 0.3, 0.02);
  Command ask;
  ask.kind = Command::Kind::guide;
  ask.guide = answer.guide;
  static_cast<void>(renderer.apply(ask));
  std::uint64_t windows = 1;
  std::vector<Vector2d> felt;
  const auto between = [&](int tick) {
    const State& now = renderer.state();
    felt.push_back({now.hip_m[0], now.hip_m[1]});
    if (tick % 10 != 0 || tick < 10) return;  // as often as a session looks
    if (auto job = navigator.follow(now)) {
      navigator.settle(job->plan);
      job->command.window = load_window(*job->scene, job->plan, ++windows);
      static_cast<void>(renderer.apply(job->command));
    }
    if (auto scroll = navigator.scroll(now)) static_cast<void>(renderer.apply(*scroll));
  };
  const test::GuidedRun run = test::run(renderer, {.height_m = 0.009}, 60.0, 0.04, between);
  EXPECT_GT(windows, 5U) << "the disc is larger than a window";
  EXPECT_LE(run.strongest_n, 1.0 + 1e-9);
  int covered = 0;
  constexpr int kPlaces = 720;
  for (int k = 0; k < kPlaces; ++k) {
    const Vector2d place(0.5 + 0.3 * std::cos(0.5 * k * 0.0174533), 0.5 + 0.3 * std::sin(0.5 * k * 0.0174533));
    covered += std::any_of(felt.begin(), felt.end(), [&](const Vector2d& hand) {
      return run.states.back().scale * (hand - place).norm() < 0.002;
    });
  }
  EXPECT_GE(covered, 0.95 * kPlaces);
}

TEST(GuideLine, OfAPartIsItsBorderAsFarAsTheSceneReaches) {
  const auto scene = stone(disc_m, [](scene::SceneDescription& d) {
    d.config.guide = scene::GuideConfig{};
    d.config.guide->path = scene::GuideConfig::Path::part;
    d.config.parts = {{"a", "The rim", {0.9, 0.4, 1.4, 0.6}}, {"b", "A leaf", {0.1, 0.1, 0.2, 0.3}}};
  });
  const GuideAnswer leaf = find_guide({scene, 0, {0.15, 0.35, 0.0}, {}});
  ASSERT_NE(leaf.guide, nullptr);
  EXPECT_EQ(leaf.part, "A leaf") << "the nearest one";
  EXPECT_NEAR(leaf.guide->path.length_m(), 0.6, 1e-9);
  EXPECT_NEAR(leaf.way_m.y(), -0.05, 1e-9);
  const GuideAnswer rim = find_guide({scene, 0, {0.15, 0.35, 0.0}, 0});
  ASSERT_NE(rim.guide, nullptr);
  EXPECT_EQ(rim.part, "The rim") << "the one that was gone to";
  EXPECT_NEAR(rim.guide->path.length_m(), 0.6, 1e-6) << "up to the scene's border";
}

TEST(GuideLine, OfAPartOfATurnedStoneStaysOnThePart) {
  const auto scene = stone([](double, double) { return 0.0; },
                           [](scene::SceneDescription& d) {
                             d.config.guide = scene::GuideConfig{};
                             d.config.guide->path = scene::GuideConfig::Path::part;
                             d.config.parts = {{"b", "A leaf", {0.1, 0.1, 0.2, 0.3}}};
                             d.region_from_grid =
                                 Eigen::Matrix4d::Identity();  // turned by half a turn about (0.5, 0.5)
                             (*d.region_from_grid)(0, 0) = (*d.region_from_grid)(1, 1) = -1.0;
                             (*d.region_from_grid)(0, 3) = (*d.region_from_grid)(1, 3) = 1.0;
                           });
  const GuideAnswer leaf = find_guide({scene, 0, {0.5, 0.5, 0.0}, {}});
  ASSERT_NE(leaf.guide, nullptr);
  const test::Polygon turned{{0.8, 0.7}, {0.9, 0.7}, {0.9, 0.9}, {0.8, 0.9}};
  for (std::size_t k = 0; k < leaf.guide->path.pieces(); ++k)
    EXPECT_LT(test::distance_to(turned, true, leaf.guide->path.corner(k).head<2>()), 0.0025 * 1.5);
  EXPECT_NEAR(leaf.guide->path.length_m(), 0.6, 0.02);
}

TEST(GuideLine, ThatIsDrawnIsTakenAsItIs) {
  const auto drawn = [](std::vector<std::array<double, 2>> line, bool turned = false) {
    return find_guide({stone(disc_m,
                             [&](scene::SceneDescription& d) {
                               d.config.guide = scene::GuideConfig{};
                               d.config.guide->path = scene::GuideConfig::Path::drawn;
                               d.config.guide->line_m = line;
                               d.config.guide->force_n = 0.7;
                               d.config.guide->speed_m_per_s = 0.03;
                               if (turned) d.region_from_grid = Eigen::Matrix4d::Identity();
                             }),
                       0,
                       {0.1, 0.1, 0.0},
                       {}});
  };
  const GuideAnswer answer = drawn({{0.1, 0.2}, {0.3, 0.2}, {0.3, 0.4}});
  ASSERT_NE(answer.guide, nullptr);
  EXPECT_NEAR(answer.guide->path.length_m(), 0.4, 1e-12);
  EXPECT_EQ(answer.guide->force_n, 0.7);
  EXPECT_EQ(answer.guide->speed_m_per_s, 0.03);
  EXPECT_EQ(drawn({{3.0, 3.0}, {4.0, 3.0}}).why.key(), "guide_no_line");
  EXPECT_EQ(drawn({{0.1, 0.2}, {0.3, 0.2}}, true).why.key(), "guide_other_side");
}

TEST(GuideLine, ThatIsDrawnBeyondTheStoneIsItsLongestRunOnTheStone) {
  using Drawn = std::vector<std::array<double, 2>>;
  struct Case {
    Drawn line;
    double length_m;  // by hand
  };
  // The stone reaches from 0 to 1 m.
  const std::vector<Case> cases = {
      {{{0.5, 0.5}, {3.0, 0.5}}, 0.5},                                                  // one corner on it
      {{{-1.0, 0.5}, {2.0, 0.5}}, 1.0},                                                 // across it, no corner on it
      {{{0.2, 0.5}, {0.2, -1.0}, {0.5, -1.0}, {0.5, 0.9}}, 0.9},                        // two runs: 0.5 and 0.9
      {{{0.5, 0.5}, {2.0, 0.5}, {2.0, 0.8}, {0.5, 0.8}, {0.5, 0.5}}, 0.5 + 0.3 + 0.5},  // closed: one run
      {{{1.5, 0.0}, {0.0, 1.5}}, std::sqrt(0.5)},                                       // over a corner
      {{{0.1, 0.1}, {0.1, 0.1}, {0.4, 0.1}}, 0.3}};                                     // a corner twice
  for (const Case& drawn : cases) {
    const auto scene = stone(disc_m, [&](scene::SceneDescription& d) {
      d.config.guide = scene::GuideConfig{};
      d.config.guide->path = scene::GuideConfig::Path::drawn;
      d.config.guide->line_m = drawn.line;
    });
    const GuideAnswer answer = find_guide({scene, 0, {0.1, 0.1, 0.0}, {}});
    ASSERT_NE(answer.guide, nullptr);
    EXPECT_NEAR(answer.guide->path.length_m(), drawn.length_m, 1e-9) << ::testing::PrintToString(drawn.line);
    for (std::size_t k = 0; k < answer.guide->path.pieces(); ++k) {
      EXPECT_GE(answer.guide->path.corner(k).minCoeff(), -1e-12);
      EXPECT_LE(answer.guide->path.corner(k).maxCoeff(), 1.0 + 1e-12);
    }
  }
}

TEST(GuideControl, IsOffAsSoonAsItWasDroppedAndOnWhenItIsAskedForAgain) {
  AnnouncementBoard board;
  const auto scene = stone(disc_m);
  Announcer announcer(board, scene);
  GuideControl guide(announcer);
  const GuideWish wish{scene, 0, {0.5, 0.5, 0.0}, {}};
  guide.ask(wish);
  EXPECT_TRUE(guide.on());
  static_cast<void>(guide.stop(true));
  EXPECT_FALSE(guide.on()) << "the search goes on, for nobody";
  guide.ask(wish);
  EXPECT_TRUE(guide.on());
  std::optional<Command> command;
  ASSERT_TRUE(eventually([&] { return (command = guide.poll()).has_value(); }));
  EXPECT_NE(command->guide, nullptr);
}

TEST(GuideControl, SaysWhyWhateverEndedTheSearch) {
  AnnouncementBoard board;
  const auto scene = stone(disc_m, [](scene::SceneDescription& d) {
    d.config.guide = scene::GuideConfig{};
    d.config.guide->path = scene::GuideConfig::Path::part;
  });
  Announcer announcer(board, scene);
  GuideControl guide(announcer);
  guide.ask({scene, 0, {0.5, 0.5, 0.0}, 99});  // std::out_of_range, no Error
  ASSERT_TRUE(eventually([&] {
    EXPECT_FALSE(guide.poll());
    return !board.since(0).empty();
  }));
  EXPECT_EQ(board.since(0).front().priority, Announcement::Priority::fault);
  EXPECT_FALSE(guide.on());
}

TEST(GuideLine, OfTheOutlinePrefersThatOfThePart) {
  const auto two_discs = [](double x, double y) {
    return std::hypot(x - 0.3, y - 0.5) < 0.1 || std::hypot(x - 0.7, y - 0.5) < 0.15 ? 0.02 : 0.0;
  };
  const auto scene = stone(two_discs, [](scene::SceneDescription& d) {
    d.config.parts = {{"a", "The small one", {0.19, 0.39, 0.41, 0.61}}};
  });
  const auto radius_m = [&](const GuideAnswer& answer) { return answer.guide->path.length_m() / (2.0 * 3.14159265); };
  const GuideAnswer part = find_guide({scene, 0, {0.6, 0.5, 0.0}, 0});
  const GuideAnswer nearest = find_guide({scene, 0, {0.6, 0.5, 0.0}, {}});
  ASSERT_TRUE(part.guide && nearest.guide);
  EXPECT_NEAR(radius_m(part), 0.1, 0.004);
  EXPECT_NEAR(radius_m(nearest), 0.15, 0.006);
}

/// A session under a hand at rest, and what it says.
class Listened {
 public:
  explicit Listened(scene::ScenePointer scene, const std::string& language = "en")
      : session_(std::move(scene), std::make_unique<ScriptedDevice>([](std::uint64_t, double time_s) {
                   return sample_at({0.0, 0.0, 0.02}, time_s);
                 }),
                 options(language)) {
    session_.start();
  }
  ~Listened() { session_.stop(); }
  void ask(Request::Kind kind) { session_.requests().post({kind}); }
  [[nodiscard]] bool hears(const std::string& words) { return hears_one_of({words}); }
  [[nodiscard]] bool hears_one_of(const std::vector<std::string>& choice) {
    return eventually([&] {
      session_.poll();
      for (const Announcement& said : session_.announcements().since(0))
        for (const std::string& words : choice)
          if (said.text.find(words) != std::string::npos) return true;
      return false;
    });
  }
  [[nodiscard]] bool sees(const std::function<bool(const State&)>& so) {
    return eventually([&] {
      session_.poll();
      return so(session_.state().read());
    });
  }

 private:
  static SessionOptions options(const std::string& language) {
    SessionOptions result;
    result.longest_gap_s = 1.0;
    result.real_time = false;
    result.language = language;
    return result;
  }
  Session session_;
};

TEST(GuideWords, SayWhereTheOutlineIsAndThatTheGuideIsOff) {
  for (const char* language : {"en", "hi"}) {
    Listened visit(stone(disc_m), language);
    ASSERT_TRUE(visit.sees([](const State& s) { return s.tick > 0; })) << "the hand's place is known";
    visit.ask(Request::Kind::guide);
    const Phrases phrases = Phrases::of(language);
    const std::string on = phrases.text("guide_on");
    EXPECT_TRUE(visit.hears(on.substr(0, on.find('{')))) << language;
    // From the middle, on the overview's nodes of 10 mm, in a workspace of a tenth of the stone.
    EXPECT_TRUE(visit.hears_one_of({phrases.distance(0.029), phrases.distance(0.03), phrases.distance(0.031)}));
    EXPECT_TRUE(visit.sees([](const State& s) { return s.guide == GuidePhase::waiting; }));
    visit.ask(Request::Kind::guide);
    EXPECT_TRUE(visit.hears(phrases.text("guide_off"))) << language;
    EXPECT_TRUE(visit.sees([](const State& s) { return s.guide == GuidePhase::off; }));
  }
}

TEST(GuideWords, SayWhenThereIsNothingToBeLedAlong) {
  for (const char* language : {"en", "hi"}) {
    Listened visit(stone([](double x, double) { return 0.1 * x; }), language);
    visit.ask(Request::Kind::guide);
    EXPECT_TRUE(visit.hears(Phrases::of(language).text("guide_no_outline"))) << language;
    EXPECT_TRUE(visit.sees([](const State& s) { return s.guide == GuidePhase::off; }));
  }
}

}  // namespace
}  // namespace sparsha::haptics
