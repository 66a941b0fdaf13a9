// What the glTF specification demands of files, and what is said of those that do otherwise.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/pipeline/scan/formats/gltf_files.h"
#include "tests/support/scan_files.h"

namespace sparsha::pipeline {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;
using testing::expect_refused;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::gltf::kCorners;
using testing::gltf::kFloat;
using testing::gltf::kSquare;
using testing::gltf::kUnsignedByte;
using testing::gltf::kUnsignedInt;
using testing::gltf::kUnsignedShort;
using testing::gltf::Maker;
using testing::gltf::square;
using Points = std::vector<Eigen::Vector3d>;

TEST(GltfRules, PointsAreThoseThatTheirIndicesName) {
  Maker maker;
  const std::size_t positions = maker.numbers(kSquare, kFloat, 3);
  const std::size_t first = maker.numbers<std::uint16_t>({2, 0, 2}, kUnsignedShort, 1);
  const std::size_t second = maker.numbers<std::uint32_t>({1, 4}, kUnsignedInt, 1);
  maker.root["materials"] = {{{"pbrMetallicRoughness", {{"baseColorFactor", {1, 0, 0, 1}}}}},
                             {{"pbrMetallicRoughness", {{"baseColorFactor", {0, 1, 0, 1}}}}}};
  const auto points = [&](std::size_t indices, int material) {
    return json{{"attributes", {{"POSITION", positions}}}, {"indices", indices}, {"material", material}, {"mode", 0}};
  };
  maker.root["meshes"].push_back({{"primitives", json::array({points(first, 0), points(second, 1)})}});
  const RawScan scan = read_scan_bytes(maker.glb(), "a.glb");
  EXPECT_EQ(scan.points, (Points{kCorners[0], kCorners[2], kCorners[1]}));
  EXPECT_THAT(scan.rgba, ElementsAre(0xFF0000FFU, 0xFF0000FFU, 0xFF00FF00U));
  EXPECT_THAT(scan.warnings, ElementsAre(HasSubstr("a position that no index of its points names is not read"),
                                         HasSubstr("an index of points names a position that is not there")));

  // Beside a mesh that shares the positions, and comes behind them, the mesh gives those that nothing names.
  const std::size_t corners = maker.numbers<std::uint16_t>({0, 1, 2}, kUnsignedShort, 1);
  maker.root["meshes"][0]["primitives"][1] = {{"attributes", {{"POSITION", positions}}}, {"indices", corners}};
  const RawScan both = read_scan_bytes(maker.glb(), "a.glb");
  EXPECT_EQ(both.points, (Points{kCorners[0], kCorners[2], kCorners[0], kCorners[1], kCorners[2], kCorners[3]}));
  EXPECT_THAT(both.faces, ElementsAre(std::array<std::uint32_t, 3>{2, 3, 4}));
  EXPECT_THAT(both.warnings, IsEmpty());
}

TEST(GltfRules, WeightsOfNodesGoBeforeThoseOfMeshes) {
  const auto warnings = [](const json& of_mesh, const json& of_node) {
    Maker maker = square();
    if (!of_mesh.is_null()) maker.root["meshes"][0]["weights"] = of_mesh;
    if (!of_node.is_null()) maker.root["nodes"][0]["weights"] = of_node;
    return read_scan_bytes(maker.glb(), "a.glb").warnings;
  };
  const auto said = ElementsAre(HasSubstr("a mesh's morph targets are not applied"));
  EXPECT_THAT(warnings({0.5}, nullptr), said);
  EXPECT_THAT(warnings(nullptr, {0, 1}), said);
  EXPECT_THAT(warnings({0.0}, {0.25}), said);
  // Nothing is moved.
  EXPECT_THAT(warnings({0.5}, {0.0}), IsEmpty());
  EXPECT_THAT(warnings({0, 0.0}, nullptr), IsEmpty());
}

TEST(GltfRules, WholeNumbersOfColoursAreNormalisedWhetherTheyAreSaidToBeOrNot) {
  const auto read = [](bool shorts, bool said) {
    Maker maker;
    const std::size_t positions = maker.numbers(kSquare, kFloat, 3);
    const std::size_t colours =
        shorts ? maker.numbers<std::uint16_t>({0, 0, 0, 65535, 65535, 65535, 65535, 0, 0, 0, 65535, 0}, kUnsignedShort,
                                              3, said)
               : maker.accessor(maker.view(std::string("\x0A\x14\x1E\0\xFF\xFF\xFF\0\x80\0\0\0\0\x80\0\0", 16), 4),
                                kUnsignedByte, 4, "VEC3", said);
    maker.mesh({{"attributes", {{"POSITION", positions}, {"COLOR_0", colours}}}, {"mode", 0}});
    return read_scan_bytes(maker.glb(), "a.glb");
  };
  for (const bool said : {true, false}) {
    EXPECT_THAT(read(false, said).rgba, ElementsAre(0xFF1E140AU, 0xFFFFFFFFU, 0xFF000080U, 0xFF008000U));
    EXPECT_THAT(read(true, said).rgba, ElementsAre(0xFF000000U, 0xFFFFFFFFU, 0xFF0000FFU, 0xFF00FF00U));
  }
  EXPECT_THAT(read(true, true).warnings, IsEmpty());
  for (const bool shorts : {false, true})
    EXPECT_THAT(read(shorts, false).warnings,
                ElementsAre(HasSubstr("whole numbers that are not said to be normalised")));
}

TEST(GltfRules, ElementsThatOverlapAreRefusedWithTheirAccessor) {
  Maker maker = square();
  maker.root["bufferViews"][0]["byteStride"] = 8;
  expect_refused("a.glb", maker.glb(), "accessors[0]: its elements of 12 bytes overlap");
  maker.root["bufferViews"][0]["byteStride"] = 12;
  EXPECT_EQ(read_scan_bytes(maker.glb(), "a.glb").points, kCorners);
}

TEST(GltfRules, AMatrixIsWrittenByColumns) {
  const auto with = [](const json& matrix) {
    Maker maker = square();
    maker.root["nodes"][0]["matrix"] = matrix;
    return maker.glb();
  };
  EXPECT_EQ(read_scan_bytes(with({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1}), "a.glb").points[0],
            Eigen::Vector3d(5, 6, 7));
  expect_refused("a.glb", with({1, 0, 0, 5, 0, 1, 0, 6, 0, 0, 1, 7, 0, 0, 0, 1}),
                 "nodes[0]: 'matrix' is written row by row");
  expect_refused("a.glb", with({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 2}), "nodes[0]: 'matrix' has numbers 4");
}

TEST(GltfRules, AMatrixGoesBeforeTranslationRotationAndScale) {
  Maker maker = square();
  maker.root["nodes"][0]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1};
  maker.root["nodes"][0]["translation"] = {1, 1, 1};
  const RawScan scan = read_scan_bytes(maker.glb(), "a.glb");
  EXPECT_EQ(scan.points[0], Eigen::Vector3d(5, 6, 7));
  EXPECT_THAT(scan.warnings, ElementsAre(HasSubstr("a matrix and a translation, rotation or scale")));
}

TEST(GltfRules, AFileThatNeedsALaterVersionIsRefused) {
  Maker maker = square();
  maker.root["asset"]["version"] = "2.1";
  EXPECT_EQ(read_scan_bytes(maker.glb(), "a.glb").points, kCorners);
  for (const char* const version : {"2.1", "3.0", "10.0"}) {
    maker.root["asset"]["minVersion"] = version;
    expect_refused("a.glb", maker.glb(), std::string("needs version '") + version + "'");
  }
  for (const char* const version : {"1.0", "2.0"}) {
    maker.root["asset"]["minVersion"] = version;
    EXPECT_EQ(read_scan_bytes(maker.glb(), "a.glb").points, kCorners);
  }
  maker.root["asset"]["minVersion"] = 2;
  expect_refused("a.glb", maker.glb(), "'minVersion' is no text");
}

TEST(GltfRules, HiddenNodesAreLeftOutWithTheirChildren) {
  const json hidden = {{"KHR_node_visibility", {{"visible", false}}}};
  Maker maker = square();
  maker.root["extensionsRequired"] = {"KHR_node_visibility"};
  maker.root["nodes"] = json::array({{{"mesh", 0}, {"children", {1}}, {"extensions", hidden}},
                                     {{"mesh", 0}},
                                     {{"mesh", 0}, {"extensions", {{"KHR_node_visibility", {{"visible", true}}}}}}});
  maker.root["scenes"][0]["nodes"] = {0, 2};
  const RawScan scan = read_scan_bytes(maker.glb(), "a.glb");
  EXPECT_EQ(scan.points, kCorners);
  EXPECT_THAT(scan.warnings, ElementsAre(HasSubstr("2 nodes' meshes are hidden (KHR_node_visibility)")));
  maker.root["scenes"][0]["nodes"] = {0};
  expect_refused("a.glb", maker.glb(), "all meshes of its scene are hidden");
}

}  // namespace
}  // namespace sparsha::pipeline
