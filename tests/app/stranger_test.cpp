// Scenes and scans from strangers: which files they may name, and what reaches the terminal.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/text/printable.h"
#include "tests/app/program.h"

namespace sparsha {
namespace {
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kSecret = "root:x:0:0:nobody's business\n";

class Stranger : public Program {
 protected:
  void SetUp() override {
    Program::SetUp();
    write("simulation.yaml", "surface: {form: plane, size_m: [0.2, 0.2]}\nnodes: 64\nsampler: {points_per_node: 4}\n");
    ASSERT_EQ(run("simulate simulation.yaml --out scan").code, 0);
    ASSERT_EQ(run("build scan/sparsha.yaml -o scene --quiet").code, 0);
    write("secret", kSecret);
  }
  void replace_in_description(const std::string& from, const std::string& to) {
    std::string yaml = text_of(folder_ / "scene" / "scene.yaml");
    const std::size_t at = yaml.find(from);
    ASSERT_NE(at, std::string::npos);
    write("scene/scene.yaml", yaml.replace(at, from.size(), to));
  }
};

bool has_control_characters(const std::string& text) {
  return std::any_of(text.begin(), text.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return (byte < 0x20 && c != '\n' && c != '\t') || byte == 0x7F;
  });
}

TEST_F(Stranger, ScansOfASceneAreReadWhenTheyAreItsOwnAndElseOnlyWithTrust) {
  EXPECT_EQ(run("check scene --json").code, 0) << "its own scan, by its bytes";
  replace_in_description("../scan/scan.ply", "../secret");
  for (const char* arguments : {"check scene", "build scene/scene.yaml"}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 3) << arguments;
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("--trust"), Not(HasSubstr("root:x"))));
  }
  // Trusted, the file is read, is no scan, and its line is still nobody's business.
  const Outcome trusted = run("check scene --trust");
  EXPECT_EQ(trusted.code, 3);
  EXPECT_THAT(trusted.err, AllOf(HasSubstr("no rows of numbers"), Not(HasSubstr("root:x"))));
  EXPECT_THAT(run("check scene secret").err, Not(HasSubstr("root:x")));
  replace_in_description("../secret", "../other.ply");
  fs::copy_file(folder_ / "scan" / "scan.ply", folder_ / "other.ply");
  EXPECT_EQ(run("check scene").code, 0) << "the same bytes elsewhere";
}

TEST_F(Stranger, AClipOutsideIsRefusedByEveryCommandUnlessTrusted) {
  replace_in_description("viewer:",
                         "audio:\n  regions:\n    - {name: a, box_m: [0, 0, 1, 1], clip: ../secret}\nviewer:");
  write("path.csv", "t_s,x_m,y_m,z_m\n0,0.1,0.1,0\n");
  for (const char* arguments :
       {"info scene", "check scene", "export scene --to x.ply", "build scene/scene.yaml",
        "trace scene --hip path.csv --out t.csv", "explore scene --device simulated --headless --duration 0.2"}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 3) << arguments;
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("outside the scene's folder"), Not(HasSubstr("root:x")))) << arguments;
  }
  EXPECT_EQ(run("info scene --trust").code, 0);
  EXPECT_EQ(run("export scene --trust --to x.ply").code, 0);
}

TEST_F(Stranger, ControlCharactersOfFilesNeverReachTheTerminal) {
  const std::string evil = "\x1b]0;owned\x07\x1b[2j\x7f\302\23331m";  // the reader takes names in lower case
  write("evil.ply",
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
        "property float " +
            evil + "\nend_header\n0 0 0 1\n");
  write("bad.ply", "ply\nformat " + evil + " 1.0\n");
  write("words.xyz", "0 0 0\n1 1 1\n" + evil + "\n");
  write("name\033[31m.ply", kTetrahedron);
  write("c.yaml", "scans: [{file: \"a\\x1b[31mb.ply\"}]\n");
  write("k.yaml", "scans: [{file: a.ply}]\n\"\\x1b[31mkey\": 1\n");
  for (const std::string& arguments :
       {std::string("info evil.ply"), std::string("info evil.ply --json"), std::string("info bad.ply"),
        std::string("info words.xyz"), std::string("info name*.ply"), std::string("info name*.ply --json"),
        std::string("new name*.ply"), std::string("build c.yaml"), std::string("build k.yaml"),
        std::string("build name*.ply -o \"$(printf 'out\\033[31m')\""), std::string("'\x1b[31m'")}) {
    const Outcome outcome = run(arguments);
    EXPECT_FALSE(has_control_characters(outcome.out + outcome.err)) << arguments;
    EXPECT_THAT(outcome.out + outcome.err, Not(HasSubstr("\xc2\x9b"))) << arguments;
    EXPECT_FALSE((outcome.out + outcome.err).empty()) << arguments;
  }
  const auto json = nlohmann::json::parse(run("info evil.ply --json").out);
  EXPECT_EQ(json["fields"][3], evil) << "machines get the text itself";
}

TEST(Printable, EscapesWhatATerminalObeysAndKeepsAllOtherText) {
  using sparsha::printable;
  for (const char* kept : {"plain", "Grüße, 表面, 🗿", "a \"quoted\" \\ text"}) EXPECT_EQ(printable(kept), kept);
  EXPECT_EQ(printable("\x1b[2J"), "\\u001b[2J");
  EXPECT_EQ(printable("a\nb\tc", true), "a\nb\tc");
  EXPECT_EQ(printable("a\nb\tc"), "a\\u000ab\\u0009c");
  EXPECT_EQ(printable("\x7f\xc2\x80\xc2\x9f\xc2\xa0"), "\\u007f\\u0080\\u009f\xc2\xa0");
  EXPECT_EQ(printable("\342\200\256abc"),
            "\\u202eabc");  // turns the direction of writing
  EXPECT_EQ(printable("\2331m"),
            "\\x9b1m");  // a control character of 8-bit terminals
  EXPECT_EQ(printable("\xc0\x9b\xed\xa0\x80\xf4\x90\x80\x80\xe2\x82"),
            "\\xc0\\x9b\\xed\\xa0\\x80\\xf4\\x90\\x80\\x80\\xe2\\x82");
  EXPECT_EQ(printable(std::string_view("\0", 1)), "\\u0000");
}

TEST_F(Stranger, AScanThatCannotCarryAGridIsTheScansFault) {
  write("line.xyz", "0 0 0\n1 0 0\n2 0 0\n3 0 0\n4 0 0\n5 0 0\n");
  write("point.xyz", "1 1 1\n1 1 1\n1 1 1\n1 1 1\n1 1 1\n");
  write("slim.xyz", "0 0 0\n1 1e-5 0\n2 0 0\n3 1e-5 0\n4 0 0\n5 1e-5 0\n6 0 0\n7 1e-5 0\n");
  write("solid.stl", "solid nothing\nendsolid nothing\n");
  for (const char* scan : {"line.xyz", "point.xyz", "slim.xyz", "solid.stl"}) {
    EXPECT_EQ(run(std::string("build ") + scan + " -o s").code, 3) << scan;
    write("c.yaml", std::string("scans: [{file: ") + scan + "}]\n");
    EXPECT_EQ(run("build c.yaml -o s").code, 3) << scan;
    write("d.yaml", std::string("scans: [{file: ") + scan + "}]\ngrid: {spacing_mm: 10}\n");
    EXPECT_EQ(run("build d.yaml -o s").code, 3) << scan;
  }
  const Outcome wide = run("build scan/sparsha.yaml --set \"grid={spacing_mm: 1e6}\" -o s");
  EXPECT_EQ(wide.code, 2) << "the spacing's fault";
  EXPECT_THAT(wide.err, testing::HasSubstr("\nscan/sparsha.yaml: error: "));
}

TEST_F(Stranger, ANoteThatBuildTakesIsOneThatExploreTakes) {
  const std::string rest = "decay_s: 1}}]}\ngrid: {spacing_mm: 5}\n";
  for (const auto& [hz, taken] : {std::pair{"16000", true}, std::pair{"16001", false}, std::pair{"20000", false},
                                  std::pair{"10", true}, std::pair{"9.9", false}}) {
    write("scan/note.yaml",
          std::string(
              "scans: [{file: scan.ply}]\naudio: {regions: [{name: a, box_m: [0, 0, 1, 1], modal: {frequency_hz: ") +
              hz + ", " + rest);
    EXPECT_EQ(run("build scan/note.yaml -o note").code, taken ? 0 : 2) << hz;
    if (!taken) continue;
    EXPECT_EQ(run("explore note --device simulated --headless --duration 0.2 --audio-out a.wav").code, 0) << hz;
  }
}

}  // namespace
}  // namespace sparsha
