// Which side of the sheets is outside, by the raw points: bodies that are turned inside out are found, and nothing
// else.
#include "pipeline/check/sides_check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "pipeline/charts/charts.h"
#include "tests/support/closed_scan.h"
#include "tests/support/clouds.h"

namespace sparsha::pipeline {
namespace {

using Eigen::Vector3d;
using test::Points;

struct Scanned {
  Cloud cloud;
  scene::Charts charts;
  double spacing_m = 0.0;
};

Scanned charted(const Points& points, double spacing_m) {
  ThreadPool pool(2);
  Progress progress;
  scene::GridConfig grid;
  grid.spacing_m = spacing_m;
  Scanned result{test::make_cloud(points), {}, spacing_m};
  result.charts = make_charts(result.cloud, Eigen::Matrix4d::Identity(), grid, 0.0, {pool, progress}).charts;
  return result;
}

Scanned scanned(
    const test::ClosedObject& object, std::size_t points = 15'000,
    const std::function<bool(const Vector3d&)>& keep = [](const Vector3d&) { return true; }) {
  test::ScanOptions options;
  options.points = points;
  options.seed = 3;
  const test::ObjectScan scan = scan_object(object, options);
  Points kept;
  for (const auto& p : scan.points)
    if (keep({p[0], p[1], p[2]})) kept.push_back(p);
  return charted(kept, scan.spacing_m);
}

SidesCheck sides_of(const Scanned& scan, unsigned threads = 2,
                    const Eigen::Matrix4d& scan_to_grid = Eigen::Matrix4d::Identity()) {
  ThreadPool pool(threads);
  Progress progress;
  return check_sides(scan.cloud, scan_to_grid, scan.charts, ChartNodes(scan.charts), {pool, progress});
}

/// The same nodes, seen from behind: u and v change places.
scene::Sheet turned_over(const scene::Sheet& sheet) {
  scene::Sheet back = sheet;
  back.side = static_cast<scene::Side>(static_cast<int>(sheet.side) ^ 1);
  back.first_u = sheet.first_v;
  back.first_v = sheet.first_u;
  back.nx = sheet.ny;
  back.ny = sheet.nx;
  for (int j = 0; j < sheet.ny; ++j) {
    for (int i = 0; i < sheet.nx; ++i) {
      const std::size_t from = sheet.index(i, j), to = back.index(j, i);
      back.height_m[to] = -sheet.height_m[from];
      back.slope_u[to] = -sheet.slope_v[from];
      back.slope_v[to] = -sheet.slope_u[from];
      back.mask[to] = sheet.mask[from];
    }
  }
  return back;
}

/// Turns over the sheets whose nodes mostly lie where `which` says; gives how many nodes they have.
std::uint64_t turn_over(scene::Charts& charts, const std::function<bool(const Vector3d&, const Vector3d&)>& which) {
  std::uint64_t turned = 0;
  for (scene::Sheet& sheet : charts.sheets) {
    std::uint64_t nodes = 0, there = 0;
    for (int j = 0; j < sheet.ny; ++j) {
      for (int i = 0; i < sheet.nx; ++i) {
        if (!sheet.measured(sheet.index(i, j))) continue;
        ++nodes;
        there += which(charts.origin_m + charts.place_m(sheet, i, j), scene::Charts::normal(sheet, i, j)) ? 1 : 0;
      }
    }
    if (2 * there <= nodes) continue;
    const Vector3d before = scene::Charts::normal(sheet, 0, 0);
    sheet = turned_over(sheet);
    EXPECT_TRUE(!before.allFinite() || (before + scene::Charts::normal(sheet, 0, 0)).norm() < 1e-6);
    turned += nodes;
  }
  return turned;
}

bool everything(const Vector3d&, const Vector3d&) { return true; }

TEST(SidesCheck, AsksNothingOfObjectsThatFaceOutwards) {
  const Eigen::Matrix3d askew = test::turned(30.0, 20.0);
  const double plate_m = std::sqrt(8.0 / 15'000.0);
  const std::vector<test::NamedObject> objects{{"torus", test::make_torus()},
                                               {"two spheres", test::make_two_spheres()},
                                               {"vase", test::make_vase(test::turned(48.0, 0.0))},
                                               {"knot", test::make_knot()},
                                               {"coin", test::make_coin()},
                                               {"cube", test::make_box({0.6, 0.6, 0.6}, Eigen::Matrix3d::Identity())},
                                               {"plate of 5", test::make_box({1.0, 1.0, 2.5 * plate_m}, askew)},
                                               {"plate of 3", test::make_box({1.0, 1.0, 1.5 * plate_m}, askew)}};
  for (const test::NamedObject& named : objects) {
    Scanned scan = scanned(*named.object);
    const std::uint64_t all = scan.charts.measured_nodes();
    const SidesCheck right = sides_of(scan);
    EXPECT_EQ(right.inwards, 0U) << named.name;
    EXPECT_TRUE(right.places.empty()) << named.name;
    EXPECT_EQ(right.told + right.untold, all) << named.name;
    // From deep in the vase hardly a ray gets out of its mouth.
    const bool deep = named.name == "vase";
    EXPECT_LE(right.untold, deep ? all / 4 : all / 50) << named.name;
    EXPECT_EQ(turn_over(scan.charts, everything), all);
    const SidesCheck wrong = sides_of(scan);
    EXPECT_EQ(wrong.inwards, wrong.told) << named.name;
    EXPECT_LE(wrong.untold, deep ? all / 4 : all / 50) << named.name;
  }
}

TEST(SidesCheck, NamesTheBodyThatIsInsideOutInTheFrameOfTheScans) {
  // The smaller ball, half a metre about (0.35, 0.1, 0.6) or so.
  Scanned scan = scanned(*test::make_two_spheres());
  const std::uint64_t turned = turn_over(scan.charts, [](const Vector3d& p, const Vector3d&) { return p.z() > 0.45; });
  ASSERT_GT(turned, scan.charts.measured_nodes() / 10);
  ASSERT_LT(turned, scan.charts.measured_nodes() / 3);
  for (const unsigned threads : {1U, 3U}) {
    const SidesCheck found = sides_of(scan, threads);
    EXPECT_EQ(found.inwards, turned);
    ASSERT_EQ(found.places.size(), 1U);
    EXPECT_EQ(found.places[0].nodes, turned);
    EXPECT_NEAR((found.places[0].max_m - found.places[0].min_m).maxCoeff(), 1.0, 2.0 * scan.spacing_m);
    EXPECT_GT(found.places[0].min_m.z(), -0.2);
  }
  // The same scan, whose frame is moved and a thousand times as large.
  Eigen::Matrix4d to_grid = Eigen::Matrix4d::Identity();
  to_grid.topLeftCorner<3, 3>() *= 1e-3;
  to_grid.topRightCorner<3, 1>() = Vector3d(5.0, 6.0, 7.0);
  Scanned large = scan;
  for (std::size_t k = 0; k < 4 * large.cloud.size(); ++k)
    if (k % 4 < 3)
      large.cloud.xyz1()[k] = 1e3F * (large.cloud.xyz1()[k] - static_cast<float>(to_grid(static_cast<int>(k % 4), 3)));
  const SidesCheck found = sides_of(large, 2, to_grid);
  EXPECT_EQ(found.inwards, turned);
  ASSERT_EQ(found.places.size(), 1U);
  EXPECT_NEAR((found.places[0].max_m - found.places[0].min_m).maxCoeff(), 1e3, 2e3 * scan.spacing_m);
}

TEST(SidesCheck, FindsSheetsOfOneSideThatAreInsideOut) {
  Scanned cube = scanned(*test::make_box({0.6, 0.6, 0.6}, Eigen::Matrix3d::Identity()));
  const std::uint64_t face = turn_over(cube.charts, [](const Vector3d&, const Vector3d& n) { return n.x() > 0.9; });
  ASSERT_GT(face, cube.charts.measured_nodes() / 10);
  EXPECT_EQ(sides_of(cube).inwards, face);
  // The hollow of a vase about the y axis: its inside looks at the axis.
  Scanned vase = scanned(*test::make_vase(Eigen::Matrix3d::Identity()), 40'000);
  const std::uint64_t inside = turn_over(vase.charts, [](const Vector3d& p, const Vector3d& n) {
    return n.x() * p.x() + n.z() * p.z() < -0.2 * std::hypot(p.x(), p.z());
  });
  ASSERT_GT(inside, vase.charts.measured_nodes() / 5);
  EXPECT_GE(sides_of(vase).inwards, inside * 9 / 10);
  EXPECT_LE(sides_of(vase).inwards, inside);
}

TEST(SidesCheck, SaysNothingOfOpenShells) {
  const auto ball = [](const Vector3d& p) { return (p - Vector3d(0.0, 0.0, -0.6)).norm() < 1.1; };
  for (const double lowest : {-0.8, -0.4, 0.0}) {
    const Scanned open =
        scanned(*test::make_two_spheres(), 15'000, [&](const Vector3d& p) { return ball(p) && p.y() > lowest; });
    const SidesCheck found = sides_of(open);
    EXPECT_EQ(found.inwards, 0U) << "a ball down to " << lowest;
    EXPECT_EQ(found.told > 0, lowest < 0.0) << "of half a ball both sides are seen";
  }
}

/// Points on a box about the origin as a station in it sees them.
Scanned room(bool told) {
  Scanned scan = scanned(*test::make_box({1.0, 0.8, 0.6}, test::turned(10.0, 20.0)));
  turn_over(scan.charts, everything);
  if (!told) return scan;
  Station station;
  station.place_m = Vector3d(0.1, 0.2, -0.1);
  for (std::size_t k = 0; k < scan.cloud.size(); k += 10)
    station.seen_m.push_back(Eigen::Map<const Eigen::Vector3f>(scan.cloud.xyz1() + 4 * k).cast<double>());
  scan.cloud.stations.push_back(station);
  return scan;
}

TEST(SidesCheck, BelievesScannersThatStandInTheRoomThatTheySee) {
  EXPECT_EQ(sides_of(room(true)).inwards, 0U);
  EXPECT_EQ(sides_of(room(true)).untold, 0U);
  EXPECT_EQ(sides_of(room(false)).inwards, room(false).charts.measured_nodes());
  // The normals of a file say the same.
  Scanned normals = room(true);
  Station& station = normals.cloud.stations.front();
  for (const Vector3d& p : station.seen_m) station.normals.push_back((station.place_m - p).cast<float>());
  station.place_m.setConstant(100.0);
  EXPECT_EQ(sides_of(normals).inwards, 0U);
}

TEST(SidesCheck, BelievesScannersWhereNoRayTells) {
  // Half a ball that its scanner saw from below.
  Scanned open = scanned(*test::make_two_spheres(), 15'000,
                         [](const Vector3d& p) { return (p - Vector3d(0.0, 0.0, -0.6)).norm() < 1.1 && p.y() > 0.0; });
  Station below;
  below.place_m = Vector3d(0.0, -3.0, -0.6);
  for (std::size_t k = 0; k < open.cloud.size(); k += 10)
    below.seen_m.push_back(Eigen::Map<const Eigen::Vector3f>(open.cloud.xyz1() + 4 * k).cast<double>());
  open.cloud.stations.push_back(below);
  const SidesCheck found = sides_of(open);
  EXPECT_GT(found.inwards, open.charts.measured_nodes() / 2) << "its sheets look at what nobody saw";
}

TEST(SidesCheck, HollowsThatNobodySeesFaceWhatTheyFace) {
  // A ball with a closed hollow: no ray comes there, and the points tell nothing.
  std::mt19937_64 random(8);
  std::normal_distribution<double> normal;
  Points points, hollow;
  for (int k = 0; k < 16'000; ++k) {
    const Vector3d p = Vector3d(normal(random), normal(random), normal(random)).normalized();
    (k % 5 == 0 ? hollow : points)
        .push_back(
            {(k % 5 == 0 ? 0.5 : 1.0) * p.x(), (k % 5 == 0 ? 0.5 : 1.0) * p.y(), (k % 5 == 0 ? 0.5 : 1.0) * p.z()});
  }
  const double spacing_m = std::sqrt(4.0 * 3.14159 / 12'800.0);
  Scanned both = charted(points, spacing_m);
  scene::Charts inner = charted(hollow, spacing_m).charts;
  const std::uint64_t outer = both.charts.measured_nodes();
  turn_over(inner, everything);
  // The sheets of both on one lattice: nodes of the hollow move by less than a spacing.
  const Vector3d shift = inner.origin_m - both.charts.origin_m;
  for (scene::Sheet& sheet : inner.sheets) {
    const scene::SideAxes axes = scene::SideAxes::of(sheet.side);
    const Vector3d by = axes.to_chart(shift);
    sheet.first_u += static_cast<int>(std::lround(by[0] / spacing_m));
    sheet.first_v += static_cast<int>(std::lround(by[1] / spacing_m));
    for (float& height : sheet.height_m) height += static_cast<float>(by[2]);
    both.charts.sheets.push_back(sheet);
  }
  points.insert(points.end(), hollow.begin(), hollow.end());
  both.cloud = test::make_cloud(points);
  const SidesCheck found = sides_of(both);
  EXPECT_EQ(found.inwards, 0U);
  EXPECT_EQ(found.told, outer);
  EXPECT_GT(found.untold, 1000U);
}

}  // namespace
}  // namespace sparsha::pipeline
