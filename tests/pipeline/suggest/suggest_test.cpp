// What `sparsha new` suggests is built, passes its own cross-check and lies on the surface the points were taken from.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/files/files.h"
#include "base/yaml/yaml.h"
#include "pipeline/build/build.h"
#include "pipeline/scan/inspect.h"
#include "pipeline/scan/reader.h"
#include "pipeline/suggest/group.h"
#include "pipeline/suggest/suggest.h"
#include "scene/scene.h"
#include "tests/support/test_folder.h"

namespace sparsha::pipeline {
namespace {
namespace fs = std::filesystem;

using Points = std::vector<Eigen::Vector3d>;

class Suggested : public ::testing::Test {
 protected:
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  double normal(double sigma) { return sigma * std::normal_distribution<double>()(random_); }
  /// Uniform on a sphere, with noise across it.
  Points shell(std::size_t count, const Eigen::Vector3d& centre, double radius, double noise = 0.0) {
    Points points;
    while (points.size() < count) {
      const Eigen::Vector3d p(normal(1.0), normal(1.0), normal(1.0));
      points.emplace_back(centre + p.normalized() * (radius + (noise > 0.0 ? normal(noise) : 0.0)));
    }
    return points;
  }
  /// A waved square of 1 m, x and y its own axes.
  Points relief(std::size_t count, double noise) {
    Points points;
    while (points.size() < count) {
      const double x = uniform(0, 1);
      const double y = uniform(0, 1);
      points.emplace_back(x, y, waves(x, y) + normal(noise));
    }
    return points;
  }
  static double waves(double x, double y) { return 0.03 * std::sin(9 * x) * std::cos(7 * y); }

  fs::path write(const Points& points, const std::string& name = "scan.xyz") const {
    std::ofstream file(folder_ / name);
    file.precision(12);
    for (const Eigen::Vector3d& p : points) file << p.x() << ' ' << p.y() << ' ' << p.z() << '\n';
    return folder_ / name;
  }
  /// Builds what is suggested for the file, which must give no error and no warning about the surface's fit.
  BuildResult build(const fs::path& file) {
    Progress progress;
    suggestion_ = suggest_config({file}, {}, progress);
    EXPECT_TRUE(progress.warnings().empty()) << progress.warnings().front();
    return build_suggested();
  }
  BuildResult build_suggested() {
    Progress progress;
    BuildResult result = build_scene(suggestion_.config, {}, progress);
    EXPECT_FALSE(warned(result, "farther than")) << suggestion_.yaml;
    EXPECT_FALSE(warned(result, "times finer than")) << suggestion_.yaml;
    EXPECT_LE(result.report.check->cloud_to_surface.median_m, suggestion_.config.grid.spacing_m) << suggestion_.yaml;
    EXPECT_GT(result.report.check->cloud_to_surface.samples, 0U);
    return result;
  }
  static bool warned(const BuildResult& result, const std::string& words) {
    const std::vector<std::string>& warnings = result.report.warnings;
    return std::any_of(warnings.begin(), warnings.end(),
                       [&](const std::string& w) { return w.find(words) != std::string::npos; });
  }
  /// Share of measured nodes whose place in the scan frame satisfies `holds`.
  static double share(const BuildResult& result, const std::function<bool(const Eigen::Vector3d&)>& holds) {
    const scene::DepthGrid grid = result.scene->read_level(0).grid;
    const Eigen::Matrix4d& to_scan = result.scene->description().scan_from_grid;
    std::size_t all = 0;
    std::size_t good = 0;
    for (int j = 0; j < grid.lattice.ny; ++j) {
      for (int i = 0; i < grid.lattice.nx; ++i) {
        const std::size_t n = grid.lattice.index(i, j);
        if (grid.state[n] != scene::NodeState::measured) continue;
        const double z = grid.lattice.origin_m.z() + static_cast<double>(grid.height_m[n]);
        const Eigen::Vector4d p = to_scan * Eigen::Vector4d(grid.lattice.x_m(i), grid.lattice.y_m(j), z, 1.0);
        ++all;
        if (holds(p.head<3>())) ++good;
      }
    }
    EXPECT_GT(all, 100U);
    return static_cast<double>(good) / static_cast<double>(std::max<std::size_t>(1, all));
  }
  [[nodiscard]] Eigen::Vector3d towards_viewer() const {
    return suggestion_.config.orientation.scan_to_grid.block<1, 3>(2, 0).transpose().normalized();
  }

  std::mt19937_64 random_{7};
  const test::TestFolder folder_;
  Suggestion suggestion_;
};

TEST_F(Suggested, ALineThatIsNoCommentAnyMoreBuildsAllSidesOfASolidObject) {
  Points points = shell(20'000, {0.3, 0.2, 0.6}, 0.1);
  for (const Eigen::Vector3d& p : shell(40'000, {0.3, 0.2, 0.3}, 0.2)) points.push_back(p);
  std::erase_if(points, [](const Eigen::Vector3d& p) {
    return (p - Eigen::Vector3d(0.3, 0.2, 0.3)).norm() < 0.199 || (p - Eigen::Vector3d(0.3, 0.2, 0.6)).norm() < 0.0995;
  });
  Progress progress;
  suggestion_ = suggest_config({write(points)}, {}, progress);
  EXPECT_FALSE(suggestion_.config.around);
  const std::string hint = "# around: {}  #";
  const std::size_t at = suggestion_.yaml.find(hint);
  ASSERT_NE(at, std::string::npos) << suggestion_.yaml;
  suggestion_.config =
      scene::parse_config(yaml::parse_text(suggestion_.yaml.erase(at, 2), "the suggested configuration"), {});
  const BuildResult built = build_suggested();
  ASSERT_TRUE(built.report.around);
  EXPECT_GT(built.report.around->nodes, 20'000U);

  EXPECT_EQ(suggest_config({write(relief(20'000, 1e-4))}, {}, progress).yaml.find(hint), std::string::npos);
}

// Of few points, and of so many that they are gone through in blocks.
TEST_F(Suggested, ScanColoursAreKeptWhereThereIsMoreThanOne) {
  for (const std::size_t count : {std::size_t{20'000}, std::size_t{120'000}}) {
    for (const int colours : {0, 1, 2}) {
      if (count > 100'000 && colours < 2) continue;
      std::string text = "//X Y Z" + std::string(colours > 0 ? " R G B\n" : "\n");
      std::size_t k = 0;
      for (const Eigen::Vector3d& p : relief(count, 1e-4)) {
        text += std::to_string(p.x()) + ' ' + std::to_string(p.y()) + ' ' + std::to_string(p.z());
        if (colours > 0) text += ++k % 2 < static_cast<std::size_t>(colours) - 1 ? " 90 80 70" : " 200 180 160";
        text += '\n';
      }
      write_file(folder_ / "tinted.xyz", text);
      Progress progress;
      const Suggestion suggestion = suggest_config({folder_ / "tinted.xyz"}, {}, progress);
      EXPECT_EQ(suggestion.config.grid.colour, colours == 2) << suggestion.yaml;
      EXPECT_EQ(suggestion.yaml.find("the scans have colours") != std::string::npos, colours == 2) << suggestion.yaml;
    }
  }
}

TEST_F(Suggested, LeavesOutAScanWithoutPointsAndSaysSoInTheConfiguration) {
  const fs::path scan = write(relief(3000, 0.0)), empty = write({}, "empty.xyz");
  Progress progress;
  const Suggestion found = suggest_config({empty, scan}, folder_, progress);
  ASSERT_EQ(found.config.scans.size(), 1U);
  EXPECT_EQ(found.config.scans.front().file.filename(), scan.filename());
  EXPECT_NE(found.yaml.find("# left out: "), std::string::npos) << found.yaml;
  const std::vector<std::string> warnings = progress.warnings();
  EXPECT_TRUE(std::any_of(warnings.begin(), warnings.end(), [](const std::string& warning) {
    return warning.find("empty.xyz: the file is empty; the scan is left out") != std::string::npos;
  }));
  EXPECT_THROW((void)suggest_config({empty, empty}, folder_, progress), Error);
}

TEST_F(Suggested, AShellOfPointsIsSeenAsItsFrontHalf) {
  const BuildResult result = build(write(shell(20000, {0, 0, 0}, 1.0)));
  const double spacing = std::sqrt(4 * std::numbers::pi / 20000);
  EXPECT_NEAR(suggestion_.config.grid.spacing_m, spacing, 0.2 * spacing);
  EXPECT_GT(share(result,
                  [&](const Eigen::Vector3d& p) {
                    return std::abs(p.norm() - 1.0) < 0.5 * spacing && p.dot(towards_viewer()) > -spacing;
                  }),
            0.97);
}

TEST_F(Suggested, NoiseOfManyPointSpacingsCoarsensTheGridUntilTheCheckPasses) {
  constexpr double kNoise = 0.02;  // points are 4.5 mm apart
  const BuildResult result = build(write(relief(50000, kNoise)));
  EXPECT_GT(suggestion_.config.grid.spacing_m, 0.5 * kNoise);
  EXPECT_GT(std::abs(towards_viewer().z()), 0.99);
  EXPECT_GT(share(result, [&](const Eigen::Vector3d& p) { return std::abs(p.z() - waves(p.x(), p.y())) < 3 * kNoise; }),
            0.97);
}

TEST_F(Suggested, ACloudOfWhichASampleWasTriedPassesAsAWhole) {
  constexpr std::size_t kPoints = 600'000;
  const BuildResult result = build(write(shell(kPoints, {0, 0, 0}, 1.0, 0.0005)));
  const double spacing = std::sqrt(4 * std::numbers::pi / kPoints);
  EXPECT_NEAR(suggestion_.config.grid.spacing_m, spacing, 0.2 * spacing);
  EXPECT_NE(suggestion_.yaml.find("% of the points"), std::string::npos);
  EXPECT_GT(share(result, [&](const Eigen::Vector3d& p) { return std::abs(p.norm() - 1.0) < spacing; }), 0.97);
}

TEST_F(Suggested, ARoomScannedFromInsideKeepsToItsWalls) {
  const Eigen::Vector3d half(3.0, 2.0, 1.5);
  constexpr double kNoise = 0.002;
  Points points;
  while (points.size() < 60000) {
    const Eigen::Vector3d beam = Eigen::Vector3d(normal(1.0), normal(1.0), normal(1.0)).normalized();
    const double range = (half.array() / beam.array().abs().max(1e-9)).minCoeff();
    points.emplace_back(beam * (range + normal(kNoise)));
  }
  const BuildResult result = build(write(points));
  const double spacing = suggestion_.config.grid.spacing_m;
  EXPECT_GT(share(result,
                  [&](const Eigen::Vector3d& p) {
                    return ((p.cwiseAbs() - half).array().abs() < spacing + 3 * kNoise).any();
                  }),
            0.95);
}

TEST_F(Suggested, GroundInSurveyCoordinatesIsSeenFromAbove) {
  Points points;
  for (int n = 0; n < 20000; ++n) points.emplace_back(uniform(500, 550), uniform(400, 450), uniform(200, 200.1));
  (void)build(write(points));
  EXPECT_GT(towards_viewer().z(), 0.99);
}

TEST_F(Suggested, OfTwoObjectsFarApartOneIsShownAndTheOtherCroppedWithAWarning) {
  Points points = shell(12000, {0, 0, 0}, 0.5);
  const Points other = shell(8000, {1000, 300, 0}, 0.5);
  points.insert(points.end(), other.begin(), other.end());
  const fs::path file = write(points);
  Progress progress;
  suggestion_ = suggest_config({file}, {}, progress);
  ASSERT_EQ(progress.warnings().size(), 1U);
  EXPECT_NE(progress.warnings().front().find("60.0 % of the points"), std::string::npos);
  const BuildResult result = build_suggested();
  EXPECT_EQ(result.report.points.filtered, 8000U);
  const double spacing = std::sqrt(std::numbers::pi / 12000);
  EXPECT_GT(share(result, [&](const Eigen::Vector3d& p) { return std::abs(p.norm() - 0.5) < 0.5 * spacing; }), 0.97);
}

TEST_F(Suggested, StraysAllAroundAnObjectDoNotHideIt) {
  Points points = shell(20000, {0, 0, 0}, 1.0);
  for (int n = 0; n < 400; ++n) points.emplace_back(uniform(-50, 50), uniform(-50, 50), uniform(-50, 50));
  const fs::path file = write(points);
  Progress progress;
  suggestion_ = suggest_config({file}, {}, progress);
  const BuildResult result = build_suggested();
  const double spacing = std::sqrt(4 * std::numbers::pi / 20000);
  EXPECT_LT(suggestion_.config.grid.spacing_m, 1.2 * spacing);
  EXPECT_GT(share(result, [&](const Eigen::Vector3d& p) { return std::abs(p.norm() - 1.0) < 0.5 * spacing; }), 0.97);
}

TEST_F(Suggested, NamesTheColumnsThatTheValuesOfATableTell) {
  std::ofstream file(folder_ / "counted.txt");
  for (int k = 0; k < 2500; ++k) {
    const double x = 0.02 * (k % 50);
    const double y = 0.02 * (k / 50);
    file << k + 1 << ' ' << x << ' ' << y << ' ' << waves(x, y) << '\n';
  }
  file.close();
  Progress progress;
  suggestion_ = suggest_config({folder_ / "counted.txt"}, {}, progress);
  const std::vector<std::string> columns = {"skip", "x", "y", "z"};
  EXPECT_EQ(suggestion_.config.scans.front().columns, columns);
  ASSERT_EQ(progress.warnings().size(), 1U);
  EXPECT_NE(progress.warnings().front().find("its first column counts the rows"), std::string::npos);
  const BuildResult result = build_suggested();
  const scene::Lattice& base = result.scene->description().levels.front();
  EXPECT_LT(base.spacing_m * std::max(base.nx, base.ny), 1.1) << "not 2500 wide";
  EXPECT_FALSE(warned(result, "counts the rows")) << "said once";
}

TEST_F(Suggested, ADetailHasTheUnitOfTheScanThatShowsTheWhole) {
  const auto times = [](Points points, double factor) {
    for (Eigen::Vector3d& p : points) p *= factor;
    return points;
  };
  Points detail;
  const Points whole = times(relief(60000, 0.0), 600.0);
  for (const Eigen::Vector3d& p : whole)
    if (p.x() < 44.0 && p.y() < 44.0) detail.push_back(p);
  const std::vector<fs::path> files = {write(detail, "detail.xyz"), write(whole, "whole.xyz")};
  for (const std::vector<fs::path>& set : {files, std::vector<fs::path>{files[1], files[0]}}) {
    Progress progress;
    const Suggestion suggestion = suggest_config(set, {}, progress);
    for (const scene::ScanConfig& scan : suggestion.config.scans)
      EXPECT_EQ(scan.units.unit, scene::LengthUnit::mm) << scan.file;
    EXPECT_NE(suggestion.yaml.find("as \"whole.xyz\""), std::string::npos) << suggestion.yaml;
  }
  // Alone it is taken for metres, as anything of 44.
  Progress progress;
  EXPECT_EQ(suggest_config({files[0]}, {}, progress).config.scans[0].units.unit, scene::LengthUnit::m);
}

TEST_F(Suggested, MillimetresFarFromZeroAreDoubtedAlikeByInfoNewAndBuild) {
  Points plaque = relief(20000, 0.0);
  for (Eigen::Vector3d& p : plaque) p = 150.0 * p + Eigen::Vector3d(12500, 23400, 1000);
  const fs::path file = write(plaque, "plaque.xyz");
  const std::string reason = "m long in metres, ";
  EXPECT_NE(::testing::PrintToString(inspect_scan(file).warnings).find(reason), std::string::npos);
  Progress progress;
  const Suggestion suggestion = suggest_config({file}, {}, progress);
  EXPECT_EQ(suggestion.config.scans[0].units.unit, scene::LengthUnit::m) << "it may lie in a national grid";
  EXPECT_NE(suggestion.yaml.find(reason), std::string::npos) << suggestion.yaml;
  EXPECT_NE(suggestion.yaml.find("set 'mm' if that is right"), std::string::npos) << suggestion.yaml;
  scene::ScanConfig config;
  config.file = file;
  Progress of_build;
  (void)load_scan(config, of_build);
  EXPECT_NE(::testing::PrintToString(of_build.warnings()).find(reason), std::string::npos);
}

TEST_F(Suggested, ACloudWithoutASurfaceIsSaidToFailTheCheckOnScreenAndInTheFile) {
  Points points;
  for (int n = 0; n < 10000; ++n) points.emplace_back(normal(1.0), normal(1.0), normal(1.0));
  const fs::path file = write(points);
  Progress progress;
  const Suggestion suggestion = suggest_config({file}, {}, progress);
  ASSERT_EQ(progress.warnings().size(), 1U);
  EXPECT_NE(progress.warnings().front().find("passes the cross-check"), std::string::npos);
  EXPECT_NE(suggestion.yaml.find("CROSS-CHECK FAILS"), std::string::npos);
  EXPECT_THROW((void)build_scene(suggestion.config, {}, progress), Error);
}

TEST_F(Suggested, PointsAlongALineAreNotSaidToLieOnASurface) {
  Points line;
  while (line.size() < 5000) {
    const double t = uniform(0, 1);
    line.emplace_back(t + normal(0.0005), t + normal(0.0005), t + normal(0.0005));
  }
  Progress progress;
  suggestion_ = suggest_config({write(line)}, {}, progress);
  EXPECT_NE(suggestion_.yaml.find("no surface to compare"), std::string::npos) << suggestion_.yaml;
  EXPECT_EQ(suggestion_.yaml.find("farther than 0 mm"), std::string::npos) << suggestion_.yaml;
  const BuildResult result = build_scene(suggestion_.config, {}, progress);
  EXPECT_EQ(result.report.check->cloud_to_surface.samples, 0U);
  EXPECT_TRUE(warned(result, "nothing to compare"));
}

TEST_F(Suggested, PointsOnALineOrInOnePlaceAreAnError) {
  for (const double length : {0.0, 1.0}) {
    Points points;
    for (int k = 0; k < 300; ++k)
      points.emplace_back(Eigen::Vector3d(443000, 5512000, 120) + length * k * Eigen::Vector3d(0.01, 0.007, 0.001));
    const fs::path file = write(points);
    Progress progress;
    try {
      (void)suggest_config({file}, {}, progress);
      ADD_FAILURE() << length;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      EXPECT_NE(error.wrong().find(length > 0.0 ? "straight line" : "one place"), std::string::npos) << error.what();
    }
    scene::Config config;
    config.scans.emplace_back();
    config.scans[0].file = file;
    EXPECT_THROW((void)build_scene(config, {}, progress), Error);
  }
}

TEST_F(Suggested, AnErrorOfSeveralScansNamesTheOneAtFaultOrAllOfThem) {
  const auto error_of = [](const std::vector<fs::path>& files) {
    Progress progress;
    try {
      (void)suggest_config(files, {}, progress);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  Points far = relief(3000, 0.0);
  for (Eigen::Vector3d& p : far) p += Eigen::Vector3d(3e9, 0, 0);
  const std::string spread = error_of({write(relief(3000, 0.0), "near.xyz"), write(far, "far.xyz")});
  EXPECT_NE(spread.find("far.xyz: "), std::string::npos) << spread;
  EXPECT_EQ(spread.find("near.xyz"), std::string::npos) << spread;
  std::vector<fs::path> lines;
  for (int part = 0; part < 4; ++part) {
    Points line;
    for (int k = 0; k < 300; ++k) line.emplace_back(Eigen::Vector3d(0.01, 0.007, 0.001) * (300 * part + k));
    lines.push_back(write(line, "line" + std::to_string(part) + ".xyz"));
  }
  const std::string straight = error_of(lines);
  EXPECT_NE(straight.find("line0.xyz, "), std::string::npos) << straight;
  EXPECT_NE(straight.find("line2.xyz and 1 more: "), std::string::npos) << straight;
}

TEST_F(Suggested, AGridOfHeightsGivesItsOwnHeightsAndKeepsItsHole) {
  constexpr int kColumns = 61, kRows = 47;
  const auto is_hole = [](int i, int j) { return i >= 20 && i < 28 && j >= 20 && j < 30; };
  const auto rough = [](int i, int j) { return 2.0 * std::sin(0.31 * i) + 0.37 * ((7 * i + 13 * j) % 5); };
  for (const double cell : {0.5, 0.001, 0.03}) {
    const fs::path file = folder_ / "grid.asc";
    std::ofstream out(file);
    out.precision(12);
    out << "ncols " << kColumns << "\nnrows " << kRows << "\nxllcenter 4000\nyllcenter 0\ncellsize " << cell
        << "\nNODATA_value -9999\n";
    for (int j = kRows - 1; j >= 0; --j) {
      for (int i = 0; i < kColumns; ++i) out << (is_hole(i, j) ? -9999.0 : 0.1 * cell * rough(i, j)) << ' ';
      out << '\n';
    }
    out.close();
    Progress progress;
    suggestion_ = suggest_config({file}, {}, progress);
    EXPECT_NEAR(suggestion_.config.grid.spacing_m, cell, 1e-12 * cell);
    suggestion_.config.fill.reset();
    const BuildResult result = build_scene(suggestion_.config, {}, progress);
    std::size_t measured = 0;
    const double exact = share(result, [&](const Eigen::Vector3d& p) {
      const int i = static_cast<int>(std::lround((p.x() - 4000.0) / cell));
      const int j = static_cast<int>(std::lround(p.y() / cell));
      ++measured;
      return !is_hole(i, j) && std::abs(p.x() - 4000.0 - i * cell) < 1e-3 * cell &&
             std::abs(p.z() - 0.1 * cell * rough(i, j)) < 1e-5 * cell;
    });
    EXPECT_EQ(exact, 1.0) << cell;
    EXPECT_GE(measured, static_cast<std::size_t>(kColumns * kRows - 80 - 2)) << cell;
  }
}

// Two balls on each other and a smaller one before the lower.
TEST_F(Suggested, UpAndTheSidesOfASolidObjectCanBeSaid) {
  Points points = shell(9000, {0, 0, 0}, 1.0);
  for (const Eigen::Vector3d& p : shell(4000, {1.4, 0, 0}, 0.6)) points.push_back(p);
  for (const Eigen::Vector3d& p : shell(1000, {0, 0, 1.1}, 0.3)) points.push_back(p);
  const fs::path file = write(points);
  Progress progress;
  SuggestOptions options;
  options.up = Eigen::Vector3d::UnitX();
  suggestion_ = suggest_config({file}, {}, progress, options);
  EXPECT_NEAR(suggestion_.config.orientation.scan_to_grid.row(1).head<3>().normalized().x(), 1.0, 1e-6);
  for (const char* side : {"# back", "# left", "# right", "# top", "# bottom"})
    EXPECT_NE(suggestion_.yaml.find(side), std::string::npos) << suggestion_.yaml;
}

TEST_F(Suggested, TheOrderOfThePointsDoesNotMatter) {
  Points points = shell(5000, {0.3, 0.2, 0.1}, 1.0, 0.01);
  Progress progress;
  const std::string once = suggest_config({write(points)}, {}, progress).yaml;
  std::shuffle(points.begin(), points.end(), random_);
  EXPECT_EQ(suggest_config({write(points)}, {}, progress).yaml, once);
}

TEST_F(Suggested, AFileThatIsGivenTwiceIsGuessedOnAndListedOnce) {
  const fs::path file = write(relief(20000, 0.0005));
  fs::copy_file(file, folder_ / "copy.xyz");
  Progress once, twice;
  const std::string alone = suggest_config({file}, {}, once).yaml;
  EXPECT_TRUE(once.warnings().empty());
  EXPECT_EQ(suggest_config({file, file, folder_ / "copy.xyz"}, {}, twice).yaml, alone);
  ASSERT_EQ(twice.warnings().size(), 1U);
  EXPECT_NE(twice.warnings().front().find("the same scan is listed 3 times"), std::string::npos);
}

TEST(MainGroup, IsTheLargestOfGroupsFarApartAndNothingWhereTheyAreNear) {
  Points points;
  for (int n = 0; n < 1000; ++n) points.emplace_back(0.001 * n, 0.001 * (n % 7), 0.0);
  EXPECT_FALSE(main_group(points).has_value());
  for (int n = 0; n < 500; ++n) points.emplace_back(5.0 + 0.001 * n, 0.0, 0.0);
  EXPECT_FALSE(main_group(points).has_value());                              // a fifth of the whole is well seen
  for (int n = 0; n < 500; ++n) points.emplace_back(100.0, 0.001 * n, 0.0);  // only beside this both are small
  const auto group = main_group(points);
  ASSERT_TRUE(group.has_value());
  EXPECT_DOUBLE_EQ(group->share, 0.5);
  EXPECT_GT(group->crop.min_m.x(), -0.2);
  EXPECT_GE(group->crop.max_m.x(), 0.999);
  EXPECT_LT(group->crop.max_m.x(), 1.2);
}

TEST(SuggestedForRealScans, EveryCloudOfAThousandPointsPassesItsOwnCheck) {
  const char* folder = std::getenv("SPARSHA_SCANS_DIR");
  if (folder == nullptr) GTEST_SKIP() << "SPARSHA_SCANS_DIR is not set: no real scans at hand";
  // The large ones take most of the time.
  const std::uintmax_t largest = std::getenv("SPARSHA_NIGHTLY") != nullptr ? std::uintmax_t{1} << 40U : 2'000'000;
  int judged = 0;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file() || entry.file_size() > largest) continue;
    Progress progress;
    scene::ScanConfig scan;
    scan.file = entry.path();
    try {
      if (load_scan(scan, progress).size() < 1000) continue;
    } catch (const Error&) {
      EXPECT_THROW((void)suggest_config({entry.path()}, {}, progress), Error) << entry.path();
      continue;
    }
    SCOPED_TRACE(entry.path().string());
    Progress quiet;
    const Suggestion suggestion = suggest_config({entry.path()}, {}, quiet);
    BuildResult result;
    ASSERT_NO_THROW(result = build_scene(suggestion.config, {}, quiet)) << suggestion.yaml;
    EXPECT_LE(result.report.check->cloud_to_surface.median_m, suggestion.config.grid.spacing_m);
    for (const std::string& warning : result.report.warnings) {
      EXPECT_EQ(warning.find("farther than"), std::string::npos) << warning;
      EXPECT_EQ(warning.find("times finer than"), std::string::npos) << warning;
      EXPECT_EQ(warning.find("seems to face away"), std::string::npos) << warning;
    }
    ++judged;
  }
  EXPECT_GT(judged, 20);
}

}  // namespace
}  // namespace sparsha::pipeline
