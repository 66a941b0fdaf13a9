// What museums bring besides statues: friezes, coins, slabs that lie askew, stones on a lawn, bowls, masks, columns.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <optional>
#include <random>

#include <Eigen/Geometry>

#include "base/threads/progress.h"
#include "pipeline/suggest/suggest.h"
#include "tests/support/test_folder.h"

namespace sparsha::pipeline {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using Points = std::vector<Eigen::Vector3d>;
constexpr double kTurn = 2.0 * std::numbers::pi;

class Everyday : public ::testing::Test {
 protected:
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  double normal(double sigma) { return sigma * std::normal_distribution<double>()(random_); }
  Points relief(std::size_t count, double width, double height, double depth) {
    Points points;
    while (points.size() < count) {
      const double x = uniform(0.0, width), y = uniform(0.0, height), each = 20.0 / std::min(width, height);
      points.emplace_back(x, y, depth * std::sin(each * x) * std::cos(each * y));
    }
    return points;
  }
  /// What is suggested for points in metres.
  const Suggestion& suggested(const Points& points, const std::optional<Eigen::Vector3d>& normal = {}) {
    {
      std::ofstream file(folder_ / "scan.xyz");
      file << "x [m],y [m],z [m]" << (normal ? ",nx,ny,nz\n" : "\n");
      file.precision(9);
      for (const Eigen::Vector3d& p : points) {
        file << p.x() << ',' << p.y() << ',' << p.z();
        if (normal) file << ',' << normal->x() << ',' << normal->y() << ',' << normal->z();
        file << '\n';
      }
    }
    Progress progress;
    suggestion_ = suggest_config({folder_ / "scan.xyz"}, folder_, progress);
    return suggestion_;
  }
  [[nodiscard]] Eigen::Vector3d towards_viewer() const {
    return suggestion_.config.orientation.scan_to_grid.block<1, 3>(2, 0).transpose().normalized();
  }
  [[nodiscard]] Eigen::Vector3d up() const {
    return suggestion_.config.orientation.scan_to_grid.block<1, 3>(1, 0).transpose().normalized();
  }

  std::mt19937_64 random_{11};
  const test::TestFolder folder_;
  Suggestion suggestion_;
};

double apart_deg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::acos(std::clamp(a.normalized().dot(b.normalized()), -1.0, 1.0)) * 360.0 / kTurn;
}

Eigen::Matrix3d turned(double about_x_deg, double about_z_deg) {
  return (Eigen::AngleAxisd(about_z_deg * kTurn / 360.0, Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(about_x_deg * kTurn / 360.0, Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

TEST_F(Everyday, ALongFriezeIsAsFineAsItsPoints) {
  const double spacing_m = suggested(relief(200'000, 30.0, 0.4, 0.02)).config.grid.spacing_m;
  EXPECT_NEAR(spacing_m, std::sqrt(30.0 * 0.4 / 200'000), 0.2 * spacing_m) << suggestion_.yaml;
}

TEST_F(Everyday, ACoinIsAsFineAsAHandThatItFillsFeels) {
  const double spacing_m = suggested(relief(400'000, 0.02, 0.02, 0.0002)).config.grid.spacing_m;
  EXPECT_NEAR(spacing_m, std::sqrt(0.02 * 0.02 / 400'000), 0.2 * spacing_m) << suggestion_.yaml;
}

TEST_F(Everyday, ASlabThatLiesAskewIsSeenSquarelyAndStraight) {
  for (const double tilt_deg : {9.0, 35.0}) {
    const Eigen::Matrix3d askew = turned(tilt_deg, 0.0) * turned(0.0, 21.0);
    Points slab = relief(60'000, 1.2, 0.5, 0.002);
    for (Eigen::Vector3d& p : slab) p = askew * p;
    suggested(slab);
    EXPECT_LT(apart_deg(towards_viewer(), askew.col(2)), 0.5) << suggestion_.yaml;
    const double off_deg = std::min(apart_deg(up(), askew.col(1)), apart_deg(up(), -askew.col(1)));
    EXPECT_LT(std::min(off_deg, std::abs(off_deg - 90.0)), 0.5) << suggestion_.yaml;
  }
}

TEST_F(Everyday, ASlabThatIsNearlyInPlaceStaysThere) {
  Points slab = relief(60'000, 1.2, 0.5, 0.002);
  for (Eigen::Vector3d& p : slab) p = turned(2.0, 0.5) * p;
  suggested(slab);
  EXPECT_EQ(towards_viewer(), Eigen::Vector3d::UnitZ()) << suggestion_.yaml;
  EXPECT_EQ(up(), Eigen::Vector3d::UnitY()) << suggestion_.yaml;
}

TEST_F(Everyday, NormalsTellTheFrontOfAReliefAndWithoutThemTheOtherSideIsOffered) {
  const Points wall = relief(20'000, 1.0, 1.0, 0.01);
  const std::string other = "# orientation: {look_from: [0, 0, -1], up: [0, 1, 0]}  # its other side";
  EXPECT_THAT(suggested(wall).yaml, HasSubstr(other));
  for (const double side : {1.0, -1.0}) {
    suggested(wall, side * Eigen::Vector3d::UnitZ());
    EXPECT_EQ(towards_viewer(), side * Eigen::Vector3d::UnitZ()) << suggestion_.yaml;
    EXPECT_THAT(suggestion_.yaml, HasSubstr("their normals face this way"));
    EXPECT_THAT(suggestion_.yaml, Not(HasSubstr("other side")));
  }
  const Points many = relief(150'000, 1.0, 1.0, 0.01);  // a sample of them is kept
  suggested(many, Eigen::Vector3d(0.1, 0.0, -1.0));
  EXPECT_EQ(towards_viewer(), -Eigen::Vector3d::UnitZ()) << suggestion_.yaml;
}

TEST_F(Everyday, GroundThatSlopesIsSeenFromAboveAndNorthIsUp) {
  Points ground = relief(60'000, 80.0, 40.0, 0.5);
  for (Eigen::Vector3d& p : ground) p = turned(15.0, 0.0) * turned(0.0, 30.0) * p;
  suggested(ground);
  EXPECT_EQ(towards_viewer(), Eigen::Vector3d::UnitZ()) << suggestion_.yaml;
  EXPECT_EQ(up(), Eigen::Vector3d::UnitY()) << suggestion_.yaml;
}

TEST_F(Everyday, AWallStandsHoweverItIsTurnedAboutThePlumbLine) {
  const Points wall = relief(30'000, 5.0, 2.5, 0.02);
  for (const double turn_deg : {12.0, 41.0, 75.0}) {
    const Eigen::Matrix3d about_z = turned(0.0, turn_deg) * turned(91.0, 0.0);  // it leans by a degree
    Points turned_wall = wall;
    for (Eigen::Vector3d& p : turned_wall) p = about_z * p;
    suggested(turned_wall);
    EXPECT_LT(apart_deg(up(), Eigen::Vector3d::UnitZ()), 2.0) << turn_deg << suggestion_.yaml;
    const auto about_y = Eigen::AngleAxisd(turn_deg * kTurn / 360.0, Eigen::Vector3d::UnitY()).toRotationMatrix();
    turned_wall = wall;
    for (Eigen::Vector3d& p : turned_wall) p = about_y * p;
    suggested(turned_wall);
    EXPECT_LT(apart_deg(up(), Eigen::Vector3d::UnitY()), 1.0) << turn_deg << suggestion_.yaml;
  }
}

TEST_F(Everyday, ABoardIsSeenFromTheSideOfWhatStandsOnIt) {
  // A chess board of 40 cm whose lower face no scanner saw, and a cone on each fourth field.
  Points board;
  for (const double side : {0.0, 0.4}) {
    for (int k = 0; k < 4'000; ++k) {
      board.emplace_back(side, uniform(0.0, 0.4), uniform(-0.02, 0.0));
      board.emplace_back(uniform(0.0, 0.4), side, uniform(-0.02, 0.0));
    }
  }
  const auto middle = [](double at) { return 0.05 + 0.1 * std::clamp(std::floor(at / 0.1), 0.0, 3.0); };
  for (int k = 0; k < 80'000; ++k) {
    const double x = uniform(0.0, 0.4), y = uniform(0.0, 0.4);
    if (std::hypot(x - middle(x), y - middle(y)) > 0.015) board.emplace_back(x, y, normal(0.0001));
  }
  for (int piece = 0; piece < 16; ++piece) {
    for (int k = 0; k < 4'000; ++k) {
      const double height = uniform(0.0, 0.055), around = uniform(0.0, kTurn), radius = 0.015 * (1.0 - height / 0.056);
      board.emplace_back(0.05 + 0.1 * (piece % 4) + radius * std::cos(around),
                         0.05 + 0.1 * std::floor(piece / 4) + radius * std::sin(around), height);
    }
  }
  suggested(board);
  EXPECT_EQ(towards_viewer(), Eigen::Vector3d::UnitZ()) << suggestion_.yaml;
}

TEST_F(Everyday, AFlatStoneStandsWithoutItsLawn) {
  const Eigen::Matrix3d leaning = turned(0.0, 33.0) * turned(-6.0, 0.0);
  Points points;
  for (int k = 0; k < 60'000; ++k) {
    const double x = uniform(-0.4, 0.4), z = uniform(0.0, 1.2);
    points.push_back(leaning * Eigen::Vector3d(x, -0.075 + 0.003 * std::sin(40.0 * x) * std::sin(40.0 * z), z));
  }
  for (int k = 0; k < 8'000; ++k)
    points.push_back(leaning * Eigen::Vector3d(k % 2 == 0 ? 0.4 : -0.4, uniform(-0.075, 0.075), uniform(0.0, 1.2)));
  for (int k = 0; k < 60'000; ++k) points.emplace_back(uniform(-2.0, 2.0), uniform(-3.0, 1.0), std::abs(normal(0.02)));
  for (Eigen::Vector3d& p : points) p += Eigen::Vector3d(-4.0, 6.5, -1.5);  // from the scanner
  suggested(points);
  EXPECT_THAT(suggestion_.yaml, HasSubstr("\n  - remove_plane: {normal: [0, 0, 1]"));
  EXPECT_LT(apart_deg(towards_viewer(), -leaning.col(1)), 2.0) << suggestion_.yaml;
  EXPECT_LT(apart_deg(up(), leaning.col(2)), 2.0) << suggestion_.yaml;
}

TEST_F(Everyday, ABowlOpensUpwardsAndABellHangs) {
  const auto shell = [&](double side) {
    Points points;
    while (points.size() < 40'000) {
      const Eigen::Vector3d p(normal(1.0), normal(1.0), normal(1.0));
      const Eigen::Vector3d d = p.normalized();
      if (side * d.z() < 0.1) points.push_back((points.size() % 2 == 0 ? 0.1 : 0.095) * d);
    }
    return points;
  };
  suggested(shell(1.0));
  EXPECT_LT(apart_deg(up(), Eigen::Vector3d::UnitZ()), 1.0) << suggestion_.yaml;
  suggested(shell(-1.0));
  EXPECT_LT(apart_deg(up(), Eigen::Vector3d::UnitZ()), 1.0) << suggestion_.yaml;
}

TEST_F(Everyday, AMaskLooksAtTheViewer) {
  const Eigen::Matrix3d lying = turned(70.0, 20.0);
  Points points;
  while (points.size() < 80'000) {
    const double x = uniform(-0.07, 0.07), y = uniform(-0.1, 0.1);
    const double inside = 1.0 - x * x / 0.0049 - y * y / 0.01;
    if (inside < 0.0) continue;
    const double front = 0.04 * std::sqrt(inside) + 0.012 * std::exp(-x * x / 1e-4 - y * y / 9e-4);
    points.push_back(lying * Eigen::Vector3d(x, y, front - (points.size() % 2 == 0 ? 0.0 : 0.003)));
  }
  suggested(points);
  EXPECT_GT(towards_viewer().dot(lying.col(2)), 0.7) << suggestion_.yaml;
}

TEST_F(Everyday, AVaseStandsOnItsFootWhateverItsAxes) {
  Points vase;
  for (int k = 0; k < 30'000; ++k) {
    const double turn = uniform(0.0, kTurn), z = uniform(0.0, 0.3);
    const double belly = std::exp(-std::pow((z - 0.12) / 0.07, 2)), mouth = std::exp(-std::pow((z - 0.3) / 0.03, 2));
    const double radius = 0.03 + 0.07 * belly + 0.02 * mouth;
    vase.emplace_back(radius * std::cos(turn), radius * std::sin(turn), z);
  }
  for (int k = 0; k < 2'000; ++k) {
    const double turn = uniform(0.0, kTurn), radius = 0.0325 * std::sqrt(uniform(0.0, 1.0));
    vase.emplace_back(radius * std::cos(turn), radius * std::sin(turn), 0.0);
  }
  for (int k = 0; k < 4'000; ++k) {  // two handles
    const double around = uniform(0.0, kTurn), along = uniform(-1.4, 1.4), side = k % 2 == 0 ? 1.0 : -1.0;
    const double reach = 0.05 + 0.006 * std::cos(around);
    vase.emplace_back(side * (0.045 + reach * std::cos(along)), 0.006 * std::sin(around),
                      0.22 + reach * std::sin(along));
  }
  for (const double lying_deg : {0.0, 90.0, 130.0, 180.0}) {
    Points lying = vase;
    for (Eigen::Vector3d& p : lying) p = turned(lying_deg, 25.0) * p;
    suggested(lying);
    EXPECT_LT(apart_deg(up(), turned(lying_deg, 25.0).col(2)), 1.0) << lying_deg << "\n" << suggestion_.yaml;
  }
}

TEST_F(Everyday, AColumnMayBeLaidFlatAndAPillarMayNot) {
  const auto pillar = [&](bool round) {
    Points points;
    for (int k = 0; k < 60'000; ++k) {
      const double turn = uniform(0.0, kTurn), z = uniform(0.0, 3.0);
      const double flutes = 0.5 - 0.02 * z - 0.02 * std::abs(std::sin(10.0 * turn));
      const double square = 0.4 / std::max(std::abs(std::cos(turn)), std::abs(std::sin(turn)));
      const double radius = round ? flutes : square;
      points.emplace_back(radius * std::cos(turn), radius * std::sin(turn), z);
    }
    return points;
  };
  EXPECT_THAT(suggested(pillar(true)).yaml, HasSubstr("\n# unroll: {axis: auto}  # it is round"));
  EXPECT_THAT(suggested(pillar(false)).yaml, Not(HasSubstr("unroll")));
}

}  // namespace
}  // namespace sparsha::pipeline
