// What stands where files of scans are named: empty files among others, folders, a shell's patterns.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include <nlohmann/json.hpp>

#include "tests/app/program.h"

namespace sparsha {
namespace {
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class NamedFiles : public Program {
 protected:
  void SetUp() override {
    std::string rows;
    for (int j = 0; j < 12; ++j)
      for (int i = 0; i < 12; ++i)
        rows += std::to_string(0.01 * i) + " " + std::to_string(0.01 * j) + " " + std::to_string(0.001 * (i * j % 5)) +
                "\n";
    fs::create_directory(folder_ / "scans");
    for (const char* name : {"scans/a.xyz", "scans/b.xyz", "scans/c.xyz", "scans/d.xyz", "one.xyz"}) write(name, rows);
    write("scans/notes.odt", "no scan");
    write("empty.ply", "");
  }
};

TEST_F(NamedFiles, InfoTellsOfTheOthersBesideAFileThatIsNoScan) {
  for (const char* files :
       {"one.xyz empty.ply scans/a.xyz", "empty.ply one.xyz scans/a.xyz", "one.xyz scans scans/a.xyz"}) {
    const Outcome info = run("info " + std::string(files));
    EXPECT_EQ(info.code, 3) << files;
    EXPECT_THAT(info.out, AllOf(HasSubstr("one.xyz\n"), HasSubstr("scans/a.xyz\n"))) << files;
    EXPECT_THAT(info.err, HasSubstr(" error: ")) << files;
    const Outcome json = run("info --json " + std::string(files));
    EXPECT_EQ(json.code, 3) << files;
    const auto all = nlohmann::json::parse(json.out);
    ASSERT_EQ(all.size(), 3U) << files;
    int failed = 0;
    for (const auto& file : all) {
      EXPECT_NE(file.contains("error"), file.contains("points")) << file;
      if (file.contains("error")) ++failed;
    }
    EXPECT_EQ(failed, 1) << files;
  }
  const Outcome alone = run("info --json empty.ply");
  EXPECT_EQ(alone.code, 3);
  EXPECT_EQ(alone.out, "");
  EXPECT_THAT(alone.err, HasSubstr("empty.ply: error: the file is empty"));
}

TEST_F(NamedFiles, AnEmptyFileAmongScansIsLeftOutWithAWordAndAloneRefused) {
  for (const char* command : {"new one.xyz empty.ply", "build one.xyz empty.ply --out scene"}) {
    const Outcome outcome = run(command);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("warning: empty.ply: the file is empty; the scan is left out")) << command;
  }
  for (const char* command :
       {"new empty.ply", "build empty.ply --out other", "explore empty.ply --headless --device simulated"}) {
    const Outcome outcome = run(command);
    EXPECT_EQ(outcome.code, 3) << command;
    EXPECT_THAT(outcome.err, HasSubstr("empty.ply: error: the file is empty")) << command;
  }
  EXPECT_FALSE(fs::exists(folder_ / "other"));
}

TEST_F(NamedFiles, AFolderOfScansIsRefusedWithTheirNames) {
  write("folder.yaml", "scans:\n  - file: scans\n");
  for (const char* command : {"info scans", "new scans", "build scans --out scene", "build folder.yaml --out scene",
                              "explore scans --headless --device simulated --duration 1"}) {
    const Outcome outcome = run(command);
    EXPECT_EQ(outcome.code, 3) << command;
    EXPECT_THAT(outcome.err, HasSubstr("scans: error: ")) << command;
    EXPECT_THAT(outcome.err,
                AllOf(HasSubstr("by their names: "), HasSubstr("scans/a.xyz "), HasSubstr("scans/c.xyz and 1 more")))
        << command;
    EXPECT_THAT(outcome.err, Not(HasSubstr("notes.odt"))) << command;
  }
  EXPECT_FALSE(fs::exists(folder_ / "scene"));
}

TEST_F(NamedFiles, AShellsPatternIsRefusedAsOne) {
  write("pattern.yaml", "scans:\n  - file: scans/*.xyz\n");
  for (const char* command :
       {"info 'scans/*.xyz'", "new 'scans/?.xyz'", "build '*.nope' --out scene", "build pattern.yaml --out scene",
        "explore 'scans/[ab].xyz' --headless --device simulated --duration 1"}) {
    const Outcome outcome = run(command);
    EXPECT_EQ(outcome.code, 3) << command;
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("no file has this name"), HasSubstr("by their names"))) << command;
  }
  write("list.yaml", "scans: [scans/*.xyz]\n");
  const Outcome list = run("build list.yaml --out scene");
  EXPECT_EQ(list.code, 2);
  EXPECT_THAT(list.err, AllOf(HasSubstr("list.yaml:1:9: error: a scan is 'scans/*.xyz'"), HasSubstr("'- file: NAME'")));
  fs::copy_file(folder_ / "one.xyz", folder_ / "a*[1].xyz");
  EXPECT_EQ(run("info 'a*[1].xyz'").code, 0) << "a file's own name";
}

}  // namespace
}  // namespace sparsha
