// The program as a user meets it: exit codes, messages with places, JSON, files whole or not there.
#include <gmock/gmock.h>

#include <gtest/gtest.h>
#include <cmath>
#include <cstdlib>

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "scene/scene.h"
#include "tests/app/program.h"
#include "tests/support/sanitized.h"

namespace sparsha {
namespace {
using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

TEST_F(Program, UsageErrorsExitWithTwoAndNameTheNearestWord) {
  EXPECT_EQ(run("").code, 2);
  const Outcome command = run("bild x.yaml");
  EXPECT_EQ(command.code, 2);
  EXPECT_THAT(command.err, HasSubstr("did you mean build?"));
  const Outcome option = run("build x.yaml --thread 2");
  EXPECT_EQ(option.code, 2);
  EXPECT_THAT(option.err, HasSubstr("did you mean --threads?"));
  EXPECT_EQ(run("export x --to y.ply --nodess").code, 2);
  EXPECT_EQ(run("--help").code, 0);
  EXPECT_THAT(run("--version").out,
              ContainsRegex("^sparsha [0-9]+\\.[0-9]+\\.[0-9]+\ncommit: ([0-9a-f]{12}|unknown)\nfeatures: [a-z ]+\n$"));
}

#if defined(__linux__)
// Each of these makes every command slower to start: VTK, Qt, GDAL and OpenCV by what they load, PCL's own libraries by
// their templates for every type of point, which the dynamic linker binds.
TEST_F(Program, LoadsNoLibraryThatSlowsDownEveryStart) {
  const fs::path list = folder_ / "libraries";
  const std::string command =
      std::string("LD_TRACE_LOADED_OBJECTS=1 \"") + SPARSHA_PROGRAM + "\" > \"" + list.string() + "\"";
  ASSERT_EQ(std::system(command.c_str()), 0);
  std::istringstream lines(text_of(list));
  std::vector<std::string> slow;
  bool lists = false;
  for (std::string line; std::getline(lines, line);) {
    lists = lists || line.find("libpcl_common") != std::string::npos;
    for (const std::string name : {"libpcl_", "libvtk", "libQt", "libgdal", "libopencv_"}) {
      if (SPARSHA_SANITIZED && name == "libopencv_") continue;  // linked there: see pipeline/CMakeLists.txt
      if (line.find(name) != std::string::npos && line.find("libpcl_common") == std::string::npos) slow.push_back(line);
    }
  }
  EXPECT_TRUE(lists);
  EXPECT_THAT(slow, IsEmpty());
}
#endif

TEST_F(Program, AMissingFileExitsWithThreeAndWritesNothing) {
  for (const char* arguments :
       {"build none.ply --out s", "info none.ply", "explore none --device simulated --headless",
        "export none --to x.ply", "check none", "trace none --hip p.csv --out t.csv", "new none.ply"}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 3) << arguments;
    EXPECT_THAT(outcome.err, HasSubstr("none")) << arguments;
    EXPECT_THAT(outcome.err, HasSubstr("error: ")) << arguments;
    EXPECT_EQ(outcome.out, "") << arguments;
  }
  EXPECT_EQ(entries(), 0U);
}

TEST_F(Program, AConfigurationsErrorsCarryFileLineAndColumnAndExitWithTwo) {
  write("scan.ply", kTetrahedron);
  const std::vector<std::array<const char*, 3>> cases = {
      {"scans: [{file: scan.ply}]\ngridd: {size: 8}\n", "c.yaml:2:1: error:", "did you mean 'grid'?"},
      {"scans: [{file: scan.ply, units: inch}]\n", "c.yaml:1:33: error: units is 'inch'", "m | cm | mm"},
      {"scans: [{file: scan.ply}]\ngrid: {size: 8}\ngrid: {size: 9}\n", "c.yaml:3:1: error:", "given twice"},
      {"scans: [{file: scan.ply}]\ngrid: {size: -8}\n", "c.yaml:2:14: error:", "from 2 to"},
  };
  for (const auto& [text, place, hint] : cases) {
    write("c.yaml", text);
    const Outcome outcome = run("build c.yaml --out scene");
    EXPECT_EQ(outcome.code, 2) << text;
    EXPECT_THAT(outcome.err, HasSubstr(place));
    EXPECT_THAT(outcome.err, HasSubstr(hint));
  }
  EXPECT_FALSE(fs::exists(folder_ / "scene"));
}

/// A LAS 1.2 file of no points.
std::string empty_las() {
  std::string bytes(227, '\0');
  const auto set = [&](std::size_t at, auto value) { std::memcpy(bytes.data() + at, &value, sizeof value); };
  bytes.replace(0, 4, "LASF");
  bytes[24] = 1;
  bytes[25] = 2;
  set(94, std::uint16_t{227});
  set(96, std::uint32_t{227});
  set(105, std::uint16_t{20});
  for (std::size_t axis = 0; axis < 3; ++axis) set(131 + 8 * axis, 0.01);
  return bytes;
}

TEST_F(Program, ADeclaredZeroOfPointsIsInformationButNotAScene) {
  const std::string ply = "element vertex 0\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string pcd =
      "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 0\nHEIGHT 1\nPOINTS 0\n";
  const std::vector<std::pair<std::string, std::string>> files = {
      {"ascii.ply", "ply\nformat ascii 1.0\n" + ply + "end_header\n"},
      {"binary.ply", "ply\nformat binary_little_endian 1.0\n" + ply + "end_header\n"},
      {"mesh.ply",
       "ply\nformat ascii 1.0\n" + ply + "element face 0\nproperty list uchar int vertex_indices\nend_header\n"},
      {"ascii.pcd", pcd + "DATA ascii\n"},
      {"binary.pcd", pcd + "DATA binary\n"},
      {"packed.pcd", pcd + "DATA binary_compressed\n" + std::string(8, '\0')},
      {"a.las", empty_las()},
      {"a.pts", "0\n"},
      {"a.ptx", "0\n0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"},
  };
  for (const auto& [name, bytes] : files) {
    write(name, bytes);
    const Outcome info = run("info " + name + " --json");
    ASSERT_EQ(info.code, 0) << name << info.err;
    const auto json = nlohmann::json::parse(info.out);
    EXPECT_EQ(json["points"], 0) << name;
    EXPECT_TRUE(json["extent_m"].is_null()) << name;
    const Outcome build = run("build " + name + " --out scene");
    EXPECT_EQ(build.code, 3) << name;
    EXPECT_THAT(build.err, AllOf(HasSubstr(name), HasSubstr("no points"))) << name;
    EXPECT_FALSE(fs::exists(folder_ / "scene"));
  }
}

TEST_F(Program, AFileWithNothingThatCouldBeAPointIsNoScan) {
  const std::vector<std::pair<std::string, std::string>> files = {
      {"binary.stl", std::string(84, '\0')},
      {"solid.stl", "solid of nothing" + std::string(68, '\0')},
      {"ascii.stl", "solid a\nendsolid a\n"},
      {"normals.obj", "vn 0 0 1\nvt 0 0\n"},
      {"empty.xyz", ""},
      {"blank.xyz", "\n\n\n"},
      {"comments.xyz", "# only\n# comments\n"},
      {"header.csv", "x,y,z\n"},
      {"scene.gltf", "{\"asset\": {\"version\": \"2.0\"}}"},
      {"model.glb", std::string("glTF\2\0\0\0\14\0\0\0", 12)},
  };
  for (const auto& [name, bytes] : files) {
    write(name, bytes);
    for (const std::string& arguments : {"info " + name, "build " + name + " --out scene", "new " + name}) {
      const Outcome outcome = run(arguments);
      EXPECT_EQ(outcome.code, 3) << arguments;
      EXPECT_THAT(outcome.err, HasSubstr(name)) << arguments;
      EXPECT_THAT(outcome.out, IsEmpty()) << arguments;
    }
    EXPECT_FALSE(fs::exists(folder_ / "scene"));
  }
}

std::string wavy_rows(int nx, int ny) {
  std::string rows;
  for (int i = 0; i < nx; ++i) {
    for (int j = 0; j < ny; ++j) {
      rows += std::to_string(0.001 * i) + " " + std::to_string(0.001 * j) + " " +
              std::to_string(1e-4 * (i * 7919 % 13)) + "\n";
    }
  }
  return rows;
}

TEST_F(Program, AConfigurationIsFoundWhereNewWritesItAndFindsItsScan) {
  fs::create_directories(folder_ / "in/scans");
  fs::create_directories(folder_ / "out");
  const std::string scan = "in/scans/st\xE9le.xyz";  // Latin-1: no UTF-8
  write(scan, wavy_rows(30, 30));
  EXPECT_EQ(run("new " + scan + " -o out/c.yaml").code, 0);
  // The shell opens the file; what is written is relative to its folder too.
  const std::string command =
      "cd \"" + folder_.path().string() + "\" && \"" SPARSHA_PROGRAM "\" new " + scan + " > out/d.yaml 2> /dev/null";
  EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 0);
  EXPECT_EQ(run("new \"" + (folder_ / scan).string() + "\" -o out/e.yaml").code, 0);
  for (const std::string name : {"c", "d", "e"}) {
    const Outcome build = run("build out/" + name + ".yaml --out scene-" + name);
    EXPECT_EQ(build.code, 0) << name << build.err;
    EXPECT_TRUE(fs::exists(folder_ / ("scene-" + name) / "scene.yaml")) << name;
  }
  const Outcome again = run("new " + scan + " -o out/c.yaml");
  EXPECT_EQ(again.code, 2) << again.err;
  EXPECT_THAT(again.err, HasSubstr("--force"));
  EXPECT_EQ(run("new " + scan + " -o out/c.yaml --force").code, 0);
}

TEST_F(Program, ASettingOfTheSpacingDecidesOnAStripOfTwoRows) {
  write("strip.xyz", wavy_rows(4000, 2));
  EXPECT_EQ(run("build strip.xyz --out a").code, 0) << "its grid is as fine as its points";
  for (const char* spacing : {"0.5", "1"}) {
    const Outcome told = run(std::string("build strip.xyz --force --out a --set grid.spacing_mm=") + spacing);
    EXPECT_EQ(told.code, 0) << told.err;
    EXPECT_THAT(told.out, HasSubstr(std::string(spacing) + " mm apart"));
  }
  const Outcome wide = run("build strip.xyz --force --out a --set grid.spacing_mm=5");
  EXPECT_EQ(wide.code, 3);
  EXPECT_THAT(wide.err, HasSubstr("strip.xyz: error: "));
}

TEST_F(Program, InfoGivesOneObjectForOneFileAndAnArrayForSeveral) {
  write("a.ply", kTetrahedron);
  const auto one = nlohmann::json::parse(run("info a.ply --json").out);
  EXPECT_EQ(one["points"], 4);
  EXPECT_EQ(one["invalid"], 0);
  EXPECT_EQ(one["triangles"], 2);
  EXPECT_EQ(one["extent_m"]["max"][0], 1.0);
  for (const char* key : {"file", "format", "spacing_m", "fields", "units", "duplicates", "scans", "viewpoint"}) {
    EXPECT_TRUE(one.contains(key)) << key;
  }
  EXPECT_EQ(nlohmann::json::parse(run("info a.ply a.ply --json").out).size(), 2U);
}

TEST_F(Program, InfoCountsThePointsOfAScanThatLieInSpace) {
  std::string text;
  for (int i = 0; i < 70; ++i)
    for (int j = 0; j < 60; ++j) text += fmt::format("{} {} {:.4f}\n", i, j, std::sin(0.1 * i) + std::cos(0.12 * j));
  write("clean.xyz", text);
  for (int k = 0; k < 300; ++k)  // evenly, by three irrational steps
    text += fmt::format("{:.3f} {:.3f} {:.3f}\n", 69 * std::fmod(0.8191725 * k, 1.0),
                        59 * std::fmod(0.6710436 * k, 1.0), 40 * std::fmod(0.5497005 * k, 1.0) - 20);
  write("stray.xyz", text);
  EXPECT_FALSE(nlohmann::json::parse(run("info clean.xyz --json").out).contains("scattered"));
  EXPECT_THAT(run("info clean.xyz").out, Not(HasSubstr("scattered")));
  const int scattered = nlohmann::json::parse(run("info stray.xyz --json").out).value("scattered", 0);
  EXPECT_GE(scattered, 200);
  EXPECT_LE(scattered, 300);
  EXPECT_THAT(run("info stray.xyz").out, HasSubstr(fmt::format("scattered   {} points lie in space", scattered)));
}

TEST_F(Program, WithoutADisplayAutoIsADeviceErrorThatNamesTheChoices) {
  write("a.ply", kTetrahedron);
  const Outcome outcome = run("explore a.ply --duration 1");
  EXPECT_EQ(outcome.code, 4);
  for (const char* choice : {"falcon", "pointer", "simulated", "playback:FILE"}) {
    EXPECT_THAT(outcome.err, HasSubstr(choice));
  }
  EXPECT_EQ(run("explore a.ply --device pointer --headless").code, 4);
  EXPECT_EQ(run("explore a.ply --device glove --headless").code, 2);
  EXPECT_EQ(run("explore a.ply --device simulated --headless --memory 1KB").code, 2);
  EXPECT_EQ(run("explore a.ply --device simulated --headless --memory much").code, 2);
}

TEST_F(Program, AnExhibitionNeedsNoSceneOfItsOwn) {
  ASSERT_EQ(run("build " + relief_ + " --out scenes/relief").code, 0);
  const Outcome outcome = run("explore --kiosk --scenes scenes --device simulated --headless --duration 0.3");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(run("explore --scenes scenes --device simulated --headless --duration 0.3").code, 2);
  EXPECT_EQ(run("explore --kiosk --device simulated --headless --duration 0.3").code, 2);
}

TEST_F(Program, TheReliefGoesFromScansToSceneToTouchPictureSoundAndExports) {
  const Outcome build = run("build " + relief_ + " --out scene --json");
  ASSERT_EQ(build.code, 0) << build.err;
  EXPECT_GT(nlohmann::json::parse(build.out)["coverage"], 0.9);

  const Outcome explore =
      run("explore scene --device simulated --headless --duration 4 --record run.csv "
          "--screenshot view.png --audio-out run.wav --json");
  ASSERT_EQ(explore.code, 0) << explore.err;
  const auto summary = nlohmann::json::parse(explore.out);
  EXPECT_GT(summary["contact_s"], 0.0);
  const std::string csv = text_of(folder_ / "run.csv");
  EXPECT_TRUE(
      csv.starts_with("t_s,hip_x_m,hip_y_m,hip_z_m,proxy_x_m,proxy_y_m,proxy_z_m,force_x_n,force_y_n,force_z_n,"
                      "contact,level,tick_ns,"));
  EXPECT_EQ(static_cast<std::uint64_t>(std::count(csv.begin(), csv.end(), '\n')),
            summary["ticks"].get<std::uint64_t>() + 1);
  EXPECT_TRUE(text_of(folder_ / "view.png").starts_with("\x89PNG"));
  EXPECT_TRUE(text_of(folder_ / "run.wav").starts_with("RIFF"));

  const Outcome trace = run("trace scene --hip run.csv --out trace.csv --json");
  ASSERT_EQ(trace.code, 0) << trace.err;
  const auto figures = nlohmann::json::parse(trace.out);
  EXPECT_EQ(figures["below_surface"], 0);
  EXPECT_EQ(figures["not_a_number"], 0);
  EXPECT_EQ(figures["updates"], summary["ticks"]);
  EXPECT_EQ(figures["path"]["not_a_number"], 0);
  write("broken.csv", "t_s,x_m,y_m,z_m\n0,0,0,0\n0.001,nan,0,0\n0.001,0,0,0\n");
  const Outcome broken = run("trace scene --hip broken.csv --out trace.csv");
  EXPECT_EQ(broken.code, 0) << "it is rendered";
  EXPECT_NE(broken.err.find("1 row of the hand's path has a time or a position that is not a number (row 2"),
            std::string::npos)
      << broken.err;
  EXPECT_NE(broken.err.find("the time of the row before (row 3"), std::string::npos) << broken.err;
  EXPECT_EQ(run("trace scene --hip run.csv --live --out live.csv").code, 0);
  const std::string live = text_of(folder_ / "live.csv");
  EXPECT_EQ(std::count(live.begin(), live.end(), '\n'), std::count(csv.begin(), csv.end(), '\n'));
  EXPECT_EQ(run("trace scene --hip run.csv --live --level 0 --out live.csv").code, 2);
  EXPECT_EQ(run("trace scene --hip trace.csv --live --out live.csv").code, 3) << "it names no windows";

  for (const char* file : {"mesh.ply", "mesh.obj", "points.xyz", "heights.tif", "heights.png"}) {
    EXPECT_EQ(run(std::string("export scene --to ") + file).code, 0) << file;
    EXPECT_GT(fs::file_size(folder_ / file), 1000U) << file;
  }
  EXPECT_EQ(run("export scene --nodes --to x.tif").code, 2);
  EXPECT_EQ(run("export scene --to relief.stl --size-mm 60").code, 0);
  EXPECT_EQ(run("export scene --to relief.stl --base-mm 0.5").code, 2);
  EXPECT_EQ(run("export scene --to x.ply --size-mm 60").code, 2) << "means nothing for a mesh";
  EXPECT_EQ(run("export scene --to x.gif").code, 2);
  EXPECT_EQ(run("check scene --json").code, 0);
  EXPECT_EQ(run("info scene --json").code, 0);
}

TEST_F(Program, NewWritesAConfigurationThatBuildValidates) {
  write("a.ply", kTetrahedron);
  const Outcome suggestion = run("new a.ply");
  ASSERT_EQ(suggestion.code, 0) << suggestion.err;
  write("a.yaml", suggestion.out);
  EXPECT_EQ(run("build a.yaml --validate").code, 0);
  EXPECT_FALSE(fs::exists(folder_ / "a.scene"));
  EXPECT_EQ(run("build a.yaml --quiet").code, 0);
  EXPECT_TRUE(fs::exists(folder_ / "a.scene" / "scene.yaml"));
}

TEST_F(Program, AFolderThatIsNoSceneIsNotOverwritten) {
  write("a.ply", kTetrahedron);
  fs::create_directories(folder_ / "photos");
  write("photos/precious.txt", "kept");
  EXPECT_EQ(run("build a.ply --out photos").code, 2);
  EXPECT_EQ(text_of(folder_ / "photos" / "precious.txt"), "kept");
}

TEST_F(Program, AStudyWithoutATerminalAsksNothingAndStaysRectangular) {
  ASSERT_EQ(run("build " + relief_ + " --out scene").code, 0);
  const std::string explore = "explore scene --device simulated --headless --duration 0.2 --study visitors";
  write("seven", "7\n");
  for (const char* input : {"seven", "/dev/null"}) {
    const Outcome outcome = run(explore, input);
    EXPECT_EQ(outcome.code, 0) << input;
    EXPECT_THAT(outcome.err, Not(HasSubstr("How real"))) << input;
  }
  std::istringstream lines(text_of(folder_ / "visitors.csv"));
  std::string line;
  std::vector<std::string> realism;
  while (std::getline(lines, line)) {
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), 8) << line;
    realism.push_back(line.substr(0, line.find(',')));
  }
  EXPECT_EQ(realism, (std::vector<std::string>{"realism", "", ""}));

  write("notes.csv", "name,age\n");
  for (const char* name : {"notes", "a/b", "..", "'a,b'", "\"$(printf 'a\\tb')\""})
    EXPECT_EQ(run(std::string("explore scene --device simulated --headless --duration 0.2 --study ") + name).code, 2)
        << name;
  EXPECT_EQ(text_of(folder_ / "notes.csv"), "name,age\n");
}

TEST_F(Program, AnOutputThatFailsTakesNoOtherWithIt) {
  if (!fs::is_character_file("/dev/full")) GTEST_SKIP() << "no full device";
  ASSERT_EQ(run("build " + relief_ + " --out scene").code, 0);
  const Outcome outcome =
      run("explore scene --device simulated --headless --duration 0.5 --record /dev/full --screenshot view.png "
          "--study visitors --json");
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("/dev/full: error: the recording could not be written whole"));
  EXPECT_GT(nlohmann::json::parse(outcome.out)["ticks"], 0);
  EXPECT_TRUE(text_of(folder_ / "view.png").starts_with("\x89PNG"));
  EXPECT_THAT(text_of(folder_ / "visitors.csv"), HasSubstr("realism,"));
}

TEST_F(Program, ATraceSaysHowManyKnownNodesHaveHeightsThatAreNotNumbers) {
  ASSERT_EQ(run("build " + relief_ + " --out scene").code, 0);
  write("path.csv", "t_s,x_m,y_m,z_m\n0,0.1,0.1,0\n");
  EXPECT_THAT(run("trace scene --hip path.csv --out trace.csv").err, Not(HasSubstr("not numbers")));
  const scene::ScenePointer sound = scene::open_scene(folder_ / "scene");
  std::vector<scene::Layers> levels;
  for (std::size_t level = 0; level < sound->description().levels.size(); ++level)
    levels.push_back(sound->read_level(static_cast<int>(level)));
  scene::DepthGrid& grid = levels.front().grid;
  int broken = 0;
  for (std::size_t n = 0; n < grid.state.size() && broken < 3; ++n) {
    if (grid.state[n] == scene::NodeState::unknown) continue;
    grid.height_m[n] = broken == 0 ? std::numeric_limits<float>::infinity() : std::numeric_limits<float>::quiet_NaN();
    ++broken;
  }
  fs::create_directory(folder_ / "broken");
  scene::write_scene(*scene::make_scene(sound->description(), levels), folder_ / "broken");
  const Outcome doubtful = run("trace broken --hip path.csv --out trace.csv");
  EXPECT_EQ(doubtful.code, 0) << doubtful.err;
  EXPECT_THAT(doubtful.err, HasSubstr("3 of the "));
  EXPECT_THAT(doubtful.err, HasSubstr("known nodes of level 0 have heights that are not numbers"));
}

TEST_F(Program, AGuideWithoutPartsIsRefusedAndOneBesideTheStoneIsWarnedOf) {
  write("a.ply", kTetrahedron);
  const std::string scan = "scans: [{file: a.ply}]\ngrid: {size: 20}\n";
  write("parts.yaml", scan + "guide: {path: part}\n");
  const Outcome refused = run("build parts.yaml --validate");
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err, HasSubstr("parts.yaml:3:8: error: the guide leads along parts, and there are none"));
  write("line.yaml", scan + "guide: {path: drawn, line_m: [[7, 7], [8, 8]]}\n");
  EXPECT_THAT(run("build line.yaml --out scene").err,
              HasSubstr("the guide's line is nowhere: it lies beside the grid"));
  write("on.yaml", scan + "guide: {path: drawn, line_m: [[0.2, 0.2], [8, 8]]}\n");
  EXPECT_THAT(run("build on.yaml --out other").err, Not(HasSubstr("nowhere")));
  write("labels.yaml", scan + "audio: {labels: none.png, regions: [{name: a, label: 1, material: wood}]}\n");
  const Outcome labels = run("build labels.yaml --validate");
  EXPECT_EQ(labels.code, 3);
  EXPECT_THAT(labels.err, HasSubstr("none.png: error: the label image does not exist"));
}

TEST_F(Program, JsonIsAskedForAndComesOrIsRefused) {
  write("a.ply", kTetrahedron);
  EXPECT_EQ(nlohmann::json::parse(run("export a.ply --to nodes.ply --nodes --json").out)["file"], "nodes.ply");
  const Outcome proposal = run("new a.ply --json");
  EXPECT_EQ(proposal.code, 2);
  EXPECT_THAT(proposal.err, HasSubstr("YAML"));
  EXPECT_THAT(proposal.out, IsEmpty());
}

TEST_F(Program, ATraceOfAWindowBesideTheSceneIsAUsageError) {
  ASSERT_EQ(run("build " + relief_ + " --set levels.window=32 --out scene").code, 0);
  write("path.csv", "t_s,x_m,y_m,z_m\n0,0.1,0.1,0\n");
  const std::string trace = "trace scene --hip path.csv --out trace.csv ";
  EXPECT_EQ(run(trace + "--level 0 --centre 0.1 0.1").code, 0);
  fs::remove(folder_ / "trace.csv");
  for (const char* window : {"--centre nan 0.1", "--centre 0.1 inf", "--centre -1e300 0", "--centre 0.1 5",
                             "--level 64", "--level -1", "--solver paper --rho nan"})
    EXPECT_EQ(run(trace + window).code, 2) << window;
  EXPECT_FALSE(fs::exists(folder_ / "trace.csv"));
}

TEST_F(Program, ADurationThatIsNoNumberIsRefused) {
  write("a.ply", kTetrahedron);
  for (const char* duration : {"nan", "inf", "0", "-1", "ten"})
    EXPECT_EQ(run(std::string("explore a.ply --device simulated --headless --duration ") + duration).code, 2);
}

TEST_F(Program, ANumberForTheFalconThatIsNoneIsRefused) {
  for (const char* arguments : {"check --duration nan", "monitor --duration nan", "monitor --duration -1",
                                "calibrate --weight-g nan", "emulate --weight-g nan -- true"}) {
    const Outcome outcome = run(std::string("device ") + arguments);
    EXPECT_EQ(outcome.code, 2) << arguments;
    EXPECT_THAT(outcome.err, HasSubstr("is not a number from")) << arguments;
  }
}

}  // namespace
}  // namespace sparsha
