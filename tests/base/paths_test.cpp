// Names without dots lead where the system goes, through symbolic links too.
#include "base/files/paths.h"

#include <gtest/gtest.h>

#include "base/files/files.h"
#include "tests/support/test_folder.h"

namespace sparsha {
namespace {
namespace fs = std::filesystem;

class Paths : public ::testing::Test {
 protected:
  void SetUp() override {
    before_ = fs::current_path();
    fs::current_path(folder_.path());
    fs::create_directories("disk/project/scans");
    fs::create_directories("out/deep/here");
    fs::create_directory_symlink("disk/project", "link");
    fs::create_directory_symlink(fs::absolute("out/deep/here"), "configs");
    for (const char* file : {"a", "disk/b", "disk/project/scans/c"}) write_file(file, "x");
  }
  void TearDown() override { fs::current_path(before_); }

  test::TestFolder folder_;
  fs::path before_;
};

TEST_F(Paths, WithoutDotsAreThoseOfTheSystem) {
  EXPECT_EQ(without_dots("x/./y/../z"), "x/z");
  EXPECT_EQ(without_dots("../../x"), "../../x");
  EXPECT_EQ(without_dots("x/.."), ".");
  EXPECT_EQ(without_dots("/../../x/"), "/x");
  EXPECT_EQ(without_dots(""), "");
  EXPECT_EQ(without_dots("link/scans/c"), "link/scans/c") << "links keep their names";
  for (const char* path : {"link/../b", "configs/../../../a", "link/scans/../../b", "out/../link/../../a",
                           "configs/../here/../../../disk/./b"}) {
    const fs::path plain = without_dots(path);
    EXPECT_TRUE(fs::equivalent(plain, path)) << path << " / " << plain;
    for (const fs::path& part : plain) EXPECT_TRUE(part != "." && part != "..") << plain;
  }
  fs::create_symlink("nowhere", "broken");
  EXPECT_EQ(without_dots("broken/../a"), "broken/../a");
}

TEST_F(Paths, FromAFolderAreFoundByAnyOfItsNames) {
  for (const char* folder : {"", ".", "out/deep/here", "configs", "link", "link/scans", "link/.."}) {
    for (const char* file : {"a", "link/../b", "link/scans/c", "configs/../../../a"}) {
      const fs::path found = path_from(folder, file);
      EXPECT_TRUE(found.is_relative()) << found;
      EXPECT_TRUE(fs::equivalent(fs::path(folder) / found, file)) << folder << " / " << file << " / " << found;
      EXPECT_TRUE(fs::equivalent(without_dots(fs::path(folder) / found), file)) << folder << " / " << found;
    }
  }
  EXPECT_EQ(path_from("", "link/scans/c"), "link/scans/c");
  EXPECT_EQ(path_from("link/scans", "disk/project/scans/c"), "c");
}

}  // namespace
}  // namespace sparsha
