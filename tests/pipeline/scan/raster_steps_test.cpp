// A scanner that turned proves where it stood; points in any other order, and other places, prove nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "base/files/message.h"
#include "pipeline/scan/raster_steps.h"
#include "tests/support/raster_scan.h"

namespace sparsha::pipeline {
namespace {

using Eigen::Vector3d;
using Points = std::vector<Vector3d>;

Points hits(const test::RasterScan& scan) {
  Points points;
  for (const Vector3d& p : scan.seen)
    if (!p.isZero(0.0)) points.push_back(scan.place + p);
  return points;
}

bool proves(const Points& points, const Vector3d& place) {
  RasterSteps steps;
  const std::span all(points);
  for (std::size_t k = 0; k < points.size(); k += 4096)
    steps.add(all.subspan(k, std::min<std::size_t>(4096, points.size() - k)), place);
  return steps.are_even();
}

const test::RasterScan& cave() {
  static const test::RasterScan scan = test::scan_from({1.5, -0.4, 0.2}, test::free_in_cave, 0.012);
  return scan;
}

TEST(RasterSteps, ProveThePlaceOfAScannerThatTurnedAndNoOther) {
  const Points points = hits(cave());
  EXPECT_TRUE(proves(points, cave().place));
  for (const Vector3d& off : {Vector3d(1, 0, 0), Vector3d(0, -1, 0.5), Vector3d(-2, 0.5, 0), Vector3d(40, 30, 5)})
    EXPECT_FALSE(proves(points, cave().place + off)) << off.transpose();
}

TEST(RasterSteps, AreThoseOfRowsAndOfRoundedAndThinnedPointsToo) {
  const test::RasterScan& scan = cave();
  Points rows, rounded, thinned;
  for (int j = 0; j < scan.rows; ++j)
    for (int i = 0; i < scan.columns; ++i)
      rows.push_back(scan.place + scan.seen[static_cast<std::size_t>(i * scan.rows + j)]);
  std::mt19937_64 random(3);
  for (const Vector3d& p : hits(scan)) {
    rounded.push_back(1e-3 * (1e3 * p).array().round().matrix());
    if (random() % 50 != 0) thinned.push_back(p);
  }
  EXPECT_TRUE(proves(rows, scan.place));
  EXPECT_TRUE(proves(rounded, scan.place));
  EXPECT_TRUE(proves(thinned, scan.place));
}

TEST(RasterSteps, ShuffledPointsFewPointsAndGridsProveNothing) {
  Points points = hits(cave());
  EXPECT_FALSE(proves({points.begin(), points.begin() + 300}, cave().place));
  std::mt19937_64 random(5);
  std::shuffle(points.begin(), points.end(), random);
  EXPECT_FALSE(proves(points, cave().place));
  Points grid, ball;
  for (int i = 0; i < 200; ++i)
    for (int j = 0; j < 200; ++j) {
      grid.emplace_back(0.01 * i, 0.01 * j, 0.1 * std::sin(0.1 * i));
      const double turn = 0.03 * i, up = 0.015 * j - 1.5;
      ball.emplace_back(std::cos(turn) * std::cos(up), std::sin(turn) * std::cos(up), std::sin(up));
    }
  EXPECT_FALSE(proves(grid, {1.0, 1.0, 1e4})) << "seen from far away, even steps in metres are even angles";
  EXPECT_FALSE(proves(ball, Vector3d::Zero())) << "even about its middle, whoever wrote it";
}

TEST(RasterSteps, OfSharesAddUpToThoseOfAll) {
  const Points points = hits(cave());
  const std::span all(points);
  RasterSteps half, sum;
  half.add(all.first(600), cave().place);
  sum.add(all.subspan(600, 3000), cave().place);
  EXPECT_FALSE(half.are_even()) << "too few";
  MessageWriter message;
  half.write(message);
  const std::vector<std::byte> bytes = message.take();
  MessageReader reader(bytes);
  sum.add(reader);
  EXPECT_TRUE(sum.are_even());
}

}  // namespace
}  // namespace sparsha::pipeline
