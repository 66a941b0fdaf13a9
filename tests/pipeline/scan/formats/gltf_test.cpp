// glTF and GLB of the kinds that phones, photogrammetry and modelling programs write, built here byte by byte.
#include <gmock/gmock.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <Eigen/Geometry>

#include "base/files/files.h"
#include "pipeline/scan/writer.h"
#include "tests/pipeline/scan/formats/gltf_files.h"
#include "tests/support/scan_files.h"
#include "tests/support/test_folder.h"

namespace sparsha::pipeline {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::put;
using testing::gltf::kCorners;
using testing::gltf::kFloat;
using testing::gltf::kShort;
using testing::gltf::kSquare;
using testing::gltf::kUnsignedByte;
using testing::gltf::kUnsignedInt;
using testing::gltf::kUnsignedShort;
using testing::gltf::Maker;
using testing::gltf::square;

std::string message_of(const std::string& bytes, const char* name) {
  const auto error = testing::error_of_bytes(name, bytes);
  return error ? error->what() : "";
}

TEST(GltfReader, ReadsAMesh) {
  const RawScan scan = read_scan_bytes(square().glb(), "a.glb");
  EXPECT_EQ(scan.points, kCorners);
  ASSERT_EQ(scan.faces.size(), 2U);
  EXPECT_EQ(scan.faces[1], (std::array<std::uint32_t, 3>{0, 2, 3}));
  EXPECT_EQ(scan.format, "glTF 2.0 binary");
  EXPECT_EQ(scan.unit, scene::LengthUnit::m);
  EXPECT_THAT(scan.warnings, IsEmpty());
  EXPECT_EQ(scan.fields, (std::vector<std::string>{"x", "y", "z"}));
}

TEST(GltfReader, ReadsItWhateverItsNameAndInText) {
  const std::string file = square().glb();
  for (const char* name : {"a.bin", "a.ply", "a"}) EXPECT_EQ(read_scan_bytes(file, name).points, kCorners) << name;
  const test::TestFolder folder;
  Maker maker = square();
  maker.root["buffers"] = json::array({{{"byteLength", maker.bytes.size()}, {"uri", "the%20bytes.bin"}}});
  write_file(folder / "the bytes.bin", maker.bytes);
  write_file(folder / "a.gltf", maker.root.dump(1));
  const RawScan scan = read_scan(folder / "a.gltf");
  EXPECT_EQ(scan.points, kCorners);
  EXPECT_EQ(scan.format, "glTF 2.0 text");
  // "AAAA" is three zeros.
  Maker zeros;
  zeros.root["bufferViews"] = json::array({{{"buffer", 0}, {"byteLength", 36}}});
  (void)zeros.accessor(0, kFloat, 3, "VEC3");
  zeros.mesh({{"attributes", {{"POSITION", 0}}}, {"mode", 0}});
  zeros.root["buffers"] =
      json::array({{{"byteLength", 36}, {"uri", "data:application/octet-stream;base64," + std::string(48, 'A')}}});
  EXPECT_EQ(read_scan_bytes(zeros.root.dump(), "b.gltf").records, 3U);
  // Scans of a hundred thousand points are embedded so, too.
  zeros.root["bufferViews"][0]["byteLength"] = 12 * 100000;
  zeros.root["accessors"][0]["count"] = 100000;
  zeros.root["buffers"] =
      json::array({{{"byteLength", 12 * 100000},
                    {"uri", "data:application/octet-stream;base64," + std::string(16 * 100000, 'A')}}});
  EXPECT_EQ(read_scan_bytes(zeros.root.dump(), "c.gltf").records, 100000U);
}

TEST(GltfReader, NodesMoveTurnAndScaleTheirMeshes) {
  Maker maker = square();
  const double half = std::sqrt(0.5);
  // A quarter turn about z, twice as large, one up; its child is mirrored.
  maker.root["nodes"] = json::array({{{"mesh", 0},
                                      {"translation", {0, 0, 1}},
                                      {"rotation", {0, 0, half, half}},
                                      {"scale", {2, 2, 2}},
                                      {"children", {1}}},
                                     {{"mesh", 0}, {"matrix", {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1}}}});
  const RawScan scan = read_scan_bytes(maker.glb(), "a.glb");
  ASSERT_EQ(scan.points.size(), 8U);
  ASSERT_EQ(scan.faces.size(), 4U);
  for (std::size_t k = 0; k < 4; ++k) {
    const Eigen::Vector3d& p = kCorners[k];
    EXPECT_LT((scan.points[k] - Eigen::Vector3d(-2 * p.y(), 2 * p.x(), 2 * p.z() + 1)).norm(), 1e-12) << k;
    EXPECT_LT((scan.points[4 + k] - Eigen::Vector3d(-2 * p.y(), -2 * p.x(), 2 * (p.z() + 5) + 1)).norm(), 1e-12) << k;
  }
  // A mirrored triangle goes the other way round, so that its outside stays outside.
  EXPECT_EQ(scan.faces[2], (std::array<std::uint32_t, 3>{4, 6, 5}));
}

TEST(GltfReader, OnlyTheDefaultSceneIsRead) {
  Maker maker = square();
  maker.mesh(maker.root["meshes"][0]["primitives"][0]);
  maker.root["nodes"] = json::array({{{"mesh", 0}}, {{"mesh", 1}, {"translation", {7, 0, 0}}}});
  maker.root["scenes"] = json::array({{{"nodes", {0}}}, {{"nodes", {1}}}});
  maker.root["scene"] = 1;
  const RawScan scan = read_scan_bytes(maker.glb(), "a.glb");
  ASSERT_EQ(scan.points.size(), 4U);
  EXPECT_EQ(scan.points[0].x(), 7.0);
  ASSERT_EQ(scan.warnings.size(), 1U);
  EXPECT_THAT(scan.warnings[0], HasSubstr("another scene"));
  maker.root.erase("scene");
  maker.root.erase("scenes");
  EXPECT_EQ(read_scan_bytes(maker.glb(), "a.glb").points.size(), 8U);
}

TEST(GltfReader, PointsHaveColoursNormalsAndNumbersOfTheirOwn) {
  Maker maker;
  const std::size_t positions = maker.numbers(kSquare, kFloat, 3);
  const std::size_t colours =
      maker.numbers<std::uint8_t>({255, 0, 0, 255, 0, 128, 0, 255, 0, 0, 64, 128, 1, 2, 3, 4}, kUnsignedByte, 4, true);
  const std::size_t normals = maker.numbers<float>({0, 0, 1, 0, 1, 0, 1, 0, 0, 0, 0, -1}, kFloat, 3);
  const std::size_t confidence = maker.numbers<float>({0.25F, 0.5F, 0.75F, 1}, kFloat, 1);
  maker.mesh({{"mode", 0},
              {"attributes",
               {{"POSITION", positions}, {"COLOR_0", colours}, {"NORMAL", normals}, {"_CONFIDENCE", confidence}}}});
  ReadOptions options;
  options.fields = {"confidence"};
  const RawScan scan = read_scan_bytes(maker.glb(), "a.glb", options);
  ASSERT_EQ(scan.rgba.size(), 4U);
  EXPECT_EQ(scan.rgba[0], pack_rgba(255, 0, 0, 255));
  EXPECT_EQ(scan.rgba[1], pack_rgba(0, 128, 0, 255));
  EXPECT_EQ(scan.rgba[3], pack_rgba(1, 2, 3, 4));
  EXPECT_EQ(scan.normals[3], Eigen::Vector3f(0, 0, -1));
  ASSERT_EQ(scan.values.size(), 1U);
  EXPECT_EQ(scan.values[0], (std::vector<float>{0.25F, 0.5F, 0.75F, 1}));
  EXPECT_TRUE(scan.faces.empty());
}

TEST(GltfReader, FineColoursAreLightAndMaterialsColourWhatHasNone) {
  Maker maker = square();
  const std::size_t colours = maker.numbers<float>({1, 1, 1, 0.5F, 0, 0, 0, 0.21404114F, 0, 0, 0, 1}, kFloat, 3);
  maker.root["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = colours;
  RawScan scan = read_scan_bytes(maker.glb(), "a.glb");
  EXPECT_EQ(scan.rgba[0], kWhite);
  EXPECT_EQ(scan.rgba[1], pack_rgba(188, 0, 0));  // 0.5 of the light
  EXPECT_EQ(scan.rgba[2], pack_rgba(0, 128, 0));
  Maker plain = square();
  plain.root["materials"] = json::array({{{"pbrMetallicRoughness", {{"baseColorFactor", {0.2159, 0, 1, 1}}}}}});
  plain.root["meshes"][0]["primitives"][0]["material"] = 0;
  scan = read_scan_bytes(plain.glb(), "a.glb");
  ASSERT_EQ(scan.rgba.size(), 4U);
  EXPECT_EQ(scan.rgba[2], pack_rgba(128, 0, 255));
  plain.root["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", 0}};
  scan = read_scan_bytes(plain.glb(), "a.glb");
  EXPECT_TRUE(scan.rgba.empty());
  ASSERT_EQ(scan.warnings.size(), 1U);
  EXPECT_THAT(scan.warnings[0], HasSubstr("texture"));
}

TEST(GltfReader, NumbersMayBeQuantisedInterleavedAndSparse) {
  Maker quantised;
  const std::size_t positions =
      quantised.numbers<std::int16_t>({0, 0, 0, 32767, 0, -32768, 16384, -32767, 0}, kShort, 3, true);
  quantised.mesh({{"mode", 0}, {"attributes", {{"POSITION", positions}}}});
  quantised.root["extensionsRequired"] = {"KHR_mesh_quantization"};
  RawScan scan = read_scan_bytes(quantised.glb(), "a.glb");
  EXPECT_EQ(scan.points[1], Eigen::Vector3d(1, 0, -1));
  EXPECT_NEAR(scan.points[2].x(), 16384.0 / 32767.0, 1e-12);
  quantised.root["accessors"][0].erase("normalized");
  EXPECT_EQ(read_scan_bytes(quantised.glb(), "a.glb").points[1], Eigen::Vector3d(32767, 0, -32768));

  Maker woven;  // x y z and a colour, one after the other
  std::string data;
  for (std::size_t k = 0; k < 4; ++k) {
    for (std::size_t c = 0; c < 3; ++c) put(data, kSquare[3 * k + c]);
    for (int c = 0; c < 4; ++c) put(data, static_cast<std::uint8_t>(10 * k + static_cast<std::size_t>(c)));
  }
  const std::size_t both = woven.view(data, 16);
  (void)woven.accessor(both, kFloat, 4, "VEC3");
  (void)woven.accessor(both, kUnsignedByte, 4, "VEC4", true);
  woven.root["accessors"][1]["byteOffset"] = 12;
  woven.mesh({{"mode", 0}, {"attributes", {{"POSITION", 0}, {"COLOR_0", 1}}}});
  scan = read_scan_bytes(woven.glb(), "a.glb");
  EXPECT_EQ(scan.points, kCorners);
  EXPECT_EQ(scan.rgba[2], pack_rgba(20, 21, 22, 23));

  Maker sparse = square();
  std::string at;
  put(at, std::uint8_t{1});
  put(at, std::uint8_t{3});
  std::string of;
  for (const float value : {9.F, 8.F, 7.F, 6.F, 5.F, 4.F}) put(of, value);
  const std::size_t where = sparse.view(at);
  const std::size_t what = sparse.view(of);
  sparse.root["accessors"][0]["sparse"] = {{"count", 2},
                                           {"indices", {{"bufferView", where}, {"componentType", kUnsignedByte}}},
                                           {"values", {{"bufferView", what}}}};
  scan = read_scan_bytes(sparse.glb(), "a.glb");
  EXPECT_EQ(scan.points, (std::vector<Eigen::Vector3d>{kCorners[0], {9, 8, 7}, kCorners[2], {6, 5, 4}}));
  sparse.root["accessors"][0].erase("bufferView");  // all others are zero
  scan = read_scan_bytes(sparse.glb(), "a.glb");
  EXPECT_EQ(scan.points[2], Eigen::Vector3d(0, 0, 0));
  EXPECT_EQ(scan.points[3], Eigen::Vector3d(6, 5, 4));
}

TEST(GltfReader, StripsAndFansBecomeTrianglesWithTheSameOutside) {
  Maker maker;
  const std::size_t positions = maker.numbers<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0}, kFloat, 3);
  for (const int mode : {5, 6}) {
    maker.root["meshes"] = json::array();
    maker.mesh({{"mode", mode}, {"attributes", {{"POSITION", positions}}}});
    const RawScan scan = read_scan_bytes(maker.glb(), "a.glb");
    ASSERT_EQ(scan.faces.size(), 3U);
    if (mode == 6) {
      EXPECT_EQ(scan.faces[2], (std::array<std::uint32_t, 3>{0, 3, 4}));
      continue;
    }
    for (const auto& [a, b, c] : scan.faces) {
      EXPECT_GT((scan.points[b] - scan.points[a]).cross(scan.points[c] - scan.points[a]).z(), 0.0);
    }
  }
  maker.root["meshes"] = json::array();
  maker.mesh({{"mode", 1}, {"attributes", {{"POSITION", positions}}}});
  const RawScan lines = read_scan_bytes(maker.glb(), "a.glb");
  EXPECT_EQ(lines.records, 0U);
  ASSERT_EQ(lines.warnings.size(), 1U);
  EXPECT_THAT(lines.warnings[0], HasSubstr("lines"));
}

TEST(GltfReader, PrimitivesThatShareVerticesGiveThoseThatTheirIndicesName) {
  // Six vertices: a strip on three, triangles on three with one shared, and one that no index names.
  const std::vector<float> places{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0, 7, 7, 7};
  const auto corners = [](const RawScan& scan) {
    std::vector<std::array<Eigen::Vector3d, 3>> triangles;
    for (const auto& [a, b, c] : scan.faces) triangles.push_back({scan.points[a], scan.points[b], scan.points[c]});
    return triangles;
  };
  const Eigen::Vector3d a(0, 0, 0), b(1, 0, 0), c(0, 1, 0), d(1, 1, 0), e(0, 2, 0), alone(7, 7, 7);
  Maker maker;
  const std::size_t positions = maker.numbers(places, kFloat, 3);
  const std::size_t strip = maker.numbers<std::uint16_t>({0, 1, 2}, kUnsignedShort, 1);
  const std::size_t list = maker.numbers<std::uint16_t>({4, 2, 3}, kUnsignedShort, 1);
  const json first = {{"attributes", {{"POSITION", positions}}}, {"indices", strip}, {"mode", 5}};
  const json second = {{"attributes", {{"POSITION", positions}}}, {"indices", list}};
  maker.root["meshes"].push_back({{"primitives", json::array({first, second})}});
  RawScan scan = read_scan_bytes(maker.glb(), "a.glb");
  EXPECT_EQ(scan.points, (std::vector<Eigen::Vector3d>{a, b, c, alone, c, d, e}));
  const std::vector<std::array<Eigen::Vector3d, 3>> wanted{{a, b, c}, {e, c, d}};
  EXPECT_EQ(corners(scan), wanted);
  EXPECT_THAT(scan.warnings, IsEmpty());

  // As parts of their own, which stand apart.
  maker.root["meshes"] = json::array({{{"primitives", json::array({first})}}, {{"primitives", json::array({second})}}});
  maker.root["nodes"] = json::array({{{"mesh", 0}}, {{"mesh", 1}, {"translation", {0, 0, 5}}}});
  maker.root["scenes"] = json::array({{{"nodes", {0, 1}}}});
  scan = read_scan_bytes(maker.glb(), "a.glb");
  const Eigen::Vector3d up(0, 0, 5);
  EXPECT_EQ(scan.points, (std::vector<Eigen::Vector3d>{a, b, c, alone, c + up, d + up, e + up, alone + up}));

  // A mesh alone gives all of its vertices in their order, and so do points beside it.
  maker.root["scenes"] = json::array({{{"nodes", {0}}}});
  const std::vector<Eigen::Vector3d> all{a, b, c, d, e, alone};
  EXPECT_EQ(read_scan_bytes(maker.glb(), "a.glb").points, all);
  const json points = {{"attributes", {{"POSITION", positions}}}, {"mode", 0}};
  maker.root["meshes"] = json::array({{{"primitives", json::array({first, points})}}});
  scan = read_scan_bytes(maker.glb(), "a.glb");
  EXPECT_EQ(scan.points, (std::vector<Eigen::Vector3d>{a, b, c, a, b, c, d, e, alone}));
}

TEST(GltfReader, ManyPrimitivesOfOneAccessorAreNotRefusedAsRepeatedMeshes) {
  constexpr std::uint32_t kVertices = 30'000;
  Maker maker;
  const std::size_t positions = maker.numbers(std::vector<float>(std::size_t{3} * kVertices, 1.0F), kFloat, 3);
  json primitives = json::array();
  for (std::uint32_t k = 0; k < 1000; ++k) {
    const std::size_t indices = maker.numbers<std::uint32_t>({3 * k, 3 * k + 1, 3 * k + 2}, kUnsignedInt, 1);
    primitives.push_back({{"attributes", {{"POSITION", positions}}}, {"indices", indices}});
  }
  maker.root["meshes"].push_back({{"primitives", primitives}});
  EXPECT_EQ(read_scan_bytes(maker.glb(), "a.glb").records, kVertices);
}

TEST(GltfReader, WhatIsNotKnownIsRefusedByNameWithTheRemedy) {
  Maker maker = square();
  maker.root["extensionsRequired"] = {"ACME_secret"};
  EXPECT_THAT(message_of(maker.glb(), "a.glb"), HasSubstr("ACME_secret"));
  maker.root["extensionsRequired"] = {"KHR_materials_unlit", "KHR_texture_transform"};
  EXPECT_EQ(read_scan_bytes(maker.glb(), "a.glb").points, kCorners);
}

TEST(GltfReader, GaussianSplatsAreReadAsInOtherFiles) {
  Maker maker;
  std::vector<float> places, axes, opacities, terms;
  for (int k = 0; k < 50; ++k) {
    places.insert(places.end(), {static_cast<float>(k), 0.5F, 2.0F});
    // The 7th is faint, the 9th long.
    axes.insert(axes.end(), {0.01F, k == 9 ? 3.0F : 0.02F, 0.001F});
    opacities.push_back(k == 7 ? 0.05F : 0.9F);
    terms.insert(terms.end(), {1.7724539F, 0.0F, -1.7724539F});  // 1, 0.5, 0
  }
  maker.mesh({{"attributes",
               {{"POSITION", maker.numbers(places, kFloat, 3)},
                {"KHR_gaussian_splatting:SCALE", maker.numbers(axes, kFloat, 3)},
                {"KHR_gaussian_splatting:OPACITY", maker.numbers(opacities, kFloat, 1)},
                {"KHR_gaussian_splatting:SH_DEGREE_0_COEF_0", maker.numbers(terms, kFloat, 3)}}},
              {"mode", 0},
              {"extensions", {{"KHR_gaussian_splatting", {{"colorSpace", "srgb_rec709_display"}}}}}});
  RawScan scan = read_scan_bytes(maker.glb(), "a.glb");
  EXPECT_EQ(scan.points.size(), 48U);
  EXPECT_EQ(scan.invalid, 2U);
  EXPECT_EQ(scan.rgba.at(3), pack_rgba(255, 128, 0));
  EXPECT_THAT(scan.fields, ::testing::Contains("opacity"));
  EXPECT_THAT(scan.warnings, ::testing::SizeIs(1));
  json& primitive = maker.root["meshes"][0]["primitives"][0];
  primitive["extensions"]["KHR_gaussian_splatting"]["colorSpace"] = "lin_rec709_display";
  EXPECT_EQ(read_scan_bytes(maker.glb(), "a.glb").rgba.at(3), pack_rgba(255, 188, 0));
  maker.root["accessors"][2]["count"] = 49;
  EXPECT_THAT(message_of(maker.glb(), "a.glb"), HasSubstr("accessors[2]"));
}

TEST(GltfReader, DamageIsToldWithItsPlace) {
  const auto broken = [](const auto& change) {
    Maker maker = square();
    change(maker.root);
    return message_of(maker.glb(), "a.glb");
  };
  EXPECT_THAT(broken([](json& root) { root["accessors"][0]["count"] = 5; }), HasSubstr("accessors[0]"));
  EXPECT_THAT(broken([](json& root) { root["accessors"][0]["count"] = 1e18; }), HasSubstr("accessors[0]"));
  EXPECT_THAT(broken([](json& root) { root["accessors"][0]["count"] = -1; }), HasSubstr("accessors[0]"));
  EXPECT_THAT(broken([](json& root) { root["accessors"][0]["byteOffset"] = 18446744073709551615ULL; }),
              HasSubstr("accessors[0]"));
  EXPECT_THAT(broken([](json& root) { root["accessors"][0]["type"] = "MAT4"; }), HasSubstr("MAT4"));
  EXPECT_THAT(broken([](json& root) { root["accessors"][0]["componentType"] = 5124; }), HasSubstr("5124"));
  EXPECT_THAT(broken([](json& root) {
                root["accessors"][0].erase("bufferView");
                root["accessors"][0]["count"] = 1000000000;
              }),
              HasSubstr("without bytes"));
  EXPECT_THAT(broken([](json& root) { root["bufferViews"][0]["byteLength"] = 4000; }), HasSubstr("bufferViews[0]"));
  EXPECT_THAT(broken([](json& root) { root["nodes"][0]["mesh"] = 3; }), HasSubstr("meshes[3]"));
  EXPECT_THAT(broken([](json& root) { root["nodes"][0]["children"] = {0}; }), HasSubstr("twice"));
  EXPECT_THAT(broken([](json& root) { root["nodes"][0]["children"] = {9}; }), HasSubstr("nodes[0]"));
  EXPECT_THAT(broken([](json& root) { root["nodes"][0]["matrix"] = {1, 2}; }), HasSubstr("matrix"));
  EXPECT_THAT(broken([](json& root) { root["nodes"][0]["rotation"] = {0, 0, 0, 0}; }), HasSubstr("rotation"));
  EXPECT_THAT(broken([](json& root) { root["scenes"][0]["nodes"] = json::array(); }), HasSubstr("no node"));
  EXPECT_THAT(broken([](json& root) { root["asset"]["version"] = "1.0"; }), HasSubstr("1.0"));
  EXPECT_THAT(broken([](json& root) { root["meshes"][0]["primitives"][0]["mode"] = 7; }), HasSubstr("mode 7"));
  EXPECT_THAT(message_of(square().glb(1), "a.glb"), HasSubstr("version 1"));
  EXPECT_THAT(message_of("{\"asset\": {\"version\": \"2.0\"}, \"n\": 1e99999}", "a.gltf"), HasSubstr("too large"));
  std::string file = square().glb();
  for (std::size_t size = 8; size < file.size(); ++size)
    EXPECT_FALSE(message_of(file.substr(0, size), "a.glb").empty()) << size;
  const auto outside = [](const char* uri) {
    Maker maker = square();
    maker.root["buffers"] = json::array({{{"byteLength", maker.bytes.size()}, {"uri", uri}}});
    return message_of(maker.root.dump(), "a.gltf");
  };
  for (const char* uri : {"/etc/passwd", "../a.bin", "https://example.org/a.bin", "a/../../b.bin", "%2e%2e/b.bin"})
    EXPECT_THAT(outside(uri), HasSubstr("elsewhere")) << uri;
  EXPECT_THAT(outside("not_there.bin"), HasSubstr("not_there.bin"));
  EXPECT_THAT(outside("data:text/plain,abc"), HasSubstr("base64"));
}

TEST(GltfReader, IndicesThatDoNotExistAreCountedAndAMeshIsNotRepeatedWithoutBounds) {
  Maker maker = square();
  maker.root["accessors"][1]["componentType"] = kUnsignedByte;  // 0 0 1 0 2 0: three of them name no corner twice
  EXPECT_EQ(read_scan_bytes(maker.glb(), "a.glb").records, 4U);
  Maker wrong;
  const std::size_t positions = wrong.numbers(kSquare, kFloat, 3);
  const std::size_t indices = wrong.numbers<std::uint32_t>({0, 1, 2, 0, 2, 4000000000U}, kUnsignedInt, 1);
  wrong.mesh({{"attributes", {{"POSITION", positions}}}, {"indices", indices}});
  const RawScan scan = read_scan_bytes(wrong.glb(), "a.glb");
  EXPECT_EQ(scan.faces.size(), 1U);
  EXPECT_FALSE(scan.warnings.empty());

  Maker many;
  const std::size_t places = many.numbers(std::vector<float>(60000, 1.0F), kFloat, 3);
  many.mesh({{"mode", 0}, {"attributes", {{"POSITION", places}}}});
  json nodes = json::array();
  json all = json::array();
  for (int k = 0; k < 40000; ++k) {
    nodes.push_back({{"mesh", 0}});
    all.push_back(k);
  }
  many.root["nodes"] = nodes;
  many.root["scenes"] = json::array({{{"nodes", all}}});
  EXPECT_THAT(message_of(many.glb(), "a.glb"), AllOf(HasSubstr("together"), HasSubstr("MB in memory")));
}

}  // namespace
}  // namespace sparsha::pipeline
