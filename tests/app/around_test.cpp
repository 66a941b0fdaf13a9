// A whole object from its scan to a traced path, as a user meets it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "tests/app/program.h"

namespace sparsha {
namespace {

using ::testing::HasSubstr;

/// A ball of 50 mm about (1, 2, 3) m down to `lowest` radii, and a configuration that looks at it askew.
void write_ball(const fs::path& folder, double lowest = -1.0) {
  std::ofstream scan(folder / "ball.xyz");
  scan << std::setprecision(9);
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 6000; ++k) {
    double p[3];
    double length = 0.0;
    for (double& coordinate : p) coordinate = normal(random), length += coordinate * coordinate;
    for (double& coordinate : p) coordinate *= 0.05 / std::sqrt(length);
    if (p[2] < 0.05 * lowest) continue;
    scan << 1.0 + p[0] << ' ' << 2.0 + p[1] << ' ' << 3.0 + p[2] << '\n';
  }
  std::ofstream(folder / "ball.yaml")
      << "scans:\n  - {file: ball.xyz, units: m}\norientation: {euler_deg: [20, 40, 70]}\n"
         "haptics: {stiffness_n_per_m: 1000}\naround: {}\n";
}

TEST_F(Program, TracesAPathRoundAWholeObjectInTheScanFrame) {
  write_ball(folder_);
  const std::string scene = "\"" + (folder_ / "scene").string() + "\"";
  const Outcome built = run("build \"" + (folder_ / "ball.yaml").string() + "\" --out " + scene);
  ASSERT_EQ(built.code, 0);
  EXPECT_THAT(built.out, HasSubstr("around    6 sheets with"));
  EXPECT_TRUE(fs::exists(folder_ / "scene" / "around.png"));
  const std::string page = text_of(folder_ / "scene" / "report.html");
  for (const char* words : {"All around</h3>", "The whole object, all sides"})
    EXPECT_NE(page.find(words), std::string::npos) << words;
  {
    // From outside to 2 mm below the equator, and all round it.
    std::ofstream path(folder_ / "path.csv");
    path << std::setprecision(12) << "t_s,x_m,y_m,z_m\n";
    for (int k = 0; k < 1000; ++k) {
      const double turn = 2.0 * M_PI * std::max(0, k - 100) / 900.0;
      const double radius = 0.058 - 0.0001 * std::min(k, 100);
      path << 0.001 * k << ',' << 1.0 + radius * std::cos(turn) << ",2," << 3.0 + radius * std::sin(turn) << '\n';
    }
  }
  const std::string trace = "trace " + scene + " --hip \"" + (folder_ / "path.csv").string() +
                            "\" --frame scan --out \"" + (folder_ / "trace.csv").string() + "\"";
  const Outcome done = run(trace + " --json");
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_EQ(done.err.find("front view"), std::string::npos) << done.err;
  const auto summary = nlohmann::json::parse(done.out);
  EXPECT_GE(summary["around"]["touched"].get<int>(), 4);
  EXPECT_GE(summary["around"]["hand_overs"].get<int>(), summary["around"]["touched"].get<int>() - 1);
  EXPECT_EQ(summary["around"]["releases"].get<int>(), 0);
  EXPECT_EQ(summary["unfinished"].get<int>(), 0);

  std::istringstream rows(text_of(folder_ / "trace.csv"));
  std::string row;
  std::getline(rows, row);
  EXPECT_THAT(row, HasSubstr("tick_ns,sheet"));
  int contacts = 0;
  for (int k = 0; std::getline(rows, row); ++k) {
    std::vector<double> v;
    std::istringstream fields(row);
    for (std::string field; std::getline(fields, field, ',');) v.push_back(std::stod(field));
    ASSERT_EQ(v.size(), 14U);
    if (k < 105) continue;
    ASSERT_EQ(v[10], 1.0) << k;
    ++contacts;
    // The proxy on the ball, and 2 mm times 1000 N/m away from its middle.
    const double place[3] = {v[4] - 1.0, v[5] - 2.0, v[6] - 3.0};
    EXPECT_NEAR(std::sqrt(place[0] * place[0] + place[1] * place[1] + place[2] * place[2]), 0.05, 2e-4) << k;
    const double out = (v[7] * (v[1] - 1.0) + v[9] * (v[3] - 3.0)) / std::hypot(v[1] - 1.0, v[3] - 3.0);
    EXPECT_NEAR(out, 2.0, 0.2) << k;
  }
  EXPECT_EQ(contacts, 895);

  const Outcome refused = run(trace + " --solver paper");
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err, HasSubstr("--solver paper is not there for whole objects yet"));
}

TEST_F(Program, ExportsOneClosedMeshOfAWholeObject) {
  write_ball(folder_);
  const std::string scene = "\"" + (folder_ / "scene").string() + "\"";
  ASSERT_EQ(run("build \"" + (folder_ / "ball.yaml").string() + "\" --out " + scene).code, 0);
  const auto to = [&](const char* name) { return "export " + scene + " --to \"" + (folder_ / name).string() + "\" "; };
  const Outcome whole = run(to("ball.ply") + "--json");
  ASSERT_EQ(whole.code, 0) << whole.err;
  EXPECT_EQ(whole.err.find("front view"), std::string::npos) << whole.err;
  EXPECT_EQ(whole.err.find("made up"), std::string::npos) << whole.err;
  const auto facts = nlohmann::json::parse(whole.out);
  EXPECT_EQ(facts["shells"].get<int>(), 1);
  EXPECT_NEAR(facts["volume_m3"].get<double>(), 4.0 / 3.0 * M_PI * std::pow(0.05, 3.0), 2e-6);
  EXPECT_EQ(facts["unseen"].get<double>(), 0.0);
  const Outcome said = run(to("ball.obj") + "--holes leave");
  EXPECT_THAT(said.out, HasSubstr("1 closed surface"));
  // The front view is a mesh of its own, by choice.
  EXPECT_EQ(run(to("front.ply") + "--front").code, 0);
  EXPECT_NE(text_of(folder_ / "front.ply"), text_of(folder_ / "ball.ply"));
  EXPECT_THAT(run(to("points.xyz")).err, HasSubstr("front view"));
  EXPECT_EQ(run(to("ball.tif") + "--holes leave").code, 2);
  EXPECT_THAT(run(to("ball.stl") + "--unrolled").err, HasSubstr("--unrolled means nothing here"));
  EXPECT_EQ(run(to("ball.glb") + "--haptics").code, 2);
}

TEST_F(Program, WarnsOfTheShareOfAClosedMeshThatIsMadeUp) {
  write_ball(folder_, -0.7);
  ASSERT_EQ(run("build ball.yaml --out scene").code, 0);
  const Outcome closed = run("export scene --to ball.ply --json");
  ASSERT_EQ(closed.code, 0) << closed.err;
  const double unseen = nlohmann::json::parse(closed.out)["unseen"].get<double>();
  // The cap that is missing is 0.15 of the ball, the disc over it 0.13 of that and the rest.
  EXPECT_NEAR(unseen, 0.14, 0.03);
  EXPECT_THAT(closed.err, HasSubstr(std::to_string(static_cast<int>(std::lround(100.0 * unseen))) +
                                    " % of the mesh's surface is made up: it closes over places that no scan saw"));
  const Outcome open = run("export scene --to ball.obj --holes leave");
  ASSERT_EQ(open.code, 0) << open.err;
  EXPECT_EQ(open.err.find("made up"), std::string::npos) << open.err;
  EXPECT_THAT(open.out, HasSubstr("it is left open there"));
}

TEST_F(Program, LooksAtAMeshOfTwelveTrianglesFromAllSides) {
  // A box of 60 x 40 x 50 mm.
  const double half[3] = {0.03, 0.02, 0.025};
  std::ofstream mesh(folder_ / "box.obj");
  for (int k = 0; k < 8; ++k)
    mesh << "v " << (k & 1 ? half[0] : -half[0]) << ' ' << (k & 2 ? half[1] : -half[1]) << ' '
         << (k & 4 ? half[2] : -half[2]) << '\n';
  for (const char* face :
       {"1 3 4", "1 4 2", "5 6 8", "5 8 7", "1 2 6", "1 6 5", "3 7 8", "3 8 4", "1 5 7", "1 7 3", "2 4 8", "2 8 6"})
    mesh << "f " << face << '\n';
  mesh.close();
  write("box.yaml", "scans: [{file: box.obj, units: m}]\ngrid: {spacing_mm: 1}\ncheck: {}\naround: {}\n");
  const Outcome built = run("build box.yaml --out scene");
  ASSERT_EQ(built.code, 0) << built.err;
  const auto around = nlohmann::json::parse(text_of(folder_ / "scene" / "report.json"))["around"];
  EXPECT_EQ(around["sheets"].get<int>(), 6);
  EXPECT_LT(around["check"]["cloud_to_surface"]["median_m"].get<double>(), 1e-6);
  EXPECT_EQ(around["check"]["far"].get<int>(), 0);
  ASSERT_EQ(run("export scene --nodes --to nodes.xyz").code, 0);
  std::ifstream nodes(folder_ / "nodes.xyz");
  int on_side[6] = {}, rounded = 0;  // at edges, by less than half a spacing
  for (std::string line; std::getline(nodes, line);) {
    double p[3];
    std::istringstream fields(line);
    ASSERT_TRUE(fields >> p[0] >> p[1] >> p[2]) << line;
    int side = -1;
    for (int axis = 0; axis < 3; ++axis) {
      ASSERT_LT(std::abs(p[axis]), half[axis] + 5e-4);
      if (std::abs(std::abs(p[axis]) - half[axis]) < 1e-4) side = 2 * axis + (p[axis] > 0 ? 1 : 0);
    }
    ++(side >= 0 ? on_side[side] : rounded);
  }
  EXPECT_LT(rounded, 800);
  for (int side = 0; side < 6; ++side) {
    const double nodes_of = 4e6 * half[(side / 2 + 1) % 3] * half[(side / 2 + 2) % 3];
    EXPECT_NEAR(on_side[side], nodes_of, 0.15 * nodes_of) << side;
  }
}

}  // namespace
}  // namespace sparsha
