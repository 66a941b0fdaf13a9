// A scan whose file says which points are worth little, filtered by that, against a file without those points.
#include <gmock/gmock.h>

#include <fstream>
#include <random>

#include <fmt/format.h>

#include "base/error.h"
#include "pipeline/suggest/suggest.h"
#include "tests/pipeline/outofcore/two_builds.h"

namespace sparsha::pipeline {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

/// A relief 0.4 m wide and, of three points one, something above it with a confidence of 0.
class PointWorth : public TwoBuilds {
 protected:
  struct Point {
    double x, y, z;
    int confidence;
  };
  [[nodiscard]] static std::vector<Point> points(bool regular) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::vector<Point> all;
    constexpr int kSide = 60;
    for (int j = 0; j < kSide; ++j) {
      for (int i = 0; i < kSide; ++i) {
        const double x = 0.4 * (i + (regular ? 0.0 : 0.5 * unit(random))) / kSide;
        const double y = 0.4 * (j + (regular ? 0.0 : 0.5 * unit(random))) / kSide;
        const double z = 0.02 * std::sin(9.0 * x) * std::cos(7.0 * y);
        const bool bad = regular ? (i > 20 && i < 30 && j > 20 && j < 30) : unit(random) < 0.33;
        all.push_back({x, y, bad ? z + 0.05 * unit(random) : z, bad ? 0 : 1 + static_cast<int>(2.0 * unit(random))});
      }
    }
    return all;
  }
  /// An ASCII PLY; `field`: with the confidences; `mesh`: with two triangles a cell of the raster of all points.
  [[nodiscard]] std::string write(const std::string& name, const std::vector<Point>& points, bool field,
                                  bool mesh = false) const {
    std::string faces;
    std::size_t count = 0;
    std::vector<std::size_t> place(points.size());
    std::string rows;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      place[i] = kept;
      if (!field && points[i].confidence == 0) continue;
      ++kept;
      rows += fmt::format("{:.9g} {:.9g} {:.9g}", points[i].x, points[i].y, points[i].z);
      rows += field ? fmt::format(" {}\n", points[i].confidence) : "\n";
    }
    constexpr std::size_t kSide = 60;
    for (std::size_t j = 0; mesh && j + 1 < kSide; ++j) {
      for (std::size_t i = 0; i + 1 < kSide; ++i) {
        const std::size_t a = j * kSide + i;
        for (const std::array<std::size_t, 3>& f :
             {std::array{a, a + 1, a + kSide}, std::array{a + 1, a + kSide + 1, a + kSide}}) {
          const bool gone = std::any_of(f.begin(), f.end(), [&](std::size_t v) { return points[v].confidence == 0; });
          if (!field && gone) continue;
          ++count;
          faces += fmt::format("3 {} {} {}\n", place[f[0]], place[f[1]], place[f[2]]);
        }
      }
    }
    std::string head = fmt::format(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n", kept);
    if (field) head += "property uchar confidence\n";
    if (mesh) head += fmt::format("element face {}\nproperty list uchar int vertex_indices\n", count);
    std::ofstream(folder_ / name) << head << "end_header\n" << rows << faces;
    return name;
  }
  [[nodiscard]] scene::Config config(const std::vector<std::string>& files, const std::string& filters) const {
    std::string yaml = "scans:\n";
    for (const std::string& file : files) yaml += "  - {file: " + file + ", units: m}\n";
    yaml +=
        filters + "grid: {spacing_mm: 8, bounds_m: [0, 0, 0.4, 0.4]}\nfill: {max_gap_mm: 20}\ncheck: {samples: all}\n";
    std::ofstream(folder_ / "c.yaml") << yaml;
    return scene::load_config(folder_ / "c.yaml");
  }
  void expect_same_heights(const std::string& a, const std::string& b) const {
    for (const char* layer : {"height.tif", "mask.tif"}) {
      EXPECT_TRUE(read_file(folder_ / a / "level-0" / layer, kLargest) ==
                  read_file(folder_ / b / "level-0" / layer, kLargest))
          << a << ' ' << b << ' ' << layer;
    }
  }
};

constexpr const char* kFilter = "filters:\n  - field: {name: Confidence, min: 1}\n";

TEST_F(PointWorth, FilteredByItsFieldAScanGivesTheHeightsOfOneWithoutThosePoints) {
  const std::vector<Point> all = points(false);
  (void)write("all.ply", all, true);
  (void)write("good.ply", all, false);
  build(config({"all.ply"}, kFilter), "memory", 0);
  build(config({"all.ply"}, kFilter), "disk", 1000);
  build(config({"good.ply"}, ""), "good", 0);
  build(config({"all.ply"}, ""), "unfiltered", 0);
  expect_same(folder_ / "memory", folder_ / "disk");
  expect_same_heights("memory", "good");
  EXPECT_FALSE(read_file(folder_ / "unfiltered/level-0/height.tif", kLargest) ==
               read_file(folder_ / "good/level-0/height.tif", kLargest));
  const auto warnings = report(folder_ / "unfiltered")["warnings"].dump();
  EXPECT_THAT(warnings, HasSubstr("have a confidence of 0"));
  EXPECT_THAT(warnings, HasSubstr("field: {name: confidence, min: 1}"));
  EXPECT_THAT(report(folder_ / "memory")["warnings"].dump(), ::testing::Not(HasSubstr("confidence")));
}

TEST_F(PointWorth, FacesGoWithTheirCorners) {
  const std::vector<Point> all = points(true);
  (void)write("all.ply", all, true, true);
  (void)write("good.ply", all, false, true);
  build(config({"all.ply"}, kFilter), "filtered", 0);
  build(config({"good.ply"}, ""), "good", 0);
  expect_same_heights("filtered", "good");
  EXPECT_EQ(report(folder_ / "filtered")["triangles"], report(folder_ / "good")["triangles"]);
}

TEST_F(PointWorth, AScanThatSaysNothingKeepsItsPointsAndThatIsSaid) {
  const std::vector<Point> all = points(false);
  (void)write("all.ply", all, true);
  (void)write("good.ply", all, false);
  std::vector<Point> other = points(true);
  for (Point& p : other) p.y += 0.003;
  (void)write("other.ply", other, false);
  for (const char* filters :
       {kFilter, "filters:\n  - pass: {axis: x, min_m: 0.05}\n  - field: {name: confidence, min: 1}\n"}) {
    build(config({"other.ply", "all.ply"}, filters), "memory", 0);
    build(config({"other.ply", "all.ply"}, filters), "disk", 1000);
    expect_same(folder_ / "memory", folder_ / "disk");
    const auto warnings = report(folder_ / "memory")["warnings"].dump();
    EXPECT_THAT(warnings, HasSubstr("other.ply: has no field 'confidence'"));
    EXPECT_THAT(report(folder_ / "memory")["filters"].dump(), HasSubstr("points without a value stay"));
  }
  build(config({"other.ply", "good.ply"}, ""), "good", 0);
  build(config({"other.ply", "all.ply"}, kFilter), "filtered", 0);
  expect_same_heights("filtered", "good");
}

TEST_F(PointWorth, AFieldThatNoScanHasIsAnErrorThatNamesThoseThatThereAre) {
  (void)write("all.ply", points(false), true);
  const auto error_of = [&](const std::string& filter) -> std::string {
    try {
      build(config({"all.ply"}, "filters:\n  - " + filter + "\n"), "scene", 0);
    } catch (const Error& error) {
      return std::string(error.what()) + " " + error.place().file;
    }
    return "no error";
  };
  EXPECT_THAT(error_of("field: {name: qality, min: 1}"), HasSubstr("no scan has the field 'qality'"));
  EXPECT_THAT(error_of("field: {name: qality, min: 1}"), HasSubstr("confidence"));
  EXPECT_THAT(error_of("field: {name: qality, min: 1}"), HasSubstr("c.yaml"));
  EXPECT_THAT(error_of("classes: {drop: [7]}"), HasSubstr("no scan has the field 'classification'"));
  EXPECT_THAT(error_of("field: {name: confidence, min: 7}"), HasSubstr("nothing is left"));
  EXPECT_THAT(error_of("voxel: {leaf_mm: 1}\n  - field: {name: confidence, min: 1}"), HasSubstr("after 'voxel'"));
}

TEST_F(PointWorth, IsProposedWithItsReasonAndTheShareThatStays) {
  (void)write("all.ply", points(false), true);
  Progress progress;
  const Suggestion suggestion = suggest_config({folder_ / "all.ply"}, folder_.path(), progress);
  EXPECT_THAT(suggestion.yaml, HasSubstr("  - field: {name: confidence, min: 1}  # "));
  EXPECT_THAT(suggestion.yaml, HasSubstr("% of its points stay"));
  EXPECT_EQ(suggestion.config.filters.size(), 1U);
  EXPECT_THAT(progress.warnings(), ::testing::Contains(HasSubstr("field: {name: confidence, min: 1}")));
  build(suggestion.config, "scene", 0);
}

}  // namespace
}  // namespace sparsha::pipeline
