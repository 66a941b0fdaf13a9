// How many voxels points fall in, against cells that are counted by their making.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "pipeline/filter/voxel.h"

namespace sparsha::pipeline {
namespace {

// Two points in each of nx * ny * 2 cells of a millimetre.
std::uint64_t counted(int nx, int ny) {
  VoxelCounter counter({500.0, -20.0, 3.0}, 0.001);
  for (int again = 0; again < 2; ++again) {
    for (int j = 0; j < ny; ++j) {
      for (int i = 0; i < nx; ++i) {
        for (int k = 0; k < 2; ++k) {
          const float off = 0.3F + 0.3F * static_cast<float>(again);
          const std::array<float, 3> p{(static_cast<float>(i) + off) * 1e-3F, (static_cast<float>(j) + off) * 1e-3F,
                                       (static_cast<float>(k) + off) * 1e-3F};
          counter.add(p.data());
        }
      }
    }
  }
  return counter.voxels();
}

TEST(VoxelCounter, CountsFewVoxelsExactlyAndManyWithinFivePercent) {
  EXPECT_EQ(counted(100, 100), 20'000U);
  for (const int side : {200, 500, 900}) {
    const double cells = 2.0 * side * side;
    EXPECT_NEAR(static_cast<double>(counted(side, side)), cells, 0.05 * cells) << side;
  }
}

}  // namespace
}  // namespace sparsha::pipeline
