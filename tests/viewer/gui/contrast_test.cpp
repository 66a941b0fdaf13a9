// The window's contrast mode as it is drawn: words against what is around them, after WCAG 2.2, 1.4.6.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>

#include "tests/viewer/relief_scene.h"
#include "tests/viewer/studio.h"
#include "viewer/gui/brush.h"

namespace sparsha::viewer::test {
namespace {

/// Relative luminance of sRGB, WCAG 2.2.
double luminance(const Pixel& pixel) {
  const auto linear = [](int value) {
    const double share = value / 255.0;
    return share <= 0.04045 ? share / 12.92 : std::pow((share + 0.055) / 1.055, 2.4);
  };
  return 0.2126 * linear(pixel.r) + 0.7152 * linear(pixel.g) + 0.0722 * linear(pixel.b);
}

/// Of the lightest and the darkest pixel where the words are: their ink and their ground.
double contrast(const Image& image, const DrawnText& words) {
  double light = 0.0, dark = 1.0;
  const auto inside = [](float value, int most) { return std::clamp(static_cast<int>(value), 0, most - 1); };
  for (int y = inside(words.y, image.height); y <= inside(words.y + words.height, image.height); ++y)
    for (int x = inside(words.x, image.width); x <= inside(words.x + words.width, image.width); ++x) {
      const double here = luminance(image.at(x, y));
      light = std::max(light, here);
      dark = std::min(dark, here);
    }
  return (light + 0.05) / (dark + 0.05);
}

/// WCAG judges colours without what smooths the edges of glyphs. Words have strokes that are drawn whole; a lone
/// "-" may have none, and is judged by its colours.
bool is_a_word(const std::string& words) {
  return words.size() > 1 || std::isalnum(static_cast<unsigned char>(words.front())) != 0;
}

TEST(Contrast, OfAllColoursThatTheContrastModePutsOnEachOtherIsSevenToOneOrMore) {
  const Theme theme = theme_of(true);
  const auto colour = [](std::uint32_t packed) {
    EXPECT_EQ(packed >> 24U, 255U) << "nothing shines through";
    return Pixel{static_cast<int>(packed & 255U), static_cast<int>(packed >> 8U & 255U),
                 static_cast<int>(packed >> 16U & 255U)};
  };
  const auto ratio = [&](std::uint32_t ink, std::uint32_t ground) {
    const double a = luminance(colour(ink)), b = luminance(colour(ground));
    return (std::max(a, b) + 0.05) / (std::min(a, b) + 0.05);
  };
  for (const std::uint32_t ground : {theme.panel, theme.card})
    for (const std::uint32_t ink : {theme.text, theme.dim, theme.accent, theme.warning, theme.fault, theme.line})
      EXPECT_GE(ratio(ink, ground), 7.0) << std::hex << ink << " on " << ground;
  EXPECT_GE(ratio(theme.text, theme.key), 7.0);
  EXPECT_GE(ratio(theme.accent_text, theme.accent), 7.0);
}

TEST(Contrast, OfAllWordsInTheWindowsContrastModeIsSevenToOneOrMore) {
  haptics::AnnouncementBoard board;
  Connections connections;
  connections.announcements = &board;
  connections.rescan = [](const Eigen::Matrix4d&) {};
  ViewSettings settings;
  settings.high_contrast = true;
  Studio studio(scene_of(lotus, {101, 101, 0.004, 3},
                         [](scene::SceneDescription& description) {
                           scene::PartConfig part;
                           part.name = "lotus";
                           part.box_m = {0.0, 0.0, 1.0, 1.0};
                           description.config.parts.push_back(part);
                         }),
                settings, connections);
  const auto scene = studio.picture().scene();
  double least = 21.0;
  std::string which;
  using Priority = haptics::Announcement::Priority;
  for (const std::uint64_t flags :
       {std::uint64_t{haptics::kFlagImpact | haptics::kFlagFilledArea}, std::uint64_t{haptics::kFlagFault},
        std::uint64_t{haptics::kFlagStale}, std::uint64_t{haptics::kFlagUnknownArea}})
    for (const ColourMode colour : {ColourMode::relief, ColourMode::curvature, ColourMode::coverage})
      for (const bool large : {false, true})
        for (const int page : {0, 1, 2}) {
          haptics::State state = touching(*scene, 0.2, 0.2, 0.01, 0.2, 0.2);
          state.flags |= flags;
          Frame& frame = studio.controller().frame();
          frame.settings.colour = colour;
          frame.settings.large_type = large;
          frame.settings.figures = page == 0;
          frame.settings.help = page == 1;
          frame.asks_rescan = page == 2;
          if (page == 0)
            board.say("A part of the scene cannot be read",
                      (flags & haptics::kFlagFault) != 0 ? Priority::fault : Priority::warning);
          const Image image = studio.shoot(state, 1280, 720);
          const auto& texts = studio.gui().texts();
          const int top = std::max_element(texts.begin(), texts.end(), [](const DrawnText& a, const DrawnText& b) {
                            return a.layer < b.layer;
                          })->layer;
          ASSERT_GT(texts.size(), 10U);
          for (const DrawnText& words : texts) {
            if (words.layer < top && top == 2) continue;  // a page lies over it
            if (!is_a_word(words.words)) continue;
            const double here = contrast(image, words);
            EXPECT_GE(here, 7.0) << words.words << ", page " << page << (large ? ", large" : "");
            if (here < least) which = words.words;
            least = std::min(least, here);
          }
        }
  std::printf("least contrast %.2f : 1, of '%s'\n", least, which.c_str());
  EXPECT_TRUE(studio.gl_errors().empty()) << studio.gl_errors().front();
}

}  // namespace
}  // namespace sparsha::viewer::test
