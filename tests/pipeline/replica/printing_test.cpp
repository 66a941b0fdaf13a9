// Replicas as independent programs find them, where those are installed: admesh repairs meshes, PrusaSlicer slices
// them.
#include <gtest/gtest.h>

#include <sys/wait.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <regex>
#include <sstream>
#include <string>

#include "base/threads/progress.h"
#include "pipeline/replica/replica.h"
#include "pipeline/replica/whole_replica.h"
#include "tests/support/ball_scene.h"
#include "tests/support/scenes.h"
#include "tests/support/test_folder.h"

namespace sparsha::pipeline {
namespace {

namespace fs = std::filesystem;

bool installed(const std::string& program) {
  return std::system(("command -v " + program + " > /dev/null").c_str()) == 0;
}

struct Said {
  int code = -1;
  std::string text;
};
Said run(const fs::path& folder, const std::string& command) {
  const int status = std::system(("cd '" + folder.string() + "' && " + command + " > said 2>&1 < /dev/null").c_str());
  std::ifstream in(folder / "said");
  return {WEXITSTATUS(status), {std::istreambuf_iterator<char>(in), {}}};
}

/// A carved stone with a hole that nobody measured, a step, and a part whose name becomes Braille.
scene::ScenePointer stone() {
  return sparsha::test::scene_of(
      [](double x, double y) {
        if (std::hypot(x - 0.03, y - 0.07) < 0.01) return std::nan("");
        const double step = x > 0.06 ? 0.004 : 0.0;
        return step + 0.003 * std::sin(90.0 * x) * std::cos(70.0 * y);
      },
      161, 0.1, 161, Eigen::Vector3d::Zero(),
      [](scene::SceneDescription& d) {
        d.config.parts.push_back({"lotus", "", {0.02, 0.02, 0.05, 0.05}});
      });
}

/// The number after a name in admesh's table; none when the name is missing.
std::optional<long> number_after(const std::string& text, const std::string& name) {
  std::smatch found;
  if (!std::regex_search(text, found, std::regex(name + R"(\s*:\s*(-?\d+))"))) return std::nullopt;
  return std::stol(found[1]);
}

/// That admesh counts nothing to repair in FOLDER/FILE, one part, and about this volume.
void expect_nothing_to_repair(const fs::path& folder, const std::string& file, double volume_mm3) {
  const Said said = run(folder, "admesh " + file);
  ASSERT_EQ(said.code, 0) << said.text;
  EXPECT_EQ(number_after(said.text, "Number of parts"), 1) << said.text;
  for (const char* fault : {"Degenerate facets", "Edges fixed", "Facets removed", "Facets added", "Facets reversed",
                            "Backwards edges", "Normals fixed"})
    EXPECT_EQ(number_after(said.text, fault), 0) << fault << "\n" << said.text;
  for (const char* open : {"Facets with 1 disconnected edge", "Facets with 2 disconnected edges",
                           "Facets with 3 disconnected edges", "Total disconnected facets"}) {
    std::smatch found;
    // Before and after repair.
    ASSERT_TRUE(std::regex_search(said.text, found, std::regex(std::string(open) + R"(\s*:\s*(\d+)\s+(\d+))"))) << open;
    EXPECT_EQ(found[1], "0") << open;
    EXPECT_EQ(found[2], "0") << open;
  }
  std::smatch volume;
  ASSERT_TRUE(std::regex_search(said.text, volume, std::regex(R"(Volume\s*:\s*([\d.]+))")));
  // It sums the volumes of some hundred thousand triangles in single precision.
  EXPECT_NEAR(std::stod(volume[1]) / volume_mm3, 1.0, 1e-4);
}

TEST(ReplicaPrinting, AdmeshFindsNothingToRepair) {
  if (!installed("admesh")) GTEST_SKIP() << "admesh is not installed";
  const sparsha::test::TestFolder folder;
  Progress progress;
  const ReplicaReport report = export_replica(*stone(), folder / "relief.stl", {}, progress);
  ASSERT_FALSE(report.lines.empty()) << "with Braille";
  expect_nothing_to_repair(folder.path(), "relief.stl", report.volume_mm3);
  // That it can find something.
  fs::copy_file(folder / "relief.stl", folder / "open.stl");
  {
    std::fstream file(folder / "open.stl", std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(84 + 50 * 1000 + 12);
    const float away = 1e3F;
    file.write(reinterpret_cast<const char*>(&away), 4);
  }
  EXPECT_NE(run(folder.path(), "admesh --no-check open.stl").text, "");
  EXPECT_NE(number_after(run(folder.path(), "admesh open.stl").text, "Edges fixed").value_or(0) +
                number_after(run(folder.path(), "admesh open.stl").text, "Facets removed").value_or(0) +
                number_after(run(folder.path(), "admesh open.stl").text, "Facets added").value_or(0),
            0);
}

TEST(ReplicaPrinting, AdmeshFindsNothingToRepairInAWholeObject) {
  if (!installed("admesh")) GTEST_SKIP() << "admesh is not installed";
  const sparsha::test::TestFolder folder;
  ThreadPool pool(2);
  Progress progress;
  const scene::ScenePointer ball = sparsha::test::ball_scene(0.05, 0.0021, Eigen::Matrix4d::Identity());
  const WholeReplicaReport report = export_whole_replica(*ball, folder / "ball.stl", 150.0, {pool, progress});
  expect_nothing_to_repair(folder.path(), "ball.stl", report.volume_mm3);
}

TEST(ReplicaPrinting, PrusaSlicerSlicesBothFormatsIntoAllLayersOfTheSolid) {
  if (!installed("prusa-slicer")) GTEST_SKIP() << "prusa-slicer is not installed";
  if (std::getenv("SPARSHA_NIGHTLY") == nullptr) GTEST_SKIP() << "slicing takes most of a minute: SPARSHA_NIGHTLY=1";
  const sparsha::test::TestFolder folder;
  Progress progress;
  constexpr double kLayer_mm = 0.3;
  for (const char* ending : {"stl", "3mf"}) {
    const std::string file = std::string("relief.") + ending;
    ReplicaOptions options;
    options.longest_mm = 80.0;
    const ReplicaReport report = export_replica(*stone(), folder / file, options, progress);
    const Said said = run(folder.path(),
                          "prusa-slicer --export-gcode --layer-height 0.3 --first-layer-height 0.3 "
                          "--fill-density 5% --output sliced.gcode " +
                              file);
    ASSERT_EQ(said.code, 0) << said.text;
    EXPECT_EQ(said.text.find("epaired"), std::string::npos) << said.text;
    std::ifstream sliced(folder / "sliced.gcode");
    int layers = 0;
    for (std::string line; std::getline(sliced, line);) layers += line.rfind(";LAYER_CHANGE", 0) == 0 ? 1 : 0;
    EXPECT_NEAR(layers, report.thickness_mm / kLayer_mm, 1.0) << file;
    fs::remove(folder / "sliced.gcode");
  }
}

}  // namespace
}  // namespace sparsha::pipeline
