// Lengths, frames and seams of unrolled mantles, held against lengths that are summed along curves in space.
#include "scene/frame/unrolling.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <Eigen/Geometry>

#include "base/error.h"
#include "base/yaml/yaml.h"
#include "scene/config/config.h"
#include "scene/folder/repeated_read.h"
#include "scene/scene.h"

namespace sparsha::scene {
namespace {

using Eigen::Vector3d;
constexpr double kPi = std::numbers::pi;

UnrollConfig mantle(double slope_deg) {
  UnrollConfig config;
  config.shape = slope_deg == 0.0 ? UnrollConfig::Shape::cylinder : UnrollConfig::Shape::cone;
  config.axis = Vector3d(0.3, -0.2, 2.0);
  config.centre_m = Vector3d(400.0, -70.0, 12.0);
  config.radius_m = 0.7;
  if (slope_deg != 0.0) config.slope_rad = slope_deg * kPi / 180.0;
  return config;
}

const std::vector<double> kSlopes = {0.0, 3.0, -3.0, 20.0, -20.0, 55.0, -55.0};

TEST(Unrolling, LengthsOnTheMantleAreTrue) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(-0.2, 0.2);
  for (const double slope : kSlopes) {
    const Unrolling unrolling(mantle(slope), Vector3d(1.0, 0.2, 0.1));
    for (int trial = 0; trial < 50; ++trial) {
      const Vector3d a(unit(random), unit(random), 0.0), b(unit(random), unit(random), 0.0);
      constexpr int kPieces = 4000;
      double length = 0.0;
      Vector3d before = unrolling.scan(a);
      for (int k = 1; k <= kPieces; ++k) {
        const Vector3d next = unrolling.scan(a + (b - a) * k / kPieces);
        length += (next - before).norm();
        before = next;
      }
      EXPECT_NEAR(length, (b - a).norm(), 1e-6 * (b - a).norm()) << slope;
    }
  }
}

TEST(Unrolling, TheMantleIsFlatAndDistancesFromItAreTrue) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (const double slope : kSlopes) {
    const UnrollConfig config = mantle(slope);
    const Unrolling unrolling(config, Vector3d(2, 1, 1));
    const Vector3d axis = config.axis->normalized();
    const Vector3d side = axis.unitOrthogonal();
    const double grows = std::tan(slope * kPi / 180.0), upright = std::cos(slope * kPi / 180.0);
    for (int trial = 0; trial < 200; ++trial) {
      const double height = 0.2 * unit(random), turn = 3.1 * unit(random), off = 0.05 * unit(random);
      const Vector3d radial = Eigen::AngleAxisd(turn, axis) * side;
      const Vector3d place = *config.centre_m + height * axis + (*config.radius_m + height * grows) * radial;
      EXPECT_NEAR(unrolling.flat(place).z(), 0.0, 1e-12) << slope;
      const Vector3d normal = upright * radial - upright * grows * axis;
      const Vector3d flat = unrolling.flat(place + off * normal);
      EXPECT_NEAR(flat.z(), off, 1e-12) << slope;
      EXPECT_LT((unrolling.scan(flat) - place - off * normal).norm(), 1e-12) << slope;
      EXPECT_LT((unrolling.scan_from_flat(flat).col(2) - normal).norm(), 1e-12) << slope;
    }
  }
}

TEST(Unrolling, DirectionsAreThoseOfSmallSteps) {
  for (const double slope : kSlopes) {
    const Unrolling unrolling(mantle(slope), Vector3d(-1.0, 0.5, 0.0));
    for (const Vector3d& at : {Vector3d(0, 0, 0), Vector3d(0.4, 0.1, 0), Vector3d(-0.6, -0.1, 0)}) {
      const Eigen::Matrix3d turn = unrolling.scan_from_flat(at);
      EXPECT_NEAR(turn.determinant(), 1.0, 1e-12);
      for (int k = 0; k < 3; ++k) {
        const Vector3d step = 1e-5 * Vector3d::Unit(k);
        const Vector3d moved = (unrolling.scan(at + step) - unrolling.scan(at - step)) / 2e-5;
        EXPECT_LT((turn.col(k) - moved).norm(), 1e-7) << slope << " " << k;
      }
    }
    const Eigen::Matrix4d touching = unrolling.scan_to_grid();
    EXPECT_LT(
        (touching * unrolling.scan({1e-6, 2e-6, 3e-6}).homogeneous() - Eigen::Vector4d(1e-6, 2e-6, 3e-6, 1)).norm(),
        1e-10);
    EXPECT_GT(unrolling.scan_from_flat(Vector3d::Zero()).col(1).dot(*mantle(slope).axis), 0.0);
  }
}

TEST(Unrolling, AWholeTurnFartherIsTheSamePlace) {
  for (const double slope : {0.0, 5.0, -5.0}) {
    const Unrolling unrolling(mantle(slope), Vector3d(1.0, 0.0, 0.0));
    const Vector3d flat(0.3, -0.05, 0.02);
    for (const int turns : {-1, 1}) {
      const Vector3d there = unrolling.turned(flat, turns);
      EXPECT_LT((unrolling.scan(there) - unrolling.scan(flat)).norm(), 1e-12) << slope;
      EXPECT_NEAR(unrolling.angle(there), unrolling.angle(flat) + turns * 2 * kPi, 1e-9) << slope;
    }
  }
}

TEST(Unrolling, AViewAlongTheAxisIsRefused) { EXPECT_THROW(Unrolling(mantle(0.0), *mantle(0.0).axis), Error); }

TEST(UnrollBlock, IsReadAndWritten) {
  const auto read = [](const std::string& block) {
    return parse_config(yaml::parse_text("scans: [{file: a.xyz}]\nunroll: " + block + "\n", "a.yaml"), {});
  };
  EXPECT_FALSE(read("{axis: auto}").unroll->axis);
  EXPECT_EQ(read("{}").unroll->shape, UnrollConfig::Shape::automatic);
  const Config config = read("{axis: [0, 0, 2], centre_m: [1, 2, 3], shape: cone, radius_m: 0.5, slope_deg: -12.5}");
  const Config again = parse_config(yaml::parse_text(to_yaml(config), "b.yaml"), {});
  EXPECT_EQ(*again.unroll->axis, Vector3d(0, 0, 2));
  EXPECT_EQ(*again.unroll->centre_m, Vector3d(1, 2, 3));
  EXPECT_EQ(*again.unroll->radius_m, 0.5);
  EXPECT_NEAR(*again.unroll->slope_rad, -12.5 * kPi / 180.0, 1e-15);
  for (const char* wrong :
       {"{axis: [0, 0, 0]}", "{axis: up}", "{centre_m: [0, 0, 0]}", "{slope_deg: 5}", "{shape: cone, slope_deg: 0.1}",
        "{shape: cone, slope_deg: 70}", "{radius_m: 0}", "{shape: sphere}", "{}\naround: {}",
        "{}\ngrid: {bounds_m: [0, 0, 1, 1]}", "{}\norientation: {face: auto}", "{}\norientation: {scale: 2}"}) {
    EXPECT_THROW((void)read(wrong), Error) << wrong;
  }
}

TEST(RepeatedRead, GoesOverTheSeamAsOftenAsItTakes) {
  SceneDescription description;
  UnrollConfig unroll = mantle(0.0);
  constexpr int kAround = 16, kOver = 2;
  const double spacing_m = 2 * kPi * *unroll.radius_m / kAround;
  description.config.unroll.emplace(mantle(0.0));
  description.config.orientation.scan_to_grid = Unrolling(unroll, Vector3d(1, 0, 0)).scan_to_grid();
  Lattice lattice;
  lattice.nx = kAround + 2 * kOver;
  lattice.ny = 3;
  lattice.spacing_m = spacing_m;
  description.levels = {lattice};
  Layers level;
  level.grid.lattice = lattice;
  for (int j = 0; j < lattice.ny; ++j) {
    for (int i = 0; i < lattice.nx; ++i) {
      level.grid.height_m.push_back(static_cast<float>(100 * j + (i - kOver + kAround) % kAround));
      level.grid.state.push_back(NodeState::measured);
    }
  }
  const ScenePointer scene = make_scene(description, {level});
  EXPECT_EQ(nodes_around(scene->description(), 0), kAround);
  const Layers read = read_repeated(*scene, 0, -45, 1, 120, 2);
  for (int j = 0; j < 2; ++j) {
    for (int i = 0; i < 120; ++i) {
      const int column = ((i - 45 - kOver) % kAround + kAround) % kAround;
      const std::size_t node = read.grid.lattice.index(i, j);
      ASSERT_EQ(read.grid.height_m[node], static_cast<float>(100 * (j + 1) + column)) << i << " " << j;
      ASSERT_EQ(read.grid.state[node], NodeState::measured);
    }
  }
  EXPECT_NEAR(read.grid.lattice.x_m(45), lattice.x_m(0), 1e-12);
}

}  // namespace
}  // namespace sparsha::scene
