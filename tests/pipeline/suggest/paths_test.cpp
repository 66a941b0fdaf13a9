// A configuration finds the scans that it was made for: names of any bytes, absolute and relative ones, other folders.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "base/files/files.h"
#include "pipeline/suggest/suggest.h"
#include "tests/support/test_folder.h"

namespace sparsha::pipeline {
namespace {
namespace fs = std::filesystem;

class SuggestedPaths : public ::testing::Test {
 protected:
  void SetUp() override {
    before_ = fs::current_path();
    fs::current_path(folder_.path());
  }
  void TearDown() override { fs::current_path(before_); }

  static fs::path write(const fs::path& file) {
    if (file.has_parent_path()) fs::create_directories(file.parent_path());
    std::ofstream out(file, std::ios::binary);
    for (int j = 0; j < 12; ++j) {
      for (int i = 0; i < 12; ++i) out << 0.01 * i << ' ' << 0.01 * j << ' ' << 0.0001 * i * j << '\n';
    }
    return file;
  }
  /// The path that the configuration, written into `folder`, gives for the scan.
  static fs::path found(const fs::path& scan, const fs::path& folder, std::string* yaml = nullptr) {
    Progress progress;
    const Suggestion suggestion = suggest_config({scan}, folder, progress);
    if (yaml != nullptr) *yaml = suggestion.yaml;
    const fs::path file = folder / "made.yaml";
    write_file(file, suggestion.yaml);
    return scene::load_config(file).scans.at(0).file;
  }

  test::TestFolder folder_;
  fs::path before_;
};

TEST_F(SuggestedPaths, KeepNamesByteForByte) {
  for (const std::string name :
       {"-dash.xyz", "- dash.xyz", "two\nlines.xyz", "caf\xE9.xyz", "\x93\x5F.xyz", "a b #1: \"final\" (2).xyz",
        "l'eau & feu \xE2\x80\x93 \xE9\xBB\x9E.xyz", "back\\slash.xyz", "tab\t.xyz", "\x1B[31mred.xyz", "{a}.xyz",
        "!tag.xyz", "~.xyz", "\xEF\xBB\xBFmark.xyz", "line\xE2\x80\xA8separator.xyz", "%41.xyz"}) {
    write(name);
    EXPECT_EQ(found(name, "").filename().string(), name);
    EXPECT_EQ(found(fs::path("./") / name, "").filename().string(), name);
    EXPECT_TRUE(fs::equivalent(found(name, ""), name));
  }
}

TEST_F(SuggestedPaths, OfSeveralScansDoNotLeakIntoComments) {
  write("two\nlines: [.xyz");
  std::ofstream large("caf\xE9.xyz");
  for (int k = 0; k < 144; ++k) large << 10 * (k % 12) << ' ' << 10 * (k / 12) << " 0\n";
  large.close();
  Progress progress;
  const Suggestion suggestion = suggest_config({"two\nlines: [.xyz", "caf\xE9.xyz"}, "", progress);
  EXPECT_EQ(suggestion.config.scans.size(), 2U);
}

TEST_F(SuggestedPaths, StayAbsoluteWhereTheyAreGivenSo) {
  const fs::path file = write(folder_ / "scans/a.xyz");
  fs::create_directories("elsewhere/deep");
  std::string yaml;
  EXPECT_EQ(found(file, "", &yaml), file);
  EXPECT_NE(yaml.find("file: \"" + file.string() + "\""), std::string::npos);
  EXPECT_EQ(found(file, "elsewhere/deep", &yaml), file);
  EXPECT_NE(yaml.find("file: \"" + file.string() + "\""), std::string::npos);
}

TEST_F(SuggestedPaths, AreRelativeToTheFolderOfTheConfiguration) {
  write("scans/a.xyz");
  fs::create_directories("elsewhere/deep");
  std::string yaml;
  EXPECT_TRUE(fs::equivalent(found("scans/a.xyz", "", &yaml), "scans/a.xyz"));
  EXPECT_NE(yaml.find("file: \"scans/a.xyz\""), std::string::npos);
  EXPECT_TRUE(fs::equivalent(found("scans/a.xyz", "elsewhere/deep", &yaml), "scans/a.xyz"));
  EXPECT_NE(yaml.find("file: \"../../scans/a.xyz\""), std::string::npos);
  EXPECT_TRUE(fs::equivalent(found("elsewhere/../scans/a.xyz", "scans", &yaml), "scans/a.xyz"));
  EXPECT_NE(yaml.find("file: \"a.xyz\""), std::string::npos);
}

TEST_F(SuggestedPaths, LeadThroughSymbolicLinks) {
  write("disk/project/scans/a.xyz");
  fs::create_directories("out/here");
  fs::create_directory_symlink("disk/project", "link");
  fs::create_directory_symlink(fs::absolute("out/here"), "configs");
  EXPECT_TRUE(fs::equivalent(found("link/scans/a.xyz", ""), "disk/project/scans/a.xyz"));
  EXPECT_TRUE(fs::equivalent(found("link/scans/a.xyz", "configs"), "disk/project/scans/a.xyz"));
  // 'link/..' is disk, though it reads like the present folder.
  write("disk/b.xyz");
  EXPECT_TRUE(fs::equivalent(found("link/../b.xyz", ""), "disk/b.xyz"));
  EXPECT_TRUE(fs::equivalent(found("link/../b.xyz", "configs"), "disk/b.xyz"));
  // A configuration that is written by one name of its folder is read by another.
  fs::create_directories("out/here/more");
  fs::create_directory_symlink(fs::absolute("out/here/more"), "far");
  EXPECT_TRUE(fs::equivalent(found("disk/b.xyz", "far"), "disk/b.xyz"));
  EXPECT_TRUE(fs::equivalent(scene::load_config("out/here/more/made.yaml").scans.at(0).file, "disk/b.xyz"));
  EXPECT_TRUE(fs::equivalent(found("disk/b.xyz", "out/here/more"), "disk/b.xyz"));
  EXPECT_TRUE(fs::equivalent(scene::load_config("far/made.yaml").scans.at(0).file, "disk/b.xyz"));
}

}  // namespace
}  // namespace sparsha::pipeline
