// Which scans a new depth scan, a part and a refused scene concern.
#include "app/raw_scans/open_scans.h"

#include <gtest/gtest.h>

namespace sparsha::app {
namespace {

std::unique_ptr<DepthScans> some(const char* name) {
  return std::make_unique<DepthScans>(std::vector<std::filesystem::path>{name});
}

TEST(OpenScans, PartsOfTheTouchedObjectDoNotConcernOtherScansThatAreShown) {
  OpenScans scans;
  scans.show(some("statue.ply"));
  EXPECT_FALSE(scans.touched()) << "nothing is touched before the first depth scan";
  scans.touch();
  EXPECT_TRUE(scans.touched());
  scans.show(some("vase.ply"));
  EXPECT_FALSE(scans.touched());
  scans.touch();  // the vase has been scanned
  EXPECT_TRUE(scans.touched());
}

TEST(OpenScans, ARefusedDepthScanOfOtherScansLeavesThemShownAndUntouched) {
  OpenScans scans;
  scans.show(some("statue.ply"));
  scans.touch();
  scans.show(some("vase.ply"));
  const DepthScans* const vase = &scans.shown();
  scans.touch();
  scans.go_back();
  EXPECT_EQ(&scans.shown(), vase);
  EXPECT_FALSE(scans.touched()) << "the statue is touched again";
}

TEST(OpenScans, ARefusedSceneGivesTheScansBeforeBack) {
  OpenScans scans;
  scans.show(some("statue.ply"));
  scans.touch();
  const DepthScans* const statue = &scans.shown();
  scans.touch(some("vase.ply"));
  EXPECT_TRUE(scans.touched());
  scans.settle();
  scans.go_back();
  EXPECT_EQ(&scans.shown(), statue);
  EXPECT_TRUE(scans.touched());
}

TEST(OpenScans, ARefusedDepthScanOfTheSameObjectIsStillOfItsScans) {
  OpenScans scans;
  scans.show(some("vase.ply"));
  scans.touch();
  scans.touch(some("statue.ply"));
  scans.settle();
  scans.settle();
  scans.touch();  // a new depth scan of the statue
  scans.go_back();
  EXPECT_TRUE(scans.touched());
}

}  // namespace
}  // namespace sparsha::app
