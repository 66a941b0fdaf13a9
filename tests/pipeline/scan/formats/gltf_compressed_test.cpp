// Meshes of glTF that Draco and meshoptimizer have compressed, by these libraries' own encoders.
#include <gmock/gmock.h>

#ifdef SPARSHA_HAS_COMPRESSION
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <meshoptimizer.h>
#endif

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/pipeline/scan/formats/gltf_files.h"
#include "tests/support/scan_files.h"

namespace sparsha::pipeline {
namespace {

#ifdef SPARSHA_HAS_COMPRESSION
using nlohmann::json;
using ::testing::HasSubstr;
using testing::gltf::kFloat;
using testing::gltf::kUnsignedInt;
using testing::gltf::Maker;

constexpr int kSide = 40;

/// Waves of 40 x 40 vertices.
Eigen::Vector3f vertex(int i, int j) {
  const auto x = static_cast<float>(i), y = static_cast<float>(j);
  return {x, y, 3.0F * std::sin(0.3F * x) + std::cos(0.2F * y)};
}

std::vector<std::uint32_t> corners() {
  std::vector<std::uint32_t> result;
  for (std::uint32_t j = 0; j + 1 < kSide; ++j) {
    for (std::uint32_t i = 0; i + 1 < kSide; ++i) {
      const std::uint32_t a = j * kSide + i;
      for (const std::uint32_t corner : {a, a + 1, a + kSide + 1, a, a + kSide + 1, a + kSide})
        result.push_back(corner);
    }
  }
  return result;
}

json accessor(int type, std::size_t count, const char* shape) {
  return {{"componentType", type}, {"count", count}, {"type", shape}};
}

std::string draco_stream(bool edges) {
  draco::TriangleSoupMeshBuilder builder;
  const std::vector<std::uint32_t> indices = corners();
  builder.Start(static_cast<int>(indices.size() / 3));
  const int place = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  for (std::size_t k = 0; k < indices.size() / 3; ++k) {
    std::vector<Eigen::Vector3f> p;
    for (std::size_t c = 0; c < 3; ++c) {
      const auto n = static_cast<int>(indices[3 * k + c]);
      p.push_back(vertex(n % kSide, n / kSide));
    }
    builder.SetAttributeValuesForFace(place, draco::FaceIndex(static_cast<std::uint32_t>(k)), p[0].data(), p[1].data(),
                                      p[2].data());
  }
  const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
  draco::Encoder encoder;
  encoder.SetEncodingMethod(edges ? draco::MESH_EDGEBREAKER_ENCODING : draco::MESH_SEQUENTIAL_ENCODING);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 16);
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
  return {buffer.data(), buffer.size()};
}

Maker draco_file(const std::string& stream) {
  Maker maker;
  const std::size_t view = maker.view(stream);
  maker.root["accessors"] = {accessor(kFloat, kSide * kSide, "VEC3"),
                             accessor(kUnsignedInt, corners().size(), "SCALAR")};
  maker.mesh(
      {{"attributes", {{"POSITION", 0}}},
       {"indices", 1},
       {"extensions", {{"KHR_draco_mesh_compression", {{"bufferView", view}, {"attributes", {{"POSITION", 0}}}}}}}});
  maker.root["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  return maker;
}

/// The area over the plane, and the greatest distance of a vertex from its wave: any order of vertices will do.
void expect_waves(const RawScan& scan, double within) {
  ASSERT_EQ(scan.points.size(), static_cast<std::size_t>(kSide * kSide));
  ASSERT_EQ(scan.faces.size(), corners().size() / 3);
  for (const Eigen::Vector3d& p : scan.points) {
    const Eigen::Vector3f at = vertex(static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y())));
    EXPECT_LT((p - at.cast<double>()).cwiseAbs().maxCoeff(), within);
  }
  double area = 0.0;
  for (const auto& face : scan.faces) {
    const Eigen::Vector3d b = scan.points[face[1]] - scan.points[face[0]],
                          c = scan.points[face[2]] - scan.points[face[0]];
    const double twice = b.x() * c.y() - b.y() * c.x();
    EXPECT_GT(twice, 0.9);
    area += twice / 2.0;
  }
  EXPECT_NEAR(area, (kSide - 1) * (kSide - 1), 0.01);
}

TEST(GltfCompressed, DracoMeshesAreRead) {
  for (const bool edges : {false, true})
    expect_waves(read_scan_bytes(draco_file(draco_stream(edges)).glb(), "a.glb"), 1e-3);
}

TEST(GltfCompressed, DracoStreamsThatLieOrAreDamagedAreErrors) {
  const std::string stream = draco_stream(true);
  for (std::size_t size = 0; size < stream.size(); size += 1 + stream.size() / 97)
    EXPECT_TRUE(testing::error_of_bytes("a.glb", draco_file(stream.substr(0, size)).glb()).has_value()) << size;
  // Ten thousand million triangles, as the varint at byte 13 has them.
  std::string lie = stream;
  lie.replace(13, 1, "\xFF\xFF\xFF\xFF\x0F");
  testing::expect_refused("a.glb", draco_file(lie).glb(), "accessors have");
  Maker more = draco_file(stream);
  more.root["accessors"][0]["count"] = kSide * kSide + 1;
  testing::expect_refused("a.glb", more.glb(), "elements of a Draco mesh of 1600 vertices");
  Maker other = draco_file(stream);
  other.root["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"]["attributes"]["POSITION"] = 9;
  testing::expect_refused("a.glb", other.glb(), "attribute 9");
}

TEST(GltfCompressed, DracoIsPassedOverWhereTheNumbersAreBeside) {
  Maker maker = testing::gltf::square();
  json& primitive = maker.root["meshes"][0]["primitives"][0];
  primitive["extensions"] = {{"KHR_draco_mesh_compression", {{"bufferView", 99}, {"attributes", {{"POSITION", 0}}}}}};
  EXPECT_EQ(read_scan_bytes(maker.glb(), "a.glb").points, testing::gltf::kCorners);
}

/// A view whose bytes are packed; its own buffer is the one that has nothing.
std::size_t packed_view(Maker& maker, const std::string& bytes, std::size_t count, std::size_t stride,
                        const char* mode) {
  const std::size_t view = maker.view(bytes);
  json& object = maker.root["bufferViews"][view];
  const json packed = {{"buffer", 0},
                       {"byteOffset", object["byteOffset"]},
                       {"byteLength", bytes.size()},
                       {"count", count},
                       {"byteStride", stride},
                       {"mode", mode}};
  object = {{"buffer", 1}, {"byteLength", count * stride}, {"extensions", {{"EXT_meshopt_compression", packed}}}};
  return view;
}

struct Packed {
  std::string vertices, triangles;
};

Packed pack(const std::vector<float>& vertices, const std::vector<std::uint32_t>& indices) {
  Packed packed;
  const std::size_t count = vertices.size() / 3;
  std::vector<unsigned char> bytes(meshopt_encodeVertexBufferBound(count, 12));
  bytes.resize(meshopt_encodeVertexBuffer(bytes.data(), bytes.size(), vertices.data(), count, 12));
  packed.vertices.assign(bytes.begin(), bytes.end());
  bytes.resize(meshopt_encodeIndexBufferBound(indices.size(), count));
  bytes.resize(meshopt_encodeIndexBuffer(bytes.data(), bytes.size(), indices.data(), indices.size()));
  packed.triangles.assign(bytes.begin(), bytes.end());
  return packed;
}

Maker meshopt_file(const Packed& packed) {
  Maker maker;
  const std::size_t places = packed_view(maker, packed.vertices, kSide * kSide, 12, "ATTRIBUTES");
  const std::size_t triangles = packed_view(maker, packed.triangles, corners().size(), 4, "TRIANGLES");
  const std::size_t positions = maker.accessor(places, kFloat, kSide * kSide, "VEC3");
  const std::size_t indices = maker.accessor(triangles, kUnsignedInt, corners().size(), "SCALAR");
  maker.mesh({{"attributes", {{"POSITION", positions}}}, {"indices", indices}});
  maker.root["extensionsRequired"] = {"EXT_meshopt_compression"};
  return maker;
}

Packed packed_waves() {
  std::vector<float> places;
  for (int n = 0; n < kSide * kSide; ++n) {
    const Eigen::Vector3f p = vertex(n % kSide, n / kSide);
    places.insert(places.end(), p.data(), p.data() + 3);
  }
  return pack(places, corners());
}

TEST(GltfCompressed, MeshoptViewsAreRead) {
  expect_waves(read_scan_bytes(meshopt_file(packed_waves()).glb(), "a.glb"), 1e-6);
}

TEST(GltfCompressed, MeshoptViewsThatLieOrAreDamagedAreErrors) {
  const Packed whole = packed_waves();
  for (std::size_t size = 0; size < whole.vertices.size(); size += 1 + whole.vertices.size() / 97) {
    const Packed cut{whole.vertices.substr(0, size), whole.triangles};
    EXPECT_TRUE(testing::error_of_bytes("a.glb", meshopt_file(cut).glb()).has_value()) << size;
  }
  const auto refused = [&](const char* key, const json& value, const char* why) {
    Maker maker = meshopt_file(whole);
    maker.root["bufferViews"][0]["extensions"]["EXT_meshopt_compression"][key] = value;
    testing::expect_refused("a.glb", maker.glb(), why);
  };
  refused("count", 4'000'000'000U, "no more than these can hold");
  refused("byteStride", 7, "meshopt mode 'ATTRIBUTES'");
  refused("byteStride", 0, "meshopt mode 'ATTRIBUTES'");
  refused("mode", "SOMETHING", "meshopt mode 'SOMETHING'");
  refused("filter", "COLOR", "meshopt filter 'COLOR'");
  refused("byteLength", 1'000'000'000, "of a buffer of");
}
#else
TEST(GltfCompressed, IsRefusedByName) {
  testing::gltf::Maker maker;
  maker.root["accessors"] = {{{"componentType", 5126}, {"count", 3}, {"type", "VEC3"}}};
  maker.mesh(
      {{"attributes", {{"POSITION", 0}}}, {"extensions", {{"KHR_draco_mesh_compression", {{"bufferView", 0}}}}}});
  testing::expect_refused("a.glb", maker.glb(), "KHR_draco_mesh_compression");
}
#endif

}  // namespace
}  // namespace sparsha::pipeline
