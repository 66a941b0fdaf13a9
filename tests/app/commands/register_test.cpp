// `sparsha register` as a user meets it, and what a build says of scans that were not registered.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "scene/config/config.h"
#include "tests/app/program.h"

namespace sparsha {
namespace {
using ::testing::AllOf;
using ::testing::HasSubstr;

// The sample relief, whose second station stands 2 mm nearer than it should.
std::string misplaced() {
  const std::string data = (fs::path(SPARSHA_SOURCE_DIR) / "data" / "relief").string();
  return "# not yet registered\nscans:\n"
         "  - file: " +
         data +
         "/station-1.ply\n"
         "    units: m\n"
         "    pose: {translate: [-0.55, -1, 0.6], quaternion: [0, 0, -0.3100911230304846, 0.9507068398921367]}\n"
         "  - file: " +
         data +
         "/station-2.ply   # moved by hand\n"
         "    units: m\n"
         "    pose: {translate: [0.95, -1.052, 0.35], quaternion: [0, 0, 0.311122969374084, 0.9503696638297399]}\n"
         "register: {method: gicp}\n"
         "orientation: {look_from: [0, -1, 0], up: [0, 0, 1]}\n"
         "grid: {spacing_mm: 3}\n";
}

TEST_F(Program, RegisterWritesTheConfigurationWithPosesThatPutTheStationsTogether) {
  write("statue.yaml", misplaced());
  const Outcome outcome = run("register statue.yaml");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("# not yet registered"), HasSubstr("# moved by hand")));
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("before"), HasSubstr("after"), HasSubstr("station-1.ply - station-2.ply")));
  write("registered.yaml", outcome.out);
  const scene::Config config = scene::load_config(folder_ / "registered.yaml");
  ASSERT_EQ(config.scans.size(), 2U);
  EXPECT_EQ(config.scans[0].pose(0, 3), -0.55);
  // What is right for the sample: its noise is 0.06 mm and the stations stand a metre from the slab.
  EXPECT_LT((config.scans[1].pose.topRightCorner<3, 1>() - Eigen::Vector3d(0.95, -1.05, 0.35)).norm(), 0.3e-3);

  const Outcome json = run("register statue.yaml --json --threads 1 --report pairs.html");
  ASSERT_EQ(json.code, 0) << json.err;
  const auto result = nlohmann::json::parse(json.out);
  EXPECT_EQ(result["scans"][1]["pose"][3], config.scans[1].pose(0, 3)) << "not the same with one thread";
  ASSERT_EQ(result["pairs"].size(), 1U);
  EXPECT_LT(result["pairs"][0]["after"]["residual_m"], result["pairs"][0]["before"]["residual_m"]);
  EXPECT_EQ(result["pairs"][0]["use"], "used");

  // The page has the same figures, before and after, in its one row.
  const std::string page = text_of(folder_ / "pairs.html");
  const std::string row = page.substr(page.find("<tbody>"), page.find("</tbody>") - page.find("<tbody>"));
  const auto overlap = [&](const char* when) {
    char text[32];
    std::snprintf(text, sizeof(text), "<td>%.1f", 100.0 * result["pairs"][0][when]["overlap"].get<double>());
    return row.find(text);
  };
  EXPECT_NE(overlap("before"), std::string::npos) << row;
  EXPECT_LT(overlap("before"), row.rfind("<td>"));
  EXPECT_NE(overlap("after"), std::string::npos) << row;
  EXPECT_THAT(page, AllOf(HasSubstr("Residual before"), HasSubstr("Residual after"), HasSubstr("<svg ")));
}

TEST_F(Program, RegisterGoesOnFromThePairsOfOneThatWasKilled) {
  write("statue.yaml", misplaced());
  const Outcome nowhere = run("register statue.yaml --resume");
  EXPECT_EQ(nowhere.code, 2);
  EXPECT_THAT(nowhere.err, AllOf(HasSubstr("--resume"), HasSubstr("--out")));
  ASSERT_EQ(run("register statue.yaml --out once.yaml").code, 0);

  const std::string registers = "register statue.yaml --resume --out registered.yaml";
  const Outcome again = run(registers, "/dev/null",
                            "true; \"" SPARSHA_PROGRAM "\" " + registers +
                                " 2> /dev/null & killed=$!; while kill -0 $killed && ! grep -q , "
                                ".registered.yaml.pairs; do sleep 0.01; done 2> /dev/null; kill -9 $killed; wait; ");
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_THAT(again.err, HasSubstr("results of pairs taken from a registration that was ended: 1"));
  EXPECT_EQ(text_of(folder_ / "registered.yaml"), text_of(folder_ / "once.yaml"));
  EXPECT_FALSE(fs::exists(folder_ / ".registered.yaml.pairs"));
}

TEST_F(Program, ABuildMovesNoScanButReportsHowTheyFit) {
  write("statue.yaml", misplaced());
  const Outcome outcome = run("build statue.yaml --out scene");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const scene::Config built = scene::load_config(folder_ / "scene" / "scene.yaml");
  bool as_given = false;
  for (const scene::ScanConfig& scan : built.scans) as_given = as_given || scan.pose(1, 3) == -1.052;
  EXPECT_TRUE(as_given);
  const auto report = nlohmann::json::parse(text_of(folder_ / "scene" / "report.json"));
  ASSERT_EQ(report["pairs"].size(), 1U);
  EXPECT_GT(report["pairs"][0]["residual_m"], 0.5e-3);
  EXPECT_THAT(report["warnings"].dump(), HasSubstr("sparsha register"));
  EXPECT_THAT(text_of(folder_ / "scene" / "report.html"), HasSubstr("How the scans fit each other"));
}

TEST_F(Program, RegisterNamesWhatItCannotDo) {
  write("one.yaml",
        "scans: [{file: \"" + (fs::path(SPARSHA_SOURCE_DIR) / "data/relief/station-1.ply").string() + "\"}]\n");
  EXPECT_EQ(run("register one.yaml").code, 2);
  EXPECT_EQ(run("register scan.ply").code, 2);
  EXPECT_EQ(run("register none.yaml").code, run("build none.yaml").code);
  std::string apart = misplaced();
  apart.replace(apart.find("[0.95, -1.052"), 13, "[9.95, -1.052");
  write("apart.yaml", apart);
  const Outcome outcome = run("register apart.yaml");
  EXPECT_EQ(outcome.code, 3);
  EXPECT_EQ(outcome.out, "");
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("station-1.ply"), HasSubstr("station-2.ply")));
}

}  // namespace
}  // namespace sparsha
