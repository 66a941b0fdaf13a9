// A column from its scan to an unrolled scene, a path over the seam, and back into the scan frame, as a user meets it.
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

constexpr double kX_m = 7.0, kZ_m = -2.0;  // of the axis, along y

/// Distance of the surface from the axis: five soft flutes.
double radius_m(double turn) { return 0.1 + 0.003 * std::cos(5.0 * turn); }

void write_column(const fs::path& folder) {
  std::ofstream scan(folder / "column.xyz");
  scan << std::setprecision(10);
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int k = 0; k < 24000; ++k) {
    const double turn = 2 * M_PI * unit(random), r = radius_m(turn);
    scan << kX_m + r * std::sin(turn) << ' ' << 0.3 * unit(random) << ' ' << kZ_m + r * std::cos(turn) << '\n';
  }
  std::ofstream(folder / "column.yaml") << "scans:\n  - {file: column.xyz, units: m}\nunroll: {axis: auto}\ncheck: {}\n"
                                           "haptics: {stiffness_n_per_m: 1000}\n";
}

std::vector<std::vector<double>> numbers_of(const std::string& text, char between) {
  std::vector<std::vector<double>> rows;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() || std::isalpha(static_cast<unsigned char>(line.front())) != 0) continue;
    std::istringstream fields(line);
    std::vector<double>& row = rows.emplace_back();
    for (std::string field; std::getline(fields, field, between);) row.push_back(std::stod(field));
  }
  return rows;
}

TEST_F(Program, UnrollsAColumnAndTouchesItOverTheSeam) {
  write_column(folder_);
  const std::string scene = "\"" + (folder_ / "scene").string() + "\"";
  const Outcome built = run("build \"" + (folder_ / "column.yaml").string() + "\" --out " + scene);
  ASSERT_EQ(built.code, 0) << built.err;
  const auto report = nlohmann::json::parse(text_of(folder_ / "scene" / "report.json"));
  EXPECT_THAT(report["orientation"].get<std::string>(), HasSubstr("unrolled from a cylinder"));
  const auto& points = report["points"];
  EXPECT_EQ(points["read"].get<int>(), 24000);
  EXPECT_EQ(points["used"].get<int>() + points["occluded"].get<int>() + points["outlier"].get<int>() +
                points["outside"].get<int>(),
            24000);
  EXPECT_LT(report["check"]["cloud_to_surface"]["p95_m"].get<double>(), 3e-4);
  EXPECT_GT(report["coverage"].get<double>(), 0.94);
  EXPECT_EQ(report["grid"]["axes"].get<std::string>(), "local");

  // Nodes come back once around, to where the surface is.
  ASSERT_EQ(run("export " + scene + " --nodes --to \"" + (folder_ / "nodes.xyz").string() + "\"").code, 0);
  std::vector<double> off, turns;
  for (const std::vector<double>& p : numbers_of(text_of(folder_ / "nodes.xyz"), ' ')) {
    const double x = p.at(0) - kX_m, z = p.at(2) - kZ_m;
    turns.push_back(std::atan2(x, z));
    off.push_back(std::abs(std::hypot(x, z) - radius_m(turns.back())));
  }
  std::sort(off.begin(), off.end());
  EXPECT_LT(off[off.size() * 95 / 100], 4e-4);
  std::vector<int> sectors(12, 0);
  for (const double turn : turns) ++sectors[static_cast<std::size_t>((turn + M_PI) / (2 * M_PI) * 11.9999)];
  const auto [fewest, most] = std::minmax_element(sectors.begin(), sectors.end());
  EXPECT_LT(*most, 1.15 * *fewest);

  // Two and a half turns, 2 mm below the surface.
  {
    std::ofstream path(folder_ / "path.csv");
    path << "t_s,x_m,y_m,z_m\n" << std::setprecision(12);
    for (int k = 0; k <= 2500; ++k) {
      const double turn = 2 * M_PI * k / 1000.0, r = radius_m(turn) - (k < 10 ? -0.002 : 0.002);
      path << 0.001 * k << ',' << kX_m + r * std::sin(turn) << ",0.15," << kZ_m + r * std::cos(turn) << '\n';
    }
  }
  const Outcome traced = run("trace " + scene + " --hip \"" + (folder_ / "path.csv").string() +
                             "\" --frame scan --no-friction --out \"" + (folder_ / "trace.csv").string() + "\"");
  ASSERT_EQ(traced.code, 0) << traced.err;
  const auto rows = numbers_of(text_of(folder_ / "trace.csv"), ',');
  ASSERT_EQ(rows.size(), 2501U);
  std::vector<double> before;
  for (std::size_t k = 20; k < rows.size(); ++k) {
    const std::vector<double>& v = rows[k];
    ASSERT_EQ(v.at(10), 1.0) << k;
    const double x = v[4] - kX_m, z = v[6] - kZ_m;
    EXPECT_NEAR(std::hypot(x, z), radius_m(std::atan2(x, z)), 6e-4) << k;
    EXPECT_NEAR(v[5], 0.15, 2e-3) << k;
    const double outwards = (v[7] * x + v[9] * z) / std::hypot(x, z);
    EXPECT_NEAR(outwards, 2.0, 0.5) << k;
    if (!before.empty()) {
      EXPECT_LT(std::hypot(v[7] - before[7], v[8] - before[8], v[9] - before[9]), 0.6) << k;  // the seam is not felt
    }
    before = v;
  }

  const Outcome checked = run("check " + scene + " --json");
  ASSERT_EQ(checked.code, 0) << checked.err;
  EXPECT_LT(nlohmann::json::parse(checked.out)["check"]["cloud_to_surface"]["p95_m"].get<double>(), 3e-4);

  // What was found is written, so that it is built again to the same picture.
  ASSERT_EQ(run("build \"" + (folder_ / "scene" / "scene.yaml").string() + "\" --out \"" +
                (folder_ / "again").string() + "\"")
                .code,
            0);
  EXPECT_EQ(nlohmann::json::parse(text_of(folder_ / "again" / "report.json"))["grid"]["nx"], report["grid"]["nx"]);

  ASSERT_EQ(run("export " + scene + " --unrolled --nodes --to \"" + (folder_ / "flat.xyz").string() + "\"").code, 0);
  for (const std::vector<double>& p : numbers_of(text_of(folder_ / "flat.xyz"), ' '))
    ASSERT_LT(std::abs(p.at(2)), 0.01);
}

TEST_F(Program, SaysWhenNothingCanBeUnrolled) {
  std::ofstream ball(folder_ / "ball.xyz");
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 4000; ++k) {
    const double p[3] = {normal(random), normal(random), normal(random)};
    const double length = std::hypot(p[0], p[1], p[2]);
    ball << p[0] / length << ' ' << p[1] / length << ' ' << p[2] / length << '\n';
  }
  ball.close();
  write("ball.yaml", "scans: [{file: ball.xyz, units: m}]\nunroll: {axis: auto}\n");
  const Outcome built = run("build ball.yaml --out scene");
  EXPECT_EQ(built.code, 3);
  EXPECT_THAT(built.err, HasSubstr("unroll: no axis can be told"));
  EXPECT_FALSE(fs::exists(folder_ / "scene"));
}

}  // namespace
}  // namespace sparsha
