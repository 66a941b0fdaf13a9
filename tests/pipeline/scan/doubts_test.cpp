// Doubts are said where they are right and nowhere else: each kind of scan that raises one, and the like of it that
// does not.
#include "pipeline/scan/doubts.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <sstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <Eigen/Geometry>

#include "base/threads/progress.h"
#include "pipeline/scan/empty_returns.h"
#include "pipeline/scan/pieces.h"
#include "pipeline/scan/set.h"
#include "pipeline/scan/statistics.h"
#include "pipeline/scan/units.h"
#include "scene/config/config.h"
#include "tests/support/scan_files.h"

namespace sparsha::pipeline {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::ScanFolder;
using Points = std::vector<Eigen::Vector3d>;
using Face = std::array<std::uint32_t, 3>;

double relief(double x, double y) { return 0.02 * std::sin(9.0 * x) * std::cos(8.0 * y); }

/// `count` points at random over 1 m x 0.8 m.
Points random_relief(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  Points points;
  for (int k = 0; k < count; ++k) {
    const double x = unit(random);
    const double y = 0.8 * unit(random);
    points.emplace_back(x, y, relief(x, y));
  }
  return points;
}

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

Points moved(Points points, const Eigen::Vector3d& shift) {
  for (Eigen::Vector3d& p : points) p += shift;
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

RawScan scan_of(Points points, std::vector<Face> faces = {}) {
  RawScan scan;
  scan.format = "XYZ text";
  scan.records = points.size();
  scan.points = std::move(points);
  scan.faces = std::move(faces);
  return scan;
}

std::vector<std::string> doubts_of(Points points, std::vector<Face> faces = {}) {
  RawScan scan = scan_of(std::move(points), std::move(faces));
  add_doubts(scan);
  if (!scan.pieces.empty()) scan.warnings.push_back(scan.pieces);
  return scan.warnings;
}

const Eigen::Vector3d kUtm(412345.0, 5654321.0, 100.0);

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

std::string text_of(const Points& points) {
  std::ostringstream text;
  text.precision(12);
  for (const Eigen::Vector3d& p : points) text << p.x() << ' ' << p.y() << ' ' << p.z() << '\n';
  return text.str();
}

scene::ScanConfig config_of(const std::filesystem::path& file, scene::LengthUnit unit = scene::LengthUnit::automatic) {
  scene::ScanConfig config;
  config.file = file;
  config.units.unit = unit;
  return config;
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

/// A square of 21 x 21 vertices, 0.02 apart, at z = -0.6.
RawScan square_mesh() {
  Points corners;
  std::vector<Face> faces;
  for (std::uint32_t j = 0; j < 21; ++j)
    for (std::uint32_t i = 0; i < 21; ++i) {
      corners.emplace_back(0.02 * i - 0.2, 0.02 * j - 0.2, -0.6);
      const std::uint32_t n = 21 * j + i;
      if (i < 20 && j < 20) faces.insert(faces.end(), {{n, n + 1, n + 21}, {n + 1, n + 22, n + 21}});
    }
  return scan_of(std::move(corners), std::move(faces));
}

TEST(NoSurface, VerticesOfAMeshWhereADepthCameraSawNothingAreAHole) {
  RawScan scan = square_mesh();
  for (const std::uint32_t j : {9U, 10U, 11U})
    for (const std::uint32_t i : {9U, 10U, 11U}) scan.points[21 * j + i].setZero();
  drop_what_is_no_surface(scan);
  EXPECT_EQ(scan.points.size(), 441U - 9U);
  EXPECT_EQ(scan.invalid, 9U);
  EXPECT_EQ(scan.faces.size(), 800U - 30U) << "two triangles of each of 16 squares, but two at corners";
  for (const auto& face : scan.faces)
    for (const std::uint32_t v : face) EXPECT_EQ(scan.points.at(v).z(), -0.6);
  EXPECT_THAT(scan.warnings, ElementsAre(AllOf(HasSubstr("9 of 441 vertices"), HasSubstr("30 faces"))));
}

TEST(NoSurface, APictureThatIsMostlyEmptyIsStillAMesh) {
  RawScan scan = square_mesh();
  const std::size_t seen = scan.points.size();
  scan.points.resize(10 * seen, Eigen::Vector3d::Zero());
  drop_what_is_no_surface(scan);
  EXPECT_EQ(scan.points.size(), seen);
  EXPECT_EQ(scan.invalid, 9 * seen);
  EXPECT_THAT(scan.warnings, ElementsAre(HasSubstr("3969 of 4410 vertices stand at 0 0 0")));
}

TEST(NoSurface, VerticesOfAMeshThroughTheOriginStay) {
  // A cone of 100 triangles that share nothing: its apex is at 0 0 0 a hundred times.
  Points corners;
  std::vector<Face> faces;
  for (std::uint32_t k = 0; k < 100; ++k) {
    const auto at = [&](double turn) {
      return Eigen::Vector3d(std::cos(0.0628 * turn), std::sin(0.0628 * turn), -0.5);
    };
    corners.insert(corners.end(), {Eigen::Vector3d::Zero(), at(k), at(k + 1)});
    faces.push_back({3 * k, 3 * k + 1, 3 * k + 2});
  }
  RawScan cone = scan_of(corners, faces);
  drop_what_is_no_surface(cone);
  EXPECT_THAT(cone.warnings, IsEmpty());
  EXPECT_EQ(cone.points.size(), 300U);
  // A seam of copies of one vertex, as textures need them, among ordinary edges.
  RawScan seam = square_mesh();
  for (Eigen::Vector3d& p : seam.points) p.z() = 0.0;
  for (int copy = 0; copy < 6; ++copy) {
    const auto n = static_cast<std::uint32_t>(seam.points.size());
    seam.points.push_back(seam.points[220]);
    seam.faces.push_back({n, 221, 242});
  }
  ASSERT_TRUE(seam.points[220].isZero(1e-12));
  for (const std::size_t n : {220U, 441U, 442U, 443U, 444U, 445U, 446U}) seam.points[n].setZero();
  drop_what_is_no_surface(seam);
  EXPECT_EQ(seam.points.size(), 447U);
}

TEST(NoSurface, VerticesInBulkAtAnyOtherPlaceAreAHoleToo) {
  std::mt19937 random(26);
  std::normal_distribution<double> rounding(0.0, 1e-6);
  // As other programs write what is missing, the camera's place in a moved mesh, and there with rounding.
  for (const Eigen::Vector3d& shift : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(2, 3, 1), kUtm}) {
    for (const Eigen::Vector3d& place :
         {Eigen::Vector3d(-1, -1, -1), Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.05, 0.1, 0.4)}) {
      for (const double off : {0.0, 1.0}) {
        SCOPED_TRACE(fmt::format("shift {} place {} rounding {}", shift.x(), place.x(), off));
        RawScan scan = square_mesh();
        for (Eigen::Vector3d& p : scan.points) p += shift;
        for (const std::uint32_t j : {9U, 10U, 11U})
          for (const std::uint32_t i : {9U, 10U, 11U}) {
            const Eigen::Vector3d noise(rounding(random), rounding(random), rounding(random));
            scan.points[21 * j + i] = shift + place + off * noise;
          }
        drop_what_is_no_surface(scan);
        EXPECT_EQ(scan.points.size(), 441U - 9U);
        EXPECT_EQ(scan.faces.size(), 800U - 30U);
        for (const Eigen::Vector3d& p : scan.points) EXPECT_NEAR(p.z(), shift.z() - 0.6, 1e-9);
        EXPECT_THAT(scan.warnings, ElementsAre(AllOf(HasSubstr("9 of 441 vertices stand"), HasSubstr("30 faces"))));
      }
    }
  }
  RawScan scattered = square_mesh();
  for (const std::size_t n : {50U, 120U, 200U, 250U, 333U}) scattered.points[n] = {2, 3, 1};
  drop_what_is_no_surface(scattered);
  EXPECT_EQ(scattered.points.size(), 436U);
  EXPECT_EQ(scattered.faces.size(), 800U - 30U);
  RawScan empty = square_mesh();
  for (Eigen::Vector3d& p : empty.points) p += Eigen::Vector3d(2, 3, 1);
  empty.points.resize(4410, Eigen::Vector3d(2, 3, 1));
  drop_what_is_no_surface(empty);
  EXPECT_EQ(empty.points.size(), 441U);
}

TEST(NoSurface, VerticesTogetherThatBelongToTheSurfaceStay) {
  // A fine detail, 441 vertices within a hundredth of an edge, joined to large triangles.
  RawScan detail = square_mesh();
  const auto first = static_cast<std::uint32_t>(detail.points.size());
  const RawScan fine = square_mesh();
  for (const Eigen::Vector3d& p : fine.points) {
    detail.points.emplace_back(Eigen::Vector3d(0.21, 0.2, -0.6) + 1e-4 * (p + Eigen::Vector3d(0, 0, 0.6)));
  }
  for (const auto& [a, b, c] : fine.faces) detail.faces.push_back({a + first, b + first, c + first});
  for (std::uint32_t k = 0; k < 20; ++k) detail.faces.push_back({440, first + 21 * k, first + 21 * (k + 1)});
  drop_what_is_no_surface(detail);
  EXPECT_EQ(detail.points.size(), 882U);
  EXPECT_THAT(detail.warnings, IsEmpty());
  // A steep cone whose apex has a copy for each of its 200 sectors, with and without collapsed triangles, beside a
  // sheet or standing on it, with its apex at 0 0 0 or elsewhere.
  for (const bool lathe : {false, true})
    for (const bool joined : {false, true})
      for (const double height : {0.0, 1.0}) {
        SCOPED_TRACE(fmt::format("lathe {} joined {} height {}", lathe, joined, height));
        RawScan cone = square_mesh();
        const auto apex = static_cast<std::uint32_t>(cone.points.size());
        for (int k = 0; k < 200; ++k) cone.points.emplace_back(0.0, 0.0, height);
        for (const double radius : {0.2, 0.201})
          for (int k = 0; k < 200; ++k)
            cone.points.emplace_back(radius * std::cos(k * 0.0314), radius * std::sin(k * 0.0314), -0.6);
        for (std::uint32_t k = 0; k < 200; ++k) {
          const std::uint32_t next = (k + 1) % 200;
          const std::uint32_t ring = apex + 200;
          cone.faces.push_back({apex + k, ring + k, ring + next});
          if (lathe) cone.faces.push_back({apex + k, ring + next, apex + next});
          if (joined) {
            cone.faces.push_back({ring + k, ring + 200 + k, ring + next});
            cone.faces.push_back({ring + next, ring + 200 + k, ring + 200 + next});
          }
        }
        const std::size_t faces = cone.faces.size();
        drop_what_is_no_surface(cone);
        EXPECT_EQ(cone.faces.size(), faces);
        EXPECT_EQ(cone.points.size(), joined ? 1041U : 841U);
      }
}

TEST(NoSurface, TheBaseOfATurnedVesselStaysThoughItsAxisHasManyVertices) {
  // A cup of 96 segments, its base joined to its wall, each segment with a vertex of its own on the axis.
  constexpr std::uint32_t kSegments = 96, kRows = 100;
  for (const Eigen::Vector3d& axis : {Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(0, 0, 0)}) {
    Points points;
    std::vector<Face> faces;
    for (std::uint32_t row = 0; row < kRows; ++row)
      for (std::uint32_t k = 0; k < kSegments; ++k) {
        const double turn = k * 2.0 * 3.14159265358979 / kSegments;
        points.push_back(axis + Eigen::Vector3d(0.05 * std::cos(turn), 0.05 * std::sin(turn), 0.001 * row));
      }
    for (std::uint32_t k = 0; k < kSegments; ++k) {
      const std::uint32_t next = (k + 1) % kSegments;
      for (std::uint32_t row = 0; row + 1 < kRows; ++row) {
        faces.push_back({row * kSegments + k, row * kSegments + next, (row + 1) * kSegments + k});
        faces.push_back({row * kSegments + next, (row + 1) * kSegments + next, (row + 1) * kSegments + k});
      }
      faces.push_back({k, next, static_cast<std::uint32_t>(points.size())});
      points.push_back(axis);
    }
    RawScan cup = scan_of(points, faces);
    drop_what_is_no_surface(cup);
    EXPECT_THAT(cup.warnings, IsEmpty()) << axis;
    EXPECT_EQ(cup.faces.size(), faces.size()) << axis;
  }
}

TEST(NoSurface, VerticesOfNoFaceAreLeftOutAndSaidUnlessMostAre) {
  RawScan scan = square_mesh();
  scan.points.emplace_back(0, -180, -400);
  scan.points.emplace_back(251, -180, 90);
  drop_what_is_no_surface(scan);
  EXPECT_EQ(scan.points.size(), 441U);
  EXPECT_EQ(scan.invalid, 2U);
  EXPECT_THAT(scan.warnings, ElementsAre(HasSubstr("2 of 443 vertices belong to no face; they are left out")));
  EXPECT_NEAR(median_spacing(scan.points), 0.02, 1e-6);
  RawScan cloud = square_mesh();
  cloud.faces.resize(5);
  drop_what_is_no_surface(cloud);
  EXPECT_EQ(cloud.points.size(), 441U);
  EXPECT_EQ(cloud.invalid, 0U);
  EXPECT_THAT(cloud.warnings, ElementsAre(HasSubstr("taken as points")));
}

TEST(NoSurface, OfAMeshIsTheSameWhetherStreamedOrNot) {
  const ScanFolder folder;
  std::ostringstream text;
  text << "ply\nformat ascii 1.0\nelement vertex 444\nproperty float x\nproperty float y\nproperty float z\n"
          "element face 800\nproperty list uchar int vertex_indices\nend_header\n";
  RawScan mesh = square_mesh();
  for (const std::uint32_t n : {220U, 221U, 222U, 241U, 242U}) mesh.points[n].setZero();
  for (const Eigen::Vector3d& p : mesh.points) text << p.x() << ' ' << p.y() << ' ' << p.z() << '\n';
  text << "700 0 0\n0 900 0\nnan 0 0\n";
  for (const auto& [a, b, c] : mesh.faces) text << "3 " << a << ' ' << b << ' ' << c << '\n';
  const auto file = folder.write("a.ply", text.str());
  Progress first;
  Progress second;
  ScanSet memory({config_of(file, scene::LengthUnit::m)}, ScanSet::Keep::quickest, false, first);
  ScanSet streamed({config_of(file, scene::LengthUnit::m)}, ScanSet::Keep::disk, false, second);
  EXPECT_EQ(memory.points(), 436U);
  EXPECT_EQ(streamed.points(), memory.points());
  EXPECT_EQ(streamed.invalid(), memory.invalid());
  EXPECT_EQ(streamed.faces(), memory.faces());
  EXPECT_EQ(streamed.origin_m(), memory.origin_m());
  EXPECT_EQ(first.warnings(), second.warnings());
  const Cloud a = memory.load(memory.origin_m(), first);
  const Cloud b = streamed.load(streamed.origin_m(), second);
  ASSERT_EQ(a.size(), b.size());
  EXPECT_TRUE(std::equal(a.xyz1(), a.xyz1() + 4 * a.size(), b.xyz1()));
  EXPECT_EQ(a.faces, b.faces);
  EXPECT_EQ(first.warnings(), second.warnings());
}

TEST(Pieces, IslandsBesideAMeshAreCountedAndWhatTouchesIsOnePiece) {
  RawScan mesh = square_mesh();
  const auto add_island = [&](double x, double y, double z) {
    const auto first = static_cast<std::uint32_t>(mesh.points.size());
    mesh.points.insert(mesh.points.end(), {{x, y, z}, {x + 0.03, y, z}, {x, y + 0.03, z}});
    mesh.faces.push_back({first, first + 1, first + 2});
  };
  EXPECT_THAT(doubts_of(mesh.points, mesh.faces), IsEmpty());
  add_island(0, 0, -0.599);  // a crumb on the surface
  EXPECT_THAT(doubts_of(mesh.points, mesh.faces), IsEmpty());
  for (const double x : {-0.15, 0.0, 0.12}) add_island(x, x, -0.5);
  EXPECT_THAT(doubts_of(mesh.points, mesh.faces),
              ElementsAre(AllOf(HasSubstr("4 separate pieces"), HasSubstr("98 %"), HasSubstr("keep"))));
  // Two triangles of a floor, and a small mesh in the middle of one: no corner is near, and they touch.
  RawScan statue = square_mesh();
  const auto first = static_cast<std::uint32_t>(statue.points.size());
  statue.points.insert(statue.points.end(), {{-3, -3, -0.601}, {3, -3, -0.601}, {3, 3, -0.601}, {-3, 3, -0.601}});
  statue.faces.insert(statue.faces.end(), {{first, first + 1, first + 2}, {first, first + 2, first + 3}});
  EXPECT_THAT(doubts_of(statue.points, statue.faces), IsEmpty());
}

TEST(Pieces, AreNotLookedForAmongTrianglesThatLieOneOnAnotherAcrossAll) {
  RawScan scan;
  scan.points = {{0, 0, 0}, {1, 0.1, 1}, {0.1, 1, 1}, {9, 9, 9}, {9.1, 9, 9}, {9, 9.1, 9}};
  scan.faces = {{0, 1, 2}, {3, 4, 5}};
  EXPECT_TRUE(pieces_of_mesh(scan)) << "two";
  scan.points = {{0, 0, 0}, {1, 0, 1}, {0, 1, 1}};
  scan.faces.assign(2000, {0, 1, 2});  // each passes all of 64 x 64 x 64 cells
  EXPECT_FALSE(pieces_of_mesh(scan));
}

TEST(Pieces, OfPointsAreGroupsFarApartAndNotStrays) {
  Points two = random_relief(3000, 11);
  const Points other = moved(random_relief(1000, 12), {0, 0, 0.6});
  EXPECT_THAT(doubts_of(two), IsEmpty());
  two.insert(two.end(), other.begin(), other.end());
  EXPECT_THAT(doubts_of(two), ElementsAre(AllOf(HasSubstr("2 separate pieces"), HasSubstr("75 %"))));
  Points strays = random_relief(3000, 13);
  for (int k = 0; k < 20; ++k) strays.emplace_back(0.1 * k, 0.3, 0.5 + 0.02 * k);
  EXPECT_THAT(doubts_of(strays), IsEmpty());
  // Density that falls by a hundred times is no gap.
  Points uneven;
  for (const Eigen::Vector3d& p : random_relief(4000, 14)) uneven.emplace_back(std::pow(p.x(), 4), p.y(), p.z());
  EXPECT_THAT(doubts_of(uneven), IsEmpty());
}

ScanSize size_of(const std::string& name, const Points& points, bool unit = false) {
  return {name, points, points.size(), unit};
}

Points scaled(Points points, double factor) {
  for (Eigen::Vector3d& p : points) p *= factor;
  return points;
}

TEST(DifferingUnits, AreToldBySizeAndDistanceOfThePoints) {
  const Points left = random_relief(800, 15);
  const Points right = moved(random_relief(800, 16), {1, 0, 0});
  const auto found = differing_units({size_of("right", right), size_of("left", scaled(left, 1000))});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].large, 1U);
  EXPECT_EQ(found[0].of_large, scene::LengthUnit::mm);
  EXPECT_EQ(found[0].of_small, scene::LengthUnit::m);
  EXPECT_THAT(found[0].reason, HasSubstr("left is about 1000 times as large as right"));
  // A coarse mesh beside a dense scan.
  EXPECT_EQ(differing_units({size_of("mesh", scaled(random_relief(50, 24), 1000)), size_of("right", right)}).size(),
            1U);
  const auto centimetres = differing_units({size_of("left", scaled(left, 100)), size_of("right", right)});
  ASSERT_EQ(centimetres.size(), 1U);
  EXPECT_EQ(centimetres[0].of_large, scene::LengthUnit::cm);
  EXPECT_EQ(differing_units({size_of("e57", right, true), size_of("left", scaled(left, 1000))}).size(), 1U);
}

TEST(Pieces, OfAStationAreNotSaidWhenAnotherSawWhatLiesBetween) {
  const ScanFolder folder;
  Points ends = random_relief(3000, 24);
  const Points other_end = moved(random_relief(1000, 25), {0, 0, 0.6});
  ends.insert(ends.end(), other_end.begin(), other_end.end());
  Points between;
  for (int step = 0; step <= 60; ++step) {
    const Points slice = moved(random_relief(50, 26 + static_cast<unsigned>(step)), {0, 0, 0.01 * step});
    between.insert(between.end(), slice.begin(), slice.end());
  }
  const auto config = [&](const char* name, const Points& points) {
    return config_of(folder.write(name, text_of(points)), scene::LengthUnit::m);
  };
  const scene::ScanConfig first = config("ends.xyz", ends);
  Progress progress;
  const auto pieces = [&](const std::vector<scene::ScanConfig>& scans) {
    return ScanSet(scans, ScanSet::Keep::quickest, false, progress).pieces();
  };
  EXPECT_THAT(pieces({first}), ElementsAre(HasSubstr("2 separate pieces")));
  EXPECT_THAT(pieces({first, config("between.xyz", between)}), IsEmpty());
  EXPECT_THAT(pieces({first, config("again.xyz", ends)}),
              ElementsAre(HasSubstr("ends.xyz: 2 separate"), HasSubstr("again.xyz: 2 separate")));
}

TEST(DifferingUnits, AreNotToldOfScansThatAgreeOrOfADetail) {
  const Points left = random_relief(800, 17);
  const Points right = moved(random_relief(800, 18), {1, 0, 0});
  EXPECT_THAT(differing_units({size_of("a", left), size_of("b", right)}), IsEmpty());
  const Points detail = moved(scaled(random_relief(800, 19), 0.1), {0.3, 0.3, 0});
  EXPECT_THAT(differing_units({size_of("a", left), size_of("detail", detail)}), IsEmpty());
  EXPECT_THAT(differing_units({size_of("a", left, true), size_of("b", scaled(right, 0.001))}), IsEmpty())
      << "nobody measures in kilometres";
  // As large as a thousand times the other, but as dense.
  EXPECT_THAT(differing_units({size_of("a", scaled(random_relief(80000, 20), 100)),
                               size_of("b", scaled(random_relief(10, 21), 1))}),
              IsEmpty());
  EXPECT_THAT(differing_units({size_of("a", {}), size_of("b", left)}), IsEmpty());
}

TEST(DifferingUnits, AreWarnedOfByABuildThatNamesTheCause) {
  const ScanFolder folder;
  const auto mm = folder.write("mm.xyz", text_of(scaled(random_relief(800, 22), 1000)));
  const auto m = folder.write("m.xyz", text_of(moved(random_relief(800, 23), {1, 0, 0})));
  Progress progress;
  const ScanSet set({config_of(mm), config_of(m)}, ScanSet::Keep::quickest, false, progress);
  EXPECT_THAT(progress.warnings(), Contains(AllOf(HasSubstr("1000 times"), HasSubstr("set the 'units' of each"))));
  Progress told;
  const ScanSet right({config_of(mm, scene::LengthUnit::mm), config_of(m, scene::LengthUnit::m)},
                      ScanSet::Keep::quickest, false, told);
  EXPECT_THAT(told.warnings(), IsEmpty());
}

TEST(Doubts, DegreesBehindAHeightAreDegrees) {
  Points turned = degrees(20.0);
  for (Eigen::Vector3d& p : turned) p = Eigen::Vector3d(1e3 * p.z(), p.y(), p.x());
  EXPECT_THAT(doubts_of(turned), Contains(HasSubstr("y and z look like degrees")));
}

}  // namespace
}  // namespace sparsha::pipeline
