// Nothing is lost: folders, files and recordings whatever ends the program and whatever stands in its way.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "tests/app/program.h"

namespace sparsha {
namespace {
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::IsSupersetOf;
using ::testing::Not;

constexpr const char* kSimulation =
    "surface: {form: plane, size_m: [0.2, 0.2]}\nnodes: 64\nsampler: {points_per_node: 4}\n";

class Files : public Program {
 protected:
  std::map<std::string, std::string> files_in(const fs::path& folder) {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      if (entry.is_regular_file()) files[entry.path().lexically_relative(folder)] = text_of(entry.path());
    }
    return files;
  }
  void simulate(const std::string& out) {
    write("simulation.yaml", kSimulation);
    ASSERT_EQ(run("simulate simulation.yaml --out " + out).code, 0);
  }
  [[nodiscard]] bool any_hidden(const std::string& beginning) const {
    return std::any_of(fs::directory_iterator(folder_), fs::directory_iterator(),
                       [&](const auto& entry) { return entry.path().filename().string().starts_with(beginning); });
  }
  pid_t start(const std::string& arguments) {
    const std::string command = "cd \"" + folder_.path().string() + "\" && exec env -u DISPLAY -u WAYLAND_DISPLAY \"" +
                                SPARSHA_PROGRAM + "\" " + arguments + " > .out 2> .err < /dev/null";
    const pid_t child = ::fork();
    if (child == 0) {
      ::execl("/bin/sh", "sh", "-c", command.c_str(), static_cast<char*>(nullptr));
      ::_exit(127);
    }
    return child;
  }
  // Starts the program, waits until `ready`, sends the signal, and gives the status of waitpid().
  int interrupt(const std::string& arguments, int signal, const std::function<bool()>& ready, int times = 1) {
    const pid_t child = start(arguments);
    int status = 0;
    while (!ready()) {
      if (::waitpid(child, &status, WNOHANG) == child) {
        ADD_FAILURE() << "it ended by itself: " << text_of(folder_ / ".err");
        return status;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    for (int k = 0; k < times; ++k) {
      ::kill(child, signal);
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    ::waitpid(child, &status, 0);
    fs::remove(folder_ / ".out");
    fs::remove(folder_ / ".err");
    return status;
  }
};

TEST_F(Files, AFolderWithAHandWrittenSceneYamlAndItsScanIsNotReplaced) {
  fs::create_directories(folder_ / "p");
  write("p/scan.ply", kTetrahedron);
  write("p/scene.yaml", "scans: [{file: scan.ply}]  # mine\n");
  const auto before = files_in(folder_ / "p");
  for (const char* arguments : {"build p/scene.yaml -o p", "build p/scene.yaml -o p/", "build p/scene.yaml -o ./p/../p",
                                "build p/scan.ply -o p"}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 2) << arguments << outcome.err;
    EXPECT_EQ(files_in(folder_ / "p"), before) << arguments;
  }
}

TEST_F(Files, ForeignFilesInASceneAreNamedAndKept) {
  simulate("scan");
  ASSERT_EQ(run("build scan/sparsha.yaml -o scene").code, 0);
  write("scene/notes.txt", "mine");
  const Outcome outcome = run("build scan/sparsha.yaml -o scene");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("notes.txt"));
  fs::create_directory_symlink("scene", folder_ / "link");
  EXPECT_EQ(run("build scan/sparsha.yaml -o link").code, 2);
  EXPECT_TRUE(fs::is_symlink(folder_ / "link"));
  EXPECT_EQ(text_of(folder_ / "scene" / "notes.txt"), "mine");
}

TEST_F(Files, NotesOnTheObjectAreCarriedOverWhenItsSceneIsBuiltAgain) {
  simulate("scan");
  ASSERT_EQ(run("build scan/sparsha.yaml -o scene").code, 0);
  write("scene/notes.yaml", "pins:\n  - {at_m: [0, 0, 0], text: mine}  # by hand\n");
  const Outcome outcome = run("build scan/sparsha.yaml -o scene");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(text_of(folder_ / "scene" / "notes.yaml"), "pins:\n  - {at_m: [0, 0, 0], text: mine}  # by hand\n");
}

TEST_F(Files, ASceneIsBuiltAgainFromItsOwnDescriptionByteForByteAndSurvivesAFailure) {
  ASSERT_EQ(run("build " + relief_ + " --out scene --quiet").code, 0);
  auto before = files_in(folder_ / "scene");
  for (const char* arguments : {"build scene/scene.yaml --quiet", "build scene/scene.yaml --out scene --quiet"}) {
    const Outcome outcome = run(arguments);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const auto after = files_in(folder_ / "scene");
    ASSERT_EQ(after.size(), before.size());
    for (const auto& [name, bytes] : after) {
      if (name.starts_with("report")) continue;  // reports tell the time
      EXPECT_EQ(bytes, before[name]) << name;
    }
  }
  EXPECT_FALSE(fs::exists(folder_ / "scene" / "scene.scene"));
  before = files_in(folder_ / "scene");
  EXPECT_EQ(run("build scene/scene.yaml --set \"grid={spacing_mm: 1e9}\"").code, 2);
  EXPECT_EQ(files_in(folder_ / "scene"), before);
}

TEST_F(Files, OutputsThatAreOneFileOrAnInputAreRefusedBeforeAnyWork) {
  simulate("scan");
  ASSERT_EQ(run("build scan/sparsha.yaml -o scene --quiet").code, 0);
  write("path.csv", "t_s,x_m,y_m,z_m\n0,0.1,0.1,0\n");
  fs::create_directory_symlink(".", folder_ / "here");
  const std::string explore = "explore scene --device simulated --headless --duration 0.2 ";
  const auto before = files_in(folder_ / "scene");
  for (const std::string& arguments :
       {explore + "--record a.png --screenshot a.png", explore + "--record a.wav --audio-out here/a.wav",
        explore + "--record study.csv --study study", explore + "--record scene/scene.yaml",
        std::string("explore scene --device playback:path.csv --headless --record path.csv"),
        std::string("trace scene --hip path.csv --out ./path.csv"),
        std::string("export scene --to scene/level-0/height.tif"),
        std::string("export scan/scan.ply --to scan/scan.ply"),
        std::string("export scan/sparsha.yaml --to here/scan/scan.ply")}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 2) << arguments << outcome.err;
  }
  EXPECT_EQ(files_in(folder_ / "scene"), before);
  EXPECT_THAT(text_of(folder_ / "path.csv"), HasSubstr("0,0.1,0.1,0"));
}

TEST_F(Files, NoOutputTakesThePlaceOfAScanOrAFileThatTheSceneNames) {
  write("statue.ply", kTetrahedron);
  write("statue.yaml", "scans: [{file: statue.ply}]\ngrid: {size: 20}\n");
  ASSERT_EQ(run("build statue.yaml --out scene --quiet").code, 0);
  write("path.csv", "t_s,x_m,y_m,z_m\n0,0.1,0.1,0\n");
  fs::create_hard_link(folder_ / "statue.ply", folder_ / "hard.ply");
  for (const char* name : {"hard.csv", "hard.png", "hard.wav"})
    fs::create_hard_link(folder_ / "statue.ply", folder_ / name);
  fs::create_directories(folder_ / "exhibition");
  ASSERT_EQ(run("build statue.yaml --out exhibition/one --quiet").code, 0);
  const std::string explore = " --device simulated --headless --duration 0.2 ";
  for (const std::string& arguments :
       {std::string("export scene --to statue.ply"), std::string("export scene/scene.yaml --to ./scene/../statue.ply"),
        std::string("export scene --to hard.ply"), std::string("trace scene --hip path.csv --out statue.ply"),
        std::string("trace scene --hip path.csv --out hard.csv"), "explore scene" + explore + "--record statue.ply",
        "explore scene" + explore + "--audio-out hard.wav", "explore scene" + explore + "--screenshot hard.png",
        "explore statue.yaml" + explore + "--screenshot hard.png",
        "explore --kiosk --scenes exhibition" + explore + "--record statue.ply",
        std::string("register statue.yaml --out statue.ply"),
        std::string("register statue.yaml --set scans=[{\\\"file\\\":\\\"path.csv\\\"}] --report path.csv"),
        std::string("new statue.ply --force --out hard.ply")}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 2) << arguments << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("are the same file")) << arguments;
  }
  EXPECT_EQ(text_of(folder_ / "statue.ply"), kTetrahedron);
  EXPECT_EQ(run("export scene --to replica.ply --quiet").code, 0);
}

TEST_F(Files, NoOutputTakesThePlaceOfAPictureOrALibraryThatAScanNames) {
  write("statue.obj", "mtllib statue.mtl\nusemtl stone\nv 0 0 0\nv 1 0 0.1\nv 0 1 0.2\nv 1 1 0\nf 1 2 3\nf 2 4 3\n");
  write("statue.mtl", "newmtl stone\nmap_Kd stone.png\n");
  write("stone.png", "somebody's picture");
  ASSERT_EQ(run("build statue.obj --set grid.size=20 --out scene --quiet").code, 0);
  for (const char* arguments : {"export scene --to stone.png", "export statue.obj --to stone.png",
                                "explore scene --device simulated --headless --duration 0.2 --record statue.mtl"}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 2) << arguments << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("is a file that the scan")) << arguments;
  }
  EXPECT_EQ(text_of(folder_ / "stone.png"), "somebody's picture");
  EXPECT_EQ(run("export scene --to other.png --quiet").code, 0);
}

TEST_F(Files, SimulateTakesThePlaceOfNothingButAnOldSimulation) {
  fs::create_directories(folder_ / "d");
  write("d/sparsha.yaml", kSimulation);
  EXPECT_EQ(run("simulate d/sparsha.yaml --out d").code, 2);
  EXPECT_EQ(text_of(folder_ / "d" / "sparsha.yaml"), kSimulation);
  write("simulation.yaml", kSimulation);
  fs::remove(folder_ / "d" / "sparsha.yaml");
  write("d/scan.ply", "a real one");
  const Outcome outcome = run("simulate simulation.yaml --out d");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("scan.ply"));
  EXPECT_EQ(text_of(folder_ / "d" / "scan.ply"), "a real one");
  simulate("old");
  simulate("old");
}

TEST_F(Files, APipeIsRefusedByNameAsScanAndAsOutput) {
  ASSERT_EQ(::mkfifo((folder_ / "pipe.ply").c_str(), 0600), 0);
  write("a.ply", kTetrahedron);
  write("c.yaml", "scans: [{file: pipe.ply}]\n");
  write("path.csv", "t_s,x_m,y_m,z_m\n0,0.1,0.1,0\n");
  const std::string patience = "timeout 60";
  for (const auto& [arguments, code] : std::vector<std::pair<std::string, int>>{
           {"info pipe.ply", 3},
           {"new pipe.ply", 3},
           {"build pipe.ply -o s", 3},
           {"build c.yaml -o s", 3},
           {"build c.yaml -o s --memory 500MB", 3},
           {"export a.ply --to pipe.ply", 2},
           {"trace a.ply --hip path.csv --out pipe.ply", 2},
           {"trace a.ply --hip pipe.ply --out t.csv", 3},
           {"explore a.ply --device simulated --headless --duration 0.2 --record pipe.ply", 2}}) {
    const Outcome outcome = run(arguments, "/dev/null", patience);
    EXPECT_EQ(outcome.code, code) << arguments << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("pipe.ply")) << arguments;
  }
}

TEST_F(Files, AnOutputThatCannotBeWrittenIsToldBeforeTheScansAreRead) {
  // The scan is none: an error about it would show that it was read first.
  write("broken.ply", "ply\nnonsense\n");
  write("c.yaml", "scans: [{file: broken.ply}]\n");
  write("file", "in the way");
  for (const char* arguments : {"build c.yaml -o file/s", "build c.yaml -o file", "build c.yaml -o none/../file/s",
                                "export c.yaml --to file/x.ply", "export c.yaml --to none/x.ply",
                                "trace c.yaml --hip p.csv --out none/t.csv", "build broken.ply -o file/x/y"}) {
    const Outcome outcome = run(arguments);
    EXPECT_TRUE(outcome.code == 1 || outcome.code == 2) << arguments << outcome.err;
    EXPECT_THAT(outcome.err, ::testing::Not(HasSubstr("nonsense"))) << arguments;
  }
  EXPECT_EQ(text_of(folder_ / "file"), "in the way");
}

TEST_F(Files, EverySignalThatEndsAnExplorationKeepsRecordingAndSound) {
  simulate("scan");
  ASSERT_EQ(run("build scan/sparsha.yaml -o scene --quiet").code, 0);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGUSR1, SIGALRM}) {
    const auto recording = [&] {
      return std::any_of(fs::directory_iterator(folder_), fs::directory_iterator(), [](const auto& entry) {
        std::error_code code;
        return entry.path().filename().string().starts_with(".run.csv.part-") && entry.file_size(code) > 0;
      });
    };
    const int status =
        interrupt("explore scene --device simulated --headless --duration 1000 --record run.csv --audio-out run.wav",
                  signal, recording);
    ASSERT_TRUE(WIFEXITED(status)) << strsignal(signal);
    EXPECT_EQ(WEXITSTATUS(status), 0) << strsignal(signal);
    EXPECT_THAT(text_of(folder_ / "run.csv"), ::testing::EndsWith("\n"));
    EXPECT_TRUE(text_of(folder_ / "run.wav").starts_with("RIFF"));
    EXPECT_FALSE(any_hidden(".run."));
    fs::remove(folder_ / "run.csv");
    fs::remove(folder_ / "run.wav");
  }
}

TEST_F(Files, EverySignalThatEndsABuildKeepsTheOldSceneAndLeavesNothing) {
  ASSERT_EQ(run("build " + relief_ + " --out scene --quiet").code, 0);
  const auto before = files_in(folder_ / "scene");
  for (const int signal : {SIGINT, SIGHUP, SIGQUIT, SIGXCPU}) {
    const int status = interrupt("build " + relief_ + " --set grid.spacing_mm=0.1 --out scene", signal,
                                 [&] { return any_hidden(".scene.part-"); });
    ASSERT_TRUE(WIFEXITED(status)) << strsignal(signal);
    EXPECT_EQ(WEXITSTATUS(status), 1) << strsignal(signal);
    EXPECT_EQ(files_in(folder_ / "scene"), before);
    EXPECT_FALSE(any_hidden(".scene"));
  }
}

TEST_F(Files, WhatAKilledBuildLeftIsGoneAfterTheNext) {
  // An empty folder may be the trial of whether the place can be written to, which is gone a moment later.
  const auto writing = [&] {
    return std::any_of(fs::directory_iterator(folder_), fs::directory_iterator(), [](const auto& entry) {
      std::error_code code;
      return entry.path().filename().string().starts_with(".scene.part-") && !fs::is_empty(entry.path(), code) && !code;
    });
  };
  const int status = interrupt("build " + relief_ + " --set grid.spacing_mm=0.25 --out scene", SIGKILL, writing);
  ASSERT_TRUE(WIFSIGNALED(status));
  ASSERT_TRUE(any_hidden(".scene.part-"));
  ASSERT_EQ(run("build " + relief_ + " --out scene --quiet").code, 0);
  EXPECT_FALSE(any_hidden(".scene"));
}

TEST_F(Files, AFileThatMayNotGrowIsAnErrorAndLeavesNothing) {
  simulate("scan");
  ASSERT_EQ(run("build scan/sparsha.yaml -o scene --quiet").code, 0);
  const auto before = files_in(folder_ / "scene");
  for (const char* arguments :
       {"build scan/sparsha.yaml -o scene", "export scene --to mesh.ply", "simulate simulation.yaml --out other"}) {
    const Outcome outcome = run(arguments, "/dev/null", "ulimit -f 8;");
    EXPECT_EQ(outcome.code, 1) << arguments << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("error: ")) << arguments;
  }
  EXPECT_EQ(files_in(folder_ / "scene"), before);
  EXPECT_FALSE(fs::exists(folder_ / "mesh.ply"));
  EXPECT_TRUE(fs::is_empty(folder_ / "other"));
  EXPECT_FALSE(any_hidden("."));
}

TEST_F(Files, AnErrorWhileWritingNamesWhatWasAskedForWhereverTheDiskIsFull) {
  simulate("scan");
  ASSERT_EQ(run("build scan/sparsha.yaml -o scene --quiet").code, 0);
  // Scans that are smaller than the truth about them.
  std::string stations;
  for (int i = 0; i < 8; ++i) {
    stations += "  - {position_m: [0.1, 0.1, 1], target_m: [0.1, 0.1, 0], step_mrad: 40}\n";
  }
  write("tiny.yaml", "surface: {form: plane, size_m: [0.2, 0.2]}\nnodes: 4\nstations:\n" + stations);
  const std::vector<std::pair<std::string, std::string>> commands = {
      {"build scan/sparsha.yaml -o new", "new/"},
      {"build scan/sparsha.yaml -o scene", "scene/"},
      {"build scan/sparsha.yaml -o new --only grid", "new/"},
      {"simulate tiny.yaml --out other", "other/"},
      {"export scene --to mesh.ply", "mesh.ply"},
      {"export scene --to mesh.tif", "mesh.tif"},
  };
  std::set<std::string> named;
  for (const auto& [arguments, asked] : commands) {
    for (const int blocks : {0, 1, 2, 4, 8, 16, 24, 32, 48, 64, 128}) {
      const Outcome outcome = run(arguments + " --quiet", "/dev/null", "ulimit -f " + std::to_string(blocks) + ";");
      if (outcome.code == 0 || outcome.err.empty()) continue;  // standard error is a file too
      EXPECT_EQ(outcome.code, 1) << arguments;
      EXPECT_EQ(outcome.err.substr(0, asked.size()), asked) << arguments << " with " << blocks;
      EXPECT_THAT(outcome.err, Not(HasSubstr(".part-"))) << arguments << " with " << blocks;
      named.insert(outcome.err.substr(0, outcome.err.find(':')));
    }
  }
  EXPECT_THAT(named, IsSupersetOf({"new/level-0/height.tif", "scene/level-0/height.tif", "other/truth.json", "mesh.ply",
                                   "mesh.tif"}));
}

#if defined(__linux__)
// Stops the program while it has `file` mapped; false when it has ended before.
bool stop_while_mapped(pid_t program, const std::string& file) {
  const auto mapped = [&] {
    return text_of("/proc/" + std::to_string(program) + "/maps").find(file) != std::string::npos;
  };
  int status = 0;
  while (!mapped()) {
    if (::waitpid(program, &status, WNOHANG) == program) return false;
  }
  ::kill(program, SIGSTOP);
  if (::waitpid(program, &status, WUNTRACED) != program || !WIFSTOPPED(status)) return false;
  if (mapped()) return true;
  ::kill(program, SIGKILL);
  ::waitpid(program, &status, 0);
  return false;
}

TEST_F(Files, AScanThatIsCutWhileItIsReadIsAnErrorOfTheInput) {
  // Zeros that take no room on the disk: a binary PLY file of many points.
  constexpr std::uintmax_t kPoints = 8'000'000;
  const std::string header = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(kPoints) +
                             "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
  for (const char* const command : {"info cut.ply", "build cut.ply -o scene"}) {
    bool caught = false;
    for (int attempt = 0; attempt < 20 && !caught; ++attempt) {
      write("cut.ply", header);
      fs::resize_file(folder_ / "cut.ply", header.size() + 12 * kPoints);
      const pid_t program = start(command);
      caught = stop_while_mapped(program, "cut.ply");
      if (!caught) continue;
      fs::resize_file(folder_ / "cut.ply", 8192);
      ::kill(program, SIGCONT);
      int status = 0;
      ASSERT_EQ(::waitpid(program, &status, 0), program);
      ASSERT_TRUE(WIFEXITED(status)) << "signal " << WTERMSIG(status);
      EXPECT_EQ(WEXITSTATUS(status), 3) << command;
      // It was stopped between two passes over the file: once more.
      if (text_of(folder_ / ".err").find("it may be cut short") != std::string::npos) {
        caught = false;
        continue;
      }
      EXPECT_THAT(text_of(folder_ / ".err"), HasSubstr("cut.ply: error: the file became shorter while it was read"));
      EXPECT_THAT(text_of(folder_ / ".out"), IsEmpty());
    }
    EXPECT_TRUE(caught) << command << ": it was always too quick";
  }
  EXPECT_FALSE(fs::exists(folder_ / "scene"));
}
#endif

TEST_F(Files, ASecondInterruptEndsASimulationFromFarAway) {
  write("far.yaml",
        "surface: {form: sinusoid, size_m: [1, 1]}\nstations: [{position_m: [0.5, 0.5, 1e7], target_m: [0.5, 0.5, 0], "
        "step_mrad: 1e-4}]\n");
  EXPECT_EQ(run("simulate far.yaml --out far", "/dev/null", "timeout 300").code, 0);
  write("slow.yaml",
        "surface: {form: relief}\nstations: [{position_m: [0.18, 0.22, 1], target_m: [0.18, 0.22, 0], step_mrad: "
        "0.01}]\n");
  const int status = interrupt(
      "simulate slow.yaml --out slow", SIGINT,
      [&] { return fs::exists(folder_ / "slow") && !fs::is_empty(folder_ / "slow"); }, 2);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 1);
  write("beyond.yaml", "surface: {form: plane}\nstations: [{position_m: [0, 0, 1e300], target_m: [0, 0, 0]}]\n");
  EXPECT_EQ(run("simulate beyond.yaml --out beyond").code, 2);
}

TEST_F(Files, ATemporaryFolderThatDoesNotExistMattersOnlyToWhatNeedsIt) {
  simulate("scan");
  const std::string nowhere = "TMPDIR=/nowhere";
  EXPECT_EQ(run("build scan/sparsha.yaml -o scene", "/dev/null", nowhere).code, 0);
  EXPECT_EQ(run("build scan/sparsha.yaml -o scene --memory 500MB", "/dev/null", nowhere).code, 0);
  EXPECT_EQ(run("export scan/sparsha.yaml --to mesh.ply", "/dev/null", nowhere).code, 0);
}

}  // namespace
}  // namespace sparsha
