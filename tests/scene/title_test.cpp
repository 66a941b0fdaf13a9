// One name of a scene, wherever it is shown.
#include "scene/title.h"

#include <gtest/gtest.h>

#include "scene/scene.h"

namespace sparsha::scene::test {
namespace {

SceneDescription of_scans(const std::vector<std::string>& files) {
  SceneDescription description;
  for (const std::string& file : files) {
    ScanSource source;
    source.file = file;
    description.sources.push_back(source);
  }
  return description;
}

TEST(Title, IsTheFoldersNameWithoutItsEndingWhenItSaysSomething) {
  const SceneDescription scans = of_scans({"scan_7.ply"});
  EXPECT_EQ(title_of(scans, "Büste von Laura.scene"), "Büste von Laura");
  EXPECT_EQ(title_of(scans, "/objects/lion-of-the_stairs.scene/"), "Lion of the stairs");
  EXPECT_EQ(title_of(scans, "objects/v1.2"), "V1.2");
}

TEST(Title, IsThatOfTheScansWhereTheFolderSaysNothing) {
  for (const char* folder : {"", "scene", "some/scene/", ".", "scene.scene"}) {
    EXPECT_EQ(title_of(of_scans({"../scans/Büste von Laura.ply"}), folder), "Büste von Laura") << folder;
    EXPECT_EQ(title_of(of_scans({"station-1.ply", "station-2.ply", "station-3.ply"}), folder), "Station 1 and 2 more")
        << folder;
  }
  EXPECT_EQ(title_of({}, {}), "");
}

}  // namespace
}  // namespace sparsha::scene::test
