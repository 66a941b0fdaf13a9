// A scene's folder among other files: what may be replaced, and which files a scene may name.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "base/error.h"
#include "base/files/files.h"
#include "scene/folder/folder.h"
#include "scene/scene.h"
#include "tests/support/test_folder.h"

namespace sparsha::scene {
namespace {
namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

class SceneAmongFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    write_file(folder_ / "strike.wav", "a strike");
    write_file(folder_ / "scan.ply", "a scan");
    write_file(folder_ / "secret", "nobody's business");
    fs::create_directories(scene());
    write_scene(*make_scene(description(), {layers()}), scene());
  }
  [[nodiscard]] fs::path scene() const { return folder_ / "scene"; }
  [[nodiscard]] SceneDescription description() const {
    SceneDescription scene;
    ScanConfig scan;
    scan.file = folder_ / "scan.ply";
    scene.config.scans = {scan};
    AudioRegionConfig region;
    region.name = "pillar";
    region.box_m = {0.0, 0.0, 1.0, 1.0};
    region.sound = folder_ / "strike.wav";
    scene.config.audio = AudioConfig{};
    scene.config.audio->regions = {region, region};
    scene.sources = {{scan.file, sha256_of("a scan"), 6}};
    Lattice lattice;
    lattice.nx = 5;
    lattice.ny = 4;
    lattice.spacing_m = 0.1;
    scene.levels = {lattice};
    return scene;
  }
  [[nodiscard]] static Layers layers() {
    Layers layers;
    Lattice lattice;
    lattice.nx = 5;
    lattice.ny = 4;
    lattice.spacing_m = 0.1;
    layers.grid = DepthGrid(lattice);
    return layers;
  }
  static std::string sha256_of(std::string_view text) {
    return sha256(std::as_bytes(std::span<const char>(text.data(), text.size())));
  }
  void replace_in_description(const std::string& from, const std::string& to) const {
    std::string yaml = read_file(scene() / "scene.yaml", 1U << 20U);
    for (std::size_t at = yaml.find(from); at != std::string::npos; at = yaml.find(from, at + to.size())) {
      yaml.replace(at, from.size(), to);
    }
    write_file(scene() / "scene.yaml", yaml);
  }
  static std::string message_of(const std::function<void()>& work, ErrorKind kind) {
    try {
      work();
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), kind);
      return error.what();
    }
    return "no error";
  }
  [[nodiscard]] std::string refusal(const Config& config = {}) const {
    return message_of([&] { require_replaceable(scene(), config); }, ErrorKind::usage);
  }

  const test::TestFolder folder_;
};

TEST_F(SceneAmongFiles, OneThatSparshaWroteMayBeReplacedAndSoMayNothingAndAnEmptyFolder) {
  EXPECT_EQ(refusal(), "no error");
  EXPECT_NO_THROW(require_replaceable(folder_ / "new", {}));
  fs::create_directories(folder_ / "empty");
  EXPECT_NO_THROW(require_replaceable(folder_ / "empty", {}));
}

TEST_F(SceneAmongFiles, ForeignFilesInItAreNamedWhereverTheyStand) {
  const std::vector<fs::path> places = {"notes.txt",    "level-0/notes.txt",         "audio/mine.wav",
                                        "photos/a.jpg", "level-0/deeper/height.tif", "level-x/height.tif",
                                        "holiday.png"};
  for (const fs::path& place : places) {
    fs::create_directories((scene() / place).parent_path());
    write_file(scene() / place, "precious");
    const std::string top = place.begin()->string();
    const bool whole_folder = top == "photos" || top == "level-x";
    EXPECT_THAT(refusal(), HasSubstr(whole_folder ? top : place == places[4] ? "level-0/deeper" : place.string()));
    fs::remove(scene() / place);
    if (whole_folder) fs::remove(scene() / top);
    if (place == places[4]) fs::remove(scene() / "level-0" / "deeper");
    EXPECT_EQ(refusal(), "no error");
  }
  fs::create_symlink(folder_ / "secret", scene() / "report.html");
  EXPECT_THAT(refusal(), HasSubstr("report.html"));
}

TEST_F(SceneAmongFiles, AHandWrittenSceneYamlMakesNoScene) {
  write_file(scene() / "scene.yaml", "scans: [{file: scan.ply}]\n");
  EXPECT_THAT(refusal(), HasSubstr("sparsha build did not write"));
  write_file(scene() / "scene.yaml", "scans: [");
  EXPECT_THAT(refusal(), HasSubstr("cannot be read"));
  fs::remove(scene() / "scene.yaml");
  EXPECT_THAT(refusal(), HasSubstr("something else than a scene"));
}

TEST_F(SceneAmongFiles, NeitherALinkNorAFolderThatHoldsAScanOfTheBuildIsReplaced) {
  fs::create_directory_symlink(scene(), folder_ / "link");
  for (const char* name : {"link", "link/"}) {
    EXPECT_THAT(message_of([&] { require_replaceable(folder_ / name, {}); }, ErrorKind::usage),
                HasSubstr("symbolic link"));
  }
  Config config;
  ScanConfig scan;
  write_file(scene() / "scan.ply", "a scan");
  scan.file = folder_ / "link" / "scan.ply";
  config.scans = {scan};
  EXPECT_THAT(refusal(config), AllOf(HasSubstr("scan.ply"), HasSubstr("lies in the folder")));
  EXPECT_THAT(message_of([&] { require_replaceable(folder_ / "secret", {}); }, ErrorKind::usage),
              HasSubstr("is no folder"));
}

TEST_F(SceneAmongFiles, ItsOwnClipsAreOneCopyEachAndKeepTheirNamesWhenItIsWrittenAgain) {
  EXPECT_TRUE(fs::exists(scene() / "audio" / "0-strike.wav"));
  EXPECT_EQ(std::distance(fs::directory_iterator(scene() / "audio"), fs::directory_iterator()), 1);
  SceneDescription again = description();
  again.config.audio = open_scene(scene())->description().config.audio;
  fs::create_directories(folder_ / "again");
  write_scene(*make_scene(again, {layers()}), folder_ / "again");
  EXPECT_EQ(read_file(folder_ / "again" / "scene.yaml", 1U << 20U), read_file(scene() / "scene.yaml", 1U << 20U));
  EXPECT_EQ(read_file(folder_ / "again" / "audio" / "0-strike.wav", 100), "a strike");
}

TEST_F(SceneAmongFiles, AClipOrALayerOutsideIsRefusedUnlessTheSceneIsTrusted) {
  const auto refused = [&](const char* what) {
    EXPECT_THAT(message_of([&] { static_cast<void>(open_scene(scene())); }, ErrorKind::input),
                AllOf(HasSubstr(what), HasSubstr("outside the scene's folder"), HasSubstr("--trust")));
    EXPECT_NO_THROW(static_cast<void>(open_scene(scene(), Trust::any_file)));
  };
  const std::string description = read_file(scene() / "scene.yaml", 1U << 20U);
  for (const std::string& clip :
       {std::string("../secret"), (folder_ / "secret").string(), std::string("a/../../secret")}) {
    replace_in_description("audio/0-strike.wav", clip);
    refused("the clip");
    write_file(scene() / "scene.yaml", description);
  }
  fs::remove(scene() / "audio" / "0-strike.wav");
  fs::create_symlink(folder_ / "secret", scene() / "audio" / "0-strike.wav");
  refused("the clip");
  fs::remove(scene() / "audio" / "0-strike.wav");

  fs::rename(scene() / "level-0" / "height.tif", folder_ / "height.tif");
  fs::create_symlink(folder_ / "height.tif", scene() / "level-0" / "height.tif");
  refused("the layer");
  fs::remove(scene() / "level-0" / "height.tif");
  fs::rename(folder_ / "height.tif", scene() / "level-0" / "height.tif");
  fs::rename(scene() / "level-0", folder_ / "level-0");
  fs::create_directory_symlink(folder_ / "level-0", scene() / "level-0");
  refused("the layer");
  fs::remove(scene() / "level-0");
  fs::rename(folder_ / "level-0", scene() / "level-0");
  fs::rename(scene() / "scene.yaml", folder_ / "scene.yaml");
  fs::create_symlink(folder_ / "scene.yaml", scene() / "scene.yaml");
  refused("the description");
}

TEST_F(SceneAmongFiles, AScanOutsideIsReadWhenItIsTheOneTheSceneWasMadeFromAndNoOther) {
  const auto check = [&] {
    const ScenePointer opened = open_scene(scene());
    require_own_scans(opened->description(), opened->folder());
  };
  EXPECT_NO_THROW(check());
  replace_in_description("scan.ply", "secret");
  const std::string message = message_of(check, ErrorKind::input);
  EXPECT_THAT(message, AllOf(HasSubstr("secret"), HasSubstr("--trust")));
  EXPECT_THAT(message, ::testing::Not(HasSubstr("nobody's business")));
  write_file(scene() / "inside.ply", "another scan");
  replace_in_description("../secret", "inside.ply");
  EXPECT_NO_THROW(check()) << "its own folder is the stranger's own business";
  replace_in_description("inside.ply", "/dev/zero");
  EXPECT_THAT(message_of(check, ErrorKind::input), HasSubstr("no file"));
}

TEST_F(SceneAmongFiles, SizesThatTheLayersDoNotHaveAreRefusedBeforeMemoryIsTaken) {
  replace_in_description("nx: 5, ny: 4",
                         "nx: 16000000, ny: 16000000");  // 10^15 bytes, did it come to that
  EXPECT_THAT(message_of([&] { static_cast<void>(open_scene(scene())); }, ErrorKind::input), HasSubstr("height.tif"));
  replace_in_description("nx: 16000000, ny: 16000000", "nx: 5, ny: 4");
  const ScenePointer opened = open_scene(scene());
  fs::resize_file(scene() / "level-0" / "mask.tif", 300);
  EXPECT_THROW(static_cast<void>(opened->read_level(0)), Error);
}

}  // namespace
}  // namespace sparsha::scene
