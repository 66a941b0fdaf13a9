// From raw scans by way of an orientation to a scene, and back into a configuration.
#include "app/raw_scans/depth_scans.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <random>
#include <thread>

#include <fmt/format.h>

#include "app/exploration/edited_parts.h"
#include "base/files/files.h"
#include "pipeline/build/build.h"
#include "scene/area/regions.h"
#include "scene/folder/folder.h"
#include "tests/support/part_scenes.h"
#include "tests/support/test_folder.h"
#include "tests/support/wait.h"
#include "viewer/cloud/orientation.h"
#include "viewer/cloud/preview.h"

namespace sparsha::app {
namespace {

namespace fs = std::filesystem;

void finish(const DepthScans& scans) {
  test::wait_until([&] { return !scans.status().busy; });
}

/// A plate in the plane of x and z, seen from -y, with a bump on its right half; text with comments.
void write_plate(const fs::path& file, double unit = 1.0) {
  std::ofstream out(file);
  for (int i = 0; i < 160; ++i)
    for (int k = 0; k < 120; ++k) {
      const double x = 0.002 * i, z = 0.002 * k;
      const double bump = 0.02 * std::exp(-(std::pow(x - 0.24, 2) + std::pow(z - 0.12, 2)) / 0.0008);
      out << x / unit << ' ' << -bump / unit << ' ' << z / unit << '\n';
    }
}

const char* const kConfig = R"(# The plate of the test.
scans:
  - file: plate.xyz   # one station
    units: m
orientation: {look_from: [0, -1, 0], up: [0, 0, 1]}  # from the front
grid: {spacing_mm: 2}
parts:
  - {name: bump, say: "The bump", box_m: [0.2, 0.08, 0.28, 0.16]}  # right
)";

struct Plate {
  test::TestFolder folder;
  fs::path config = folder.path() / "plate.yaml";
  Plate() {
    write_plate(folder.path() / "plate.xyz");
    write_file(config, kConfig);
  }
  [[nodiscard]] scene::ScenePointer build() const {
    Progress progress;
    return pipeline::build_scene(scene::load_config(config), {}, progress).scene;
  }
};

/// The name of the part at the highest node of the scene.
std::string part_at_summit(const scene::Scene& scene) {
  const scene::Layers layers = scene.read_level(0);
  std::size_t best = 0;
  for (std::size_t n = 0; n < layers.grid.height_m.size(); ++n)
    if (layers.grid.height_m[n] > layers.grid.height_m[best] || std::isnan(layers.grid.height_m[best])) best = n;
  const scene::Lattice& lattice = layers.grid.lattice;
  const auto nx = static_cast<std::size_t>(lattice.nx);
  const std::array<double, 3> place{lattice.origin_m.x() + lattice.spacing_m * static_cast<double>(best % nx),
                                    lattice.origin_m.y() + lattice.spacing_m * static_cast<double>(best / nx),
                                    lattice.origin_m.z() + static_cast<double>(layers.grid.height_m[best])};
  Eigen::Vector4d at(place[0], place[1], place[2], 1.0);
  if (scene.description().region_from_grid) at = *scene.description().region_from_grid * at;
  const scene::PartConfig* part = scene::part_at(scene.description(), {at.x(), at.y(), at.z()});
  return part != nullptr ? part->name : "";
}

TEST(DepthScans, AScanFromAnotherSideKeepsTheLabelsOnTheObject) {
  const Plate plate;
  const scene::ScenePointer first = plate.build();
  ASSERT_EQ(part_at_summit(*first), "bump");
  DepthScans scans(first, plate.config, scene::Trust::own_folder);
  scans.open();
  finish(scans);
  ASSERT_TRUE(scans.status().points) << scans.status().note;
  viewer::ScanSetup setup = scans.status().proposal;
  EXPECT_EQ(setup.scan_to_grid, first->description().config.orientation.scan_to_grid);
  // Upside down, and so little from the side that the bump, 20 mm high, stays the highest place of the plate.
  setup.scan_to_grid = viewer::rolled(setup.scan_to_grid, 0.02, -0.01, 3.0);
  const viewer::DepthPreview preview = viewer::preview_of(*scans.status().points, setup, 1U << 20U);
  scans.scan(setup);
  finish(scans);
  const scene::ScenePointer second = scans.take_scene();
  ASSERT_TRUE(second) << scans.status().note;
  EXPECT_FALSE(scans.take_scene()) << "once";
  EXPECT_EQ(part_at_summit(*second), "bump");
  const scene::Lattice& lattice = second->description().levels.front();
  EXPECT_NEAR(preview.size_m().x(), lattice.spacing_m * (lattice.nx - 1), 2.0 * preview.cell_m);
  EXPECT_NEAR(preview.size_m().y(), lattice.spacing_m * (lattice.ny - 1), 2.0 * preview.cell_m);
  // A second turn, from the second scene's orientation, is about the same object.
  setup.scan_to_grid = viewer::rolled(setup.scan_to_grid, 0.0, 0.01, 1.5);
  scans.scan(setup);
  finish(scans);
  const scene::ScenePointer third = scans.take_scene();
  ASSERT_TRUE(third);
  EXPECT_EQ(part_at_summit(*third), "bump");
}

scene::ScenePointer scanned(DepthScans& scans, const viewer::ScanSetup& setup) {
  scans.scan(setup);
  finish(scans);
  scene::ScenePointer scene = scans.take_scene();
  EXPECT_TRUE(scene) << scans.status().note;
  return scene;
}

/// A box of 60 mm around the highest node of a scene, in its own grid.
std::vector<scene::PartConfig> box_at_summit(const scene::Scene& scene) {
  const scene::DepthGrid grid = scene.read_level(0).grid;
  std::size_t best = 0;
  for (std::size_t n = 0; n < grid.height_m.size(); ++n)
    if (grid.height_m[n] > grid.height_m[best] || std::isnan(grid.height_m[best])) best = n;
  const int nx = grid.lattice.nx, at = static_cast<int>(best);
  const double x = grid.lattice.x_m(at % nx), y = grid.lattice.y_m(at / nx), half = 0.03;
  scene::PartConfig part;
  part.name = part.say = "drawn";
  part.box_m = {x - half, y - half, x + half, y + half};
  return {part};
}

TEST(DepthScans, APartDrawnAfterATurnStaysOnTheObjectThroughTurnsAndSaving) {
  const Plate plate;
  std::string text = kConfig;
  text.erase(text.find("parts:"));  // the first turn has nothing to keep in its place
  write_file(plate.config, text);
  DepthScans scans(plate.build(), plate.config, scene::Trust::own_folder);
  scans.open();
  finish(scans);
  viewer::ScanSetup setup = scans.status().proposal;
  const viewer::ScanSetup straight = setup;
  setup.scan_to_grid = viewer::rolled(setup.scan_to_grid, 0.02, -0.01, 3.0);
  const scene::ScenePointer turned = scanned(scans, setup);
  ASSERT_TRUE(turned);
  const std::vector<scene::PartConfig> drawn = box_at_summit(*turned);
  const scene::ScenePointer edited = with_parts(turned, drawn);
  ASSERT_EQ(part_at_summit(*edited), "drawn");
  scans.set_parts(drawn, parts_frame(edited->description()));
  EXPECT_EQ(part_at_summit(*scanned(scans, setup)), "drawn") << "the same side once more";
  EXPECT_EQ(part_at_summit(*scanned(scans, straight)), "drawn") << "back to the first side";
  setup.scan_to_grid = viewer::rolled(setup.scan_to_grid, 0.0, 0.01, 1.5);
  EXPECT_EQ(part_at_summit(*scanned(scans, setup)), "drawn") << "a third side";
  scans.save(setup);
  finish(scans);
  Progress progress;
  EXPECT_EQ(part_at_summit(*pipeline::build_scene(scene::load_config(plate.config), {}, progress).scene), "drawn");
}

TEST(DepthScans, APartDrawnBeforeTheUnitIsCorrectedStaysOnTheObject) {
  const Plate plate;
  DepthScans scans(plate.build(), plate.config, scene::Trust::own_folder);
  scans.open();
  finish(scans);
  const viewer::ScanSetup setup = scans.status().proposal;
  const scene::ScenePointer first = scanned(scans, setup);
  const std::vector<scene::PartConfig> drawn = box_at_summit(*first);
  scans.set_parts(drawn, parts_frame(first->description()));
  scans.set_unit(scene::LengthUnit::ft);
  finish(scans);
  ASSERT_FALSE(scans.status().problem) << scans.status().note;
  EXPECT_EQ(part_at_summit(*scanned(scans, setup)), "drawn");
}

TEST(DepthScans, AScanFromTheSideThatIsLookedAtKeepsTheCropBoxAndIsWhatIsShownAndSaved) {
  const Plate plate;
  DepthScans scans(plate.build(), plate.config, scene::Trust::own_folder);
  scans.open();
  finish(scans);
  viewer::ScanSetup setup = scans.status().proposal;
  setup.crop = scene::CropConfig{{0.15, -1.0, -1.0}, {1.0, 1.0, 1.0}};
  const scene::ScenePointer cropped = scanned(scans, setup);
  ASSERT_TRUE(cropped);
  const std::uint64_t proposals = scans.status().proposals;
  const Eigen::Matrix4d side = viewer::rolled(setup.scan_to_grid, 0.02, -0.01, 3.0);
  scans.scan_from(side);
  finish(scans);
  const scene::ScenePointer second = scans.take_scene();
  ASSERT_TRUE(second) << scans.status().note;
  const auto& filters = second->description().config.filters;
  ASSERT_EQ(filters.size(), 1U);
  EXPECT_EQ(std::get<scene::CropConfig>(filters[0]).min_m, setup.crop->min_m);
  const viewer::OrientingStatus status = scans.status();
  EXPECT_EQ(status.proposals, proposals + 1);
  EXPECT_EQ(status.proposal.scan_to_grid, side);
  ASSERT_TRUE(status.proposal.crop);
  EXPECT_EQ(status.proposal.crop->min_m, setup.crop->min_m);
}

TEST(DepthScans, AScanFromASideBeforeTheCloudWasOpenedIsTheFirstViewOfTheCloud) {
  const Plate plate;
  const scene::ScenePointer first = plate.build();
  DepthScans scans(first, plate.config, scene::Trust::own_folder);
  const Eigen::Matrix4d side = viewer::rolled(first->description().config.orientation.scan_to_grid, 0.0, 0.0, 0.5);
  scans.scan_from(side);
  finish(scans);
  ASSERT_TRUE(scans.take_scene()) << scans.status().note;
  scans.open();
  finish(scans);
  EXPECT_EQ(scans.status().proposal.scan_to_grid, side);
}

TEST(DepthScans, ALabelImageStaysOnTheObjectAlsoWhereItsBoundsAreNotWritten) {
  const Plate plate;
  test::write_labels(plate.folder.path() / "labels.png", 40, 30, [](int column, int row) {
    const double x = (column + 0.5) * 0.318 / 40.0, y = 0.238 - (row + 0.5) * 0.238 / 30.0;
    return x > 0.2 && x < 0.28 && y > 0.08 && y < 0.16 ? 4 : 0;
  });
  std::string text = kConfig;
  text.replace(text.find("box_m: [0.2, 0.08, 0.28, 0.16]"), 30, "label: 4");
  write_file(plate.config, text + "audio: {labels: labels.png}\n");
  const scene::ScenePointer first = plate.build();
  ASSERT_EQ(part_at_summit(*first), "bump");
  DepthScans scans(first, plate.config, scene::Trust::own_folder);
  scans.open();
  finish(scans);
  viewer::ScanSetup setup = scans.status().proposal;
  setup.scan_to_grid = viewer::rolled(setup.scan_to_grid, 0.02, -0.01, 3.0);
  scans.scan(setup);
  finish(scans);
  const scene::ScenePointer second = scans.take_scene();
  ASSERT_TRUE(second) << scans.status().note;
  EXPECT_EQ(part_at_summit(*second), "bump");
  // What is saved can be built alone.
  scans.save(setup);
  finish(scans);
  Progress progress;
  EXPECT_EQ(part_at_summit(*pipeline::build_scene(scene::load_config(plate.config), {}, progress).scene), "bump");
}

TEST(DepthScans, SavingKeepsCommentsAndBuildsTheSameScene) {
  const Plate plate;
  DepthScans scans(plate.build(), plate.config, scene::Trust::own_folder);
  scans.open();
  finish(scans);
  viewer::ScanSetup setup = scans.status().proposal;
  setup.scan_to_grid = viewer::rolled(setup.scan_to_grid, 0.02, -0.01, 3.0);
  setup.crop = scene::CropConfig{{-1.0, -1.0, 0.02}, {1.0, 1.0, 1.0}};
  scans.save(setup);
  finish(scans);
  EXPECT_FALSE(scans.status().problem) << scans.status().note;
  const std::string text = read_file(plate.config, 1U << 20U);
  for (const char* comment : {"# The plate of the test.", "# one station", "# from the front", "# right"})
    EXPECT_NE(text.find(comment), std::string::npos) << text;
  const scene::Config saved = scene::load_config(plate.config);
  EXPECT_TRUE(saved.orientation.scan_to_grid.isApprox(setup.scan_to_grid, 1e-12));
  ASSERT_EQ(saved.filters.size(), 1U);
  EXPECT_EQ(std::get<scene::CropConfig>(saved.filters[0]).min_m.z(), 0.02);
  // The labels are still where they were, in a scene built from the file alone, and in one that was written to disk.
  Progress progress;
  const fs::path folder = plate.folder.path() / "scene";
  static_cast<void>(pipeline::build_scene_folder(saved, {}, folder, progress));
  EXPECT_EQ(part_at_summit(*scene::open_scene(folder, scene::Trust::any_file)), "bump");
  // Saved once more in another orientation, it is the same file.
  setup.scan_to_grid = viewer::rolled(setup.scan_to_grid, 0.0, 0.0, 0.5);
  setup.crop->max_m.z() = 0.2;
  scans.save(setup);
  finish(scans);
  EXPECT_FALSE(scans.status().problem) << scans.status().note;
  EXPECT_TRUE(scene::load_config(plate.config).orientation.scan_to_grid.isApprox(setup.scan_to_grid, 1e-12));
  EXPECT_NE(read_file(plate.config, 1U << 20U).find("# right"), std::string::npos);
}

TEST(DepthScans, SavingADrawnPartAndNoCropBoxKeepsComments) {
  const Plate plate;
  write_file(plate.config,
             std::string(kConfig) + "filters:  # why\n  - crop: {min_m: [0.1, -1, -1], max_m: [1, 1, 1]}\n");
  const scene::ScenePointer scene = plate.build();
  DepthScans scans(scene, plate.config, scene::Trust::own_folder);
  scans.open();
  finish(scans);
  viewer::ScanSetup setup = scans.status().proposal;
  ASSERT_TRUE(setup.crop);
  setup.crop.reset();
  std::vector<scene::PartConfig> parts = scene->description().config.parts;
  parts.push_back(box_at_summit(*scene).front());
  scans.set_parts(parts, parts_frame(scene->description()));
  scans.save(setup);
  finish(scans);
  EXPECT_FALSE(scans.status().problem) << scans.status().note;
  const std::string text = read_file(plate.config, 1U << 20U);
  for (const char* comment : {"# The plate of the test.", "# one station", "# right", "# why"})
    EXPECT_NE(text.find(comment), std::string::npos) << text;
  const scene::Config saved = scene::load_config(plate.config);
  EXPECT_EQ(saved.parts.size(), 2U);
  EXPECT_TRUE(saved.filters.empty());
}

TEST(DepthScans, CommentsThatCannotBeKeptAreNotWrittenOver) {
  const Plate plate;
  DepthScans scans(plate.build(), plate.config, scene::Trust::own_folder);
  scans.open();
  finish(scans);
  // Edited by hand meanwhile: the window knows nothing of it.
  std::string text = kConfig;
  text.replace(text.find("spacing_mm: 2"), 13, "spacing_mm: 3");
  write_file(plate.config, text);
  viewer::ScanSetup setup = scans.status().proposal;
  setup.scan_to_grid = viewer::rolled(setup.scan_to_grid, 0.0, 0.0, 0.5);
  scans.save(setup);
  finish(scans);
  EXPECT_EQ(read_file(plate.config, 1U << 20U), text);
  EXPECT_TRUE(scans.status().problem);
  const fs::path beside = plate.folder.path() / "plate-2.yaml";
  EXPECT_NE(scans.status().note.find(beside.string()), std::string::npos) << scans.status().note;
  EXPECT_TRUE(scene::load_config(beside).orientation.scan_to_grid.isApprox(setup.scan_to_grid, 1e-12));
}

TEST(DepthScans, ScansAloneAreGuessedShownTurnedAndBuilt) {
  const test::TestFolder folder;
  const fs::path file = folder.path() / "plate.xyz";
  write_plate(file);
  DepthScans scans(std::vector<fs::path>{file});
  EXPECT_EQ(scans.unavailable(), "");
  scans.open();
  finish(scans);
  const viewer::OrientingStatus status = scans.status();
  ASSERT_TRUE(status.points) << status.note;
  EXPECT_EQ(status.points->points.size(), 160U * 120U);
  EXPECT_EQ(status.proposals, 1U);
  EXPECT_GT(status.spacing_m, 0.0);
  scans.find_face(scene::OrientationConfig::Face::plane, status.proposal);
  finish(scans);
  EXPECT_EQ(scans.status().proposals, 2U) << scans.status().note;
  const Eigen::Matrix3d face = scans.status().proposal.scan_to_grid.topLeftCorner<3, 3>();
  // 1 degree: the bump leans the plane's fit.
  EXPECT_GT(std::abs(face(2, 1)), std::cos(0.02)) << "the plate's normal is y";
  scans.scan(scans.status().proposal);
  finish(scans);
  EXPECT_TRUE(scans.take_scene()) << scans.status().note;
}

TEST(DepthScans, TellsHowManyPointsLieInSpaceBeforeADepthScan) {
  const test::TestFolder folder;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (const int scattered : {0, 1000}) {
    const fs::path file = folder.path() / fmt::format("plate{}.xyz", scattered);
    write_plate(file);
    std::ofstream out(file, std::ios::app);
    for (int k = 0; k < scattered; ++k)
      out << 0.32 * unit(random) << ' ' << -0.1 + 0.2 * unit(random) << ' ' << 0.24 * unit(random) << '\n';
    out.close();
    DepthScans scans(std::vector<fs::path>{file});
    scans.open();
    finish(scans);
    ASSERT_TRUE(scans.status().points) << scans.status().note;
    EXPECT_LE(scans.status().scattered, static_cast<std::uint64_t>(scattered));
    EXPECT_GE(scans.status().scattered, static_cast<std::uint64_t>(scattered * 7 / 10));
  }
}

TEST(DepthScans, AnotherUnitScalesWhatWasGuessed) {
  const test::TestFolder folder;
  const fs::path file = folder.path() / "plate.xyz";
  write_plate(file, 0.001);
  DepthScans scans(std::vector<fs::path>{file});
  scans.open();
  finish(scans);
  const double spacing_m = scans.status().spacing_m;
  const double unit = scans.status().points->metres_per_unit;
  scans.set_unit(scene::LengthUnit::cm);
  finish(scans);
  const viewer::OrientingStatus status = scans.status();
  ASSERT_TRUE(status.points) << status.note;
  EXPECT_NEAR(status.spacing_m, spacing_m * 0.01 / unit, 1e-9);
  EXPECT_NEAR(static_cast<double>(status.points->high.x() - status.points->low.x()), 3.18, 0.02);
}

TEST(DepthScans, WhatIsMissingOrNoScanIsSaid) {
  const test::TestFolder folder;
  DepthScans missing(std::vector<fs::path>{folder.path() / "nothing.ply"});
  EXPECT_NE(missing.unavailable().find("nothing.ply"), std::string::npos);
  write_file(folder.path() / "text.ply", "this is no scan\n");
  DepthScans wrong(std::vector<fs::path>{folder.path() / "text.ply"});
  wrong.open();
  finish(wrong);
  EXPECT_FALSE(wrong.status().points);
  EXPECT_TRUE(wrong.status().problem);
  EXPECT_NE(wrong.status().note.find("text.ply"), std::string::npos) << wrong.status().note;
}

TEST(DepthScans, AScanIsStoppedAndTheNextOneWorks) {
  const Plate plate;
  DepthScans scans(plate.build(), plate.config, scene::Trust::own_folder);
  scans.open();
  finish(scans);
  const viewer::ScanSetup setup = scans.status().proposal;
  scans.scan(setup);
  scans.cancel();
  finish(scans);
  static_cast<void>(scans.take_scene());  // it may have been too quick to be stopped
  scans.scan(setup);
  finish(scans);
  EXPECT_TRUE(scans.take_scene()) << scans.status().note;
}

std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename().string());
  std::ranges::sort(names);
  return names;
}

TEST(DepthScans, ADepthScanIsKeptAsTheFolderThatABuildWritesAndNeverOverAnother) {
  const Plate plate;
  DepthScans scans(plate.config);
  scans.save_scene();
  finish(scans);
  EXPECT_TRUE(scans.status().problem) << "there is none yet";
  EXPECT_FALSE(scans.status().can_save_scene);
  scans.open();
  finish(scans);
  const scene::ScenePointer scene = scanned(scans, scans.status().proposal);
  ASSERT_TRUE(scene);
  EXPECT_TRUE(scans.status().can_save_scene);
  scans.save_scene();
  finish(scans);
  const fs::path folder = plate.folder.path() / "plate.scene";
  EXPECT_EQ(scans.status().note, "Saved the scene as " + folder.string());
  // What a build writes, byte for byte but for its times.
  Progress progress;
  const fs::path built = plate.folder.path() / "built.scene";
  pipeline::build_scene_folder(scans.config_of(scans.status().proposal), {}, built, progress);
  ASSERT_EQ(names_in(folder), names_in(built));
  for (const std::string& name : names_in(folder)) {
    if (!fs::is_regular_file(folder / name) || name.starts_with("report.")) continue;
    EXPECT_EQ(read_file(folder / name, 1U << 26U), read_file(built / name, 1U << 26U)) << name;
  }
  EXPECT_TRUE(scene::open_scene(folder, scene::Trust::own_folder));
  // Once more, with a part that was drawn since: in the same folder.
  scans.set_parts(box_at_summit(*scene), parts_frame(scene->description()));
  scans.save_scene();
  finish(scans);
  EXPECT_EQ(scene::open_scene(folder, scene::Trust::own_folder)->description().config.parts.size(),
            box_at_summit(*scene).size());
  // Another depth scan takes another name.
  ASSERT_TRUE(scanned(scans, scans.status().proposal));
  scans.save_scene();
  finish(scans);
  EXPECT_EQ(names_in(plate.folder.path()),
            (std::vector<std::string>{"built.scene", "plate-2.scene", "plate.scene", "plate.xyz", "plate.yaml"}));
}

TEST(DepthScans, ASceneThatCannotBeWrittenIsSaidAndLeavesNothing) {
  const Plate plate;
  DepthScans scans(plate.config);
  scans.open();
  finish(scans);
  ASSERT_TRUE(scanned(scans, scans.status().proposal));
  fs::create_symlink("nowhere", plate.folder.path() / "plate.scene");  // taken, too
  scans.save_scene();
  finish(scans);
  EXPECT_TRUE(fs::is_directory(plate.folder.path() / "plate-2.scene")) << scans.status().note;
  DepthScans of_scene(scene::open_scene(plate.folder.path() / "plate-2.scene", scene::Trust::own_folder), {},
                      scene::Trust::own_folder);
  of_scene.save_scene();
  finish(of_scene);
  EXPECT_FALSE(of_scene.status().problem);
  EXPECT_EQ(of_scene.status().note.rfind("This scene is kept in ", 0), 0U) << of_scene.status().note;
}

}  // namespace
}  // namespace sparsha::app
