// GLB: the mesh as the glTF reader gets it back, its colours, and the maps of what is felt within one step of 255.
#include <gtest/gtest.h>
#include <png.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <vector>

#include "base/error.h"
#include "base/files/files.h"
#include "pipeline/export/export.h"
#include "pipeline/scan/reader.h"
#include "scene/area/region_frame.h"
#include "scene/frame/workspace.h"
#include "scene/material/friction_law.h"
#include "scene/scene.h"
#include "tests/support/test_folder.h"

namespace sparsha::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr int kNx = 37, kNy = 23;

/// Waves with a hole, every node another colour, a friction map and a texture.
scene::ScenePointer waves(const Eigen::Matrix4d& scan_from_grid, bool colour = true) {
  scene::Layers layers;
  layers.grid = scene::DepthGrid(scene::Lattice{kNx, kNy, 0.002, {0.1, -0.2, 0.3}});
  for (std::size_t k = 0; k < layers.grid.height_m.size(); ++k) {
    const bool hole = k % kNx > 10 && k % kNx < 14 && k / kNx == 5;
    layers.grid.height_m[k] =
        hole ? scene::kUnknownHeight : static_cast<float>(0.01 * std::sin(0.3 * static_cast<double>(k)));
    layers.grid.state[k] = hole ? scene::NodeState::unknown : scene::NodeState::measured;
    layers.envelope_m.push_back(layers.grid.height_m[k] - static_cast<float>(0.001 * std::cos(static_cast<double>(k))));
    layers.curvature_per_m.push_back(static_cast<float>(k % 50));
    if (colour) layers.colour_rgba.push_back(0xFF000000U | static_cast<std::uint32_t>(k * 19) % 0x1000000U);
  }
  scene::SceneDescription description;
  description.scan_from_grid = scan_from_grid;
  description.levels = {layers.grid.lattice};
  description.height_min_m = 0.29;
  description.height_max_m = 0.31;
  description.has_colour = colour;
  description.has_envelope = description.has_curvature = true;
  description.config.friction.emplace();
  description.friction_c_m = 0.01;
  description.config.haptics.stiffness_n_per_m = 640.0;
  std::vector<scene::Layers> levels;
  levels.push_back(std::move(layers));
  return scene::make_scene(std::move(description), std::move(levels));
}

void save(const scene::Scene& scene, const fs::path& file, bool haptics) {
  Progress progress;
  export_scene(scene, file, false, progress, haptics);
}

struct Glb {
  nlohmann::json json;
  std::string binary;

  explicit Glb(const fs::path& file) {
    const std::string bytes = read_file(file, std::size_t{1} << 24U);
    const auto word = [&](std::size_t at) {
      std::uint32_t value = 0;
      std::memcpy(&value, bytes.data() + at, 4);
      return value;
    };
    EXPECT_EQ(bytes.substr(0, 4), "glTF");
    EXPECT_EQ(word(4), 2U);
    EXPECT_EQ(word(8), bytes.size());
    EXPECT_EQ(bytes.size() % 4, 0U);
    const std::size_t length = word(12);
    EXPECT_EQ(length % 4, 0U);
    json = nlohmann::json::parse(bytes.substr(20, length));
    EXPECT_EQ(word(20 + length), bytes.size() - 28 - length);
    binary = bytes.substr(28 + length);
    EXPECT_EQ(json["buffers"][0]["byteLength"], binary.size());
  }
  [[nodiscard]] std::string view(std::size_t i) const {
    const auto& view = json["bufferViews"][i];
    return binary.substr(view["byteOffset"], view["byteLength"]);
  }
};

/// Red of each pixel, top row first.
std::vector<int> pixels_of(const std::string& png) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  EXPECT_NE(png_image_begin_read_from_memory(&image, png.data(), png.size()), 0);
  image.format = PNG_FORMAT_RGB;
  EXPECT_EQ(image.width, static_cast<unsigned>(kNx));
  EXPECT_EQ(image.height, static_cast<unsigned>(kNy));
  std::vector<png_byte> bytes(PNG_IMAGE_SIZE(image));
  EXPECT_NE(png_image_finish_read(&image, nullptr, bytes.data(), 0, nullptr), 0);
  std::vector<int> red;
  for (std::size_t k = 0; k < bytes.size(); k += 3) red.push_back(bytes[k]);
  return red;
}

Eigen::Matrix4d utm_pose() {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = 0.5 * Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  m.topRightCorner<3, 1>() = Eigen::Vector3d(450000.0, 5412000.0, 300.0);
  return m;
}

TEST(ExportGlb, TheMeshComesBackWithItsColours) {
  const test::TestFolder folder;
  for (const bool haptics : {false, true}) {
    const scene::ScenePointer scene = waves(utm_pose());
    save(*scene, folder / "a.glb", haptics);
    save(*scene, folder / "a.ply", false);
    const RawScan glb = read_scan(folder / "a.glb");
    const RawScan ply = read_scan(folder / "a.ply");
    EXPECT_TRUE(glb.warnings.empty());
    ASSERT_EQ(glb.points.size(), ply.points.size());
    for (std::size_t k = 0; k < glb.points.size(); ++k) {
      EXPECT_LT((glb.points[k] - ply.points[k]).cwiseAbs().maxCoeff(), 1e-7) << k;
      EXPECT_EQ(glb.rgba[k], ply.rgba[k]) << k;
    }
    EXPECT_EQ(glb.faces, ply.faces);
  }
  save(*waves(Eigen::Matrix4d::Identity(), false), folder / "plain.glb", false);
  const Glb plain(folder / "plain.glb");
  EXPECT_FALSE(plain.json["meshes"][0]["primitives"][0]["attributes"].contains("COLOR_0"));
  EXPECT_FALSE(plain.json.contains("extensionsUsed"));
}

TEST(ExportGlb, StandsUprightBeforeViewersAndComesBackInTheScansFrame) {
  const test::TestFolder folder;
  // A wall that faces -y or +x of a scan whose z is up, a floor, and a scan whose y is up that is seen from behind.
  const std::vector<std::array<Eigen::Vector3d, 2>> up_and_front{
      {Eigen::Vector3d(0, 0.1, 1), Eigen::Vector3d(0, -1, 0.1)},
      {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(1, 0, 0)},
      {Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0, 0, 1)},
      {Eigen::Vector3d(0.2, 1, 0), Eigen::Vector3d(0.1, -0.02, -1)}};
  for (const auto& [up, front] : up_and_front) {
    Eigen::Matrix4d pose = Eigen::Matrix4d::Identity();
    pose.block<3, 1>(0, 1) = up.normalized();
    pose.block<3, 1>(0, 2) = front.normalized();
    pose.block<3, 1>(0, 0) = pose.block<3, 1>(0, 1).cross(pose.block<3, 1>(0, 2));
    pose.topRightCorner<3, 1>() = Eigen::Vector3d(4500.0, -54.0, 300.0);
    const scene::ScenePointer scene = waves(pose);
    save(*scene, folder / "a.glb", false);
    save(*scene, folder / "a.ply", false);
    const std::vector<double> matrix = Glb(folder / "a.glb").json["nodes"][0]["matrix"];
    const Eigen::Matrix4d viewer = Eigen::Map<const Eigen::Matrix4d>(matrix.data());
    const Eigen::Matrix3d turned = viewer.topLeftCorner<3, 3>() * pose.topLeftCorner<3, 3>();
    EXPECT_GT(turned.diagonal().minCoeff(), 0.9) << turned;
    EXPECT_EQ((viewer.topLeftCorner<3, 3>().determinant()), 1.0);
    const RawScan glb = read_scan(folder / "a.glb");
    const RawScan ply = read_scan(folder / "a.ply");
    ASSERT_EQ(glb.points.size(), ply.points.size());
    for (std::size_t k = 0; k < glb.points.size(); ++k)
      ASSERT_LT((glb.points[k] - ply.points[k]).cwiseAbs().maxCoeff(), 1e-7) << k;
    EXPECT_EQ(glb.faces, ply.faces);
  }
}

TEST(ExportGlb, MapsOfWhatIsFeltAreWithinOneStepOfTheScene) {
  const test::TestFolder folder;
  const scene::ScenePointer scene = waves(Eigen::Matrix4d::Identity());
  save(*scene, folder / "a.glb", true);
  const Glb glb(folder / "a.glb");
  EXPECT_EQ(glb.json["meshes"][0]["extensions"]["MPEG_haptic_material"]["hapticMaterialIndex"], 0);
  const auto& material = glb.json["extensions"]["MPEG_haptic_material"]["materials"][0];
  const scene::Layers layers = scene->read_level(0);
  const scene::FrictionLaw law(scene->description(), 1.0, scene::kDeskWorkspace_m);
  const auto compare = [&](const nlohmann::json& item, const auto& value) {
    EXPECT_EQ(item["type"], "High_Resolution");
    const std::size_t image = glb.json["textures"][item["texture"]["index"].get<std::size_t>()]["source"];
    const std::vector<int> grey = pixels_of(glb.view(glb.json["images"][image]["bufferView"]));
    const double least = item["extras"]["least"], most = item["extras"]["most"];
    for (int j = 0; j < kNy; ++j) {
      for (int i = 0; i < kNx; ++i) {
        const std::size_t node = layers.grid.lattice.index(i, j);
        if (layers.grid.state[node] == scene::NodeState::unknown) continue;
        const double read = least + (most - least) * grey[static_cast<std::size_t>((kNy - 1 - j) * kNx + i)] / 255.0;
        ASSERT_NEAR(read, value(node), (most - least) / 255.0) << i << ' ' << j;
      }
    }
  };
  ASSERT_EQ(material["friction"].size(), 2U);
  compare(material["stiffness"][0], [](std::size_t) { return 640.0; });
  EXPECT_EQ(material["friction"][0]["extras"]["coefficient"], "dynamic");
  compare(material["friction"][0], [&](std::size_t k) { return law.dynamic(layers, k); });
  compare(material["friction"][1], [&](std::size_t k) { return law.at_rest(layers, k, law.dynamic(layers, k)); });
  compare(material["vibrotactileTexture"][0], [](std::size_t k) { return 0.001 * std::cos(static_cast<double>(k)); });
}

TEST(ExportGlb, EachVertexFindsItsPixel) {
  const test::TestFolder folder;
  save(*waves(Eigen::Matrix4d::Identity()), folder / "a.glb", true);
  const Glb glb(folder / "a.glb");
  const auto& attributes = glb.json["meshes"][0]["primitives"][0]["attributes"];
  const auto floats = [&](const char* name) {
    const std::string bytes = glb.view(glb.json["accessors"][attributes[name].get<std::size_t>()]["bufferView"]);
    std::vector<float> values(bytes.size() / 4);
    std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
  };
  const std::vector<float> place = floats("POSITION"), pixel = floats("TEXCOORD_0");
  ASSERT_EQ(place.size() / 3, pixel.size() / 2);
  const std::vector<double> matrix = glb.json["nodes"][0]["matrix"];  // no turn: the grid is the scan's
  for (std::size_t k = 0; k < place.size() / 3; ++k) {
    const double i = (matrix[12] + static_cast<double>(place[3 * k]) - 0.1) / 0.002;
    const double j = (matrix[13] + static_cast<double>(place[3 * k + 1]) + 0.2) / 0.002;
    EXPECT_NEAR(kNx * static_cast<double>(pixel[2 * k]) - 0.5, i, 1e-3);
    EXPECT_NEAR(kNy - 1 - (kNy * static_cast<double>(pixel[2 * k + 1]) - 0.5), j, 1e-3);
  }
}

TEST(ExportGlb, NodesAndOtherFormatsWithMapsAreUsageErrors) {
  EXPECT_THROW(check_export("a.glb", true), Error);
  EXPECT_THROW(check_export("a.ply", false, true), Error);
  EXPECT_NO_THROW(check_export("a.glb", false, true));
}

}  // namespace
}  // namespace sparsha::pipeline
