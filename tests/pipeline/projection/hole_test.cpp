// Slabs and steles seen straight on, which windows in x and y measure: a hole in the front shows no back, or the
// projection says that it does not know. And surfaces with one side lose no node.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "base/threads/progress.h"
#include "pipeline/scan/reader.h"
#include "tests/support/clouds.h"

namespace sparsha::test {
namespace {

using Eigen::Vector3d;
using scene::NodeState;

constexpr double kHole = 10.0;   // spacings, radius
constexpr double kMargin = 2.0;  // spacings within its edge

/// A body with a hole in its front at the origin, and which of its points a scanner before it sees, or one behind.
struct Body {
  std::string name;
  Points points;
  std::vector<int> seen_by;  ///< 1 the scanner before it, -1 the one behind, 0 neither
  double spacing_m = 0.0;
  double thickness_m = 0.0;

  void add(const Vector3d& p, int by) {
    points.push_back({p.x(), p.y(), p.z()});
    seen_by.push_back(by);
  }
};

bool in_hole(double x, double y, double radius_m) { return std::hypot(x, y) < radius_m; }

/// Two sheets of 1 m by 1 m, the first with forms of 4 mm; no flanks.
Body slab(std::size_t points, double noise_spacings) {
  constexpr double kThick_m = 0.15;
  Body body{"slab", {}, {}, std::sqrt(2.0 / static_cast<double>(points)), kThick_m};
  std::mt19937_64 random(21);
  std::uniform_real_distribution<double> across(-0.5, 0.5);
  std::normal_distribution<double> noise(0.0, noise_spacings * body.spacing_m);
  for (std::size_t k = 0; k < points; ++k) {
    const double x = across(random), y = across(random);
    const bool front = k % 2 == 0;
    const double z = front ? 0.004 * std::sin(20.0 * x) * std::sin(17.0 * y) : -kThick_m;
    if (front && in_hole(x, y, kHole * body.spacing_m)) continue;
    body.add({x, y, z + noise(random)}, front ? 1 : -1);
  }
  return body;
}

/// A block of 1 m by 0.6 m with flanks.
Body stele(const std::string& name, double thickness_m, std::size_t points, double noise_spacings) {
  const std::array<double, 3> side{1.0, 0.6, thickness_m};
  const std::array<double, 3> area{side[1] * side[2], side[0] * side[2], side[0] * side[1]};
  const double half = area[0] + area[1] + area[2];
  Body body{name, {}, {}, std::sqrt(2.0 * half / static_cast<double>(points)), thickness_m};
  std::mt19937_64 random(22);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::normal_distribution<double> noise(0.0, noise_spacings * body.spacing_m);
  for (std::size_t k = 0; k < points; ++k) {
    const double which = half * unit(random);
    const int normal = which < area[0] ? 0 : which < area[0] + area[1] ? 1 : 2;
    const double towards = unit(random) < 0.5 ? -0.5 : 0.5;
    Vector3d p;
    for (int axis = 0; axis < 3; ++axis) {
      p[axis] = side[static_cast<std::size_t>(axis)] * (axis == normal ? towards : unit(random) - 0.5);
    }
    if (normal == 2 && towards > 0.0 && in_hole(p.x(), p.y(), kHole * body.spacing_m)) continue;
    p[normal] += noise(random);
    p.z() -= 0.5 * thickness_m;
    body.add(p, normal != 2 ? 0 : towards > 0.0 ? 1 : -1);
  }
  return body;
}

std::vector<Body> bodies() {
  return {slab(200'000, 0.1), slab(60'000, 0.3), stele("stele", 0.15, 150'000, 0.1), stele("plate", 0.06, 100'000, 0.1),
          stele("box", 0.5, 100'000, 0.1)};
}

/// Scanners 3 m before a body and behind it, and of each some points that it sees.
std::vector<pipeline::Station> stations_of(const Body& body, bool behind_too) {
  std::vector<pipeline::Station> stations{{"before.ptx", true, {0.3, 0.2, 3.0}, {}, {}},
                                          {"behind.ptx", true, {-0.2, 0.3, -3.0}, {}, {}}};
  const std::size_t every = body.points.size() / 8192 + 1;
  for (std::size_t k = 0; k < body.points.size(); k += every) {
    const auto& p = body.points[k];
    if (body.seen_by[k] != 0) stations[body.seen_by[k] > 0 ? 0 : 1].seen_m.emplace_back(p[0], p[1], p[2]);
  }
  if (!behind_too) stations.pop_back();
  return stations;
}

pipeline::Projection project_body(const Points& points, double spacing_m, std::vector<pipeline::Station> stations,
                                  const Eigen::Matrix4d& view = Eigen::Matrix4d::Identity()) {
  pipeline::Cloud cloud = make_cloud(points);
  cloud.stations = std::move(stations);
  scene::GridConfig grid;
  grid.spacing_m = spacing_m;
  return project_cloud(cloud, grid, view);
}

/// What is measured within the hole, and farther than its edge from it.
struct Seen {
  std::size_t in_hole = 0;  ///< of the lattice
  std::size_t through = 0;  ///< of these, measured nearer to the back than to the front
  std::size_t outside = 0;  ///< measured, outside of the hole
};
Seen look(const scene::DepthGrid& grid, const Body& body) {
  Seen seen;
  for (int j = 0; j < grid.lattice.ny; ++j) {
    for (int i = 0; i < grid.lattice.nx; ++i) {
      const std::size_t node = grid.lattice.index(i, j);
      const double away = std::hypot(grid.lattice.x_m(i), grid.lattice.y_m(j)) / body.spacing_m;
      const bool measured = grid.state[node] == NodeState::measured;
      const double z = grid.lattice.origin_m.z() + static_cast<double>(grid.height_m[node]);
      if (away < kHole - kMargin) {
        ++seen.in_hole;
        seen.through += measured && z < -0.5 * body.thickness_m ? 1 : 0;
      }
      seen.outside += away > kHole + kMargin && measured ? 1 : 0;
    }
  }
  return seen;
}

/// What the report warns of: see surface_warnings.
bool says_that_it_is_not_sure(const pipeline::Projection& p) {
  const auto measured = std::count(p.grid.state.begin(), p.grid.state.end(), NodeState::measured);
  const bool unsure = (p.closed ? 5 : 1000) * p.nodes_unsure > static_cast<std::uint64_t>(measured);
  return p.facing_asked && (!p.facing_known || unsure);
}

TEST(Holes, OfSlabsAndStelesShowNoBackWhereTheStationsAreKnown) {
  for (const Body& body : bodies()) {
    for (const double grid : {0.7, 1.0, 2.0}) {
      const pipeline::Projection p = project_body(body.points, grid * body.spacing_m, stations_of(body, true));
      const Seen seen = look(p.grid, body);
      const std::string what = body.name + ", grid " + std::to_string(grid);
      EXPECT_TRUE(p.lying_stations.empty()) << what;
      EXPECT_GT(seen.in_hole, 40U) << what;
      EXPECT_EQ(seen.through, 0U) << what;
      EXPECT_FALSE(says_that_it_is_not_sure(p)) << what;
      EXPECT_GE(p.nodes_turned_away, seen.in_hole / 2) << what << ": a hole is told";
    }
  }
}

TEST(Holes, OfSlabsAndStelesShowNoBackOrItIsSaidThatNothingTells) {
  for (const Body& body : bodies()) {
    for (const double grid : {0.7, 1.0, 2.0}) {
      const pipeline::Projection p = project_body(body.points, grid * body.spacing_m, {});
      const Seen seen = look(p.grid, body);
      const std::string what = body.name + ", grid " + std::to_string(grid);
      EXPECT_TRUE(seen.through == 0 || says_that_it_is_not_sure(p)) << what << ", " << seen.through << " nodes";
      // Flanks connect front and back, which tells the sides.
      if (body.name != "slab") {
        EXPECT_EQ(seen.through, 0U) << what;
      }
    }
  }
}

TEST(Holes, CostNoNodeOutsideThem) {
  for (const Body& body : bodies()) {
    const pipeline::Projection told = project_body(body.points, body.spacing_m, stations_of(body, true));
    const pipeline::Projection blind = project_body(body.points, body.spacing_m, {});
    const auto outside = static_cast<double>(look(blind.grid, body).outside);
    EXPECT_GE(static_cast<double>(look(told.grid, body).outside), 0.999 * outside) << body.name;
  }
}

/// A relief with steps, of one side only.
Points one_sided(std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  Points points;
  sample_surface(points, relief_m, count, {0.0002, 0.002}, random);
  return points;
}

pipeline::Station station_at(const Vector3d& place, const Points& points) {
  pipeline::Station station{"relief.ptx", true, place, {}, {}};
  for (std::size_t k = 0; k < points.size(); k += points.size() / 4096 + 1) {
    station.seen_m.emplace_back(points[k][0], points[k][1], points[k][2]);
  }
  return station;
}

TEST(Holes, AReliefOfOneSideLosesNoNodeWhereverItsStationIsSaidToBe) {
  const Points points = one_sided(80'000, 31);
  const double spacing_m = 1.0 / std::sqrt(80'000.0);
  const pipeline::Projection plain = project_body(points, spacing_m, {});
  EXPECT_FALSE(plain.facing_asked) << "there is nothing behind it";
  for (const Vector3d& place :
       {Vector3d(0.5, 0.5, 2.0), Vector3d(3.0, 0.5, 0.7), Vector3d(0.5, -4.0, 0.02), Vector3d(0.5, 0.5, -2.0)}) {
    const pipeline::Projection told = project_body(points, spacing_m, {station_at(place, points)});
    EXPECT_TRUE(told.grid.state == plain.grid.state) << place.transpose();
    EXPECT_EQ(told.nodes_turned_away, 0U) << place.transpose();
  }
}

/// Uneven ground under a third of which trees stand: crowns that hide most of it from above.
Points ground_and_trees() {
  std::mt19937_64 random(41);
  std::uniform_real_distribution<double> across(0.0, 60.0);
  std::normal_distribution<double> normal(0.0, 1.0);
  const auto ground = [](double x, double y) { return std::sin(0.15 * x) + 0.7 * std::cos(0.2 * y); };
  std::vector<Vector3d> trees;
  for (int k = 0; k < 30; ++k) {
    const double x = across(random), y = across(random);
    trees.emplace_back(x, y, ground(x, y) + 8.0);
  }
  Points points;
  for (int k = 0; k < 90'000; ++k) {
    const double x = across(random), y = across(random);
    const bool crown = k % 2 == 0;
    const auto tree = std::find_if(trees.begin(), trees.end(),
                                   [&](const Vector3d& t) { return std::hypot(x - t.x(), y - t.y()) < 3.5; });
    if (crown && tree != trees.end()) {
      const double r = std::hypot(x - tree->x(), y - tree->y());
      points.push_back({x, y, tree->z() - 0.08 * r * r + 0.15 * normal(random)});
    } else {
      points.push_back({x, y, ground(x, y) + 0.03 * normal(random)});
    }
  }
  return points;
}

TEST(Holes, GroundBetweenTreesIsNoBackOfTheirCrowns) {
  const Points points = ground_and_trees();
  for (const double grid_m : {0.2, 0.5, 1.0}) {
    const pipeline::Projection p = project_body(points, grid_m, {});
    EXPECT_EQ(p.nodes_turned_away, 0U) << grid_m;
  }
}

TEST(RealScanHoles, RoomsAndTerrainsLoseHardlyANode) {
  const char* folder = std::getenv("SPARSHA_SCANS_DIR");
  if (folder == nullptr) GTEST_SKIP() << "SPARSHA_SCANS_DIR names no folder of scans";
  for (const char* name : {"scans/room_scan1.pcd", "scans/samp11-utm.pcd", "scans/1.2-with-color.las",
                           "scans/table_scene_mug_stereo_textured.pcd", "hostile/autzen-utm.pcd"}) {
    scene::ScanConfig scan;
    scan.file = std::filesystem::path(folder) / name;
    scan.units.unit = scene::LengthUnit::m;
    if (!std::filesystem::exists(scan.file)) continue;
    Progress progress;
    const pipeline::Cloud cloud = pipeline::load_scan(scan, progress);
    scene::GridConfig grid;
    grid.size = 400;
    const pipeline::Projection p = project_cloud(cloud, grid);
    if (p.closed) continue;
    // Things in a room are closed, and some have holes; a warning is given from one node in a thousand on.
    EXPECT_LE(p.nodes_turned_away, p.used / 10000) << name;
  }
}

}  // namespace
}  // namespace sparsha::test
