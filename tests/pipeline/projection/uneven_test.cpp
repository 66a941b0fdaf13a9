// Objects whose stations stood near and far: their points are dense on one side and sparse on the other.
#include <gtest/gtest.h>

#include <cstddef>

#include "tests/pipeline/projection/front_only.h"

namespace sparsha::test {
namespace {

TEST(UnevenObjects, KeepDiscsWhereTheyAreDenseAndHaveWiderOnesWhereTheyAreSparse) {
  constexpr double kRatio = 40.0;  // greatest density over least
  for (const std::size_t k : {0U, 1U, 2U, 4U}) {
    const NamedObject& named = objects()[k];
    ScanOptions options = cloud_of(60'000);
    options.density_ratio = kRatio;
    const ObjectScan scan = scan_object(*named.object, options);
    const pipeline::Projection p = project_scan(scan);
    const Judgement f = judge_object(p.grid, *named.object, scan);
    EXPECT_TRUE(p.closed) << named.name;
    EXPECT_TRUE(p.discs) << named.name;
    EXPECT_GT(p.sparse_share, 0.0) << named.name;
    EXPECT_LE(f.wrong_smooth, 0.001) << named.name;
    EXPECT_LE(f.beyond, 0.01) << named.name;
    EXPECT_GE(f.covered, 0.9) << named.name;
  }
}

}  // namespace
}  // namespace sparsha::test
