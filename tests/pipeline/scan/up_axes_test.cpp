// Scans of which some have z up by their formats and others y: said once, unless a pose turns them.
#include "pipeline/scan/up_axes.h"

#include <gmock/gmock.h>
#include <Eigen/Geometry>

#include "base/threads/progress.h"
#include "pipeline/scan/set.h"
#include "tests/pipeline/scan/formats/gltf_files.h"
#include "tests/support/scan_files.h"

namespace sparsha::pipeline {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::ScanFolder;

TEST(UpAxes, DifferBetweenFormatsWhoseCustomsDiffer) {
  const auto found = differing_up({{"a.obj", "OBJ"}, {"b.stl", "STL binary"}, {"c.glb", "GLB 2.0"}});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->scan, 2U);
  EXPECT_THAT(found->reason, AllOf(HasSubstr("z is up in b.stl"), HasSubstr("y is up in c.glb"), HasSubstr("pose")));
  EXPECT_TRUE(differing_up({{"a.gltf", "glTF 2.0"}, {"b.las", "LAS 1.2 pf0"}}));
}

TEST(UpAxes, AreNotDoubtedWhereFormatsSayNothingOrAPoseTurns) {
  EXPECT_FALSE(differing_up({{"a.obj", "OBJ"}, {"c.glb", "GLB 2.0"}, {"d.ply", "PLY ascii"}}));
  EXPECT_FALSE(differing_up({{"a.stl", "STL ascii"}, {"b.las", "LAS 1.2 pf0"}}));
  EXPECT_FALSE(differing_up({{"a.stl", "STL ascii"}, {"c.glb", "GLB 2.0", true}}));
  EXPECT_FALSE(differing_up({{"a.stl", "STL ascii", true}, {"c.glb", "GLB 2.0"}}));
  EXPECT_FALSE(differing_up({{"c.glb", "GLB 2.0"}}));
}

TEST(UpAxes, AreSaidOfTheScansOfABuildUnlessOneIsTurned) {
  const ScanFolder folder;
  testing::gltf::Maker maker;
  const std::vector<float> corners = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0.1F};
  maker.mesh(
      {{"attributes", {{"POSITION", maker.numbers(corners, testing::gltf::kFloat, 3)}}},
       {"indices", maker.numbers(std::vector<std::uint16_t>{0, 1, 2, 1, 3, 2}, testing::gltf::kUnsignedShort, 1)}});
  scene::ScanConfig with_y;
  with_y.file = folder.write("a.glb", maker.glb());
  scene::ScanConfig with_z;
  with_z.file =
      folder.write("b.stl",
                   "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
                   "endfacet\nendsolid\n");
  with_z.units.unit = scene::LengthUnit::m;
  const auto said = [&] {
    Progress progress;
    const ScanSet set({with_y, with_z}, ScanSet::Keep::quickest, false, progress);
    return progress.warnings();
  };
  EXPECT_THAT(said(), ElementsAre(AllOf(HasSubstr("z is up in " + with_z.file.string()),
                                        HasSubstr("y is up in " + with_y.file.string()))));
  with_y.pose.topLeftCorner<3, 3>() = Eigen::AngleAxisd(std::acos(0.0), Eigen::Vector3d::UnitX()).toRotationMatrix();
  EXPECT_THAT(said(), IsEmpty());
}

}  // namespace
}  // namespace sparsha::pipeline
