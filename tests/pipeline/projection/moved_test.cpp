// A cloud that is moved by less than its scanner could tell, or told in another order, is the same cloud: no decision
// rests on which of its points a hash of their coordinates chooses.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <string>

#include "tests/pipeline/projection/front_only.h"
#include "tests/support/clouds.h"

namespace sparsha::test {
namespace {

/// Of the nodes that are measured in either grid, the share that is not within a tenth of a spacing in both. The second
/// one's cloud was moved by `moved_m`.
double changed_share(const scene::DepthGrid& before, const scene::DepthGrid& after, double moved_m) {
  EXPECT_EQ(before.state.size(), after.state.size());
  if (before.state.size() != after.state.size()) return 1.0;
  std::size_t nodes = 0, changed = 0;
  for (std::size_t node = 0; node < before.state.size(); ++node) {
    const bool was = before.state[node] == scene::NodeState::measured;
    const bool is = after.state[node] == scene::NodeState::measured;
    if (!was && !is) continue;
    ++nodes;
    const double rise_m = after.lattice.origin_m.z() + static_cast<double>(after.height_m[node]) - moved_m -
                          before.lattice.origin_m.z() - static_cast<double>(before.height_m[node]);
    changed += was && is && std::abs(rise_m) <= 0.1 * before.lattice.spacing_m ? 0 : 1;
  }
  return static_cast<double>(changed) / static_cast<double>(nodes);
}

// At noise 0.5 as well: there the sides of many samples are a close vote.
TEST(ClosedObjects, StayTheSameWhenTheyAreMovedByNanometres) {
  constexpr double kMostChanged = 1e-3;
  for (const double noise : {0.1, 0.5}) {
    for (const NamedObject& named : objects()) {
      // More points than facing looks at.
      ObjectScan scan = scan_object(*named.object, cloud_of(60'000, noise));
      const std::string what = named.name + ", noise " + std::to_string(noise);
      const pipeline::Projection before = project_scan(scan);
      ASSERT_TRUE(before.closed) << what;
      const Points points = scan.points;
      for (int k = 1; k <= 6; ++k) {
        const double by_m = 1e-9 * k;
        for (std::size_t p = 0; p < points.size(); ++p) {
          for (std::size_t axis = 0; axis < 3; ++axis) scan.points[p][axis] = points[p][axis] + by_m;
        }
        const pipeline::Projection after = project_scan(scan);
        EXPECT_EQ(after.facing_known, before.facing_known) << what << ", " << k << " nm";
        EXPECT_LE(changed_share(before.grid, after.grid, by_m), kMostChanged) << what << ", " << k << " nm";
      }
      scan.points = points;
      std::mt19937_64 random(7);
      std::shuffle(scan.points.begin(), scan.points.end(), random);
      EXPECT_EQ(changed_share(before.grid, project_scan(scan).grid, 0.0), 0.0) << what << ", in another order";
    }
  }
}

}  // namespace
}  // namespace sparsha::test
