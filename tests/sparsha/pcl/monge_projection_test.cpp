// The projection with PCL's manners against a ball that is known, and against the pipeline's own.
#include "sparsha/pcl/monge_projection.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include <gtest/gtest.h>
#include <pcl/point_types.h>

#include "base/error.h"
#include "base/threads/context.h"
#include "pipeline/projection/projection.h"
#include "scene/config/grid.h"
#include "scene/config/haptics.h"
#include "sparsha/pcl/conversions.h"
#include "sparsha/pcl/impl/monge_projection.hpp"

namespace sparsha {
namespace {

using scene::DepthGrid;
using scene::NodeState;

constexpr double kRadius = 0.05;
constexpr double kNoise = 0.0001;

template <typename PointT>
typename ::pcl::PointCloud<PointT>::Ptr ball(std::size_t points, unsigned seed = 1) {
  typename ::pcl::PointCloud<PointT>::Ptr cloud(new ::pcl::PointCloud<PointT>);
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  for (std::size_t i = 0; i < points; ++i) {
    const Eigen::Vector3d direction = Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
    PointT point;
    point.getVector3fMap() = ((kRadius + kNoise * normal(random)) * direction).template cast<float>();
    cloud->push_back(point);
  }
  return cloud;
}

/// RMS of measured nodes within 0.8 radii about the ball, and how many there are.
std::pair<double, int> error_of(const DepthGrid& grid, const Eigen::Vector3d& centre = Eigen::Vector3d::Zero()) {
  double squares = 0.0;
  int nodes = 0;
  for (int j = 0; j < grid.lattice.ny; ++j) {
    for (int i = 0; i < grid.lattice.nx; ++i) {
      const std::size_t k = grid.lattice.index(i, j);
      const double r = std::hypot(grid.lattice.x_m(i) - centre.x(), grid.lattice.y_m(j) - centre.y());
      if (grid.state[k] != NodeState::measured || r > 0.8 * kRadius) continue;
      const double z = grid.lattice.origin_m.z() + static_cast<double>(grid.height_m[k]) - centre.z();
      squares += std::pow(z - std::sqrt(kRadius * kRadius - r * r), 2);
      ++nodes;
    }
  }
  return {std::sqrt(squares / std::max(nodes, 1)), nodes};
}

bool same_grid(const DepthGrid& a, const DepthGrid& b) {
  return a.lattice.nx == b.lattice.nx && a.lattice.ny == b.lattice.ny && a.lattice.origin_m == b.lattice.origin_m &&
         a.state == b.state &&
         std::memcmp(a.height_m.data(), b.height_m.data(), a.height_m.size() * sizeof(float)) == 0;
}

TEST(MongeProjection, ABallSeenFromAnySideIsABall) {
  const auto cloud = ball<::pcl::PointXYZ>(100000);
  for (const double angle : {0.0, 1.0, 2.5}) {
    MongeProjection<::pcl::PointXYZ> projection;
    projection.setInputCloud(cloud);
    projection.setSpacing(0.001);
    projection.setOrientation(Eigen::Affine3d(Eigen::AngleAxisd(angle, Eigen::Vector3d(1, 2, 3).normalized())));
    DepthGrid grid;
    projection.compute(grid);
    const auto [rms_m, nodes] = error_of(grid);
    EXPECT_GT(nodes, 4500) << angle;  // pi 40^2 = 5027 within the circle
    EXPECT_LT(rms_m, 0.8 * kNoise) << angle;
    EXPECT_NEAR(projection.getEstimatedNoise(), kNoise, 0.25 * kNoise) << angle;
    const auto count = [&](ProjectedPoint point) {
      return std::count(projection.getPoints().begin(), projection.getPoints().end(), point);
    };
    EXPECT_NEAR(static_cast<double>(count(ProjectedPoint::occluded)), 53500.0, 3500.0)
        << "the half behind, and up to half of the 11 000 front points that lie within a spacing of the rim";
    EXPECT_GT(count(ProjectedPoint::used), 40000);
    EXPECT_EQ(count(ProjectedPoint::invalid), 0);
  }
}

TEST(MongeProjection, HeightsAreThePipelinesOwnWhateverTheThreads) {
  const auto cloud = ball<::pcl::PointXYZRGB>(20000);
  scene::GridConfig config;
  config.size = 64;
  ThreadPool pool(1);
  Progress progress;
  const pipeline::Projection expected = pipeline::project(to_cloud(*cloud), Eigen::Matrix4d::Identity(), config,
                                                          scene::HapticsConfig().resolution_m, {pool, progress});
  for (const unsigned threads : {1U, 2U, 3U}) {
    MongeProjection<::pcl::PointXYZRGB> projection;
    projection.setInputCloud(cloud);
    projection.setSize(64);
    projection.setNumberOfThreads(threads);
    DepthGrid grid;
    projection.compute(grid);
    EXPECT_TRUE(same_grid(grid, expected.grid)) << threads;
    EXPECT_EQ(projection.getEstimatedNoise(), expected.noise_m);
  }
}

TEST(MongeProjection, IndicesAreAsGoodAsACopyOfTheirPoints) {
  const auto cloud = ball<::pcl::PointXYZ>(30000);
  ::pcl::IndicesPtr odd(new ::pcl::Indices);
  ::pcl::PointCloud<::pcl::PointXYZ>::Ptr copy(new ::pcl::PointCloud<::pcl::PointXYZ>);
  for (std::size_t i = 1; i < cloud->size(); i += 2) {
    odd->push_back(static_cast<::pcl::index_t>(i));
    copy->push_back((*cloud)[i]);
  }
  MongeProjection<::pcl::PointXYZ> chosen;
  chosen.setInputCloud(cloud);
  chosen.setIndices(odd);
  chosen.setSize(50);
  MongeProjection<::pcl::PointXYZ> copied;
  copied.setInputCloud(copy);
  copied.setSize(50);
  DepthGrid a;
  DepthGrid b;
  chosen.compute(a);
  copied.compute(b);
  EXPECT_TRUE(same_grid(a, b));
  ASSERT_EQ(chosen.getPoints().size(), cloud->size());
  for (std::size_t i = 0; i < cloud->size(); ++i) {
    EXPECT_EQ(chosen.getPoints()[i], i % 2 == 0 ? ProjectedPoint::invalid : copied.getPoints()[i / 2]);
  }
}

TEST(MongeProjection, PointsThatAreNotFiniteAreLeftOutAndNamed) {
  const auto cloud = ball<::pcl::PointXYZ>(20000);
  MongeProjection<::pcl::PointXYZ> projection;
  projection.setInputCloud(cloud);
  projection.setSize(50);
  DepthGrid without;
  projection.compute(without);
  const ::pcl::PointCloud<::pcl::PointXYZ>::Ptr holes(new ::pcl::PointCloud<::pcl::PointXYZ>(*cloud));
  ::pcl::PointXYZ nothing;
  nothing.x = std::numeric_limits<float>::infinity();
  holes->insert(holes->begin() + 77, nothing);
  holes->is_dense = false;
  projection.setInputCloud(holes);
  DepthGrid with;
  projection.compute(with);
  EXPECT_TRUE(same_grid(with, without));
  EXPECT_EQ(projection.getPoints().at(77), ProjectedPoint::invalid);
}

TEST(MongeProjection, AFarOriginCostsNothing) {
  const auto cloud = ball<::pcl::PointXYZ>(100000);
  const Eigen::Vector3d origin_m(512345.678, 4987654.321, 345.6);
  MongeProjection<::pcl::PointXYZ> projection;
  projection.setInputCloud(cloud);
  projection.setOrigin(origin_m);
  projection.setSpacing(0.001);
  DepthGrid grid;
  projection.compute(grid);
  const auto [rms_m, nodes] = error_of(grid, origin_m);
  EXPECT_GT(nodes, 4500);
  EXPECT_LT(rms_m, 0.8 * kNoise);
}

TEST(MongeProjection, BoundsAndNoiseAreKept) {
  MongeProjection<::pcl::PointXYZ> projection;
  projection.setInputCloud(ball<::pcl::PointXYZ>(50000));
  projection.setSpacing(0.001);
  projection.setBounds({-0.01, -0.02, 0.01, 0.02});
  projection.setNoise(0.0003);
  DepthGrid grid;
  projection.compute(grid);
  EXPECT_EQ(grid.lattice.nx, 21);
  EXPECT_EQ(grid.lattice.ny, 41);
  EXPECT_EQ(projection.getEstimatedNoise(), 0.0003);
}

TEST(MongeProjection, APointTypeOfOnesOwnProjectsThroughTheImplementationHeader) {
  MongeProjection<::pcl::PointXYZINormal> projection;
  projection.setInputCloud(ball<::pcl::PointXYZINormal>(20000));
  projection.setSize(50);
  DepthGrid grid;
  projection.compute(grid);
  EXPECT_LT(error_of(grid).first, kNoise);
}

TEST(MongeProjection, ImpossibleSettingsAndEmptyCloudsAreErrorsAndTheGridStays) {
  const auto cloud = ball<::pcl::PointXYZ>(1000);
  DepthGrid grid;
  grid.lattice.nx = 7;
  const auto refuses = [&](auto&& set) {
    MongeProjection<::pcl::PointXYZ> projection;
    projection.setInputCloud(cloud);
    set(projection);
    EXPECT_THROW(projection.compute(grid), Error);
    EXPECT_EQ(grid.lattice.nx, 7);
  };
  refuses([](auto& p) { p.setSpacing(-1.0); });
  refuses([](auto& p) { p.setSpacing(std::nan("")); });
  refuses([](auto& p) { p.setSize(1); });
  refuses([](auto& p) {
    p.setSize(20);
    p.setSpacing(0.001);
  });
  refuses([](auto& p) { p.setNoise(-1.0); });
  refuses([](auto& p) { p.setBounds({0.0, 0.0, 0.0, 1.0}); });
  refuses([](auto& p) { p.setOrientation(Eigen::Affine3d(Eigen::Scaling(1.0, 1.0, 0.0))); });
  refuses([](auto& p) {
    p.setInputCloud(::pcl::PointCloud<::pcl::PointXYZ>::Ptr(new ::pcl::PointCloud<::pcl::PointXYZ>));
  });
  MongeProjection<::pcl::PointXYZ> without;
  EXPECT_THROW(without.compute(grid), Error);
}

}  // namespace
}  // namespace sparsha
