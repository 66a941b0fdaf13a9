// Parts as polygons and labels: read, refused, written back, found on the object, kept with the scene.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/files/files.h"
#include "base/png/png.h"
#include "base/yaml/yaml.h"
#include "scene/area/regions.h"
#include "scene/material/friction_law.h"
#include "tests/support/scenes.h"
#include "tests/support/test_folder.h"

namespace sparsha::scene {
namespace {

using ::testing::HasSubstr;

const std::string kScan = "scans: [{file: a.ply}]\n";
const std::string kLabels = "audio: {labels: {file: labels.png}}\n";

Config read(const std::string& text) { return parse_config(yaml::parse_text(text, "c.yaml"), {}); }

std::string message_of(const std::string& text) {
  try {
    static_cast<void>(read(text));
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    return error.what();
  }
  return {};
}

TEST(PartPlaces, AreReadAndWrittenBack) {
  const Config config = read(kScan +
                             "parts:\n"
                             "  - {name: a, box_m: [0, 0, 1, 1]}\n"
                             "  - {name: b, polygon_m: [[0, 0], [1, 0.125], [0.5, 1e-3]], more: \"x\"}\n"
                             "  - {name: c, label: 65535, stiffness_n_per_m: 350}\n" +
                             kLabels);
  ASSERT_EQ(config.parts.size(), 3U);
  EXPECT_TRUE(config.parts[0].is_box());
  EXPECT_EQ(config.parts[1].polygon_m, (std::vector<std::array<double, 2>>{{0, 0}, {1, 0.125}, {0.5, 1e-3}}));
  EXPECT_FALSE(config.parts[1].label);
  EXPECT_EQ(config.parts[2].label, 65535);
  const std::string written = to_yaml(config);
  EXPECT_THAT(written,
              HasSubstr("name: \"b\", say: \"b\", polygon_m: [[0, 0], [1, 0.125], [0.5, 0.001]], more: \"x\"}"));
  EXPECT_THAT(written, HasSubstr("name: \"c\", say: \"c\", label: 65535, stiffness_n_per_m: 350}"));
  EXPECT_EQ(to_yaml(read(written)), written);
}

TEST(PartPlaces, ThatAreNoneAreRefusedWhereTheyStand) {
  std::string many = "[";
  for (int k = 0; k <= 1000; ++k) many += "[" + std::to_string(k) + ", " + std::to_string(k * k) + "], ";
  many += "]";
  const std::vector<std::pair<std::string, std::vector<const char*>>> cases = {
      {"{name: a}", {"c.yaml:2:9", "part 'a' has no place", "box_m, polygon_m or label"}},
      {"{name: ' ', box_m: [0, 0, 1, 1]}", {"c.yaml:2:16", "the name of a part is empty", "words by which it is"}},
      {"{name: a, box_m: [0,0,1,1], polygon_m: [[0,0],[1,0],[0,1]]}",
       {"c.yaml:2:48", "'box_m' and 'polygon_m' contradict"}},
      {"{name: a, polygon_m: [[0,0],[1,0],[0,1]], label: 1}", {"c.yaml:2:58", "'polygon_m' and 'label' contradict"}},
      {"{name: a, polygon_m: [[0,0],[1,0]]}", {"c.yaml:2:30", "fewer than three corners"}},
      {"{name: a, polygon_m: 7}", {"c.yaml:2:30", "fewer than three corners"}},
      {"{name: a, polygon_m: [[0,0],[1,1],[2,2]]}", {"c.yaml:2:30", "the polygon has no area"}},
      {"{name: a, polygon_m: [[0,0],[1,0],[1,1],[1,0]]}", {"c.yaml:2:30", "the polygon has no area"}},
      {"{name: a, polygon_m: [[0,0],[1,0],[.nan,1]]}", {"c.yaml:2:44", "not a finite number"}},
      {"{name: a, polygon_m: [[0,0],[1,0],[1]]}", {"c.yaml:2:43", "the list has 1 entries"}},
      {"{name: a, polygon_m: [[0,0],[1,0],[1,1e300]]}", {"c.yaml:2:43", "farther away than 1e12 m"}},
      {"{name: a, polygon_m: " + many + "}", {"c.yaml:2:30", "the polygon has 1001 corners", "at most 1000"}},
      {"{name: a, label: 0}", {"c.yaml:2:26", "label is 0", "1 to 65535"}},
      {"{name: a, label: 1.5}", {"c.yaml:2:26", "not a whole number"}},
      {"{name: a, label: 3}", {"c.yaml:2:26", "the scene no label image", "labels: {file: labels.png}"}},
      {"{name: a, polygn_m: [[0,0],[1,0],[0,1]]}", {"c.yaml:2:19", "did you mean 'polygon_m'?"}},
      {"{name: a, lable: 3}", {"did you mean 'label'?"}},
      {"{name: a, box: [0,0,1,1]}", {"did you mean 'box_m'?"}},
  };
  for (const auto& [part, says] : cases) {
    const std::string message = message_of(kScan + "parts: [" + part + "]\n");
    for (const char* text : says) EXPECT_THAT(message, HasSubstr(text)) << part.substr(0, 80);
  }
  EXPECT_THAT(message_of(kScan + "parts: [{name: a, label: 3}]\naudio: {material: granite}\n"),
              HasSubstr("c.yaml:2:26"));
  EXPECT_THAT(message_of(kScan + "audio: {regions: [{name: a, label: 3, material: wood}]}\n"),
              HasSubstr("an audio region has a label and the scene no label image"));
  for (const char* good : {"[[0,0],[1,1],[1,0],[0,1]]", "[[0,0],[1,0],[0,1],[1,1]]", "[[0,0],[1,0],[1,1],[0,0]]"})
    EXPECT_EQ(message_of(kScan + "parts: [{name: a, polygon_m: " + good + "}]\n"), "") << good;
}

/// A PNG of 8 x 8 grey pixels with an L of 5 in its lower left: 6 pixels high and wide, 2 thick.
void write_labels(const std::filesystem::path& file) {
  PngFormat format;
  format.width = format.height = 8;
  format.pixel = PngFormat::Pixel::grey16;
  std::vector<std::uint8_t> pixels(128, 0);
  for (int row = 0; row < 8; ++row)
    for (int column = 0; column < 8; ++column)
      if (row >= 2 && column < 6 && (column < 2 || row >= 6))
        pixels[static_cast<std::size_t>(2 * (row * 8 + column) + 1)] = 5;
  write_png(file, format, pixels);
}

constexpr double kWidth = 0.8;

/// A stone of 0.8 m; an L of a polygon on the right of an L of a label, each with a foot to the right.
ScenePointer stone(const std::filesystem::path& labels, const test::EditDescription& edit = {}, bool flat = true) {
  return test::scene_of(
      [&](double x, double) { return flat ? 0.0 : 0.1 * x; }, {161, 161, 0.005, 2},
      [&](SceneDescription& d) {
        d.config.audio.emplace();
        d.config.audio->labels = LabelImageConfig{labels, std::array<double, 4>{0, 0, 0.4, 0.4}};
        PartConfig polygon;
        polygon.name = polygon.say = "polygon";
        polygon.polygon_m = {{0.5, 0.1}, {0.75, 0.1}, {0.75, 0.2}, {0.6, 0.2}, {0.6, 0.5}, {0.5, 0.5}};
        PartConfig label;
        label.name = label.say = "label";
        label.label = 5;
        PartConfig nowhere;
        nowhere.name = "nowhere";
        nowhere.label = 6;
        d.config.parts = {polygon, label, nowhere};
        if (edit) edit(d);
      });
}

std::string name_at(const Scene& scene, double x, double y) {
  const PartConfig* part = part_at(scene.description(), {x, y, 0.0});
  return part != nullptr ? part->name : "";
}

TEST(PartPlaces, AreFoundOnTheStone) {
  const test::TestFolder folder;
  write_labels(folder / "labels.png");
  const ScenePointer scene = stone(folder / "labels.png");
  EXPECT_EQ(name_at(*scene, 0.55, 0.4), "polygon");
  EXPECT_EQ(name_at(*scene, 0.7, 0.15), "polygon");
  EXPECT_EQ(name_at(*scene, 0.7, 0.4), "") << "in its notch";
  EXPECT_EQ(name_at(*scene, 0.05, 0.25), "label");
  EXPECT_EQ(name_at(*scene, 0.25, 0.05), "label");
  EXPECT_EQ(name_at(*scene, 0.25, 0.25), "");
  for (const std::size_t part : {0U, 1U}) {
    const auto place = part_place(*scene, part);
    ASSERT_TRUE(place);
    EXPECT_TRUE(area_of(scene->description(), part).holds(place->middle_m.x(), place->middle_m.y()));
  }
  EXPECT_EQ(part_place(*scene, 0)->box_m, (std::array<double, 4>{0.5, 0.1, 0.75, 0.5}));
  EXPECT_FALSE(part_place(*scene, 2));
}

TEST(PartPlaces, StayOnTheObjectThatWasTurned) {
  const test::TestFolder folder;
  write_labels(folder / "labels.png");
  const ScenePointer scene = stone(folder / "labels.png", [](SceneDescription& d) {
    d.region_from_grid = Eigen::Matrix4d::Identity();  // by half a turn about the middle
    (*d.region_from_grid)(0, 0) = (*d.region_from_grid)(1, 1) = -1.0;
    (*d.region_from_grid)(0, 3) = (*d.region_from_grid)(1, 3) = kWidth;
  });
  const auto polygon = part_place(*scene, 0);
  ASSERT_TRUE(polygon);
  const std::array<double, 4> turned{kWidth - 0.75, kWidth - 0.5, kWidth - 0.5, kWidth - 0.1};
  for (std::size_t side = 0; side < 4; ++side) EXPECT_NEAR(polygon->box_m[side], turned[side], 0.0101);
  for (const std::size_t part : {0U, 1U}) {
    const Eigen::Vector2d middle = part_place(*scene, part)->middle_m;
    EXPECT_TRUE(area_of(scene->description(), part).holds(kWidth - middle.x(), kWidth - middle.y()));
  }
  EXPECT_FALSE(part_place(*scene, 2));
}

TEST(PartPlaces, OfBoxesAreTheBoxesAndTheirMiddles) {
  const ScenePointer scene = test::scene_of([](double, double) { return 0.0; }, {11, 11, 0.1},
                                            [](SceneDescription& d) {
                                              d.config.parts = {{"a", "", {0.1, 0.2, 0.7, 0.3}}};
                                            });
  EXPECT_EQ(part_place(*scene, 0)->box_m, (std::array<double, 4>{0.1, 0.2, 0.7, 0.3}));
  EXPECT_EQ(part_place(*scene, 0)->middle_m, Eigen::Vector2d(0.5 * (0.1 + 0.7), 0.5 * (0.2 + 0.3)));
  EXPECT_EQ(part_at(scene->description(), {0.1, 0.3, 5.0}), scene->description().config.parts.data()) << "borders too";
}

TEST(PartPlaces, FrictionFollowsAPolygonAsTheSameBox) {
  const auto made = [](bool polygon) {
    return test::scene_of([](double, double) { return 0.0; }, {161, 161, 0.005},
                          [&](SceneDescription& d) {
                            d.config.friction = FrictionConfig{};
                            d.config.friction->law = FrictionConfig::Law::constant;
                            PartConfig part;
                            part.touch.mu_dynamic = 0.7;
                            part.touch.mu_static = 0.8;
                            if (polygon)
                              part.polygon_m = {{0.2, 0.1}, {0.6, 0.1}, {0.6, 0.5}, {0.2, 0.5}};
                            else
                              part.box_m = {0.2, 0.1, 0.6, 0.5};
                            d.config.parts = {part};
                          });
  };
  const ScenePointer box = made(false), polygon = made(true);
  constexpr double kScale = 0.1;  // a border of 20 mm
  const FrictionLaw of_box(box->description(), kScale, 0.1), of_polygon(polygon->description(), kScale, 0.1);
  const Layers layers = box->read_level(0);
  const Lattice& lattice = layers.grid.lattice;
  int between = 0;
  for (int j = 0; j < lattice.ny; ++j)
    for (int i = 0; i < lattice.nx; ++i) {
      const double x = lattice.x_m(i), y = lattice.y_m(j);
      const float a = of_box.dynamic(layers, lattice.index(i, j)), b = of_polygon.dynamic(layers, lattice.index(i, j));
      between += a > 0.2F && a < 0.7F ? 1 : 0;
      const bool corner = (x < 0.2 || x > 0.6) && (y < 0.1 || y > 0.5);
      EXPECT_NEAR(a, b, corner ? 0.05 : 1e-7) << x << ' ' << y;
      EXPECT_NEAR(of_box.at_rest(layers, lattice.index(i, j), a), of_polygon.at_rest(layers, lattice.index(i, j), b),
                  corner ? 0.05 : 1e-7);
    }
  EXPECT_GT(between, 300);
}

TEST(PartPlaces, GoWithTheSceneFolderWhereverItIsMoved) {
  const test::TestFolder folder;
  write_labels(folder / "drawn.png");
  std::filesystem::create_directories(folder / "scene");
  const auto scanned = [](SceneDescription& d) {
    d.config.scans.resize(1);
    d.config.scans[0].file = "scan.ply";
    d.sources = {{"scan.ply", std::string(64, 'a'), 77}};
  };
  write_scene(*stone(folder / "drawn.png", scanned), folder / "scene");
  std::filesystem::remove(folder / "drawn.png");
  std::filesystem::rename(folder / "scene", folder / "moved");
  const ScenePointer opened = open_scene(folder / "moved");
  EXPECT_EQ(name_at(*opened, 0.05, 0.25), "label");
  EXPECT_EQ(name_at(*opened, 0.55, 0.4), "polygon");
  // Another part is edited; these stay, and their areas are not made anew.
  SceneDescription description = opened->description();
  PartConfig box;
  box.name = "box";
  box.box_m = {0.2, 0.6, 0.3, 0.7};
  description.config.parts.insert(description.config.parts.begin(), box);
  const ScenePointer edited = with_description(opened, description);
  EXPECT_EQ(name_at(*edited, 0.25, 0.65), "box");
  EXPECT_EQ(name_at(*edited, 0.05, 0.25), "label");
  EXPECT_EQ(area_of(edited->description(), 1).polygon(), area_of(opened->description(), 0).polygon());
  EXPECT_EQ(area_of(edited->description(), 2).label(), area_of(opened->description(), 1).label());
  // Without its image it cannot be opened.
  std::filesystem::remove(folder / "moved" / "audio" / "labels.png");
  try {
    static_cast<void>(open_scene(folder / "moved"));
    FAIL() << "a scene without its label image was opened";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    EXPECT_THAT(error.what(), HasSubstr("labels.png"));
  }
}

}  // namespace
}  // namespace sparsha::scene
