// Pieces of a scan are counted, and scans whose units differ are told, where that is right and nowhere else.
#include "pipeline/scan/pieces.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <Eigen/Geometry>

#include "base/threads/progress.h"
#include "pipeline/scan/set.h"
#include "pipeline/scan/units.h"
#include "tests/support/doubted_scans.h"
#include "tests/support/scan_files.h"

namespace sparsha::pipeline {
namespace {

using ::testing::AllOf;
using testing::config_of;
using ::testing::Contains;
using testing::doubts_of;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::moved;
using testing::Points;
using testing::random_relief;
using testing::ScanFolder;
using testing::square_mesh;
using testing::text_of;

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

}  // namespace
}  // namespace sparsha::pipeline
