// Made-up scans on their whole way: each is refused as bad input, or it is built, checked, exported and touched.
#include "tests/support/whole_way.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <random>

#include "tests/support/test_folder.h"

namespace sparsha::test {
namespace {

TEST(WholeWay, ScansOfUnlikelyShapesAreRefusedAsSuchOrCanBeTouched) {
  const TestFolder folder;
  int built = 0;
  for (std::uint32_t seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    std::array<std::uint8_t, 64> bytes{};
    std::mt19937 random(seed);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    try {
      built += go_whole_way(bytes, folder) ? 1 : 0;
    } catch (const Broken& broken) {
      ADD_FAILURE() << broken.what();
    }
  }
  EXPECT_GT(built, 10);
}

}  // namespace
}  // namespace sparsha::test
