// Words at every size of the window: none lies on another, none leaves the window.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <tuple>

#include "relief_scene.h"
#include "scene/scene.h"
#include "studio.h"
#include "tests/viewer/cloud/points.h"
#include "viewer/cloud/mode.h"

namespace sparsha::viewer::test {
namespace {

constexpr std::array<std::pair<int, int>, 8> kSizes{
    {{640, 400}, {800, 600}, {1024, 600}, {1280, 720}, {720, 1280}, {1920, 1080}, {2560, 1080}, {3840, 2160}}};

/// The first pair of the same layer that overlaps by more than a pixel, or a text outside; empty when all is well.
std::string fault_in(const std::vector<DrawnText>& texts, int width, int height) {
  constexpr float kPlay = 1.0F;
  for (std::size_t a = 0; a < texts.size(); ++a) {
    const DrawnText& p = texts[a];
    if (p.x < -kPlay || p.y < -kPlay || p.x + p.width > static_cast<float>(width) + kPlay ||
        p.y + p.height > static_cast<float>(height) + kPlay)
      return "outside: " + p.words;
    if (p.room > 0.0F && p.width > p.room + kPlay) return "cut off: " + p.words;
    for (std::size_t b = a + 1; b < texts.size(); ++b) {
      const DrawnText& q = texts[b];
      // A shadow under the same words is meant.
      if (p.layer != q.layer || p.words == q.words) continue;
      const float across = std::min(p.x + p.width, q.x + q.width) - std::max(p.x, q.x);
      const float down = std::min(p.y + p.height, q.y + q.height) - std::max(p.y, q.y);
      if (across > kPlay && down > kPlay) return p.words + " on " + q.words;
    }
  }
  return {};
}

TEST(Layout, NoWordsOverlapAtAnySizeWithOrWithoutLargeType) {
  haptics::AnnouncementBoard board;
  Connections connections;
  connections.announcements = &board;
  connections.rescan = [](const Eigen::Matrix4d&) {};
  const auto edit = [](scene::SceneDescription& description) {
    scene::PartConfig part;
    part.name = "lotus medallion of the second gallery";
    part.box_m = {0.0, 0.0, 1.0, 1.0};
    description.config.parts.push_back(part);
  };
  ViewSettings settings;
  settings.colour = ColourMode::curvature;
  Studio studio(scene_of(lotus, {101, 101, 0.004, 3}, edit), settings, connections);
  const auto scene = studio.picture().scene();
  haptics::State state = touching(*scene, 0.2, 0.2, 0.01, 0.2, 0.2);
  state.flags |= haptics::kFlagImpact | haptics::kFlagFilledArea;
  studio.controller().frame().title = "Lion of the northern staircase, second flight";
  for (const auto& [width, height] : kSizes)
    for (const bool large : {false, true})
      for (const int page : {0, 1, 2, 3, 4}) {
        Frame& frame = studio.controller().frame();
        frame.settings.large_type = large;
        frame.settings.figures = page == 0;
        frame.settings.help = page == 1;
        frame.asks_rescan = page == 2;
        frame.settings.colour = page == 3 ? ColourMode::coverage : ColourMode::curvature;
        frame.settings.contour_m = page == 4 ? 0.002 : 0.0;
        frame.marks.typing.reset();
        if (page == 4)
          frame.marks.typing = "A chip at the third petal, seen in 1987, and again in 2004; it has not grown";
        frame.marks.profile.resize(page == 4 ? 100 : 0);
        for (std::size_t k = 0; k < frame.marks.profile.size(); ++k)
          frame.marks.profile[k] = {0.004 * static_cast<double>(k),
                                    {0.004 * static_cast<double>(k), 0.2, 1e-4 * static_cast<double>(k % 17)},
                                    scene::NodeState::measured};
        frame.marks.tool = page == 4 ? Tool::profile : Tool::none;
        if (page == 0) board.say("A part of the scene cannot be read: the tile at the upper left of the second level");
        studio.shoot(state, width, height);
        EXPECT_GT(studio.gui().texts().size(), 20U);
        EXPECT_EQ(fault_in(studio.gui().texts(), width, height), "")
            << width << " x " << height << (large ? " large" : "") << ", page " << page;
      }
  EXPECT_TRUE(studio.gl_errors().empty()) << studio.gl_errors().front();
}

TEST(Layout, LettersAreOfElevenPixelsOrMoreInAWindowOf800By600OrLarger) {
  constexpr double kSmallType = 13.0;  // pixels at scale 1
  for (const auto& [width, height] : kSizes) {
    if (width < 800 || height < 600) continue;
    for (const bool large : {false, true}) {
      ViewSettings settings;
      settings.large_type = large;
      const Layout layout = layout_of(width, height, settings);
      EXPECT_GE(std::round(kSmallType * layout.scale), large ? 14.0 : 11.0) << width << " x " << height;
      EXPECT_LE(layout.panel.width, width / 2) << width << " x " << height;
    }
  }
}

TEST(Layout, ButtonsKeepTheirWholeLabelsInAWindowOf800By600) {
  Studio studio(scene_of(lotus, {101, 101, 0.004, 3}), {}, {});
  studio.shoot(touching(*studio.picture().scene(), 0.2, 0.2, 0.01, 0.2, 0.2), 800, 600);
  const std::vector<DrawnText>& texts = studio.gui().texts();
  const std::vector<Action> buttons = studio.controller().buttons();
  ASSERT_GT(buttons.size(), 8U);
  for (const Action action : buttons) {
    const std::string label = info_of(action).label;
    EXPECT_TRUE(std::ranges::any_of(texts, [&](const DrawnText& text) { return text.words == label; })) << label;
  }
}

TEST(Layout, TextureAndFrictionThatASceneHasNotAreNeitherOnNorOff) {
  const auto words_of = [](bool has) {
    Studio studio(scene_of(lotus, {101, 101, 0.004, 3}, [&](scene::SceneDescription& description) {
      description.config.friction.reset();
      if (has) description.config.friction = scene::FrictionConfig{};
    }));
    EXPECT_EQ(studio.controller().frame().has_friction, has);
    studio.controller().frame().has_texture = has;
    haptics::State state = touching(*studio.picture().scene(), 0.2, 0.2, 0.01, 0.2, 0.2);
    state.flags |= haptics::kFlagTexture | haptics::kFlagFriction;
    state.contact = 0;
    studio.shoot(state);
    std::map<std::string, int> counts;
    for (const DrawnText& text : studio.gui().texts()) ++counts[text.words];
    return counts;
  };
  std::map<std::string, int> with = words_of(true), without = words_of(false);
  EXPECT_EQ(with["on"], 2);
  EXPECT_EQ(with["none"], 0);
  EXPECT_EQ(without["on"], 0);
  EXPECT_EQ(without["none"], 2);
}

TEST(Layout, NoWordsOfAnExhibitOverlapAtAnySize) {
  haptics::AnnouncementBoard board;
  Connections connections;
  connections.announcements = &board;
  connections.next_scene = [](int) {};
  ViewSettings settings;
  settings.kiosk = true;
  Studio studio(scene_of(lotus, {101, 101, 0.004, 3}), settings, connections);
  const haptics::State state = touching(*studio.picture().scene(), 0.2, 0.2, 0.01, 0.2, 0.2);
  Frame& frame = studio.controller().frame();
  frame.title = "Lion of the northern staircase, second flight";
  for (const bool speaks : {false, true})
    for (const auto& [width, height] : kSizes)
      for (const bool large : {false, true})
        for (const bool help : {false, true}) {
          frame.settings.large_type = large;
          frame.settings.help = help;
          frame.has_pointer = help && large;
          if (speaks) board.say("The object that you touch now: lion of the northern staircase, second flight");
          studio.shoot(state, width, height);
          EXPECT_GE(studio.gui().texts().size(), help ? 10U : 5U);
          EXPECT_EQ(fault_in(studio.gui().texts(), width, height), "")
              << width << " x " << height << (large ? " large" : "") << (help ? " help" : "");
        }
}

// What lies under the buttons cannot be touched with the mouse.
TEST(Layout, AnExhibitsStoneLiesAboveItsButtonsAtEverySize) {
  Connections connections;
  connections.next_scene = [](int) {};
  ViewSettings settings;
  settings.kiosk = true;
  Studio studio(scene_of(lotus, {101, 101, 0.01, 1}), settings, connections);
  const Stage& stage = studio.picture().stage();
  for (const auto& [width, height] : kSizes)
    for (const bool large : {false, true}) {
      studio.controller().frame().settings.large_type = large;
      studio.settle({}, width, height);
      studio.shoot({}, width, height);
      const Layout layout = layout_of(width, height, studio.controller().frame().settings);
      ASSERT_GT(layout.bar.height, 0);
      EXPECT_EQ(layout.bar.y + layout.bar.height, height);
      for (const double x : {0.0, 1.0})
        for (const double y : {0.0, 1.0}) {
          const auto corner = studio.picture().detail_view().to_pixel(stage.to_world({x, y, 0.0}));
          ASSERT_TRUE(corner);
          EXPECT_LT(corner->y() + layout.detail.y, layout.bar.y) << width << " x " << height << (large ? " large" : "");
          EXPECT_GT(corner->y() + layout.detail.y, 0.0) << width << " x " << height << (large ? " large" : "");
        }
    }
}

TEST(Layout, NoWordsBesideARawCloudOverlapOrAreCutOffAtAnySize) {
  PointView view = square(100, 1.0);
  view.title = "Lion of the northern staircase, second flight";
  const gl::OffscreenContext context;
  Workshop workshop(std::move(view));
  workshop.status.spacing_m = 0.001;
  for (const auto& size : kSizes)
    for (const bool large : {false, true})
      for (const int page : {0, 1, 2, 3}) {
        Gui gui;
        CloudMode mode(workshop.orienting(), {});
        ViewSettings settings;
        settings.large_type = large;
        const gl::Target target(size.first, size.second, false);
        workshop.status.busy = page == 2;
        workshop.status.stage = page == 2 ? "Filtering 12 345 678 points of the second scan" : "";
        double time_s = 0.0;
        const int width = size.first, height = size.second;
        const auto draw = [&] {
          mode.controller().frame().finished = true;
          mode.draw(gui, settings, target.framebuffer(), width, height, time_s += 0.5, true);
        };
        draw();
        if (page == 1) mode.controller().act(CloudAction::help);
        if (page == 3) mode.controller().act(CloudAction::crop);
        draw();
        draw();
        EXPECT_GT(gui.texts().size(), 10U);
        EXPECT_EQ(fault_in(gui.texts(), width, height), "")
            << width << " x " << height << (large ? " large" : "") << ", page " << page;
      }
}

TEST(Layout, ALegendTellsTheEndsOfARangeOfMicrometresApart) {
  ViewSettings settings;
  settings.colour = ColourMode::height;
  for (const double depth_m : {3e-6, 4.2e-5, 0.003, 0.4}) {
    const auto wave = [&](double x_m, double) { return 0.5 * depth_m * std::sin(30.0 * x_m); };
    Studio studio(scene_of(wave, {101, 101, 0.004, 1}), settings);
    studio.shoot();
    const Legend& legend = studio.picture().legend();
    const auto is_range = [&](const DrawnText& text) {
      return text.words.ends_with(" " + legend.unit) && text.words.find("\xE2\x80\x93") != std::string::npos;
    };
    const auto& texts = studio.gui().texts();
    const auto range = std::ranges::find_if(texts, is_range);
    ASSERT_NE(range, texts.end()) << depth_m;
    const double high = std::stod(range->words.substr(range->words.find("\xE2\x80\x93") + 3));
    const double half_a_digit = 0.005;  // of the number: three digits
    EXPECT_NEAR(high, legend.high, half_a_digit * legend.high) << range->words;
  }
}

TEST(Layout, LettersOfOtherAlphabetsAreDrawn) {
  Studio studio(scene_of(lotus, {51, 51, 0.008, 1}));
  const auto differ = [&](const char* one, const char* other) {
    studio.controller().frame().title = one;
    const Image a = studio.shoot();
    studio.controller().frame().title = other;
    return a.rgba != studio.shoot().rgba;
  };
  EXPECT_FALSE(differ("A", "A"));
  EXPECT_FALSE(differ("\xE0\xA4\x95", "\xE0\xA4\x97")) << "letters that the fonts lack all look alike";
  EXPECT_TRUE(differ("\xD0\x96", "\xD0\xA9")) << "Cyrillic";
  EXPECT_TRUE(differ("\xCE\xAC", "\xCF\x8E")) << "Greek with accents";
  EXPECT_TRUE(differ("\xCE\x86", "\xCE\x88")) << "its capitals";
  EXPECT_TRUE(differ("\xE1\xBC\x80", "\xE1\xBF\xB3")) << "and with breathings";
}

}  // namespace
}  // namespace sparsha::viewer::test
