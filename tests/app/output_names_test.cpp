// Names of outputs that say something else than what would be written, or that no file can have.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/app/program.h"

namespace sparsha {
namespace {
using ::testing::HasSubstr;

class OutputNames : public Program {
 protected:
  void SetUp() override {
    Program::SetUp();
    write("a.ply", kTetrahedron);
  }
  void expect_refused(const std::string& command, const std::string& name, const std::string& remedy) {
    const std::size_t before = entries();
    const Outcome outcome = run(command + name);
    EXPECT_EQ(outcome.code, 2) << command << name;
    EXPECT_THAT(outcome.err, HasSubstr(remedy)) << command << name;
    EXPECT_EQ(entries(), before) << command << name;
  }
};

TEST_F(OutputNames, WithTheEndingOfAnotherFormatAreRefused) {
  const std::string explore = "explore a.ply --device simulated --headless --duration 0.2 ";
  for (const char* name : {"v.jpg", "v", "v.png.jpeg"})
    expect_refused(explore + "--screenshot ", name, "a name that ends in .png");
  for (const char* name : {"run.mp3", "run"})
    expect_refused(explore + "--audio-out ", name, "a name that ends in .wav");
  EXPECT_EQ(run(explore + "--screenshot V.PNG --audio-out R.WAV").code, 0);
  EXPECT_TRUE(text_of(folder_ / "V.PNG").starts_with("\x89PNG"));
}

TEST_F(OutputNames, OfFoldersAreNoConfigurations) {
  write("simulation.yaml", "surface: {form: plane, size_m: [0.2, 0.2]}\nnodes: 64\nsampler: {points_per_node: 4}\n");
  expect_refused("build a.ply --out ", "oni.yaml", "e.g. oni.scene");
  expect_refused("build a.ply --out ", "oni.yml", "e.g. oni.scene");
  expect_refused("simulate simulation.yaml --out ", "oni.yaml", "the name of a folder");
}

TEST_F(OutputNames, ADashIsNoFile) {
  write("path.csv", "t_s,x_m,y_m,z_m\n0,0.1,0.1,0\n");
  expect_refused("trace a.ply --hip path.csv --out ", "-", "/dev/stdout");
  expect_refused("explore a.ply --device simulated --headless --duration 0.2 --record ", "-", "/dev/stdout");
  EXPECT_EQ(run("trace a.ply --hip path.csv --out ./-").code, 0);
  EXPECT_TRUE(fs::exists(folder_ / "-"));
}

TEST_F(OutputNames, AStudyThatIsNamedWithItsEndingIsTheSame) {
  const std::string explore = "explore a.ply --device simulated --headless --duration 0.2 --study ";
  EXPECT_EQ(run(explore + "st.csv").code, 0);
  EXPECT_EQ(run(explore + "st").code, 0);
  EXPECT_FALSE(fs::exists(folder_ / "st.csv.csv"));
  const std::string rows = text_of(folder_ / "st.csv");
  EXPECT_EQ(std::count(rows.begin(), rows.end(), '\n'), 3) << "a header and two sessions";
}

TEST_F(OutputNames, ThatAreTooLongAreRefusedBeforeAnyWork) {
  const std::string name(251, 'a');  // of 255 bytes with .ply, and more with .scene
  fs::rename(folder_ / "a.ply", folder_ / (name + ".ply"));
  for (const std::string& out : {std::string(), " --out " + name + "longer", " --out new/" + name + "longer"}) {
    const Outcome outcome = run("build " + name + ".ply" + out);
    EXPECT_EQ(outcome.code, 2) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("is too long; a shorter one, e.g. by --out")) << out;
    EXPECT_EQ(outcome.err.find("project"), std::string::npos) << outcome.err;
    EXPECT_EQ(entries(), 1U) << out;
  }
  EXPECT_EQ(run("build " + name + ".ply --out scene").code, 0);
  EXPECT_EQ(run("export scene --to " + name + "s.ply").code, 2);
  EXPECT_EQ(run("export scene --to " + name + ".xyz").code, 0) << "255 bytes are a name";
}

TEST_F(OutputNames, AScenesFolderIsBuiltFromItsConfiguration) {
  ASSERT_EQ(run("build a.ply --out a.scene").code, 0);
  const Outcome outcome = run("build a.scene");
  EXPECT_EQ(outcome.code, 3);
  EXPECT_THAT(outcome.err, HasSubstr("this is the folder of a scene, and no scan; a.scene/scene.yaml"));
  EXPECT_EQ(run("build a.scene/scene.yaml").code, 0);
}

TEST_F(OutputNames, MemoryIsSaidAsItWasAskedFor) {
  write("b.xyz", "0 0 0\n1 0 0.1\n0 1 0.2\n1 1 0\n");
  write("b.yaml", "scans: [{file: b.xyz, units: m}]\ngrid: {size: 20}\n");
  EXPECT_THAT(run("build b.yaml --memory 1 --out scene").err, HasSubstr("more than the limit of 1 byte;"));
  EXPECT_THAT(run("build b.yaml --memory 2MB --out scene").err, HasSubstr("more than the limit of 2 MB;"));
  EXPECT_EQ(run("build a.ply --validate --memory 1TB").code, 0);
  EXPECT_EQ(run("build a.ply --validate --memory 0.5TiB").code, 0);
  EXPECT_EQ(run("build a.ply --validate --memory 1XB").code, 2);
}

TEST_F(OutputNames, PointsThatAllStandAtZeroAreNotCalledMissing) {
  write("zero.xyz", "0 0 0\n0 0 0\n0 0 0\n0 0 0\n0 0 0\n");
  for (const char* command : {"new zero.xyz", "build zero.xyz"}) {
    const Outcome outcome = run(command);
    EXPECT_EQ(outcome.code, 3) << command;
    EXPECT_THAT(outcome.err, HasSubstr("all of its 5 points stand at 0 0 0")) << command;
  }
}

}  // namespace
}  // namespace sparsha
