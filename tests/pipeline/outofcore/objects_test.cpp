// Whole objects built through files on disk give the bytes of those built in memory.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <Eigen/Core>

#include "base/files/files.h"
#include "base/yaml/yaml.h"
#include "scene/config/config.h"
#include "tests/pipeline/outofcore/two_builds.h"
#include "tests/support/raster_scan.h"

namespace sparsha::pipeline {
namespace {

class ObjectsOutOfCore : public TwoBuilds {};

// A ball before a larger one, as text: what is steep, hidden, turned away or seen through a hole is decided by discs.
// On lines `apart_m` from each other, where that is not 0.
std::string two_balls(double apart_m = 0.0) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  std::string text;
  for (int k = 0; k < 90'000; ++k) {
    Eigen::Vector3d direction(normal(random), normal(random), normal(random));
    direction.normalize();
    if (apart_m > 0.0) direction.x() = std::clamp(apart_m * std::round(direction.x() / apart_m), -1.0, 1.0);
    direction.tail<2>() *= std::sqrt(1.0 - direction.x() * direction.x()) / direction.tail<2>().norm();
    const bool before = k % 5 == 0;
    const double radius = (before ? 0.1 : 0.2) + 0.0002 * normal(random);
    const Eigen::Vector3d p = radius * direction + Eigen::Vector3d(before ? 0.05 : 0.0, 0.02, before ? 0.4 : 0.0);
    if (!before && direction.z() > 0.98) continue;  // a hole
    text += fmt::format("{:.7f} {:.7f} {:.7f}\n", p.x(), p.y(), p.z());
  }
  return text;
}

TEST_F(ObjectsOutOfCore, ClosedObjectsGiveTheSameBytesAsInMemoryOnCoarseGridsAndFine) {
  write_file(folder_ / "balls.xyz", two_balls());
  for (const char* size : {"60", "200", "450"}) {
    const std::string text = fmt::format(
        "scans: [{{file: balls.xyz, units: m}}]\ngrid: {{size: {}}}\nfill: {{max_gap_mm: 8}}\ncheck: {{samples: "
        "4000}}\n",
        size);
    expect_same_out_of_core(scene::parse_config(yaml::parse_text(text, "balls"), folder_.path()), 30'000);
    for (const char* built : {"memory", "disk"})
      EXPECT_EQ(report(folder_ / built)["surface"]["method"], "tangent discs") << built;
  }
}

TEST_F(ObjectsOutOfCore, ClosedObjectsScannedInLinesGiveTheSameBytesAsInMemory) {
  write_file(folder_ / "balls.xyz", two_balls(0.025));
  const std::string text =
      "scans: [{file: balls.xyz, units: m}]\ngrid: {size: 200}\nfill: {max_gap_mm: 8}\ncheck: {samples: 4000}\n";
  expect_same_out_of_core(scene::parse_config(yaml::parse_text(text, "balls"), folder_.path()), 30'000);
}

// On a floor, between walls that the view shows edge-on, with scattered points. The walls' points are twice as far
// apart as the balls', so that discs reach twice as far, and 73 000 of 133 000 points lie about one node.
TEST_F(ObjectsOutOfCore, WhatIsSeenEdgeOnIsTheSameAsInMemory) {
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> place(-0.4, 0.4);
  std::string text = two_balls();
  for (int k = 0; k < 24'000; ++k) text += fmt::format("{:.7f} {:.7f} {:.7f}\n", place(random), -0.2, place(random));
  for (int k = 0; k < 16'000; ++k) {
    const double side = k % 2 == 0 ? -0.4 : 0.4;
    text += fmt::format("{:.7f} {:.7f} {:.7f}\n", side, 0.5 * place(random), place(random));
  }
  for (int k = 0; k < 3'000; ++k) {
    text += fmt::format("{:.7f} {:.7f} {:.7f}\n", place(random), place(random), place(random));
  }
  write_file(folder_ / "room.xyz", text);
  for (const char* size : {"60", "200"}) {
    const std::string yaml =
        fmt::format("scans: [{{file: room.xyz, units: m}}]\ngrid: {{size: {}}}\ncheck: {{samples: 4000}}\n", size);
    expect_same_out_of_core(scene::parse_config(yaml::parse_text(yaml, "room"), folder_.path()), 80'000);
    EXPECT_GT(report(folder_ / "disk")["not_visible"]["edge_on"], 2'000) << size;
  }
}

// The balls as two scanners before and behind them would write them, each what faces it.
std::string two_stations() {
  std::array<std::string, 2> rows;
  std::array<int, 2> counts{};
  std::istringstream text(two_balls());
  for (double x = 0.0, y = 0.0, z = 0.0; text >> x >> y >> z;) {
    const std::size_t station = z > (std::hypot(x - 0.05, y - 0.02) < 0.1 && z > 0.29 ? 0.4 : 0.0) ? 0 : 1;
    rows[station] += fmt::format("{:.7f} {:.7f} {:.7f} 0.5\n", x, y, z - (station == 0 ? 3.0 : -3.0));
    ++counts[station];
  }
  std::string ptx;
  for (const std::size_t station : {0U, 1U}) {
    const char* z = station == 0 ? "3" : "-3";
    ptx +=
        fmt::format("{}\n1\n0 0 {}\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 {} 1\n", counts[station], z, z);
    ptx += rows[station];
  }
  return ptx;
}

TEST_F(ObjectsOutOfCore, ClosedObjectsAreTurnedByTheirStationsAsInMemory) {
  write_file(folder_ / "balls.ptx", two_stations());
  const std::string text =
      "scans: [{file: balls.ptx, units: m}]\ngrid: {size: 200}\nfill: {max_gap_mm: 8}\ncheck: {samples: 4000}\n";
  expect_same_out_of_core(scene::parse_config(yaml::parse_text(text, "balls"), folder_.path()), 30'000);
}

TEST_F(ObjectsOutOfCore, ClosedObjectsWhosePointsAreToldTwiceAreTheSame) {
  const std::string balls = two_balls();
  write_file(folder_ / "balls.xyz", balls + balls);
  const std::string text =
      "scans: [{file: balls.xyz, units: m}]\ngrid: {size: 200}\nfill: {max_gap_mm: 8}\ncheck: {samples: 4000}\n";
  expect_same_out_of_core(scene::parse_config(yaml::parse_text(text, "balls"), folder_.path()), 60'000);
}

// Two sheets of 1 m by 1 m, each seen by its own scanner 2 m away; the first has a hole.
std::string sheets_with_a_hole() {
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> across(-0.5, 0.5);
  std::string ptx;
  for (const double z : {2.0, -2.2}) {
    std::string rows;
    int count = 0;
    for (int k = 0; k < 40'000; ++k) {
      const double x = across(random), y = across(random);
      if (z > 0.0 && std::hypot(x, y) < 0.06) continue;
      rows += fmt::format("{:.6f} {:.6f} {:.6f} 0.5\n", x, y, z > 0.0 ? -z + 0.01 * std::sin(9.0 * x) : 2.0);
      ++count;
    }
    ptx += fmt::format("{}\n1\n0 0 {}\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 {} 1\n", count, z, z) + rows;
  }
  return ptx;
}

TEST_F(ObjectsOutOfCore, HolesOfSlabsStayHolesAsInMemory) {
  write_file(folder_ / "slab.ptx", sheets_with_a_hole());
  for (const char* size : {"100", "250"}) {
    const std::string text = fmt::format(
        "scans: [{{file: slab.ptx, units: m}}]\ngrid: {{size: {}, noise_mm: 0.3}}\ncheck: {{samples: 4000}}\n", size);
    expect_same_out_of_core(scene::parse_config(yaml::parse_text(text, "slab"), folder_.path()), 20'000);
    const std::string warnings = report(folder_ / "disk")["warnings"].dump();
    EXPECT_NE(warnings.find("the inside of the back is seen at"), std::string::npos) << warnings;
  }
}

// Which walls are looked through, connected surfaces decide, and what the scanners' places prove for them.
TEST_F(ObjectsOutOfCore, ACaveScannedFromWithinGivesTheSameBytesAsInMemory) {
  std::vector<test::RasterScan> scans;
  for (const Eigen::Vector3d& place : {Eigen::Vector3d(-2.5, 0.3, 0.0), Eigen::Vector3d(2.6, 0.2, 0.0)})
    scans.push_back(test::scan_from(place, test::free_in_cave, 0.018));
  write_file(folder_ / "cave.ptx", test::ptx_of(scans));
  const std::string text =
      "scans: [{file: cave.ptx, units: m}]\ngrid: {size: 160}\nfill: {max_gap_mm: 100}\ncheck: {samples: 4000}\n";
  expect_same_out_of_core(scene::parse_config(yaml::parse_text(text, "cave"), folder_.path()), 30'000);
  for (const char* built : {"memory", "disk"})
    EXPECT_GT(report(folder_ / built)["points"]["occluded"], 10'000) << built << ": the ceiling is looked through";
}

}  // namespace
}  // namespace sparsha::pipeline
