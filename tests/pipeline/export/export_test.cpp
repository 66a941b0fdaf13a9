// Impulses through every export: half a cell, mirrored rows or swapped axes would put them elsewhere.
#include "pipeline/export/export.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <fstream>

#include "base/error.h"
#include "readers.h"
#include "scene/scene.h"
#include "tests/support/test_folder.h"

namespace sparsha::pipeline {
namespace {

namespace fs = std::filesystem;
using test::Mesh;
using test::Raster;

constexpr int kImpulseI = 41, kImpulse_j = 7;
constexpr double kHigh = 0.025;

class Export : public testing::Test {
 protected:
  [[nodiscard]] fs::path out(const std::string& name) const { return folder_ / name; }

 private:
  sparsha::test::TestFolder folder_;
};

/// A flat level of nx x ny nodes with one high node, asymmetric in every way; heights 0 and kHigh relative to origin.
scene::Layers impulse(int nx, int ny, const Eigen::Vector3d& origin) {
  scene::Layers layers;
  layers.grid = scene::DepthGrid(scene::Lattice{nx, ny, 0.002, origin});
  std::fill(layers.grid.height_m.begin(), layers.grid.height_m.end(), 0.0F);
  std::fill(layers.grid.state.begin(), layers.grid.state.end(), scene::NodeState::measured);
  layers.grid.height_m[layers.grid.lattice.index(kImpulseI, kImpulse_j)] = static_cast<float>(kHigh);
  return layers;
}

scene::ScenePointer scene_of(scene::Layers layers,
                             const Eigen::Matrix4d& scan_from_grid = Eigen::Matrix4d::Identity()) {
  scene::SceneDescription description;
  description.scan_from_grid = scan_from_grid;
  description.levels = {layers.grid.lattice};
  description.has_colour = !layers.colour_rgba.empty();
  std::vector<scene::Layers> levels;
  levels.push_back(std::move(layers));
  return scene::make_scene(std::move(description), std::move(levels));
}

void save(const scene::Scene& scene, const fs::path& file, bool nodes_only = false) {
  Progress progress;
  export_scene(scene, file, nodes_only, progress);
}

/// A similarity with every part in it: turned, scaled, moved to UTM.
Eigen::Matrix4d utm_pose() {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = 0.5 * (Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized())).toRotationMatrix();
  m.topRightCorner<3, 1>() = Eigen::Vector3d(450000.0, 5412000.0, 300.0);
  return m;
}

Mesh read_mesh(const fs::path& file) {
  if (file.extension() == ".ply") return test::read_ply(file);
  return file.extension() == ".obj" ? test::read_obj(file) : test::read_xyz(file);
}

TEST_F(Export, MeshesPutAnImpulseWhereTheScanHasIt) {
  const Eigen::Vector3d origin(0.3, -0.2, 1.5);
  for (const Eigen::Matrix4d& pose : {Eigen::Matrix4d(Eigen::Matrix4d::Identity()), utm_pose()}) {
    const scene::ScenePointer scene = scene_of(impulse(90, 61, origin), pose);
    const Eigen::Vector4d at = pose * Eigen::Vector4d(0.3 + kImpulseI * 0.002, -0.2 + kImpulse_j * 0.002,
                                                      1.5 + static_cast<float>(kHigh), 1.0);
    for (const char* name : {"mesh.ply", "mesh.obj", "points.xyz"}) {
      save(*scene, out(name));
      const Mesh mesh = read_mesh(out(name));
      ASSERT_EQ(mesh.vertices.size(), 90U * 61U) << name;
      // The node that stands out is the one farthest from the others' common plane: compare heights in the grid frame.
      const Eigen::Matrix4d grid_from_scan = pose.inverse();
      double highest = -1.0;
      Eigen::Vector3d found = Eigen::Vector3d::Zero();
      for (const auto& v : mesh.vertices) {
        const double z = (grid_from_scan * Eigen::Vector4d(v[0], v[1], v[2], 1.0)).z();
        if (z > highest) {
          highest = z;
          found = {v[0], v[1], v[2]};
        }
      }
      // Two ulp of the largest coordinate.
      EXPECT_LE((found - at.head<3>()).norm(), 2.0 * 5412000.0 * 2.3e-16 * (pose(0, 3) > 0 ? 1.0 : 1e-6)) << name;
    }
  }
}

TEST_F(Export, RastersPutAnImpulseIntoItsPixelAndTheWorldFilePutsThePixelBack) {
  const Eigen::Vector3d origin(0.3, -0.2, 1.5);
  Eigen::Matrix4d pose = Eigen::Matrix4d::Identity();
  pose.topRightCorner<3, 1>() = Eigen::Vector3d(100.0, 200.0, 10.0);
  const scene::ScenePointer scene = scene_of(impulse(300, 270, origin), pose);
  for (const char* name : {"heights.tif", "heights.png"}) {
    save(*scene, out(name));
    const bool tif = out(name).extension() == ".tif";
    const Raster raster = tif ? test::read_tif(out(name)) : test::read_png(out(name));
    ASSERT_EQ(raster.width, 300U);
    ASSERT_EQ(raster.height, 270U);
    EXPECT_EQ(raster.bits, tif ? 32 : 16);
    const auto row = static_cast<std::uint32_t>(270 - 1 - kImpulse_j);
    const auto highest = std::max_element(raster.z.begin(), raster.z.end());
    EXPECT_EQ(static_cast<std::size_t>(highest - raster.z.begin()), row * 300U + kImpulseI) << name;
    EXPECT_NEAR(*highest, 11.5 + kHigh, 1e-6) << name;  // half an ulp of float32 at 12 m; a PNG step is 4e-7 m
    EXPECT_NEAR(raster.at(0, 0), 11.5, 1e-6) << name;
    EXPECT_NEAR(raster.c + raster.a * kImpulseI, 100.3 + kImpulseI * 0.002, 1e-9) << name;
    EXPECT_NEAR(raster.f + raster.e * row, 199.8 + kImpulse_j * 0.002, 1e-9) << name;
    EXPECT_LT(raster.e, 0.0);
  }
}

TEST_F(Export, ARasterOfATurnedSceneStaysInTheGridFrameAndSaysSo) {
  const scene::ScenePointer scene = scene_of(impulse(60, 50, {0.3, -0.2, 1.5}), utm_pose());
  Progress progress;
  export_scene(*scene, out("heights.tif"), false, progress);
  const Raster raster = test::read_tif(out("heights.tif"));
  EXPECT_NEAR(raster.at(0, 0), 1.5, 1e-6);
  EXPECT_NEAR(raster.c, 0.3, 1e-12);
  EXPECT_NEAR(raster.f, -0.2 + 49 * 0.002, 1e-12);
  ASSERT_EQ(progress.warnings().size(), 1U);
}

TEST_F(Export, HeightsBeyondAKilometreAreWrittenInDoublePrecision) {
  const scene::ScenePointer scene = scene_of(impulse(60, 50, {0.0, 0.0, 5412000.0}));
  save(*scene, out("heights.tif"));
  const Raster raster = test::read_tif(out("heights.tif"));
  EXPECT_EQ(raster.bits, 64);
  EXPECT_NEAR(raster.at(kImpulseI, 49 - kImpulse_j) - raster.at(0, 0), kHigh, 1e-8);
}

TEST_F(Export, UnknownNodesAreNaNInTiffAndZeroInPngAndAbsentFromMeshes) {
  scene::Layers layers = impulse(40, 30, Eigen::Vector3d::Zero());
  layers.grid.height_m[layers.grid.lattice.index(20, 10)] = scene::kUnknownHeight;
  layers.grid.state[layers.grid.lattice.index(20, 10)] = scene::NodeState::unknown;
  layers.grid.state[layers.grid.lattice.index(5, 6)] = scene::NodeState::filled;
  const scene::ScenePointer scene = scene_of(std::move(layers));
  save(*scene, out("a.tif"));
  save(*scene, out("a.png"));
  save(*scene, out("a.ply"));
  save(*scene, out("nodes.ply"), true);
  const Raster tif = test::read_tif(out("a.tif"));
  const Raster png = test::read_png(out("a.png"));
  EXPECT_TRUE(std::isnan(tif.at(20, 19)));
  EXPECT_TRUE(std::isnan(png.at(20, 19)));
  EXPECT_EQ(std::count_if(png.z.begin(), png.z.end(), [](double z) { return std::isnan(z); }), 1);
  EXPECT_NE(tif.description.find("nan"), std::string::npos);
  EXPECT_NE(png.description.find("metres"), std::string::npos);
  const Mesh mesh = test::read_ply(out("a.ply"));
  EXPECT_EQ(mesh.vertices.size(), 40U * 30U - 1U);
  EXPECT_EQ(mesh.faces.size(), 2U * (39U * 29U - 4U)) << "four cells touch the unknown node";
  const Mesh nodes = test::read_ply(out("nodes.ply"));
  EXPECT_EQ(nodes.vertices.size(), 40U * 30U - 2U) << "the filled node is not measured";
  EXPECT_TRUE(nodes.faces.empty());
}

TEST_F(Export, MeshesHaveNoVertexThatNoFaceHas) {
  // A node alone, a row of nodes, and three corners of a cell, beside a surface of several bands of rows.
  scene::Layers layers = impulse(60, 600, Eigen::Vector3d::Zero());
  const auto forget = [&](int i, int j) {
    layers.grid.height_m[layers.grid.lattice.index(i, j)] = scene::kUnknownHeight;
    layers.grid.state[layers.grid.lattice.index(i, j)] = scene::NodeState::unknown;
  };
  for (int j = 0; j < 600; ++j)
    for (int i = 40; i < 60; ++i) {
      const bool alone = i == 50 && j == 255, row = j == 512 && i > 44, corners = (i == 47 || i == 48) && (j == 300);
      if (!alone && !row && !corners && !(i == 47 && j == 301)) forget(i, j);
    }
  forget(0, 1);
  forget(1, 1);
  forget(1, 0);  // the corner (0, 0) stands alone
  const scene::ScenePointer scene = scene_of(std::move(layers));
  for (const char* name : {"mesh.ply", "mesh.obj"}) {
    save(*scene, out(name));
    const Mesh mesh = read_mesh(out(name));
    std::vector<int> used(mesh.vertices.size(), 0);
    for (const auto& face : mesh.faces)
      for (const auto corner : face) used.at(static_cast<std::size_t>(corner)) = 1;
    EXPECT_EQ(std::count(used.begin(), used.end(), 0), 0) << name;
    EXPECT_EQ(mesh.vertices.size(), 40U * 600U - 4U) << name;
    EXPECT_EQ(mesh.faces.size(), 2U * (39U * 599U - 4U)) << name;
  }
  save(*scene, out("points.xyz"));
  EXPECT_EQ(read_mesh(out("points.xyz")).vertices.size(), 40U * 600U - 3U + 1U + 15U + 3U)
      << "points are all known nodes";
}

TEST_F(Export, AScenesNodesWithoutAnyFaceAreWrittenAlone) {
  scene::Layers layers = impulse(50, 50, Eigen::Vector3d::Zero());
  for (int j = 0; j < 50; ++j)
    for (int i = 0; i < 50; ++i)
      if (i % 2 == 1) layers.grid.state[layers.grid.lattice.index(i, j)] = scene::NodeState::unknown;
  const scene::ScenePointer scene = scene_of(std::move(layers));
  save(*scene, out("mesh.ply"));
  const Mesh mesh = read_mesh(out("mesh.ply"));
  EXPECT_EQ(mesh.vertices.size(), 25U * 50U);
  EXPECT_TRUE(mesh.faces.empty());
}

TEST_F(Export, NodesWithoutAColourAreWhiteAmongColouredOnes) {
  scene::Layers layers = impulse(50, 10, Eigen::Vector3d::Zero());
  layers.colour_rgba.assign(layers.grid.lattice.count(), 0xFF0000FFU);
  layers.colour_rgba[123] = 0U;
  save(*scene_of(std::move(layers)), out("a.obj"));
  std::ifstream file(out("a.obj"));
  std::size_t red = 0;
  std::size_t white = 0;
  for (std::string line; std::getline(file, line);) {
    red += line.ends_with(" 1.0000 0.0000 0.0000") ? 1 : 0;
    white += line.ends_with(" 1.0000 1.0000 1.0000") ? 1 : 0;
  }
  EXPECT_EQ(red, 499U);
  EXPECT_EQ(white, 1U);
}

/// Sum of the faces' vector areas.
Eigen::Vector3d vector_area(const Mesh& mesh) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& face : mesh.faces) {
    std::array<Eigen::Vector3d, 3> p;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& v = mesh.vertices.at(face[k]);
      p[k] = {v[0], v[1], v[2]};
    }
    sum += 0.5 * (p[1] - p[0]).cross(p[2] - p[0]);
  }
  return sum;
}

TEST_F(Export, FacesCoverEveryKnownCellOnceAndLookAtTheViewer) {
  Eigen::Matrix4d mirrored = Eigen::Matrix4d::Identity();
  mirrored(0, 0) = -1.0;  // a mirror turns the order of the corners round
  for (const Eigen::Matrix4d& pose : {Eigen::Matrix4d(Eigen::Matrix4d::Identity()), mirrored}) {
    // More than one band of rows.
    const scene::ScenePointer scene = scene_of(impulse(50, 300, {0.1, 0.2, 0.3}), pose);
    for (const char* name : {"mesh.ply", "mesh.obj"}) {
      save(*scene, out(name));
      const Mesh mesh = read_mesh(out(name));
      EXPECT_EQ(mesh.faces.size(), 2U * 49U * 299U);
      const Eigen::Vector3d area = vector_area(mesh);
      const double cells = 49.0 * 299.0 * 0.002 * 0.002;
      EXPECT_NEAR(area.x(), 0.0, 1e-12 * 49 * 299) << name;
      EXPECT_NEAR(area.y(), 0.0, 1e-12 * 49 * 299) << name;
      EXPECT_NEAR(area.z(), cells, 1e-9 * cells) << name;
    }
  }
}

TEST_F(Export, EveryVertexOfEveryMeshFormatIsTheSameAndExact) {
  scene::Layers layers;
  layers.grid = scene::DepthGrid(scene::Lattice{33, 21, 0.0013, {0.123456789, -7.5, 2.0}});
  for (std::size_t k = 0; k < layers.grid.height_m.size(); ++k) {
    layers.grid.height_m[k] = static_cast<float>(std::sin(0.37 * static_cast<double>(k)) * 0.01);
    layers.grid.state[k] = scene::NodeState::measured;
    layers.colour_rgba.push_back(0xFF000000U | static_cast<std::uint32_t>(k) << 8U | 0x21U);
  }
  const scene::Layers copy = layers;
  const scene::ScenePointer scene = scene_of(std::move(layers));
  for (const char* name : {"a.ply", "a.obj", "a.xyz"}) save(*scene, out(name));
  const Mesh ply = read_mesh(out("a.ply"));
  const Mesh obj = read_mesh(out("a.obj"));
  const Mesh xyz = read_mesh(out("a.xyz"));
  EXPECT_EQ(ply.vertices, obj.vertices);
  EXPECT_EQ(ply.vertices, xyz.vertices);
  EXPECT_EQ(ply.faces, obj.faces);
  for (int j = 0; j < 21; ++j) {
    for (int i = 0; i < 33; ++i) {
      const std::size_t k = copy.grid.lattice.index(i, j);
      EXPECT_EQ(ply.vertices[k][0], 0.123456789 + i * 0.0013);
      EXPECT_EQ(ply.vertices[k][1], -7.5 + j * 0.0013);
      EXPECT_EQ(ply.vertices[k][2], 2.0 + static_cast<double>(copy.grid.height_m[k]));
      EXPECT_EQ(ply.colours[k][0], 0x21);
      EXPECT_EQ(ply.colours[k][1], k & 0xFFU);
    }
  }
}

TEST_F(Export, AnotherEndingAndNodesOfARasterAreUsageErrorsAndWriteNothing) {
  const scene::ScenePointer scene = scene_of(impulse(60, 50, Eigen::Vector3d::Zero()));
  const auto kind_of = [&](const std::string& name, bool nodes_only) {
    try {
      save(*scene, out(name), nodes_only);
    } catch (const Error& error) {
      return error.kind();
    }
    return ErrorKind::failure;
  };
  EXPECT_EQ(kind_of("mesh.stl", false), ErrorKind::usage);
  EXPECT_EQ(kind_of("mesh", false), ErrorKind::usage);
  EXPECT_EQ(kind_of("a.tif", true), ErrorKind::usage);
  EXPECT_EQ(kind_of("a.png", true), ErrorKind::usage);
  EXPECT_TRUE(fs::is_empty(out("")));
  EXPECT_THROW(save(*scene, out("no/such/folder/a.ply")), Error);
}

TEST_F(Export, ACancelledExportKeepsTheOldFileAndLeavesNoOther) {
  const scene::ScenePointer scene = scene_of(impulse(90, 61, Eigen::Vector3d::Zero()));
  std::ofstream(out("mesh.ply")) << "old";
  std::ofstream(out("heights.png")) << "old";
  for (const char* name : {"mesh.ply", "heights.png"}) {
    Progress progress;
    progress.cancel();
    EXPECT_THROW(export_scene(*scene, out(name), false, progress), Cancelled);
    EXPECT_EQ(fs::file_size(out(name)), 3U);
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(out("")), fs::directory_iterator()), 2);
}

}  // namespace
}  // namespace sparsha::pipeline
