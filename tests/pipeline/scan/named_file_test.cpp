// Which files of a folder are scans by their names.
#include "pipeline/scan/named_file.h"

#include <fstream>

#include <gtest/gtest.h>

#include "tests/support/test_folder.h"

namespace sparsha::pipeline {
namespace {

TEST(NamedFile, HasTheEndingOfAScanInAnyCase) {
  for (const char* name : {"a.ply", "a.LAZ", "a.e57", "a.b.xyz", "folder.png/a.pts"}) {
    EXPECT_TRUE(has_ending_of_scan(name)) << name;
  }
  for (const char* name : {"a.png", "ply", ".", "a.", "", "a.xyz/notes", "a.plyx"}) {
    EXPECT_FALSE(has_ending_of_scan(name)) << name;
  }
}

TEST(NamedFile, OfAFolderAreItsScansInOrder) {
  const test::TestFolder folder;
  for (const char* name : {"b.ply", "a.xyz", "notes.odt", "c.las", "d.e57"}) std::ofstream(folder / name) << "1 2 3\n";
  const auto path = [&](const char* name) { return (folder / name).string(); };
  EXPECT_EQ(scans_in(folder), path("a.xyz") + " " + path("b.ply") + " " + path("c.las") + " and 1 more");
}

}  // namespace
}  // namespace sparsha::pipeline
