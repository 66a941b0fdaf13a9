// Points scattered evenly in an object's box belong to no surface: they make none, nor do they make its surface sparse.
#include <gtest/gtest.h>

#include <cstddef>
#include <random>

#include "tests/pipeline/projection/front_only.h"

namespace sparsha::test {
namespace {

TEST(ScatteredPoints, GrowNoSurfaceBesideAnObject) {
  for (const std::size_t k : {0U, 4U}) {
    const NamedObject& named = objects()[k];
    const ObjectScan scan = scan_object(*named.object, cloud_of(60'000));
    ObjectScan both = scan;
    Eigen::Vector3d low = Eigen::Vector3d::Constant(1e9), high = -low;
    for (const auto& p : scan.points) {
      low = low.cwiseMin(Eigen::Vector3d(p[0], p[1], p[2]));
      high = high.cwiseMax(Eigen::Vector3d(p[0], p[1], p[2]));
    }
    std::mt19937_64 random(71);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    for (std::size_t n = 0; n < scan.points.size() / 10; ++n) {
      const Eigen::Vector3d at(uniform(random), uniform(random), uniform(random));
      const Eigen::Vector3d p = low + at.cwiseProduct(high - low);
      both.points.push_back({p.x(), p.y(), p.z()});
    }
    const pipeline::Projection found = project_scan(both);
    ASSERT_TRUE(found.closed) << named.name << ": discs decide";
    const Judgement f = judge_object(found.grid, *named.object, scan);
    EXPECT_LE(f.beyond, 0.02) << named.name;
    EXPECT_LE(f.wrong_smooth, 0.002) << named.name;
  }
}

}  // namespace
}  // namespace sparsha::test
