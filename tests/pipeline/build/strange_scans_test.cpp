// Scans without a surface, in impossible coordinates or under odd names: a scene, or an error that says what is wrong.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "base/error.h"
#include "pipeline/build/build.h"
#include "pipeline/suggest/suggest.h"
#include "tests/support/test_folder.h"

namespace sparsha::pipeline {
namespace {
namespace fs = std::filesystem;

class StrangeScans : public ::testing::Test {
 protected:
  fs::path write(const std::string& name, const std::string& rows) const {
    std::ofstream(folder_ / name, std::ios::binary) << rows;
    return folder_ / name;
  }
  /// The error of building the scan as `sparsha build SCAN` does; empty when it succeeds.
  std::string error_of(const fs::path& file) {
    try {
      (void)build_scene(suggest_config({file}, {}, progress_).config, {}, progress_);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input) << error.what();
      return error.what();
    }
    return {};
  }

  const test::TestFolder folder_;
  Progress progress_;
};

std::string rows(int count, double dx, double dy, double dz) {
  std::string text;
  for (int i = 0; i < count; ++i) {
    text += std::to_string(i * dx) + " " + std::to_string(i * dy) + " " + std::to_string(i * dz) + "\n";
  }
  return text;
}

TEST_F(StrangeScans, WithoutASurfaceAreRefusedBeforeTheyGiveAGridOfOneRow) {
  EXPECT_NE(error_of(write("line.xyz", rows(1000, 0.001, 0, 0))).find("straight line"), std::string::npos);
  EXPECT_NE(error_of(write("upright.xyz", rows(1000, 0, 0, 0.001))).find("straight line"), std::string::npos);
  EXPECT_NE(error_of(write("point.xyz", rows(1, 0, 0, 0))).find("one place"), std::string::npos);
  std::string same;
  for (int i = 0; i < 5000; ++i) same += "1 2 3\n";
  EXPECT_NE(error_of(write("same.xyz", same)).find("one place"), std::string::npos);
  // At 0 0 0 they are what a depth camera did not see.
  EXPECT_NE(error_of(write("unseen.xyz", rows(5000, 0, 0, 0))).find("stand at 0 0 0"), std::string::npos);
}

TEST_F(StrangeScans, OfImpossibleSizeAreNamedAsInput) {
  std::string text;
  for (int i = 0; i < 20; ++i) {
    for (int k = 0; k < 20; ++k) text += std::to_string(i) + "e30 " + std::to_string(k) + "e30 0\n";
  }
  const std::string message = error_of(write("huge.xyz", text));
  EXPECT_NE(message.find("spread over"), std::string::npos) << message;
  text.clear();
  for (int i = 0; i < 20; ++i)
    for (int k = 0; k < 20; ++k) text += std::to_string(i) + "e-30 " + std::to_string(k) + "e-30 0\n";
  EXPECT_NE(error_of(write("tiny.xyz", text)), "");  // its scene could not be opened again
}

TEST_F(StrangeScans, KeepTheirNamesInASuggestedConfiguration) {
  for (const std::string name : {"a \"b\".xyz", "back\\slash.xyz", "new\nline.xyz", "s\xC3\xA4ule #1: front.xyz"}) {
    const fs::path file = write(name, "0 0 0\n0.01 0 0\n0 0.01 0\n0.01 0.01 0\n");
    const Suggestion suggestion = suggest_config({file}, folder_, progress_);
    EXPECT_EQ(suggestion.config.scans.at(0).file.filename(), name);
  }
}

}  // namespace
}  // namespace sparsha::pipeline
