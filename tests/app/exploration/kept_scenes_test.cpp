// A recording across new depth scans and edited parts, played and traced by the program itself.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include <Eigen/Geometry>

#include "app/exploration/edited_parts.h"
#include "app/raw_scans/depth_scans.h"
#include "base/files/files.h"
#include "pipeline/build/build.h"
#include "scene/folder/folder.h"
#include "tests/app/program.h"
#include "tests/support/changing_scenes.h"
#include "tests/support/wait.h"

namespace sparsha {
namespace {

using scene::ScenePointer;
using test::Table;

const char* const kConfig = R"(scans: [{file: stone.xyz, units: m}]
orientation: {look_from: [0, -1, 0.1], up: [0, 0, 1]}
grid: {spacing_mm: 0.7}
fill: {max_gap_mm: 3}
texture: {sigma_space_mm: 2, sigma_range_mm: 0.3}
friction: {law: curvature, mu_static: 0.45}
levels: {window: 101}
haptics: {impact: on, grain: on, tip_radius_mm: 0.3}
cues: on
parts:
  - {name: bump, say: "The bump", box_m: [0.02, 0.02, 0.05, 0.06], material: wood, mu_dynamic: 0.5}
)";

class RecordedByTheSession : public Program {
 protected:
  void SetUp() override {
    Program::SetUp();
    std::ofstream scan(folder_ / "stone.xyz");
    scan.precision(9);
    for (int i = 0; i <= 200; ++i)
      for (int k = 0; k <= 160; ++k) {
        const double x = 0.0005 * i, z = 0.0005 * k;
        const double y = 0.004 * std::sin(70.0 * x) * std::cos(55.0 * z) + 0.0002 * std::sin(900.0 * x + 700.0 * z);
        scan << x << ' ' << -y << ' ' << z << '\n';
      }
    scan.close();
    write("stone.yaml", kConfig);
    ASSERT_EQ(run("build stone.yaml --out statue").code, 0);
  }

  /// The program's own way to a scene from another side.
  static ScenePointer scanned_from(app::DepthScans& scans, const ScenePointer& scene, double turn_rad) {
    const Eigen::Matrix4d turned =
        Eigen::Affine3d(Eigen::AngleAxisd(turn_rad, Eigen::Vector3d(1.0, 0.3, 0.1).normalized())).matrix() *
        scene->description().config.orientation.scan_to_grid;
    scans.scan_from(turned);
    test::wait_until([&] { return !scans.status().busy; });
    ScenePointer result = scans.take_scene();
    EXPECT_TRUE(result) << scans.status().note;
    return result;
  }

  void record() const {
    const ScenePointer first = scene::open_scene(folder_ / "statue");
    app::DepthScans scans(first, {}, scene::Trust::own_folder);
    std::vector<scene::PartConfig> parts = first->description().config.parts;
    parts.front().box_m = {0.0, 0.0, 0.06, 0.08};
    parts.front().touch.mu_dynamic = 0.05;
    const ScenePointer edited = app::with_parts(first, parts);  // statue/scene.yaml is another one now
    scans.set_parts(parts, app::parts_frame(edited->description()));
    const ScenePointer second = scanned_from(scans, first, 0.25);
    const ScenePointer third = scanned_from(scans, first, -0.2);
    ASSERT_TRUE(second->description().region_from_grid);
    test::record_on(first, {edited, second, third}, folder_ / "run.csv", 5);
  }
};

TEST_F(RecordedByTheSession, TheProgramPlaysAndTracesItToTheLastBit) {
  record();
  const Table live(folder_ / "run.csv");
  ASSERT_EQ(live.at(live.size() - 1, "scene"), "4");
  std::vector<int> contacts(5, 0);
  for (std::size_t row = 0; row < live.size(); ++row)
    if (live.at(row, "contact") == "1") ++contacts.at(std::stoul(live.at(row, "scene")));
  const Outcome played = run("explore statue --headless --device playback:run.csv --record again.csv");
  EXPECT_EQ(played.code, 0) << played.err;
  EXPECT_NE(played.err.find("run.scenes"), std::string::npos) << "says on what it is played";
  EXPECT_EQ(Table(folder_ / "again.csv").differing(live), 0);
  EXPECT_TRUE(fs::exists(folder_ / "again.scenes" / "4" / "scene.yaml"));
  const Outcome traced = run("trace statue --hip run.csv --live --out trace.csv");
  EXPECT_EQ(traced.code, 0) << traced.err;
  EXPECT_EQ(live.differing(Table(folder_ / "trace.csv")), 0);
  std::printf("%zu rows; contacts on the scenes: %d %d %d %d\n", live.size(), contacts[1], contacts[2], contacts[3],
              contacts[4]);

  // Without the scene that the run began on.
  fs::remove_all(folder_ / "statue");
  EXPECT_EQ(run("trace statue --hip run.csv --live --out trace.csv").code, 0);
  EXPECT_EQ(live.differing(Table(folder_ / "trace.csv")), 0);
}

TEST_F(RecordedByTheSession, AMissingOrDamagedSceneIsAnErrorOfTheInputThatNamesIt) {
  record();
  const fs::path mask = folder_ / "run.scenes" / "3" / "level-0" / "mask.tif";
  const std::string good = text_of(mask);
  write_file(mask, good.substr(0, good.size() / 3));
  const std::vector<std::string> commands = {"explore statue --headless --device playback:run.csv",
                                             "trace statue --hip run.csv --live --out trace.csv"};
  for (const std::string& command : commands) {
    const Outcome outcome = run(command);
    EXPECT_EQ(outcome.code, 3) << outcome.err;
    EXPECT_NE(outcome.err.find("run.scenes/3/level-0/mask.tif"), std::string::npos) << outcome.err;
  }
  fs::remove_all(folder_ / "run.scenes" / "2");
  for (const std::string& command : commands) {
    const Outcome outcome = run(command);
    EXPECT_EQ(outcome.code, 3) << outcome.err;
    EXPECT_NE(outcome.err.find("run.scenes/2: error: the scene that the recording was made on is not there"),
              std::string::npos)
        << outcome.err;
  }
}

}  // namespace
}  // namespace sparsha
