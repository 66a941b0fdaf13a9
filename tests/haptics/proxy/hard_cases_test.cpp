// Every case that has broken a proxy somewhere, by name; judged by the oracle of rest_oracle.h.
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "haptics/proxy/proxy.h"
#include "haptics/window/surface.h"
#include "scene/scene.h"
#include "tests/support/rest_oracle.h"
#include "tests/support/surfaces.h"

namespace sparsha::haptics::test {
namespace {

using Eigen::Vector3d;

constexpr double kEps = std::numeric_limits<double>::epsilon();

/// Follows a hand and judges every rest.
class Follower {
 public:
  Follower(const MongeSurface& surface, const Vector3d& hand) : surface_(&surface) {
    state = start_proxy(surface, hand);
    move(hand);
  }
  ProxyUpdate move(const Vector3d& hand) {
    const Vector3d before = state.position;
    const bool was_feasible = surface_->height(before.x(), before.y()) <= before.z() + 1e-12;
    update = update_exact(*surface_, hand, state, SolverOptions{});
    EXPECT_TRUE(update.position.allFinite());
    EXPECT_FALSE(update.unfinished);
    const double mu =
        coefficient_at(*surface_, update.sticking ? surface_->mu_static : surface_->mu_dynamic, update.position);
    verdict = judge(*surface_, update.position, hand, mu);
    EXPECT_LE(verdict.below_cells, verdict.allowance_cells);
    if (update.contact) {
      EXPECT_LE(verdict.excess_cells, verdict.allowance_cells);
      EXPECT_LE(verdict.pull_cells, verdict.allowance_cells);
    } else {
      EXPECT_EQ(update.position, hand);
    }
    if (was_feasible) {
      const double slack = 16.0 * kEps * (hand.norm() + before.norm());
      EXPECT_LE((hand - update.position).norm(), (hand - before).norm() + slack) << "the distance to the hand rose";
    }
    return update;
  }
  void put_on(const MongeSurface& surface) { surface_ = &surface; }

  ProxyState state;
  ProxyUpdate update;
  Judgement verdict;

 private:
  const MongeSurface* surface_;
};

double slope_length(double gx, double gy) { return std::sqrt(1.0 + gx * gx + gy * gy); }

/// Nodes 40 x 40, spacing 1 cell = `cell_m`, heights in cells.
MongeSurface cells_surface(double cell_m, const std::function<double(double, double)>& height_cells) {
  return make_surface_of(40, 40, cell_m,
                         [&](double x, double y) { return cell_m * height_cells(x / cell_m, y / cell_m); });
}

}  // namespace

TEST(HardCases, StepEdgesHoldTheHandOnItsSideAndLetItFallOffTheUpperEdge) {
  const MongeSurface surface = cells_surface(1e-3, [](double x, double) { return x < 19.5 ? 0.0 : 10.0; });
  Follower follower(surface, {0.015, 0.02, -0.001});
  for (double x = 0.015; x < 0.025; x += 1e-5) follower.move({x, 0.02, -0.001});
  EXPECT_NEAR(follower.update.position.x(), 0.019 + 1e-3 * 0.5 / 10.0, 1e-4) << "held by the wall";
  follower.move({0.03, 0.02, 0.02});
  follower.move({0.03, 0.02, 0.009});
  EXPECT_NEAR(follower.update.position.z(), 0.010, 1e-9);
  for (double x = 0.03; x > 0.01; x -= 1e-5) follower.move({x, 0.02, 0.009});
  EXPECT_FALSE(follower.update.contact) << "over the edge into free space";
}

TEST(HardCases, NearVerticalWallsOfAThousandCells) {
  const MongeSurface surface =
      cells_surface(5e-5, [](double x, double y) { return 1000.0 * (std::fmod(x, 8.0) < 4.0) + 0.3 * y; });
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  Follower follower(surface, {1e-3, 1e-3, 0.0});
  for (int k = 0; k < 20000; ++k)
    follower.move({2e-3 * uniform(random), 2e-3 * uniform(random), 0.06 * uniform(random) - 0.005});
}

TEST(HardCases, SpikesUpAndDown) {
  std::mt19937_64 random(12);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const MongeSurface surface = cells_surface(0.1, [&](double, double) {
    const double kind = uniform(random);
    return kind < 0.05 ? 1000.0 : kind < 0.1 ? -1000.0 : uniform(random);
  });
  Follower follower(surface, {2.0, 2.0, 0.0});
  for (int k = 0; k < 20000; ++k)
    follower.move({4.0 * uniform(random), 4.0 * uniform(random), 40.0 * (uniform(random) - 0.7)});
}

TEST(HardCases, TheWindowBorderContinuesLevelAndNobodyFallsThrough) {
  const MongeSurface surface = cells_surface(0.01, [](double x, double y) { return 0.5 * x + std::sin(y); });
  Follower follower(surface, {0.2, 0.2, 0.0});
  for (double angle = 0.0; angle < 60.0; angle += 0.01)
    follower.move({0.195 + 0.3 * std::cos(angle), 0.195 + 0.3 * std::sin(angle), -0.01});
  for (const auto& [x, y] : {std::pair{-50.0, 0.2}, {50.0, 0.2}, {0.2, -50.0}, {0.2, 50.0}, {-1e6, 1e6}}) {
    follower.move({x, y, -0.02});
    EXPECT_TRUE(follower.update.contact);
  }
  // Exactly on the border and its corners.
  for (const double x : {0.0, 0.39})
    for (const double y : {0.0, 0.39}) {
      follower.move({x, y, -0.5});
      EXPECT_TRUE(follower.update.contact);
    }
}

TEST(HardCases, UnknownAreasAreTouchedWithoutFrictionAndSaidToBeUnknown) {
  scene::SceneDescription scene;
  scene::Lattice lattice;
  lattice.nx = lattice.ny = 30;
  lattice.spacing_m = 1e-3;
  scene.levels = {lattice};
  scene.config.friction = scene::FrictionConfig{};
  scene::Layers layers;
  layers.grid = scene::DepthGrid(lattice);
  for (int j = 0; j < 30; ++j)
    for (int i = 0; i < 30; ++i) {
      if (std::hypot(i - 15, j - 15) < 8) continue;
      layers.grid.height_m[lattice.index(i, j)] = 0.001F * static_cast<float>(i % 3);
      layers.grid.state[lattice.index(i, j)] = scene::NodeState::measured;
    }
  const auto surface = make_surface(scene, layers, 0, 1.0, {});
  Follower follower(*surface, {0.005, 0.015, -0.001});
  EXPECT_EQ(follower.update.cell_flags, 0);
  EXPECT_GT(follower.update.mu_dynamic, 0.0);
  for (double x = 0.005; x < 0.015; x += 1e-5) follower.move({x, 0.015, -0.001});
  EXPECT_TRUE(follower.update.contact);
  EXPECT_EQ(follower.update.cell_flags, kCellUnknown);
  EXPECT_EQ(follower.update.mu_dynamic, 0.0);
  EXPECT_EQ(follower.update.mu_static, 0.0);
}

TEST(HardCases, FlatTextureWithTheLargestFrictionStaysFinite) {
  scene::SceneDescription scene;
  scene::Lattice lattice;
  lattice.nx = lattice.ny = 20;
  lattice.spacing_m = 1e-3;
  scene.levels = {lattice};
  scene.config.friction = scene::FrictionConfig{};
  scene.config.friction->law = scene::FrictionConfig::Law::paper;
  scene::Layers layers;
  layers.grid = scene::DepthGrid(lattice);
  for (float& z : layers.grid.height_m) z = 0.0F;
  for (auto& s : layers.grid.state) s = scene::NodeState::measured;
  layers.mean_curvature_per_m.assign(lattice.count(), 0.0F);
  layers.gaussian_curvature_per_m2.assign(lattice.count(), 0.0F);
  const auto surface = make_surface(scene, layers, 0, 1.0, {});
  Follower follower(*surface, {0.005, 0.005, -0.002});
  follower.move({0.012, 0.009, -0.002});
  EXPECT_NEAR(follower.update.mu_dynamic, 0.9, 1e-7);
  EXPECT_EQ(follower.update.position.z(), 0.0);
}

TEST(HardCases, ExactCreasesAndNodes) {
  // A tent along x = 20 cells and a pit along y = 10 cells meet at a node; every hand is on a line of nodes.
  const MongeSurface surface =
      cells_surface(0.125, [](double x, double y) { return -0.5 * std::abs(x - 20.0) + 0.7 * std::abs(y - 10.0); });
  Follower follower(surface, {20 * 0.125, 10 * 0.125, -0.1});
  for (int i = 0; i < 40; ++i)
    for (int j = 0; j < 40; ++j)
      for (const double depth : {0.01, 0.2, 3.0}) {
        const Vector3d node(i * 0.125, j * 0.125, surface.height(i * 0.125, j * 0.125) - depth);
        follower.move(node);
        follower.move(node + Vector3d(0.0625, 0.0, 0.0));
        follower.move(node + Vector3d(0.0, 0.0625, 0.0));
      }
  // The bottom of the pit holds the hand sideways.
  follower.move({1.0, 10 * 0.125, 2.0});
  follower.move({1.0, 10 * 0.125 + 0.01, surface.height(1.0, 1.25) - 0.2});
  EXPECT_EQ(follower.update.position.y(), 10 * 0.125);
}

TEST(HardCases, AMetreInOneTickOnAMillimetreLattice) {
  const MongeSurface surface = make_sinusoid(1001);
  std::mt19937_64 random(13);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  Follower follower(surface, {0.5, 0.5, -0.002});
  for (int k = 0; k < 3000; ++k) follower.move({k % 2 == 0 ? 0.0 : 1.0, uniform(random), -0.06 * uniform(random)});
}

TEST(HardCases, DeeperThanTheRadiusOfCurvature) {
  // A dome of radius 10 cells and a bowl of radius 6, the hand up to 40 cells deep.
  const MongeSurface surface = cells_surface(1e-3, [](double x, double y) {
    const double dome = 100.0 - (x - 12) * (x - 12) - (y - 20) * (y - 20);
    const double bowl = 36.0 - (x - 30) * (x - 30) - (y - 20) * (y - 20);
    return std::sqrt(std::max(0.0, dome)) - std::sqrt(std::max(0.0, bowl));
  });
  std::mt19937_64 random(14);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  Follower follower(surface, {0.02, 0.02, 0.02});
  for (int k = 0; k < 40000; ++k)
    follower.move({0.039 * uniform(random), 0.039 * uniform(random), 0.012 - 0.05 * uniform(random)});
}

TEST(HardCases, AHandThatIsNotFiniteMovesNothingAndIsNoContact) {
  const MongeSurface surface = make_sinusoid(50);
  Follower follower(surface, {0.3, 0.3, -0.01});
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const ProxyState before = follower.state;
  for (int axis = 0; axis < 3; ++axis)
    for (const double value : {kNan, kInfinity, -kInfinity, 1e300, -1e300}) {
      Vector3d hand(0.3, 0.3, -0.01);
      hand[axis] = value;
      const ProxyUpdate update = update_exact(surface, hand, follower.state, {});
      EXPECT_FALSE(update.contact);
      EXPECT_EQ(update.position, before.position);
      EXPECT_EQ(update.normal, Vector3d::Zero());
      EXPECT_EQ(follower.state.position, before.position);
      EXPECT_EQ(follower.state.contact, before.contact);
    }
  follower.move({0.31, 0.3, -0.01});
  EXPECT_TRUE(follower.update.contact) << "and the hand goes on afterwards";
}

TEST(HardCases, ScalesFromMicrometresToThousandsOfKilometresGiveTheSameContact) {
  Vector3d reference = Vector3d::Zero();
  for (const double scale : {1.0, 1e-6, 1e6}) {
    const MongeSurface surface = make_surface_of(60, 60, scale, [&](double x, double y) {
      return scale * std::sin(x / scale / 5.0) * std::cos(y / scale / 7.0);
    });
    Follower follower(surface, scale * Vector3d(20, 20, -1.5));
    for (double u = 20.0; u < 40.0; u += 0.01) follower.move(scale * Vector3d(u, 20 + 0.3 * u, -1.5));
    if (scale == 1.0) reference = follower.update.position;
    // The nodes' float heights round differently at every scale.
    EXPECT_LE((follower.update.position / scale - reference).norm(), 20.0 * std::numeric_limits<float>::epsilon());
  }
}

TEST(HardCases, SlopesOfTenThousandComeToRestWithinATick) {
  std::mt19937_64 random(21);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (const double mu : {0.0, 0.5}) {
    MongeSurface surface = make_rough_surface(40, 1e-3, 10.0, random);
    if (mu > 0.0) set_random_friction(surface, mu, random);
    Follower follower(surface, {0.02, 0.02, 12.0});
    for (int k = 0; k < 8000; ++k)
      follower.move({0.039 * uniform(random), 0.039 * uniform(random), 12.0 * uniform(random) - 4.0});
  }
}

TEST(HardCases, SlopesOfAMillionMayTakeSeveralTicksButStayFeasibleAndFall) {
  std::mt19937_64 random(15);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const MongeSurface surface = make_rough_surface(30, 1e-6, 1.0, random);
  ProxyState state = start_proxy(surface, {1e-5, 1e-5, 0.5});
  for (int k = 0; k < 500; ++k) {
    const Vector3d hand(3e-5 * uniform(random), 3e-5 * uniform(random), uniform(random) - 0.3);
    double distance = (hand - state.position).norm();
    for (int tick = 0; tick < 3; ++tick) {
      const ProxyUpdate update = update_exact(surface, hand, state, {});
      const Judgement verdict = judge(surface, update.position, hand, 0.0);
      EXPECT_LE(verdict.below_cells, verdict.allowance_cells);
      EXPECT_LE((hand - update.position).norm(), distance + 4.0 * kEps);
      distance = (hand - update.position).norm();
      if (!update.unfinished) break;
      EXPECT_EQ(update.segments, SolverOptions{}.segment_limit);
    }
  }
}

TEST(HardCases, OffsetsOfTenMillionMetres) {
  // The lattice's origin is not the solver's business: local coordinates carry the surface. A hand 1e7 cells outside
  // must come back unharmed too.
  MongeSurface surface = make_sinusoid(100);
  surface.lattice.origin_m = {1e7, -1e7, 1e7};
  Follower follower(surface, {0.5, 0.5, -0.01});
  follower.move({1e7, -1e7, -3.0});
  follower.move({0.5, 0.5, -0.01});
  // Heights that are themselves 1e7 cells up.
  const MongeSurface high = make_surface_of(50, 50, 1.0, [](double x, double y) { return 1e7 + std::round(x) + y; });
  Follower climber(high, {20, 20, 1e7});
  for (double u = 10; u < 40; u += 0.37) climber.move({u, 45 - u, 1e7 + 30});
}

TEST(HardCases, SwapInContactSettlesOnTheNewSurfaceFromAboveAndFromBelow) {
  const MongeSurface low = cells_surface(1e-3, [](double x, double) { return 0.3 * std::sin(x); });
  const MongeSurface high = make_surface_of(77, 91, 5e-4, [](double x, double y) { return 0.004 + 0.1 * x - 0.2 * y; });
  const Vector3d hand(0.0171, 0.0203, -0.002);
  Follower follower(low, hand);
  ASSERT_TRUE(follower.update.contact);
  follower.put_on(high);
  follower.move(hand);
  EXPECT_TRUE(follower.update.contact);
  follower.put_on(low);
  follower.move(hand);
  EXPECT_TRUE(follower.update.contact);
  // By hand, as the servo does it: a position in the air with the contact still set.
  follower.state.position = hand + Vector3d(0, 0, 0.02);
  follower.state.contact = true;
  follower.move(hand);
  EXPECT_TRUE(follower.update.contact);
}

TEST(HardCases, NoRidgeIsTunnelledHoweverThin) {
  // Two valleys under a ridge one node wide and 1000 cells high.
  const MongeSurface surface = cells_surface(
      1e-3, [](double x, double y) { return x == 20.0 ? 1000.0 : 0.01 * (x - 20) * (x - 20) + 0.5 * std::sin(y); });
  std::mt19937_64 random(16);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (const double start : {0.01, 0.03}) {
    Follower follower(surface, {start, 0.02, 0.01});
    for (int k = 0; k < 30000; ++k) {
      follower.move({0.039 * uniform(random), 0.039 * uniform(random), 0.03 * (uniform(random) - 0.6)});
      ASSERT_EQ(follower.update.position.x() < 0.02, start < 0.02) << "move " << k;
    }
  }
}

TEST(HardCases, LiftOffNeverPulls) {
  std::mt19937_64 random(17);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (int run = 0; run < 50; ++run) {
    MongeSurface surface = make_rough_surface(20, 1e-3, 3e-3, random);
    set_random_friction(surface, 0.9, random);
    Follower follower(surface, {0.01, 0.01, -0.002});
    for (int k = 0; k < 400; ++k) {
      const double z = 0.004 * std::sin(0.05 * k);
      const Vector3d hand(0.01 + 0.008 * uniform(random), 0.01 + 0.008 * uniform(random), z);
      const ProxyUpdate update = follower.move(hand);
      // The normal at a node is a mean of several; whether a force pulls is decided in the cell that the hand lies in.
      if (update.contact)
        EXPECT_LE(follower.verdict.pull_cells, follower.verdict.allowance_cells);
      else
        EXPECT_EQ(update.position, hand) << "no contact, no force";
    }
  }
}

TEST(HardCases, HandsWithinRoundingOfTheSurface) {
  const MongeSurface surface = make_sinusoid(64);
  std::mt19937_64 random(18);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  Follower follower(surface, {0.5, 0.5, 0.0});
  for (int k = 0; k < 20000; ++k) {
    const double x = uniform(random);
    const double y = uniform(random);
    follower.move({x, y, surface.height(x, y) + (k % 3 - 1) * kEps * uniform(random)});
  }
}

TEST(HardCases, GrazingAlongAPlaneKeepsToIt) {
  for (const double g : {0.0, 0.3, -2.0}) {
    const MongeSurface surface = cells_surface(1e-3, [&](double x, double y) { return g * x + 0.1 * y; });
    Follower follower(surface, {0.005, 0.005, surface.height(0.005, 0.005) - 1e-6});
    for (double x = 0.005; x < 0.03; x += 1.7e-4)
      follower.move({x, 0.005 + 0.5 * x, surface.height(x, 0.005 + 0.5 * x) - 1e-6 / slope_length(g, 0.1)});
    EXPECT_TRUE(follower.update.contact);
  }
}

}  // namespace sparsha::haptics::test
