// Scenes on disk: the same values, the same bytes, movable folders, damaged ones refused.
#include "scene/scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>

#include "base/error.h"
#include "base/files/files.h"
#include "scene/folder/layer_file.h"
#include "tests/support/test_folder.h"

namespace sparsha::scene {
namespace {
namespace fs = std::filesystem;

Lattice lattice(int nx, int ny, double spacing) {
  Lattice result;
  result.nx = nx;
  result.ny = ny;
  result.spacing_m = spacing;
  result.origin_m = {450000.1, 5412000.2, 312.3};
  return result;
}

Layers layers_of(const Lattice& l) {
  Layers layers;
  layers.grid = DepthGrid(l);
  for (int j = 0; j < l.ny; ++j) {
    for (int i = 0; i < l.nx; ++i) {
      const std::size_t n = l.index(i, j);
      if ((i + j) % 7 == 0) continue;
      layers.grid.height_m[n] = static_cast<float>(i) + 0.001F * static_cast<float>(j);
      layers.grid.state[n] = (i + j) % 5 == 0 ? NodeState::filled : NodeState::measured;
    }
  }
  layers.envelope_m = layers.grid.height_m;
  layers.curvature_per_m.assign(l.count(), 3.5F);
  layers.colour_rgba.assign(l.count(), 0xFF102030U);
  return layers;
}

SceneDescription description_of() {
  SceneDescription scene;
  ScanConfig scan;
  scan.file = "elsewhere/a.ply";
  scene.config.scans = {scan};
  scene.config.texture = TextureConfig{};
  scene.config.friction = FrictionConfig{};
  scene.sources = {{scan.file, std::string(64, 'a'), 1234}};
  scene.levels = {lattice(300, 270, 0.01), lattice(150, 135, 0.02)};
  scene.noise_m = 0.0002;
  scene.height_min_m = 312.0;
  scene.height_max_m = 612.0;
  scene.friction_c_m = 0.0123;
  scene.has_envelope = scene.has_curvature = scene.has_colour = true;
  return scene;
}

bool same(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

class SceneFolder : public ::testing::Test {
 protected:
  void SetUp() override {
    const SceneDescription description = description_of();
    memory_ = make_scene(description, {layers_of(description.levels[0]), layers_of(description.levels[1])});
    write_scene(*memory_, folder_);
  }
  const test::TestFolder folder_;
  ScenePointer memory_;
};

TEST_F(SceneFolder, ReadsBackEveryLayerBitForBit) {
  const ScenePointer disk = open_scene(folder_);
  const SceneDescription& d = disk->description();
  EXPECT_EQ(d.levels[1].nx, 150);
  EXPECT_EQ(d.levels[0].origin_m, memory_->description().levels[0].origin_m);
  EXPECT_EQ(d.friction_c_m, 0.0123);
  EXPECT_EQ(d.sources[0].points, 1234U);
  EXPECT_EQ(d.sources[0].sha256, std::string(64, 'a'));
  for (int level = 0; level < 2; ++level) {
    const Layers a = memory_->read_level(level);
    const Layers b = disk->read_level(level);
    EXPECT_TRUE(same(a.grid.height_m, b.grid.height_m));
    EXPECT_EQ(a.grid.state, b.grid.state);
    EXPECT_TRUE(same(a.envelope_m, b.envelope_m));
    EXPECT_TRUE(same(a.curvature_per_m, b.curvature_per_m));
    EXPECT_EQ(a.colour_rgba, b.colour_rgba);
    EXPECT_TRUE(b.intensity.empty());
  }
}

TEST_F(SceneFolder, AWindowEqualsThatPartOfTheLevelAndIsUnknownOutside) {
  const ScenePointer disk = open_scene(folder_);
  const Layers whole = disk->read_level(0);
  for (const ScenePointer& scene : {disk, memory_}) {
    const Layers window = scene->read(0, 250, -3, 80, 20);
    EXPECT_NEAR(window.grid.lattice.origin_m.x(), 450000.1 + 2.5, 1e-9);
    for (int j = 0; j < 20; ++j) {
      for (int i = 0; i < 80; ++i) {
        const std::size_t n = window.grid.lattice.index(i, j);
        const int li = i + 250;
        const int lj = j - 3;
        if (li >= 300 || lj < 0) {
          EXPECT_TRUE(std::isnan(window.grid.height_m[n]));
          EXPECT_EQ(window.grid.state[n], NodeState::unknown);
        } else {
          const float expected = whole.grid.height_m[whole.grid.lattice.index(li, lj)];
          EXPECT_EQ(std::memcmp(&window.grid.height_m[n], &expected, 4), 0);
        }
      }
    }
  }
}

TEST_F(SceneFolder, TheSameSceneGivesTheSameBytesAndCanBeMoved) {
  const fs::path other = folder_.path().string() + "-moved";
  fs::remove_all(other);
  fs::create_directories(other);
  write_scene(*memory_, other);
  for (const auto& entry : fs::recursive_directory_iterator(folder_)) {
    if (!entry.is_regular_file()) continue;
    const fs::path twin = other / entry.path().lexically_relative(folder_);
    EXPECT_EQ(read_file(entry.path(), 1U << 30U), read_file(twin, 1U << 30U)) << twin;
  }
  fs::remove_all(folder_);
  fs::rename(other, folder_);
  EXPECT_EQ(open_scene(folder_)->read_level(1).grid.state, memory_->read_level(1).grid.state);
}

TEST_F(SceneFolder, TheTopRowComesFirstInTheFile) {
  const Lattice& base = memory_->description().levels[0];
  std::ifstream world(folder_ / "level-0" / "height.tfw");
  double a = 0, d = 0, b = 0, e = 0, c = 0, f = 0;
  world >> a >> d >> b >> e >> c >> f;
  EXPECT_EQ(a, base.spacing_m);
  EXPECT_EQ(e, -base.spacing_m);
  EXPECT_EQ(c, base.x_m(0));  // the centre of the top-left pixel is node (0, ny-1)
  EXPECT_EQ(f, base.y_m(base.ny - 1));
  // Uncompressed tiles follow the header: the file holds the top-left node's float before the bottom-left one's.
  std::vector<float> row(300);
  read_layer(folder_ / "level-0" / "height.tif", {300, 270, 0, 269, 300, 1}, std::span<float>(row));
  EXPECT_EQ(row[1], 1.0F + 0.001F * 269.0F);
}

TEST_F(SceneFolder, RefusesADamagedFolderWithTheFileThatIsWrong) {
  const auto message = [&] {
    try {
      (void)open_scene(folder_)->read_level(0);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      return std::string(error.what());
    }
    return std::string("no error");
  };
  fs::resize_file(folder_ / "level-0" / "height.tif", 1000);
  EXPECT_THAT(message(), ::testing::HasSubstr("height.tif"));
  fs::remove(folder_ / "level-0" / "height.tif");
  EXPECT_THAT(message(), ::testing::HasSubstr("the layer is missing"));
  std::string yaml = read_file(folder_ / "scene.yaml", 1U << 20U);
  yaml.replace(yaml.find("nx: 300"), 7, "nx: 301");
  write_file(folder_ / "scene.yaml", yaml);
  EXPECT_THAT(message(), ::testing::HasSubstr("the layer is missing"));
  write_file(folder_ / "scene.yaml", "scans: [");
  EXPECT_THAT(message(), ::testing::HasSubstr("scene.yaml:1"));
  fs::remove(folder_ / "scene.yaml");
  EXPECT_THAT(message(), ::testing::HasSubstr("there is no scene.yaml"));
}

TEST_F(SceneFolder, AHeightBeyondTheRangeOfItsDescriptionIsRefusedByItsNode) {
  const fs::path file = folder_ / "level-0" / "height.tif";
  for (const float wrong : {1e20F, -1e9F, -0.5F}) {
    std::vector<float> heights = memory_->read_level(0).grid.height_m;
    heights[memory_->description().levels[0].index(12, 34)] = wrong;
    write_layer(file, 300, 270, std::span<const float>(heights));
    const ScenePointer scene = open_scene(folder_);
    try {
      (void)scene->read(0, 5, 30, 20, 20);
      FAIL() << wrong << " was taken";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      EXPECT_EQ(error.place().file, file.string());
      EXPECT_THAT(error.what(), ::testing::HasSubstr("node (12, 34) lies at z = "));
    }
    EXPECT_NO_THROW((void)scene->read(0, 13, 30, 20, 20)) << "the damaged node is not among these";
  }
}

TEST_F(SceneFolder, ALayerOfACoarseLevelThatIsMissingOrCutIsRefusedWhenTheSceneIsOpened) {
  for (const char* name : {"mask", "envelope", "curvature", "colour"}) {
    const fs::path file = folder_ / "level-1" / (std::string(name) + ".tif");
    const std::string whole = read_file(file, 1U << 30U);
    for (const std::size_t kept : {std::size_t{0}, whole.size() / 2}) {
      write_file(file, whole.substr(0, kept));
      if (kept == 0) fs::remove(file);
      try {
        (void)open_scene(folder_);
        ADD_FAILURE() << name << " with " << kept << " bytes was taken";
      } catch (const Error& error) {
        EXPECT_EQ(error.place().file, file.string());
      }
    }
    write_file(file, whole);
  }
  EXPECT_NO_THROW((void)open_scene(folder_));
}

TEST(Scene, ARangeOfHeightsThatIsNotGivenIsThatOfTheKnownNodes) {
  SceneDescription description = description_of();
  description.height_min_m = description.height_max_m = 0.0;
  const ScenePointer scene =
      make_scene(description, {layers_of(description.levels[0]), layers_of(description.levels[1])});
  EXPECT_NEAR(scene->description().height_min_m, 312.3 + 0.001, 1e-9);  // node (0, 1)
  EXPECT_NEAR(scene->description().height_max_m, 312.3 + 299.269, 1e-4);
}

TEST_F(SceneFolder, ASceneOfANewerFormatIsRefusedByNameAndOneOfThisOpens) {
  EXPECT_NO_THROW((void)open_scene(folder_));
  std::string yaml = read_file(folder_ / "scene.yaml", 1U << 20U);
  const std::string version = "scene:\n  version: 1\n";
  yaml.replace(yaml.find(version), version.size(), "scene:\n  version: 2\n");
  write_file(folder_ / "scene.yaml", yaml);
  try {
    (void)open_scene(folder_);
    FAIL() << "it was opened";
  } catch (const Error& error) {
    EXPECT_EQ(error.place().file, (folder_ / "scene.yaml").string());
    EXPECT_THAT(error.what(), ::testing::HasSubstr("scene format 2, which a newer version of sparsha wrote"));
  }
}

TEST_F(SceneFolder, ALevelWhoseSizeIsNotItsLayersIsRefused) {
  std::string yaml = read_file(folder_ / "scene.yaml", 1U << 20U);
  yaml.replace(yaml.find("nx: 300"), 7, "nx: 301");
  write_file(folder_ / "scene.yaml", yaml);
  EXPECT_THROW((void)open_scene(folder_)->read_level(0), Error);
}

TEST(Scene, LayersThatDoNotMatchTheDescriptionAreRefused) {
  SceneDescription description = description_of();
  std::vector<Layers> levels = {layers_of(description.levels[0]), layers_of(description.levels[1])};
  levels[1].envelope_m.pop_back();
  EXPECT_THROW((void)make_scene(description, levels), Error);
  EXPECT_THROW((void)make_scene(description, {}), Error);
}

TEST(LayerFile, HeightsBeyondAKilometreAreKeptInDoublePrecision) {
  const test::TestFolder folder;
  const fs::path file = folder / "wide.tif";
  const std::vector<float> values = {1500.25F, -2.5F, 3.0F, kUnknownHeight};
  write_layer(file, 2, 2, std::span<const float>(values));
  std::vector<float> back(4);
  read_layer(file, {2, 2, 0, 0, 2, 2}, std::span<float>(back));
  EXPECT_EQ(std::memcmp(values.data(), back.data(), 12), 0);
  EXPECT_TRUE(std::isnan(back[3]));
  EXPECT_GT(fs::file_size(file), kTileSize * kTileSize * 8U);
}

}  // namespace
}  // namespace sparsha::scene
