// report.json by its contract, the pictures pixel by pixel, report.html by the rules of accessibility.
#include "pipeline/report/report.h"
#include "base/text/html.h"
#include "pipeline/report/html.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>

#include "pipeline/report/colour.h"
#include "pipeline/report/images.h"
#include "pipeline/report/style.h"
#include "pipeline/report/svg.h"
#include "scene/scene.h"
#include "tests/pipeline/report/contrast.h"
#include "tests/support/checked_cloud.h"
#include "tests/support/test_folder.h"

namespace sparsha::pipeline {
namespace {

using nlohmann::json;
using testing::contrast;
using testing::grid_of;
using testing::lattice_of;

scene::ScenePointer example_scene(const std::string& file = "../scans/altar <left> & \"right\".ply") {
  scene::Layers base;
  base.grid = grid_of(lattice_of(120, 90, 0.001, {1, 2, 3}),
                      [](double x, double y) { return 0.01 * std::sin(60 * x) * std::cos(50 * y); });
  for (int j = 10; j < 20; ++j)
    for (int i = 10; i < 30; ++i) {
      base.grid.height_m[base.grid.lattice.index(i, j)] = scene::kUnknownHeight;
      base.grid.state[base.grid.lattice.index(i, j)] = scene::NodeState::unknown;
    }
  base.grid.state[base.grid.lattice.index(60, 60)] = scene::NodeState::filled;
  base.envelope_m = base.grid.height_m;
  for (std::size_t n = 0; n < base.envelope_m.size(); n += 3) base.envelope_m[n] += 0.0001F;
  base.curvature_per_m.assign(base.grid.lattice.count(), 4.0F);
  scene::SceneDescription scene;
  scene.config.texture = scene::TextureConfig{};
  scene.config.friction = scene::FrictionConfig{};
  scene.config.check = scene::CheckConfig{};
  scene.levels = {base.grid.lattice};
  scene.sources = {{file, std::string(64, 'a'), 12345}};
  scene.config.scans.push_back({file, {}, Eigen::Matrix4d::Identity()});
  scene.noise_m = 0.0002;
  scene.height_min_m = 2.99;
  scene.height_max_m = 3.01;
  scene.friction_c_m = 0.01;
  scene.has_envelope = scene.has_curvature = true;
  std::vector<scene::Layers> levels;
  levels.push_back(std::move(base));
  return scene::make_scene(std::move(scene), std::move(levels));
}

Report example_report() {
  Report report;
  report.points = {12345, 12000, 100, 45, 150, 30, 20};
  report.coverage = 0.98;
  report.filled_fraction = 0.0001;
  CheckResult check;
  check.cloud_to_surface = {5000, 1e-4, 1.3e-4, 8e-5, 4e-5, 2.5e-4, 4e-4, 9e-3, 1e-6, 2e-6};
  check.surface_to_cloud = {5000, 4e-4, 5e-4, 4e-4, 1e-4, 8e-4, 1e-3, 2e-3, 2e-6, 2e-6};
  check.completeness = 0.97;
  check.tolerance_m = 0.001;
  for (std::size_t n = 0; n < 120 * 90; n += 7) check.node_errors.node.push_back(n);
  check.node_errors.error_m.assign(check.node_errors.node.size(), 1e-4F);
  check.cloud_histogram.assign(64, 70);
  check.histogram_bin_m = 1e-5;
  check.surface_histogram.assign(64, 75);
  check.surface_histogram_bin_m = 2e-5;
  check.second_method_samples = 200;
  report.check = check;
  report.stages = {{"read", 0.1}, {"project", 0.2}};
  report.total_seconds = 0.35;
  report.peak_rss_bytes = 200000000;
  report.warnings = {"the size is <implausible> & odd"};
  return report;
}

TEST(ReportJson, HasEveryKeyOfTheContract) {
  const json report = json::parse(report_json(*example_scene(), example_report()));
  for (const char* pointer : {"/points/read",    "/points/used",     "/points/occluded",
                              "/points/outlier", "/points/outside",  "/points/filtered",
                              "/points/invalid", "/grid/nx",         "/grid/ny",
                              "/grid/spacing_m", "/size_m/0",        "/size_m/1",
                              "/size_m/2",       "/coverage",        "/filled_fraction",
                              "/noise_m",        "/stages/0/name",   "/stages/0/seconds",
                              "/total_seconds",  "/peak_rss_bytes",  "/check/completeness",
                              "/inputs/0/file",  "/inputs/0/sha256", "/inputs/0/points",
                              "/warnings/0",     "/version",         "/invented"})
    EXPECT_TRUE(report.contains(json::json_pointer(pointer))) << pointer;
  for (const char* direction : {"cloud_to_surface", "surface_to_cloud"})
    for (const char* key : {"samples", "mean_m", "rms_m", "median_m", "mad_m", "p95_m", "p99_m", "max_m"})
      EXPECT_TRUE(report["check"][direction][key].is_number()) << direction << ' ' << key;
}

TEST(Report, SaysWhetherTheNoiseWasEstimatedOrGiven) {
  const auto scene = example_scene();
  scene::SceneDescription description = scene->description();
  description.config.grid.noise_m = description.noise_m;
  const auto given = scene::make_scene(description, {scene->read_level(0)});
  EXPECT_THAT(report_html(*scene, example_report(), {}, {}), ::testing::HasSubstr("standard deviation, estimated"));
  EXPECT_THAT(report_html(*given, example_report(), {}, {}),
              ::testing::HasSubstr("standard deviation, from grid.noise_mm"));
}

TEST(Report, SaysWhatIsFeltAndWasInvented) {
  const auto scene = example_scene();
  EXPECT_TRUE(json::parse(report_json(*scene, example_report()))["invented"].empty());
  scene::SceneDescription description = scene->description();
  description.config.haptics.impact = description.config.haptics.grain = true;
  const auto inventive = scene::make_scene(description, {scene->read_level(0)});
  EXPECT_EQ(json::parse(report_json(*inventive, example_report()))["invented"], json({"impact", "grain"}));
  const std::string html = report_html(*inventive, example_report(), {}, {});
  EXPECT_NE(html.find("was not measured"), std::string::npos);
  EXPECT_EQ(report_html(*scene, example_report(), {}, {}).find("was not measured"), std::string::npos);
}

TEST(ReportText, CountsTheNodesWhoseFrictionIsNotTold) {
  const scene::ScenePointer scene = example_scene();
  ASSERT_TRUE(scene->description().config.friction);
  Report report = example_report();
  EXPECT_TRUE(nlohmann::json::parse(report_json(*scene, report)).at("friction").is_null());
  EXPECT_THAT(report_html(*scene, report, {}, {}), ::testing::Not(::testing::HasSubstr("Friction not told")));
  report.friction = Report::Friction{4000, 1000};
  const auto friction = nlohmann::json::parse(report_json(*scene, report)).at("friction");
  EXPECT_EQ(friction.at("nodes"), 4000);
  EXPECT_EQ(friction.at("undecided"), 1000);
  const std::string html = report_html(*scene, report, {}, {});
  EXPECT_THAT(html, ::testing::HasSubstr("Friction not told</dt><dd>25"));
}

TEST(ReportText, SaysWhichMethodDecidedTheSurface) {
  const scene::ScenePointer scene = example_scene();
  Report report = example_report();
  EXPECT_FALSE(json::parse(report_json(*scene, report)).contains("surface"));
  EXPECT_THAT(report_html(*scene, report, {}, {}), ::testing::Not(::testing::HasSubstr("Surface decided by")));
  report.surface = {"tangent discs", 0.25};
  const json surface = json::parse(report_json(*scene, report)).at("surface");
  EXPECT_EQ(surface.at("method"), "tangent discs");
  EXPECT_EQ(surface.at("sparse_share"), 0.25);
  EXPECT_THAT(report_html(*scene, report, {}, {}), ::testing::HasSubstr("Surface decided by</dt><dd>tangent discs"));
}

TEST(ReportJson, ReadIsTheSumOfTheOthers) {
  const json points = json::parse(report_json(*example_scene(), example_report()))["points"];
  std::uint64_t sum = 0;
  for (const auto& [key, value] : points.items()) sum += key == "read" ? 0 : value.get<std::uint64_t>();
  EXPECT_EQ(points["read"], sum);
}

TEST(ReportJson, SaysNullWhereThereAreNoFigures) {
  Report report = example_report();
  report.check.reset();
  json parsed = json::parse(report_json(*example_scene(), report));
  EXPECT_TRUE(parsed["check"]["cloud_to_surface"].is_null());
  EXPECT_TRUE(parsed["check"]["surface_to_cloud"].is_null());
  EXPECT_TRUE(parsed["check"]["completeness"].is_null());
  report.check.emplace();
  report.coverage = std::numeric_limits<double>::quiet_NaN();
  parsed = json::parse(report_json(*example_scene(), report));
  EXPECT_TRUE(parsed["check"]["cloud_to_surface"].is_null());
  EXPECT_TRUE(parsed["coverage"].is_null());
}

/// A report of a build that took a floor away, some outliers, and thinned what was left.
Report filtered_report() {
  Report report = example_report();
  Report::Filter floor{"remove_plane", 2000, false, false, "a <plane>", {}};
  Report::Filter outliers{"radius_outliers", 3, true, false, "", {}};
  Report::Filter thin{"thin", 500, false, true, "", {}};
  for (int i = 0; i < 40; ++i)
    for (int j = 0; j < 40; ++j) {
      floor.sample_m.emplace_back(1 + 0.003 * i, 1.95, 3 + 0.003 * j);
      report.kept_m.emplace_back(1 + 0.003 * i, 2 + 0.002 * j, 3);
    }
  outliers.sample_m = {{1.05, 2.05, 3.05}, {1e6, 1e6, 1e6}};
  report.filters = {floor, outliers, thin};
  return report;
}

TEST(ReportJson, ListsWhatEachFilterTookAway) {
  const json filters = json::parse(report_json(*example_scene(), filtered_report()))["filters"];
  ASSERT_EQ(filters.size(), 3U);
  EXPECT_EQ(filters[0]["name"], "remove_plane");
  EXPECT_EQ(filters[0]["removed"], 2000);
  EXPECT_EQ(filters[0]["counted_as"], "filtered");
  EXPECT_EQ(filters[0]["found"], "a <plane>");
  EXPECT_EQ(filters[1]["counted_as"], "outlier");
  EXPECT_TRUE(filters[1]["found"].is_null());
  EXPECT_TRUE(json::parse(report_json(*example_scene(), example_report()))["filters"].empty());
}

TEST(ReportPictures, ShowWhatTheFiltersTookAwayInColoursOfALegend) {
  const scene::ScenePointer scene = example_scene();
  ThreadPool pool(2);
  const std::vector<Picture> pictures =
      make_pictures(scene->read_level(0), scene->description(), filtered_report(), pool);
  const Picture& picture = pictures.back();
  ASSERT_EQ(picture.name, "filters");
  ASSERT_EQ(picture.entries.size(), 3U) << "what is left, the floor and the outliers; thinning has no places";
  EXPECT_THAT(picture.entries[1].label, ::testing::HasSubstr("remove_plane"));
  EXPECT_THAT(picture.alternative, ::testing::HasSubstr("remove_plane took"));
  EXPECT_THAT(legend_svg(picture), ::testing::HasSubstr("aria-label='Legend: left by the filters, remove_plane"));
  // The colour of a legend's entry in its lightest shade, and how many pixels have any shade of its hue.
  const auto pixels_like = [&](const Rgb& colour) {
    return std::count_if(picture.pixels.begin(), picture.pixels.end(), [&](std::uint8_t p) {
      const Rgb& c = picture.palette[p];
      const double share = c.r / std::max(1.0, static_cast<double>(colour.r));
      return p != 0 && std::abs(c.g - share * colour.g) <= 2 && std::abs(c.b - share * colour.b) <= 2;
    });
  };
  const auto all = static_cast<std::ptrdiff_t>(picture.pixels.size());
  EXPECT_GT(pixels_like(picture.entries[0].colour), all / 40);
  EXPECT_GT(pixels_like(picture.entries[1].colour), all / 40);
  EXPECT_GT(pixels_like(picture.entries[2].colour), 0) << "the near outlier";
  EXPECT_LE(std::max(picture.width, picture.height), 1024) << "the far outlier does not shrink the object";
  EXPECT_NEAR(picture.width_m, 0.17, 0.06);
}

TEST(ReportPictures, ShowTheSidesToChooseFromWithTheirNamesAndDirections) {
  Report report = example_report();
  const auto named = [&] {
    ThreadPool pool(1);
    const scene::ScenePointer scene = example_scene();
    std::vector<Picture> sides;
    for (Picture& picture : make_pictures(scene->read_level(0), scene->description(), report, pool))
      if (picture.name == "sides") sides.push_back(std::move(picture));
    return sides;
  };
  EXPECT_TRUE(named().empty());
  // Each side is one pixel of surface at its own place, in an own grey.
  constexpr int kWidth = 5;
  const std::vector<std::string> names = {"front", "back", "left", "right", "top", "bottom"};
  for (std::size_t k = 0; k < names.size(); ++k) {
    Report::Side side{
        names[k], Eigen::Vector3d(0.25, 0.0, 1.0 + static_cast<double>(k)), Eigen::Vector3d::UnitY(), kWidth, {}};
    side.grey.assign(static_cast<std::size_t>(kWidth * kWidth), Report::kNoSurface);
    side.grey[k] = static_cast<std::uint8_t>(40 * k + 20);
    report.sides.push_back(side);
  }
  report.side_pixel_m = 0.002;
  const std::vector<Picture> pictures = named();
  ASSERT_EQ(pictures.size(), 1U);
  const Picture& picture = pictures.front();
  ASSERT_EQ(picture.width, 3 * kWidth);
  ASSERT_EQ(picture.height, 2 * kWidth);
  EXPECT_DOUBLE_EQ(picture.width_m, 3 * kWidth * 0.002);
  int last = 0;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const int at = static_cast<int>(k);
    const int column = at % 3 * kWidth + at % kWidth;
    const int row = at / 3 * kWidth + at / kWidth;
    const int shade = picture.pixels[static_cast<std::size_t>(row * picture.width + column)];
    EXPECT_GT(shade, last) << names[k];
    last = shade;
    EXPECT_NE(picture.caption.find(
                  fmt::format("{}: orientation: {{look_from: [0.25, 0, {}], up: [0, 1, 0]}}", names[k], k + 1)),
              std::string::npos)
        << picture.caption;
  }
}

TEST(ReportPictures, ShowMoreFiltersThanThereAreColours) {
  Report report = filtered_report();
  const Report::Filter floor = report.filters.front();
  report.filters.assign(40, floor);
  for (std::size_t k = 0; k < report.filters.size(); ++k) {
    report.filters[k].name = "filter-" + std::to_string(k) + ".";
    for (Eigen::Vector3d& p : report.filters[k].sample_m) p.y() += 0.02 * static_cast<double>(k);
  }
  const scene::ScenePointer scene = example_scene();
  ThreadPool pool(2);
  const Picture picture = make_pictures(scene->read_level(0), scene->description(), report, pool).back();
  ASSERT_EQ(picture.entries.size(), 1U + report.filters.size());
  EXPECT_EQ(picture.entries[1].colour.r, picture.entries[8].colour.r) << "seven colours";
  EXPECT_THAT(picture.alternative, ::testing::HasSubstr("filter-39. took"));
  EXPECT_THAT(picture.caption, ::testing::HasSubstr("colours repeat"));
  // The points of the last one lie above all others and are drawn, in its colour.
  const std::uint8_t top = *std::find_if(picture.pixels.begin(), picture.pixels.end(), [](auto p) { return p != 0; });
  const Rgb& colour = picture.entries.back().colour;
  const Rgb& c = picture.palette[top];
  const double share = c.r / std::max(1.0, static_cast<double>(colour.r));
  EXPECT_NEAR(c.g, share * colour.g, 2.0);
  EXPECT_NEAR(c.b, share * colour.b, 2.0);
}

TEST(ReportJson, SurvivesNamesThatAreNoUtf8) {
  const json report = json::parse(report_json(*example_scene("caf\xE9.ply"), example_report()));
  EXPECT_THAT(report["inputs"][0]["file"].get<std::string>(), ::testing::StartsWith("caf"));
}

TEST(ReportPictures, ShowTheTopRowFirstAndMarkUnknownNodes) {
  const scene::ScenePointer scene = example_scene();
  ThreadPool pool(2);
  const std::vector<Picture> pictures =
      make_pictures(scene->read_level(0), scene->description(), example_report(), pool);
  std::vector<std::string> names;
  for (const Picture& picture : pictures) names.push_back(picture.name);
  EXPECT_THAT(names, ::testing::ElementsAre("relief", "height", "texture", "friction", "coverage", "error"));
  for (const Picture& picture : pictures) {
    ASSERT_EQ(picture.width, 120);
    ASSERT_EQ(picture.height, 90);
    EXPECT_FALSE(picture.alternative.empty());
    // Nodes (10..29, 10..19) are unknown: pixel rows 70 to 79.
    for (int row = 0; row < 90; ++row)
      for (int column = 0; column < 120; ++column) {
        const std::uint8_t value = picture.pixels[static_cast<std::size_t>(row * 120 + column)];
        const bool unknown = column >= 10 && column < 30 && row >= 70 && row < 80;
        ASSERT_EQ(value == 0 || value == 255, unknown) << picture.name << ' ' << column << ' ' << row;
      }
  }
}

TEST(ReportPictures, StayBelow1024PixelsASide) {
  scene::Layers base;
  base.grid = grid_of(lattice_of(3001, 50, 0.001), [](double x, double) { return x; });
  scene::SceneDescription scene;
  scene.levels = {base.grid.lattice};
  ThreadPool pool(1);
  const std::vector<Picture> pictures = make_pictures(base, scene, Report{}, pool);
  EXPECT_EQ(pictures[0].width, 1001);
  EXPECT_EQ(pictures[0].height, 17);
}

Rgb parse_colour(const std::string& hex) {
  const auto part = [&](std::size_t k) {
    return static_cast<std::uint8_t>(std::stoi(hex.substr(1 + 2 * k, 2), nullptr, 16));
  };
  return {part(0), part(1), part(2)};
}

class ReportFolder : public ::testing::Test {
 protected:
  void SetUp() override {
    ThreadPool pool(2);
    write_report(*example_scene(), example_report(), folder_, pool);
    std::ifstream file(folder_ / "report.html");
    std::stringstream text;
    text << file.rdbuf();
    html_ = text.str();
  }

  /// All matches of the expression's first group (or the whole when it has none).
  [[nodiscard]] std::vector<std::string> all(const std::string& expression) const {
    // Base-64 bodies are long; std::regex would recurse through them.
    std::string text;
    for (std::size_t begin = 0; begin < html_.size();) {
      const std::size_t at = html_.find(";base64,", begin);
      text += html_.substr(begin, at == std::string::npos ? std::string::npos : at - begin);
      if (at == std::string::npos) break;
      begin = html_.find_first_of("'\"", at);
    }
    const std::regex regex(expression);
    std::vector<std::string> found;
    for (std::sregex_iterator it(text.begin(), text.end(), regex), end; it != end; ++it)
      found.push_back((*it)[it->size() > 1 ? 1 : 0].str());
    return found;
  }

  const test::TestFolder folder_;
  std::string html_;
};

TEST_F(ReportFolder, HoldsTheReportsAndThePreviews) {
  for (const char* name : {"report.json", "report.html", "relief.png", "height.png", "texture.png", "friction.png",
                           "coverage.png", "error.png"})
    EXPECT_GT(std::filesystem::file_size(folder_ / name), 100U) << name;
}

TEST_F(ReportFolder, PageNeedsNothingButItself) {
  EXPECT_THAT(html_, ::testing::Not(::testing::HasSubstr("http")));
  EXPECT_THAT(html_, ::testing::Not(::testing::HasSubstr("<script")));
  EXPECT_THAT(html_, ::testing::Not(::testing::HasSubstr("<link")));
  EXPECT_THAT(html_, ::testing::Not(::testing::HasSubstr("@import")));
  for (const std::string& source : all("src='([^']*)'")) EXPECT_EQ(source, "data:image/png");
  for (const std::string& target : all("href='([^']*)'")) EXPECT_EQ(target[0], '#') << target;
}

TEST_F(ReportFolder, PageIsStructuredForAssistiveTechnology) {
  EXPECT_THAT(html_, ::testing::StartsWith("<!DOCTYPE html>\n<html lang='en'>"));
  EXPECT_EQ(all("<title>[^<]+</title>").size(), 1U);
  EXPECT_EQ(all("<h1>").size(), 1U);
  EXPECT_EQ(all("<main ").size(), 1U);
  EXPECT_GE(all("<nav aria-label='[^']+'>").size(), 1U);
  EXPECT_EQ(all("<img ").size(), 6U);
  EXPECT_EQ(all("<img [^>]*alt='[^']{10,}'").size(), 6U);
  EXPECT_EQ(all("<svg ").size(), all("<svg [^>]*role='img' aria-label='[^']{10,}'").size());
  EXPECT_EQ(all("<table>").size(), all("<table><caption>[^<]+</caption>").size());
  EXPECT_EQ(all("<th[ >]").size(), all("<th [^>]*scope='(col|row)'").size());
  // Headings do not skip a level.
  int level = 1;
  for (const std::string& heading : all("<h([1-6])[ >]")) {
    EXPECT_LE(std::stoi(heading), level + 1);
    level = std::stoi(heading);
  }
  // Every jump has its target, and no id stands twice.
  const std::vector<std::string> ids = all(" id='([^']+)'");
  const std::set<std::string> unique(ids.begin(), ids.end());
  EXPECT_EQ(ids.size(), unique.size());
  for (const std::string& target : all("href='#([^']+)'")) EXPECT_TRUE(unique.count(target)) << target;
  for (const std::string& target : all("aria-labelledby='([^']+)'")) EXPECT_TRUE(unique.count(target)) << target;
  // What scrolls can be reached with the keyboard.
  EXPECT_EQ(all("<pre").size(), all("<pre tabindex='0'").size());
  EXPECT_EQ(all("class='scroll'").size(), all("class='scroll' tabindex='0' role='region' aria-label='[^']+'").size());
}

TEST_F(ReportFolder, PageEscapesWhatFilesAndWarningsSay) {
  EXPECT_THAT(html_, ::testing::HasSubstr("altar &lt;left&gt; &amp; &quot;right&quot;"));
  EXPECT_THAT(html_, ::testing::HasSubstr("the size is &lt;implausible&gt; &amp; odd"));
  EXPECT_THAT(html_, ::testing::Not(::testing::HasSubstr("<left>")));
}

TEST_F(ReportFolder, PageHasBalancedTags) {
  std::vector<std::string> open;
  const std::set<std::string> empty = {"meta", "img", "br", "hr", "stop", "rect", "line"};
  for (const std::string& tag : all("<(/?[a-zA-Z][a-zA-Z0-9]*)[^>]*>")) {
    if (tag[0] == '/') {
      ASSERT_FALSE(open.empty()) << tag;
      EXPECT_EQ("/" + open.back(), tag);
      open.pop_back();
    } else if (!empty.count(tag)) {
      open.push_back(tag);
    }
  }
  EXPECT_THAT(open, ::testing::IsEmpty());
}

TEST_F(ReportFolder, WordsOfThePageHaveSevenToOneContrast) {
  const std::string style = kReportStyle;
  const auto colour = [&](const std::string& name) {
    const std::size_t at = style.find("--" + name + ":#");
    EXPECT_NE(at, std::string::npos) << name;
    return parse_colour(style.substr(at + name.size() + 3, 7));
  };
  for (const char* ground : {"paper", "card"})
    for (const char* text : {"ink", "soft", "accent"})
      EXPECT_GE(contrast(colour(text), colour(ground)), 7.0) << text << " on " << ground;
  EXPECT_GE(contrast(colour("warnink"), colour("warn")), 7.0);
  EXPECT_GE(contrast(colour("ink"), colour("head")), 7.0);
  // Words have the palette's colours, or black on white.
  const std::set<std::string> known = {"var(--ink)", "var(--soft)", "var(--accent)", "var(--warnink)", "#fff", "#111"};
  const std::regex words(R"((?:^|[;{])color:([^;}]+))");
  for (std::sregex_iterator at(style.begin(), style.end(), words), end; at != end; ++at)
    EXPECT_TRUE(known.count((*at)[1])) << (*at)[1];
  EXPECT_GE(contrast(colour("bar"), colour("paper")), 3);  // graphics
}

TEST(ReportText, EscapesNames) { EXPECT_EQ(escape_html("a\xFF<b>"), "a\uFFFD&lt;b&gt;"); }

}  // namespace
}  // namespace sparsha::pipeline
