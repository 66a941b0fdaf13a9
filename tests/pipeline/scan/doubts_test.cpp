// Doubts are said where they are right and nowhere else: each kind of scan that raises one, and the like of it that
// does not.
#include "pipeline/scan/doubts.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <Eigen/Geometry>

#include "base/threads/progress.h"
#include "pipeline/scan/set.h"
#include "pipeline/scan/statistics.h"
#include "scene/config/config.h"
#include "tests/support/doubted_scans.h"
#include "tests/support/scan_files.h"

namespace sparsha::pipeline {
namespace {

using ::testing::AllOf;
using testing::config_of;
using ::testing::Contains;
using testing::doubts_of;
using ::testing::ElementsAre;
using testing::Face;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::kUtm;
using testing::moved;
using ::testing::Not;
using testing::Points;
using testing::random_relief;
using testing::relief;
using testing::scan_of;
using testing::ScanFolder;
using testing::text_of;

/// Every `spacing` in x and y.
Points raster_relief(double spacing, double share = 1.0) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  Points points;
  for (int j = 0; j * spacing < 0.8; ++j)
    for (int i = 0; i * spacing < 1.0; ++i)
      if (unit(random) < share) points.emplace_back(i * spacing, j * spacing, relief(i * spacing, j * spacing));
  return points;
}

Points rounded(Points points, const Eigen::Vector3d& step) {
  for (Eigen::Vector3d& p : points) p = (p.array() / step.array()).round() * step.array();
  return points;
}

Points as_floats(Points points) {
  for (Eigen::Vector3d& p : points) p = p.cast<float>().cast<double>();
  return points;
}

TEST(StoredSteps, OfFloatsFarFromZeroAreSaidWithTheStepAndThePointsDistance) {
  for (const Points& points : {random_relief(2000, 1), raster_relief(0.02)}) {
    EXPECT_THAT(doubts_of(as_floats(moved(points, kUtm))),
                ElementsAre(AllOf(HasSubstr("x in steps of 0.0312 units, y in steps of 0.5 units"), HasSubstr("0.02"),
                                  HasSubstr("double precision"))));
    EXPECT_THAT(doubts_of(moved(points, kUtm)), IsEmpty()) << "in double";
    EXPECT_THAT(doubts_of(as_floats(points)), IsEmpty()) << "near zero";
  }
  // A wall along x: all of its y are one number.
  Points wall;
  for (const Eigen::Vector3d& p : raster_relief(0.02)) wall.emplace_back(p.x(), p.z(), p.y());
  EXPECT_THAT(doubts_of(as_floats(moved(wall, kUtm))), ElementsAre(HasSubstr("y in steps of 0.5 units")));
}

TEST(StoredSteps, OfFewDecimalsAreSaidUnlessThePointsAreFarApart) {
  const Points points = random_relief(2000, 2);  // 0.02 apart
  EXPECT_THAT(doubts_of(rounded(points, {0.01, 0.01, 0.01})),
              ElementsAre(AllOf(HasSubstr("x in steps of 0.01 units, y in steps of 0.01 units, z in steps of 0.01"),
                                HasSubstr("more decimals"))));
  EXPECT_THAT(doubts_of(rounded(moved(points, kUtm), {0.01, 0.01, 0.01})), Contains(HasSubstr("steps of 0.01")));
  EXPECT_THAT(doubts_of(as_floats(rounded(moved(points, {3, 4, 5}), {0.01, 0.01, 0.01}))),
              ElementsAre(HasSubstr("steps of 0.01")));
  for (const double coarser : {0.02, 0.05, 0.1})
    EXPECT_THAT(doubts_of(rounded(points, {coarser, coarser, coarser / 10})), Contains(HasSubstr("in steps of")));
  EXPECT_THAT(doubts_of(rounded(points, {0.001, 0.001, 0.001})), IsEmpty());
  EXPECT_THAT(doubts_of(rounded(moved(points, kUtm), {0.001, 0.001, 0.001})), IsEmpty());
  // A depth camera's picture: x and y as they come, depth in whole millimetres.
  Points camera = points;
  for (Eigen::Vector3d& p : camera) p.z() = 0.01 * std::round(100.0 * (0.8 + 4.0 * p.z()));
  EXPECT_THAT(doubts_of(camera), ElementsAre(HasSubstr("z in steps of 0.01")));
  // Heights alone, of points on a raster.
  EXPECT_THAT(doubts_of(rounded(raster_relief(0.01), {1e-6, 1e-6, 0.002})),
              ElementsAre(AllOf(HasSubstr("z in steps of 0.002"), Not(HasSubstr("x in")))));
}

TEST(StoredSteps, OfARasterOrOfScanLinesAreNoDoubt) {
  const Eigen::Vector3d fine(1e-5, 1e-5, 1e-5);
  for (const double share : {1.0, 0.6, 0.35}) {
    EXPECT_THAT(doubts_of(rounded(raster_relief(0.01, share), fine)), IsEmpty()) << share;
    EXPECT_THAT(doubts_of(rounded(moved(raster_relief(0.01, share), kUtm), fine)), IsEmpty()) << share;
  }
  Points twice = rounded(raster_relief(0.01), fine);
  twice.insert(twice.end(), twice.begin(), twice.end());
  EXPECT_THAT(doubts_of(twice), IsEmpty());
  Points lines;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int line = 0; line < 80; ++line)
    for (int k = 0; k < 100; ++k) {
      const double y = unit(random);
      lines.emplace_back(0.0125 * line, y, relief(0.0125 * line, y));
    }
  EXPECT_THAT(doubts_of(lines), IsEmpty());
  // Northing in half metres are numbers that float32 has, too.
  Points terrain;
  for (const Eigen::Vector3d& p : raster_relief(0.01)) terrain.emplace_back(50.0 * p);
  EXPECT_THAT(doubts_of(rounded(moved(terrain, {412000, 5654000, 100}), {0.5, 0.5, 0.01})), IsEmpty());
  // A number that stands for no data is no step.
  Points no_data = raster_relief(0.02);
  for (std::size_t k = 0; k < no_data.size(); k += 30) no_data[k].z() = -9999.0;
  EXPECT_THAT(doubts_of(no_data), Not(Contains(HasSubstr("coarse"))));
  // Two rasters, half a step off each other.
  Points tiles = raster_relief(0.01);
  const Points other = moved(raster_relief(0.01), {1.005, 0.005, 0});
  tiles.insert(tiles.end(), other.begin(), other.end());
  EXPECT_THAT(doubts_of(rounded(tiles, fine)), IsEmpty());
  // A raster in whole millimetres whose heights are smooth.
  Points millimetres = raster_relief(0.01);
  for (Eigen::Vector3d& p : millimetres) p *= 1000.0;
  EXPECT_THAT(doubts_of(rounded(millimetres, {1, 1, 0.01})), IsEmpty());
}

TEST(StoredSteps, OfHeightsAloneAreSaidThoughTheyAreFew) {
  // A relief of 40 mm in steps of half a point's distance and of one: nine levels and five.
  const auto steep = [](Points points, double step) {
    for (Eigen::Vector3d& p : points) p.z() = step * std::round(relief(3.0 * p.x(), 3.0 * p.y()) / step);
    return points;
  };
  for (const double step : {0.005, 0.01}) {
    const Points points = steep(random_relief(8000, 12), step);
    EXPECT_THAT(doubts_of(points), ElementsAre(AllOf(HasSubstr("z in steps of 0.0"), Not(HasSubstr("x in"))))) << step;
    EXPECT_THAT(doubts_of(moved(points, {412345, 5654321, 0})), Contains(HasSubstr("z in steps of 0.0"))) << step;
    EXPECT_THAT(doubts_of(steep(raster_relief(0.01), step)), Contains(HasSubstr("z in steps of 0.0"))) << step;
  }
}

TEST(StoredSteps, OfPlatesStairsAndTerracesAreNoDoubt) {
  std::mt19937 random(13);
  std::uniform_real_distribution<double> unit(0, 1);
  Points plate, noisy, stairs, low_stairs, terraces;
  for (const Eigen::Vector3d& p : random_relief(8000, 14)) {  // 0.01 apart
    plate.emplace_back(p.x(), p.y(), 0.5);
    noisy.emplace_back(p.x(), p.y(), 0.005 * std::round(1.3 * unit(random) + 0.35));
    stairs.emplace_back(p.x(), p.y(), 0.17 * std::floor(8.0 * p.x()));
    low_stairs.emplace_back(p.x(), p.y(), 0.01 * std::floor(8.0 * p.x()));
    const double r = std::hypot(p.x() - 0.5, p.y() - 0.4);
    terraces.emplace_back(p.x(), p.y(), 0.005 * std::floor(6.0 * (1.0 - r)));
  }
  EXPECT_THAT(doubts_of(plate), IsEmpty());
  EXPECT_THAT(doubts_of(noisy), IsEmpty());
  EXPECT_THAT(doubts_of(stairs), IsEmpty());
  EXPECT_THAT(doubts_of(low_stairs), IsEmpty());
  EXPECT_THAT(doubts_of(terraces), IsEmpty());
}

TEST(StoredSteps, OfAMeshOnALatticeAreNoDoubtAndOfOneRoundedFarFromZeroAre) {
  Points corners;
  std::vector<Face> faces;
  for (std::uint32_t j = 0; j < 20; ++j)
    for (std::uint32_t i = 0; i < 20; ++i) {
      corners.emplace_back(i, j, (i * j) % 3);
      const std::uint32_t n = 20 * j + i;
      if (i < 19 && j < 19) faces.insert(faces.end(), {{n, n + 1, n + 20}, {n + 1, n + 21, n + 20}});
    }
  EXPECT_THAT(doubts_of(corners, faces), IsEmpty());
  Points far;
  for (const Eigen::Vector3d& p : corners) far.emplace_back(kUtm + 0.02 * p);
  EXPECT_THAT(doubts_of(as_floats(far), faces), ElementsAre(HasSubstr("y in steps of 0.5 units")));
}

TEST(Doubts, AreTheSameOfAStreamOfAScanInMemoryAndInAnyOrder) {
  const ScanFolder folder;
  Points points = rounded(random_relief(30000, 4), {0.005, 0.005, 0.005});
  const auto file = folder.write("a.xyz", text_of(points));
  const std::vector<std::string> said = inspect_scan(file).warnings;
  ASSERT_THAT(said, ElementsAre(HasSubstr("steps of 0.005")));
  Progress progress;
  for (const std::uint64_t large : {std::uint64_t{1}, std::uint64_t{1} << 30})
    EXPECT_EQ(scan_statistics(file, progress, large).scan.warnings, said);
  for (const ScanSet::Keep keep : {ScanSet::Keep::disk, ScanSet::Keep::quickest}) {
    Progress of_build;
    const ScanSet set({config_of(file)}, keep, false, of_build);
    EXPECT_THAT(of_build.warnings(), ElementsAre(file.string() + ": " + said[0]));
  }
  std::shuffle(points.begin(), points.end(), std::mt19937(9));
  EXPECT_EQ(inspect_scan(folder.write("b.xyz", text_of(points))).warnings, said);
}

/// About Rome, by longitude, latitude and height.
Points degrees(double size_m) {
  Points points = random_relief(500, 6);
  for (Eigen::Vector3d& p : points)
    p = {12.4923 + size_m * p.x() / 83000, 41.8902 + size_m * p.y() / 111000, 52 + size_m * p.z()};
  return points;
}

TEST(Doubts, DegreesThatNoFileNamesAreRefusedUnlessAUnitIsGiven) {
  const ScanFolder folder;
  for (const double size_m : {0.5, 200.0}) {
    const auto file = folder.write("site.xyz", text_of(degrees(size_m)));
    const ScanInfo info = inspect_scan(file);
    EXPECT_EQ(info.units, "degrees");
    EXPECT_THAT(info.warnings, ElementsAre(HasSubstr("look like degrees")));
    Progress progress;
    try {
      (void)load_scan(config_of(file), progress);
      ADD_FAILURE() << "must be refused";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      EXPECT_THAT(error.what(), HasSubstr("degrees"));
    }
    EXPECT_THAT(progress.warnings(), Contains(HasSubstr("look like degrees")));
    EXPECT_EQ(load_scan(config_of(file, scene::LengthUnit::m), progress).size(), 500U);
  }
}

TEST(Doubts, AFlatSiteInDegreesIsDoubted) {
  Points flat = degrees(20.0);
  for (Eigen::Vector3d& p : flat) p.z() = 52.0 + 0.02 * (p.z() - 52.0);
  EXPECT_THAT(doubts_of(flat), Contains(HasSubstr("may be degrees")));
  RawScan scan = scan_of(flat);
  add_doubts(scan);
  EXPECT_FALSE(scan.degrees) << "said, not refused";
}

TEST(Doubts, SmallThingsNearAndFarFromZeroAreNoDegrees) {
  EXPECT_THAT(doubts_of(random_relief(500, 7)), IsEmpty());
  EXPECT_THAT(doubts_of(moved(random_relief(500, 7), {100, 40, 5})), IsEmpty());
  Points pole;  // 5 m high, 2 cm thick
  for (const Eigen::Vector3d& p : random_relief(500, 8))
    pole.emplace_back(7.0 + 0.01 * std::cos(6.28 * p.x()), 3.0 + 0.01 * std::sin(6.28 * p.x()), 5.0 * p.y());
  EXPECT_THAT(doubts_of(pole), Not(Contains(HasSubstr("degrees"))));
}

TEST(Doubts, DegreesBehindAHeightAreDegrees) {
  Points turned = degrees(20.0);
  for (Eigen::Vector3d& p : turned) p = Eigen::Vector3d(1e3 * p.z(), p.y(), p.x());
  EXPECT_THAT(doubts_of(turned), Contains(HasSubstr("y and z look like degrees")));
}

}  // namespace
}  // namespace sparsha::pipeline
