// Replicas as a printer's program would see them: closed, of the right volume, depths in order, dots in place.
#include "pipeline/replica/replica.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <minizip/unzip.h>

#include "base/error.h"
#include "pipeline/replica/braille.h"
#include "pipeline/replica/whole_replica.h"
#include "scene/scene.h"
#include "tests/support/ball_scene.h"
#include "tests/support/test_folder.h"

namespace sparsha::pipeline {
namespace {

namespace fs = std::filesystem;
using Point = std::array<float, 3>;
using Triangle = std::array<Point, 3>;

/// A scene of one level; NaN is unknown.
scene::ScenePointer scene_of(int nx, int ny, double spacing_m, const std::function<double(double, double)>& height,
                             std::vector<scene::PartConfig> parts = {}) {
  scene::Layers layers;
  layers.grid = scene::DepthGrid(scene::Lattice{nx, ny, spacing_m, Eigen::Vector3d(4.0, -2.0, 17.0)});
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      const double z = height(i * spacing_m, j * spacing_m);
      const std::size_t n = layers.grid.lattice.index(i, j);
      layers.grid.state[n] = std::isnan(z) ? scene::NodeState::unknown : scene::NodeState::measured;
      layers.grid.height_m[n] = static_cast<float>(z);
    }
  scene::SceneDescription description;
  description.levels = {layers.grid.lattice};
  description.config.parts = std::move(parts);
  std::vector<scene::Layers> levels;
  levels.push_back(std::move(layers));
  return scene::make_scene(std::move(description), std::move(levels));
}

std::vector<Triangle> read_stl(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::vector<char> bytes((std::istreambuf_iterator<char>(in)), {});
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, 4);
  EXPECT_EQ(bytes.size(), 84U + 50U * count);
  std::vector<Triangle> triangles(count);
  for (std::uint32_t t = 0; t < count; ++t) std::memcpy(&triangles[t], bytes.data() + 84 + 50 * t + 12, 36);
  return triangles;
}

double volume(const std::vector<Triangle>& triangles) {
  double six = 0.0;
  for (const Triangle& t : triangles) {
    const auto& [a, b, c] = t;
    six += static_cast<double>(a[0]) * (static_cast<double>(b[1]) * c[2] - static_cast<double>(b[2]) * c[1]) -
           static_cast<double>(a[1]) * (static_cast<double>(b[0]) * c[2] - static_cast<double>(b[2]) * c[0]) +
           static_cast<double>(a[2]) * (static_cast<double>(b[0]) * c[1] - static_cast<double>(b[1]) * c[0]);
  }
  return six / 6.0;
}

/// Edges whose way from a to b is not met by exactly one way from b to a.
std::size_t open_edges(const std::vector<Triangle>& triangles) {
  std::map<std::pair<Point, Point>, int> ways;
  for (const Triangle& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) ++ways[{t[k], t[(k + 1) % 3]}];
  std::size_t open = 0;
  for (const auto& [edge, count] : ways) {
    const auto back = ways.find({edge.second, edge.first});
    if (count != 1 || back == ways.end() || back->second != 1) ++open;
  }
  return open;
}

ReplicaReport save(const scene::Scene& scene, const fs::path& file, const ReplicaOptions& options = {}) {
  Progress progress;
  return export_replica(scene, file, options, progress);
}

double bumps(double x, double y) { return 0.004 * std::sin(40.0 * x) * std::cos(31.0 * y) + 0.02 * x; }

TEST(Replica, IsClosedAndItsVolumeIsTheIntegralOfTheBilinearHeights) {
  const sparsha::test::TestFolder folder;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> noise(0.0, 0.01);
  const std::vector<std::function<double(double, double)>> grounds = {
      bumps, [](double, double) { return 1.0; }, [&](double, double) { return noise(random); },
      [](double x, double y) { return std::hypot(x - 0.1, y - 0.1) < 0.03 ? std::nan("") : bumps(x, y); }};
  for (const auto& ground : grounds)
    for (const auto& [nx, ny] : {std::pair{41, 31}, std::pair{2, 9}, std::pair{90, 90}}) {
      const scene::ScenePointer scene = scene_of(nx, ny, 0.005, ground);
      ReplicaOptions options;
      options.longest_mm = 24.0;
      options.depth_mm = 5.0;
      const fs::path file = folder.path() / "relief.stl";
      const ReplicaReport report = save(*scene, file, options);
      const std::vector<Triangle> triangles = read_stl(file);
      EXPECT_EQ(triangles.size(), report.triangles);
      EXPECT_EQ(open_edges(triangles), 0U);
      // The scene's own integral, by the trapezium rule on its nodes, which is exact for bilinear cells.
      const scene::Layers layers = scene->read_level(0);
      double low = 1e9, high = -1e9;
      for (const float z : layers.grid.height_m)
        if (!std::isnan(z)) low = std::min(low, double{z}), high = std::max(high, double{z});
      const double step_mm = 24.0 / (std::max(nx, ny) - 1);
      double sum = 0.0;
      for (int j = 0; j < ny; ++j)
        for (int i = 0; i < nx; ++i) {
          const double z = double{layers.grid.height_m[layers.grid.lattice.index(i, j)]};
          const double share = std::isnan(z) || high == low ? 0.0 : (z - low) / (high - low);
          sum += (3.0 + 5.0 * share) * (i == 0 || i == nx - 1 ? 0.5 : 1.0) * (j == 0 || j == ny - 1 ? 0.5 : 1.0);
        }
      const double wanted = sum * step_mm * step_mm;
      EXPECT_NEAR(volume(triangles) / wanted, 1.0, 1e-6) << nx << " x " << ny;
      EXPECT_NEAR(report.volume_mm3 / wanted, 1.0, 1e-6);
    }
}

TEST(Replica, KeepsTheOrderOfDepthsAndTheSizeAsked) {
  for (const double curve : {0.3, 1.0, 3.0})
    for (const std::optional<double> depth :
         {std::optional<double>(), std::optional<double>(0.7), std::optional<double>(40.0)}) {
      const scene::ScenePointer scene = scene_of(51, 31, 0.01, bumps);
      ReplicaOptions options;
      options.longest_mm = 150.0;
      options.curve = curve;
      options.depth_mm = depth;
      ReplicaReport report;
      const ReplicaPlate plate = make_replica(*scene, options, report);
      EXPECT_NEAR(report.width_mm, 150.0, 1e-6);
      EXPECT_NEAR(report.length_mm, 90.0, 1e-6);
      const auto [least, most] = std::minmax_element(plate.height_mm.begin(), plate.height_mm.end());
      EXPECT_NEAR(*least, 3.0, 1e-5);
      if (depth) {
        EXPECT_NEAR(*most, 3.0 + *depth, 1e-4);
      } else {
        EXPECT_LE(*most, 18.0 + 1e-4);
      }
      const scene::Layers layers = scene->read_level(0);
      const int fine = (plate.nx - 1) / 50;
      std::mt19937 random(3);
      const auto pick = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
      for (int k = 0; k < 5000; ++k) {
        const int a = pick(51), b = pick(31), c = pick(51), d = pick(31);
        const float first = layers.grid.height_m[layers.grid.lattice.index(a, b)];
        const float second = layers.grid.height_m[layers.grid.lattice.index(c, d)];
        if (first < second) {
          EXPECT_LE(plate.at(a * fine, b * fine), plate.at(c * fine, d * fine));
        }
      }
    }
}

TEST(Replica, OfAnySizeHasAtMost2000NodesAlongASideAndSaysSo) {
  const auto tilted = [](double x, double y) { return 0.1 * x + 0.2 * y; };
  for (const bool levels : {true, false}) {
    const scene::ScenePointer one = scene_of(4501, 31, 0.001, tilted);
    scene::SceneDescription description = one->description();
    std::vector<scene::Layers> layers{one->read_level(0)};
    if (levels) {
      const scene::ScenePointer coarser = scene_of(1501, 11, 0.003, tilted);
      description.levels.push_back(coarser->description().levels.front());
      layers.push_back(coarser->read_level(0));
    }
    const scene::ScenePointer scene = scene::make_scene(std::move(description), std::move(layers));
    ReplicaOptions options;
    options.longest_mm = 2000.0;
    ReplicaReport report;
    const ReplicaPlate plate = make_replica(*scene, options, report);
    EXPECT_LE(std::max(plate.nx, plate.ny), 2000);
    EXPECT_NEAR(report.width_mm, 2000.0, plate.spacing_mm) << "a node's distance at most is lost at the rim";
    ASSERT_EQ(report.warnings.size(), 1U);
    EXPECT_NE(report.warnings[0].find("at most 2000"), std::string::npos) << report.warnings[0];
    // Heights are those of the scene's nodes: the tilt is as steep everywhere.
    const float rise = plate.at(1, plate.first_row) - plate.at(0, plate.first_row);
    for (int i = 1; i < plate.nx; i += 100)
      EXPECT_NEAR(plate.at(i, plate.first_row) - plate.at(i - 1, plate.first_row), rise, 1e-4);
    options.longest_mm = 200.0;
    ReplicaReport small;
    static_cast<void>(make_replica(*scene, options, small));
    EXPECT_TRUE(small.warnings.empty()) << small.warnings.front();
  }
}

TEST(Replica, HasTheNamesOfItsPartsBelowTheReliefAsDotsThatFingersRead) {
  scene::PartConfig part;
  part.name = "lotus";
  part.say = "lotus";
  const scene::ScenePointer scene = scene_of(101, 51, 0.002, bumps, {part});
  ReplicaOptions options;
  options.longest_mm = 120.0;
  ReplicaReport report;
  const ReplicaPlate plate = make_replica(*scene, options, report);
  ASSERT_GT(plate.first_row, 0);
  EXPECT_EQ(report.lines, std::vector<std::string>{"lotus"});
  // l o t u s: 3 + 3 + 4 + 3 + 3 dots, counted as tops of the strip.
  std::vector<std::array<double, 2>> tops;
  for (int j = 1; j + 1 < plate.first_row; ++j)
    for (int i = 1; i + 1 < plate.nx; ++i) {
      const float z = plate.at(i, j);
      bool top = z > 3.3F;
      for (int dj = -1; dj <= 1; ++dj)
        for (int di = -1; di <= 1; ++di)
          top = top &&
                (z > plate.at(i + di, j + dj) || (z == plate.at(i + di, j + dj) && (dj > 0 || (dj == 0 && di >= 0))));
      if (top) tops.push_back({i * plate.spacing_mm, j * plate.spacing_mm});
    }
  EXPECT_EQ(tops.size(), 16U);
  for (std::size_t a = 0; a < tops.size(); ++a)
    for (std::size_t b = a + 1; b < tops.size(); ++b)
      EXPECT_GT(std::hypot(tops[a][0] - tops[b][0], tops[a][1] - tops[b][1]), 2.5 - 2.0 * plate.spacing_mm);
  options.braille = false;
  ReplicaReport bare;
  EXPECT_EQ(make_replica(*scene, options, bare).first_row, 0);
}

TEST(Replica, NamesThatTakeMoreRoomThanTheReliefAreAWarningAndEndlessOnesAnError) {
  ReplicaOptions options;
  options.longest_mm = 100.0;
  scene::PartConfig part;
  const auto warned = [&](std::size_t letters) {
    part.say = std::string(letters, 'x');
    ReplicaReport report;
    static_cast<void>(make_replica(*scene_of(101, 51, 0.002, bumps, {part}), options, report));
    return std::any_of(report.warnings.begin(), report.warnings.end(),
                       [](const std::string& text) { return text.find("mm of Braille") != std::string::npos; });
  };
  // 14 cells a line and 10 mm a line.
  EXPECT_FALSE(warned(14 * 8));
  EXPECT_TRUE(warned(14 * 12));
  EXPECT_THROW(static_cast<void>(warned(14 * 210)), Error);
}

TEST(Replica, NamesPartsOfAnyShapeInTheirOrder) {
  scene::PartConfig polygon;
  polygon.name = polygon.say = "sash";
  polygon.polygon_m = {{4.0, -2.0}, {4.1, -2.0}, {4.0, -1.95}};
  scene::PartConfig label;
  label.name = label.say = "hair";
  label.label = 7;  // that nothing has
  scene::PartConfig box;
  box.name = box.say = "lotus";
  ReplicaOptions options;
  ReplicaReport mixed, boxes;
  const ReplicaPlate plate = make_replica(*scene_of(101, 51, 0.002, bumps, {polygon, label, box}), options, mixed);
  EXPECT_EQ(mixed.lines, (std::vector<std::string>{"sash", "hair", "lotus"}));
  for (scene::PartConfig* part : {&polygon, &label}) {
    part->polygon_m.clear();
    part->label.reset();
  }
  EXPECT_EQ(make_replica(*scene_of(101, 51, 0.002, bumps, {polygon, label, box}), options, boxes).height_mm,
            plate.height_mm);
}

TEST(WholeReplica, StandsUprightClosedAndInScale) {
  const sparsha::test::TestFolder folder;
  ThreadPool pool(2);
  Progress progress;
  const scene::ScenePointer ball = test::ball_scene(0.05, 0.0021, Eigen::Matrix4d::Identity());
  const WholeReplicaReport report = export_whole_replica(*ball, folder / "ball.stl", 150.0, {pool, progress});
  const std::vector<Triangle> triangles = read_stl(folder / "ball.stl");
  EXPECT_EQ(triangles.size(), report.triangles);
  EXPECT_EQ(open_edges(triangles), 0U);
  EXPECT_NEAR(volume(triangles) / (4.0 / 3.0 * 3.14159265 * 75.0 * 75.0 * 75.0), 1.0, 0.01);
  EXPECT_NEAR(report.volume_mm3 / volume(triangles), 1.0, 1e-4);
  EXPECT_NEAR(report.scale, 1.5, 0.01);
  EXPECT_TRUE(report.warnings.size() == 1 && report.warnings[0].find("facets") != std::string::npos);
  float low = 1e9F, high = -1e9F;
  for (const Triangle& t : triangles)
    for (const Point& p : t) {
      low = std::min(low, p[2]);
      high = std::max(high, p[2]);
      EXPECT_LT(std::abs(p[0]), 75.1F);
    }
  EXPECT_NEAR(low, 0.0, 1e-4);
  EXPECT_NEAR(high, 150.0, 1.0);
  EXPECT_THROW((void)export_whole_replica(*ball, folder / "ball.stl", 5.0, {pool, progress}), Error);
  static_cast<void>(export_whole_replica(*ball, folder / "ball.3mf", 150.0, {pool, progress}));
  EXPECT_GT(fs::file_size(folder / "ball.3mf"), 10'000U);
}

/// The text of a part of a package, by another library than what wrote it.
std::string part_of(const fs::path& file, const char* name) {
  const unzFile package = unzOpen64(file.c_str());
  std::string text;
  if (package != nullptr && unzLocateFile(package, name, 1) == UNZ_OK && unzOpenCurrentFile(package) == UNZ_OK) {
    std::array<char, 65536> piece{};
    for (int got = 0; (got = unzReadCurrentFile(package, piece.data(), static_cast<unsigned>(piece.size()))) > 0;)
      text.append(piece.data(), static_cast<std::size_t>(got));
    unzCloseCurrentFile(package);
  }
  unzClose(package);
  return text;
}

/// What follows `before` in a text, each time.
std::vector<std::string> all_after(const std::string& text, const std::string& before) {
  std::vector<std::string> found;
  for (std::size_t at = 0; (at = text.find(before, at)) != std::string::npos;) {
    at += before.size();
    found.push_back(text.substr(at, text.find('"', at) - at));
  }
  return found;
}

// Red where x is positive, else blue, and white where no colour is known: at the top.
TEST(WholeReplica, HasTheScansColoursIn3mf) {
  scene::Charts charts = test::ball_charts(0.05, 0.0031, {0.1, -0.2, 0.3});
  for (scene::Sheet& sheet : charts.sheets) {
    sheet.colour_rgba.assign(sheet.count(), 0);
    for (int j = 0; j < sheet.ny; ++j)
      for (int i = 0; i < sheet.nx; ++i)
        if (sheet.measured(sheet.index(i, j)) && charts.place_m(sheet, i, j).y() < 0.03)
          sheet.colour_rgba[sheet.index(i, j)] = charts.place_m(sheet, i, j).x() > 0.0 ? 0xFF0000FFU : 0xFFFF0000U;
  }
  const sparsha::test::TestFolder folder;
  ThreadPool pool(2);
  Progress progress;
  const scene::ScenePointer scene = test::scene_of_charts(std::move(charts), Eigen::Matrix4d::Identity(), 0.05);
  static_cast<void>(export_whole_replica(*scene, folder / "ball.3mf", 100.0, {pool, progress}));
  const std::string model = part_of(folder / "ball.3mf", "3D/3dmodel.model");
  const std::vector<std::string> palette = all_after(model, "<m:color color=\"");
  const std::vector<std::string> x = all_after(model, "<vertex x=\""), corner = all_after(model, "<triangle v1=\""),
                                 colour = all_after(model, " p1=\"");
  ASSERT_EQ(corner.size(), colour.size());
  ASSERT_GT(corner.size(), 3000U);
  EXPECT_EQ(all_after(model, " pindex=\"").size(), 1U);
  EXPECT_EQ(all_after(model, " z=\"").size(), x.size());
  const std::vector<std::string> z = all_after(model, " z=\"");
  std::map<std::string, int> seen;
  for (std::size_t t = 0; t < corner.size(); ++t) {
    const std::size_t v = std::stoul(corner[t]);
    const std::string& shown = palette.at(std::stoul(colour[t]));
    ++seen[shown];
    // What has a colour is below 80 mm; a vertex takes that of a node up to 6 mm away.
    if (std::stod(z.at(v)) > 88.0) {
      EXPECT_EQ(shown, "#FFFFFF");
    }
    if (std::stod(z.at(v)) < 72.0 && std::abs(std::stod(x.at(v))) > 4.0) {
      EXPECT_EQ(shown, std::stod(x.at(v)) > 0.0 ? "#FF0000" : "#0000FF");
    }
  }
  for (const char* of : {"#FFFFFF", "#FF0000", "#0000FF"}) EXPECT_GT(seen[of], 100) << of;
}

TEST(Replica, ThreeMfHoldsTheSameSolid) {
  const sparsha::test::TestFolder folder;
  const scene::ScenePointer scene = scene_of(31, 21, 0.005, bumps);
  const ReplicaReport report = save(*scene, folder.path() / "relief.3mf");
  const ReplicaReport again = save(*scene, folder.path() / "again.3mf");
  const auto bytes = [](const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return std::string((std::istreambuf_iterator<char>(in)), {});
  };
  const std::string package = bytes(folder.path() / "relief.3mf");
  EXPECT_EQ(package, bytes(folder.path() / "again.3mf")) << "the same bytes";
  EXPECT_EQ(package.substr(0, 4), "PK\x03\x04");
  for (const char* name : {"[Content_Types].xml", "_rels/.rels", "3D/3dmodel.model"})
    EXPECT_NE(package.find(name), std::string::npos);
  EXPECT_EQ(report.triangles, again.triangles);
  EXPECT_TRUE(fs::exists(folder.path() / "relief.legibility.png"));
}

TEST(Replica, OfASceneThatIsNarrowerThanAPixelHasItsPictureToo) {
  const sparsha::test::TestFolder folder;
  ReplicaOptions options;
  options.longest_mm = 20.0;
  for (const auto& [nx, ny] : {std::pair{200, 2}, std::pair{2, 200}, std::pair{2, 2}}) {
    static_cast<void>(save(*scene_of(nx, ny, 0.001, bumps), folder.path() / "strip.stl", options));
    EXPECT_TRUE(fs::exists(folder.path() / "strip.legibility.png")) << nx << " x " << ny;
    fs::remove(folder.path() / "strip.legibility.png");
  }
}

TEST(Replica, SaysWhatFingersWouldNotFindOrWouldRunTogether) {
  const sparsha::test::TestFolder folder;
  const auto report_of = [&](const std::function<double(double, double)>& ground, double depth_mm) {
    ReplicaOptions options;
    options.longest_mm = 100.0;
    options.depth_mm = depth_mm;
    return save(*scene_of(201, 201, 0.001, ground), folder.path() / "map.stl", options);
  };
  constexpr double kTurn = 2.0 * 3.14159265358979;
  // Waves of 3 mm and of 20 mm in print; the scene is 0.2 m wide.
  const ReplicaReport fine = report_of([](double x, double) { return std::sin(kTurn * x / 0.006); }, 2.0);
  const ReplicaReport coarse = report_of([](double x, double) { return std::sin(kTurn * x / 0.040); }, 2.0);
  const ReplicaReport smooth = report_of([](double x, double) { return std::sin(kTurn * x / 0.040); }, 0.1);
  EXPECT_GT(fine.crowded, 0.6);
  EXPECT_LT(coarse.crowded, 0.05);
  EXPECT_GT(coarse.felt, 0.6);
  EXPECT_EQ(smooth.felt, 0.0);
  EXPECT_FALSE(fine.warnings.empty());
  EXPECT_FALSE(smooth.warnings.empty());
}

TEST(Replica, RefusesSizesThatCannotBePrintedAndScenesWithoutAPlace) {
  const scene::ScenePointer scene = scene_of(11, 11, 0.01, bumps);
  ReplicaReport report;
  const auto refused = [&](const std::function<void(ReplicaOptions&)>& change) {
    ReplicaOptions options;
    change(options);
    EXPECT_THROW(static_cast<void>(make_replica(*scene, options, report)), Error);
  };
  refused([](ReplicaOptions& options) { options.longest_mm = 0.0; });
  refused([](ReplicaOptions& options) { options.longest_mm = std::nan(""); });
  refused([](ReplicaOptions& options) { options.depth_mm = -1.0; });
  refused([](ReplicaOptions& options) { options.curve = 0.0; });
  refused([](ReplicaOptions& options) { options.base_mm = 1.0; });
  const scene::ScenePointer nothing = scene_of(11, 11, 0.01, [](double, double) { return std::nan(""); });
  EXPECT_THROW(static_cast<void>(make_replica(*nothing, {}, report)), Error);
}

std::string dots(const Braille& braille) {
  std::string text;
  for (const BrailleCell cell : braille.cells) {
    for (unsigned dot = 0; dot < 6; ++dot)
      if ((cell >> dot & 1U) != 0) text += static_cast<char>('1' + dot);
    text += ' ';
  }
  return text;
}

TEST(Braille, SpellsLettersFiguresAndSigns) {
  EXPECT_EQ(dots(to_braille("abc xyz", false)), "1 12 14  1346 13456 1356 ");
  EXPECT_EQ(dots(to_braille("Om 108.", false)), "6 135 134  3456 1 245 125 256 ");
  EXPECT_EQ(dots(to_braille("3b", false)), "3456 14 56 12 ");
  EXPECT_EQ(dots(to_braille("2.5", false)), "3456 12 256 15 ");
  EXPECT_EQ(dots(to_braille("1,000 7", false)), "3456 1 2 245 245 245  3456 1245 ");
  EXPECT_EQ(dots(to_braille("Śiva", false)), dots(to_braille("Siva", false)));
  EXPECT_EQ(dots(to_braille("ÀÉ", false)), dots(to_braille("AE", false)));
  EXPECT_FALSE(to_braille("\xe0\xa4\xb8", false).complete) << "Devanagari needs the library";
  EXPECT_FALSE(to_braille("\xff\xfe", false).complete);
}

TEST(Braille, TheLibrarySpellsLatinAsWeDoAndKnowsDevanagari) {
  const Braille latin = to_braille("lotus");
  if (!latin.by_library) GTEST_SKIP() << "liblouis is not installed";
  EXPECT_EQ(latin.cells, to_braille("lotus", false).cells);
  const Braille hindi = to_braille("\xe0\xa4\x95\xe0\xa4\xae\xe0\xa4\xb2");  // kamal, lotus
  EXPECT_EQ(dots(hindi), "13 134 123 ");
}

TEST(Braille, LinesBreakBetweenWordsAndNeverLoseACell) {
  const std::vector<BrailleCell> cells = to_braille("the great lotus medallion", false).cells;
  for (std::size_t most = 1; most < 30; ++most) {
    std::size_t kept = 0;
    for (const auto& line : wrap_braille(cells, most)) {
      EXPECT_LE(line.size(), most);
      kept += static_cast<std::size_t>(std::count_if(line.begin(), line.end(), [](BrailleCell c) { return c != 0; }));
    }
    EXPECT_EQ(kept, 22U) << most;
  }
  EXPECT_TRUE(wrap_braille(cells, 0).empty());
}

}  // namespace
}  // namespace sparsha::pipeline
