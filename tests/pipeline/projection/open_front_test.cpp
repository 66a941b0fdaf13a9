// Two stations before an object leave an open front, whose hollows look like the inside of a back from the views around
// it. What was measured stays, unless something in front of it was measured too.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>
#include <utility>

#include "tests/pipeline/projection/front_only.h"

namespace sparsha::test {
namespace {

/// Of an object's points those that a far scanner sees, `angle` radians beside the viewer.
std::vector<std::size_t> seen_from(const ObjectScan& scan, double angle) {
  constexpr double kGlancing = 0.2, kCell = 2.0, kSheet = 4.0;  // cosine; spacings
  const Eigen::Vector3d towards(std::sin(angle), 0.0, std::cos(angle));
  const Eigen::Vector3d right(std::cos(angle), 0.0, -std::sin(angle));
  const auto place = [&](std::size_t k) {
    return Eigen::Vector3d(scan.points[k][0], scan.points[k][1], scan.points[k][2]);
  };
  const auto cell = [&](std::size_t k) {
    const double side = kCell * scan.spacing_m;
    return std::pair{std::floor(place(k).dot(right) / side), std::floor(place(k).y() / side)};
  };
  std::map<std::pair<double, double>, double> nearest;
  for (std::size_t k = 0; k < scan.points.size(); ++k) {
    double& depth = nearest.try_emplace(cell(k), place(k).dot(towards)).first->second;
    depth = std::max(depth, place(k).dot(towards));
  }
  std::vector<std::size_t> seen;
  for (std::size_t k = 0; k < scan.points.size(); ++k) {
    if (scan.normals[k].dot(towards) < kGlancing) continue;
    if (nearest[cell(k)] - place(k).dot(towards) < kSheet * scan.spacing_m) seen.push_back(k);
  }
  return seen;
}

/// What two stations see of an object, 60 degrees apart.
ObjectScan seen_by_two(const ObjectScan& all) {
  std::vector<std::size_t> seen = seen_from(all, std::numbers::pi / 6);
  const std::vector<std::size_t> other = seen_from(all, -std::numbers::pi / 6);
  seen.insert(seen.end(), other.begin(), other.end());
  std::sort(seen.begin(), seen.end());
  seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
  ObjectScan front;
  front.spacing_m = all.spacing_m;
  front.noise_m = all.noise_m;
  for (const std::size_t k : seen) {
    front.points.push_back(all.points[k]);
    front.normals.push_back(all.normals[k]);
  }
  return front;
}

TEST(OpenFronts, KeepWhatTwoStationsSaw) {
  for (const std::size_t k : {0U, 2U, 4U}) {
    const NamedObject& named = objects()[k];
    const ObjectScan front = seen_by_two(scan_object(*named.object, cloud_of(60'000)));
    const pipeline::Projection p = project_scan(front);
    ASSERT_TRUE(p.closed) << named.name << ": discs decide";
    EXPECT_TRUE(p.facing_known) << named.name;
    // A warning is given from one node in a thousand on.
    EXPECT_LE(p.nodes_turned_away, p.used / 1000) << named.name;
    const Judgement f = judge_object(p.grid, *named.object, front);
    EXPECT_GE(f.covered, 0.905) << named.name;
    EXPECT_EQ(f.wrong_smooth, 0.0) << named.name;
  }
}

}  // namespace
}  // namespace sparsha::test
