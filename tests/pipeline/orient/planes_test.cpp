#include "pipeline/orient/planes.h"

#include <gtest/gtest.h>

namespace sparsha::pipeline {
namespace {

TEST(LargestPlane, PclPrintsNothingWhereThereIsNoPlaneOrPointsStandInRows) {
  std::vector<Eigen::Vector3f> line, rows;
  for (int i = 0; i < 40; ++i) {
    line.emplace_back(static_cast<float>(i), 0.0F, 0.0F);
    rows.emplace_back(static_cast<float>(i % 20), static_cast<float>(i / 20), 0.0F);
  }
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  EXPECT_FALSE(largest_plane(line, 0.1).has_value());
  (void)largest_plane(rows, 1.5);
  EXPECT_EQ(testing::internal::GetCapturedStderr() + testing::internal::GetCapturedStdout(), "");
}

}  // namespace
}  // namespace sparsha::pipeline
