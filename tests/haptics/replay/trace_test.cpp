#include "haptics/replay/trace.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "base/error.h"
#include "base/threads/progress.h"
#include "tests/support/rest_oracle.h"
#include "tests/support/surfaces.h"

namespace sparsha::haptics::test {
namespace {

class TraceFiles : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              (std::string("sparsha_trace_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }
  std::filesystem::path folder_;
};

std::string message_of(const std::filesystem::path& file) {
  try {
    (void)read_hip_path(file);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    return error.what();
  }
  return "no error";
}

std::vector<HipSample> stroke(const MongeSurface& surface, int ticks, double depth_m) {
  std::vector<HipSample> path;
  for (int k = 0; k < ticks; ++k) {
    const double t = 0.001 * k;
    const double x = 0.5 + 0.37 * std::sin(0.9 * t + 0.3);
    const double y = 0.5 + 0.33 * std::sin(1.3 * t);
    path.push_back({t, surface.lattice.origin_m + Eigen::Vector3d(x, y, surface.height(x, y) - depth_m)});
  }
  return path;
}

}  // namespace

TEST_F(TraceFiles, ReadsPathsAndRunsWhateverTheOrderOfColumnsAndLineEnds) {
  const auto path = write("path.csv", "t_s,x_m,y_m,z_m\r\n0,1,2,3\r\n0.001,1e-3,-2.5,+4\r\n\r\n");
  const std::vector<HipSample> samples = read_hip_path(path);
  ASSERT_EQ(samples.size(), 2U);
  EXPECT_EQ(samples[1].t_s, 0.001);
  EXPECT_EQ(samples[1].position_m, Eigen::Vector3d(1e-3, -2.5, 4.0));
  const auto run = write("run.csv", "hip_z_m,t_s,flags,hip_x_m,hip_y_m\n3,0,abc,1,2");
  EXPECT_EQ(read_hip_path(run).at(0).position_m, Eigen::Vector3d(1, 2, 3));
}

TEST_F(TraceFiles, ACancelledTraceEndsAtItsNextLookAndAProgressChangesNoRow) {
  const MongeSurface surface = make_sinusoid(50);
  const std::vector<HipSample> path = stroke(surface, 30000, 1e-3);
  std::vector<double> told;
  Progress whole([&](const ProgressUpdate& update) { told.push_back(update.fraction); });
  const TraceResult plain = trace(surface, path, {}, {});
  const TraceResult watched = trace(surface, path, {}, {}, &whole);
  ASSERT_GE(told.size(), 4U);
  EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
  ASSERT_EQ(watched.rows.size(), plain.rows.size());
  for (std::size_t n = 0; n < plain.rows.size(); ++n) {
    ASSERT_EQ(watched.rows[n].proxy_m, plain.rows[n].proxy_m) << n;
    ASSERT_EQ(watched.rows[n].force_n, plain.rows[n].force_n) << n;
  }
  std::size_t looks = 0;
  Progress ended([&](const ProgressUpdate&) {
    if (++looks == 2) ended.cancel();
  });
  EXPECT_THROW((void)trace(surface, path, {}, {}, &ended), Cancelled);
  EXPECT_EQ(looks, 2U);
}

TEST_F(TraceFiles, RowsThatAreNoNumbersDoubleOrBackInTimeAreCountedAndNamed) {
  const MongeSurface surface = make_sinusoid(50);
  std::vector<HipSample> path = stroke(surface, 20, 1e-3);
  EXPECT_TRUE(sentences(trace(surface, path, {}, {}).summary.path).empty());
  path[3].position_m.z() = std::numeric_limits<double>::quiet_NaN();
  path[7].position_m.x() = std::numeric_limits<double>::infinity();
  path[9].t_s = path[8].t_s;
  path[12].t_s = path[5].t_s;
  path[13].t_s = path[6].t_s;
  path[19].t_s = std::numeric_limits<double>::quiet_NaN();
  const PathDoubts doubts = trace(surface, path, {}, {}).summary.path;
  EXPECT_EQ(doubts.not_a_number, 3U);
  EXPECT_EQ(doubts.first_not_a_number, 4U);
  EXPECT_EQ(doubts.same_time, 1U);
  EXPECT_EQ(doubts.first_same_time, 10U);
  EXPECT_EQ(doubts.backwards, 2U) << "the rows after a step back go on from there, and are earlier than it was";
  EXPECT_EQ(doubts.first_backwards, 13U);
  EXPECT_EQ(sentences(doubts), (std::vector<std::string>{
                                   "3 rows of the hand's path have times or positions that are not numbers (first: row "
                                   "4 below the header)",
                                   "1 row of the hand's path has the time of the row before (row 10 below the header)",
                                   "2 rows of the hand's path are earlier than a row before (first: row 13 below the "
                                   "header)"}));
}

TEST_F(TraceFiles, NamesFileAndLineOfWhatIsWrongInAPath) {
  EXPECT_NE(message_of(write("a.csv", "t_s,x_m,y_m,z_m\n0,1,2,3\n0,1,zwei,3\n")).find("a.csv:3"), std::string::npos);
  EXPECT_NE(message_of(write("b.csv", "t_s,x_m,y_m,z_m\n0,1,2\n")).find("b.csv:2"), std::string::npos);
  EXPECT_NE(message_of(write("comma.csv", "t_s,x_m,y_m,z_m\n0,0,5,1,2,3\n")).find("comma.csv:2"), std::string::npos)
      << "decimal commas";
  EXPECT_NE(message_of(write("c.csv", "time,x,y,z\n0,1,2,3\n")).find("c.csv:1"), std::string::npos);
  EXPECT_NE(message_of(write("d.csv", "t_s,x_m,y_m,z_m\n")).find("d.csv"), std::string::npos);
  EXPECT_NE(message_of(write("e.csv", "")).find("e.csv"), std::string::npos);
  EXPECT_NE(message_of(folder_ / "missing.csv").find("missing.csv"), std::string::npos);
}

TEST_F(TraceFiles, SaysOfAHeaderWhatKeepsItFromBeingOne) {
  const auto says = [&](const std::string& header, const std::string& what) {
    EXPECT_NE(message_of(write("h.csv", header + "\n0,1,2,3\n")).find(what), std::string::npos) << header;
  };
  says("t_s;x_m;y_m;z_m", "semicolons");
  says("t_s\tx_m\ty_m\tz_m", "tabs");
  says("\"t_s\",\"x_m\",\"y_m\",\"z_m\"", "quotes");
  says("T_S,X_M,Y_M,Z_M", "capital letters");
  says("0,1,2,3", "no header");
  says("t_s,x_m,y_m,z_m,x_m", "x_m twice");
  says("t_s,hip_x_m,hip_y_m,hip_z_m,t_s", "t_s twice");
}

TEST_F(TraceFiles, ALastRowThatIsCutIsLeftOutAndSaid) {
  std::vector<std::string> told;
  Progress progress([&](const ProgressUpdate& update) { told.emplace_back(update.text); });
  EXPECT_EQ(read_hip_path(write("a.csv", "t_s,x_m,y_m,z_m\n0,1,2,3\n1,2,3"), &progress).size(), 1U);
  ASSERT_EQ(told.size(), 1U);
  EXPECT_NE(told[0].find("in the middle of a row"), std::string::npos);
  EXPECT_EQ(read_hip_path(write("b.csv", "t_s,x_m,y_m,z_m\n0,1,2,3\n1,2,3,4"), &progress).size(), 2U);
  EXPECT_EQ(told.size(), 1U) << "whole without a line feed";
  EXPECT_NE(message_of(write("c.csv", "t_s,x_m,y_m,z_m\n0,1,2,3\n1,2,3\n")).find("c.csv:3"), std::string::npos);
}

TEST_F(TraceFiles, RowsBesideTheSurfaceAndForcesOfNoDeviceAreCountedAndSaid) {
  const MongeSurface surface = make_sinusoid(50);
  const double spacing_m = surface.lattice.spacing_m;
  std::vector<HipSample> path = stroke(surface, 20, 1e-3);
  // Half a cell beside it is none; 3 m along x and 4 m along y from the corner are 5 m; far below is a great force.
  const Eigen::Vector3d corner_m =
      surface.lattice.origin_m + Eigen::Vector3d(surface.width_m(), surface.depth_m(), 0.0);
  path[4].position_m = corner_m + Eigen::Vector3d(0.5 * spacing_m, 0.0, 10.0);
  path[6].position_m = corner_m + Eigen::Vector3d(3.0, 4.0, 10.0);
  path[9].position_m = surface.lattice.origin_m + Eigen::Vector3d(-2.0, 0.5, -100.0);
  const PathDoubts doubts = trace(surface, path, {}, {}).summary.path;
  EXPECT_EQ(doubts.outside, 2U);
  EXPECT_EQ(doubts.first_outside, 7U);
  EXPECT_EQ(doubts.outside_in_contact, 1U);
  EXPECT_NEAR(doubts.outside_m, 5.0, 1e-9);
  EXPECT_EQ(doubts.impossible_force, 1U);
  EXPECT_GT(doubts.deepest_m, 99.0);
  EXPECT_NEAR(doubts.largest_force_n, scene::HapticsConfig().stiffness_n_per_m * surface.scale * doubts.deepest_m,
              1e-9 * doubts.largest_force_n);
  const std::vector<std::string> said = sentences(doubts);
  ASSERT_EQ(said.size(), 2U);
  EXPECT_NE(said[0].find("2 rows of the hand's path are beside the scene, by up to 5 m"), std::string::npos) << said[0];
  EXPECT_NE(said[1].find("1 row of the path has forces above 50 N"), std::string::npos) << said[1];
}

TEST_F(TraceFiles, WritesRowsThatReadBackToTheSameBits) {
  MongeSurface surface = make_sinusoid(50);
  surface.level = 2;
  const TraceResult result = trace(surface, stroke(surface, 100, 0.003), {}, {});
  write_trace(folder_ / "trace.csv", result);
  std::ifstream file(folder_ / "trace.csv");
  std::string line;
  std::getline(file, line);
  EXPECT_EQ(line,
            "t_s,hip_x_m,hip_y_m,hip_z_m,proxy_x_m,proxy_y_m,proxy_z_m,force_x_n,force_y_n,force_z_n,contact,level,"
            "tick_ns");
  for (const TraceRow& row : result.rows) {
    ASSERT_TRUE(std::getline(file, line));
    std::istringstream fields(line);
    std::vector<double> value;
    for (std::string field; std::getline(fields, field, ',');) value.push_back(std::strtod(field.c_str(), nullptr));
    ASSERT_EQ(value.size(), 13U);
    EXPECT_EQ(value[0], row.t_s);
    EXPECT_EQ(Eigen::Vector3d(value[4], value[5], value[6]), row.proxy_m);
    EXPECT_EQ(Eigen::Vector3d(value[7], value[8], value[9]), row.force_n);
    EXPECT_EQ(value[10], 1.0);
    EXPECT_EQ(value[11], 2.0);
  }
  EXPECT_FALSE(std::getline(file, line));
  EXPECT_EQ(read_hip_path(folder_ / "trace.csv").size(), result.rows.size()) << "a trace is a path too";
}

TEST(Trace, ForceIsStiffnessTimesTheWayToTheProxyInTheDeviceFrame) {
  MongeSurface surface = make_sinusoid(100);
  surface.scale = 0.25;
  surface.lattice.origin_m = {450000.0, 5412000.0, 120.0};
  scene::HapticsConfig haptics;
  haptics.stiffness_n_per_m = 600.0;
  const TraceResult result = trace(surface, stroke(surface, 2000, 0.002), haptics, {});
  const double ulp = std::numeric_limits<double>::epsilon() * 5412000.0;
  for (const TraceRow& row : result.rows) {
    ASSERT_TRUE(row.contact);
    EXPECT_LE((row.force_n - 150.0 * (row.proxy_m - row.hip_m)).cwiseAbs().maxCoeff(), 150.0 * 2.0 * ulp);
  }
}

TEST(Trace, SummaryCountsAndJudgesWhatHappened) {
  MongeSurface surface = make_sinusoid(100);
  std::vector<HipSample> path = stroke(surface, 3000, 0.002);
  for (int k = 0; k < 1000; ++k) path[static_cast<std::size_t>(k)].position_m.z() += 0.004;
  path[1500].position_m.x() = std::numeric_limits<double>::quiet_NaN();
  const TraceSummary summary = trace(surface, path, {}, {}).summary;
  EXPECT_EQ(summary.updates, 3000U);
  EXPECT_EQ(summary.contacts, 1999U);
  EXPECT_EQ(summary.below_surface, 0U);
  EXPECT_EQ(summary.not_a_number, 0U);
  EXPECT_EQ(summary.unfinished, 0U);
  EXPECT_LE(summary.residual_cells_max, 1.1e-9);
  EXPECT_LE(summary.residual_cells_p99, summary.residual_cells_max);
  EXPECT_LE(summary.ns_p50, summary.ns_p99);
  EXPECT_LE(summary.ns_p999, summary.ns_max);
  EXPECT_GT(summary.timer_overhead_ns, 0.0);
}

TEST(Trace, CountsNobodyBelowOnSpikesOfAThousandCells) {
  std::mt19937_64 random(11);
  std::vector<double> heights(1600);
  for (double& height : heights) height = random() % 10 == 0 ? 1.0 : 1e-7 * static_cast<double>(random() % 10);
  const auto spike = [&heights](int i, int j) { return heights[static_cast<std::size_t>(40 * j + i)]; };
  MongeSurface surface = make_surface_of(40, 40, 0.001, [&](double x, double y) {
    return spike(static_cast<int>(std::lround(x / 0.001)), static_cast<int>(std::lround(y / 0.001)));
  });
  set_friction(surface, 0.5, 0.3);
  std::normal_distribution<double> step(0.0, 0.0015);
  Eigen::Vector3d hand(0.02, 0.02, 0.5);
  std::vector<HipSample> path;
  for (int k = 0; k < 30'000; ++k) {
    for (Eigen::Index axis = 0; axis < 3; ++axis) hand[axis] += step(random);
    hand = hand.cwiseMax(Eigen::Vector3d(0.0, 0.0, -0.05)).cwiseMin(Eigen::Vector3d(0.039, 0.039, 0.9));
    path.push_back({0.001 * k, hand});
  }
  const TraceSummary summary = trace(surface, path, {}, {}).summary;
  EXPECT_GT(summary.contacts, 3000U);  // a tenth of the path
  EXPECT_EQ(summary.below_surface, 0U);
}

TEST(Trace, TheFirstProxyStartsAboveOrAtTheHandAndSettles) {
  const MongeSurface surface = make_sinusoid(100);
  const Eigen::Vector3d hip(0.31, 0.22, surface.height(0.31, 0.22) - 0.01);
  const TraceResult result = trace(surface, {{0.0, hip}}, {}, {});
  ASSERT_TRUE(result.rows[0].contact);
  const Judgement verdict = judge(surface, result.rows[0].proxy_m, hip, 0.0);
  EXPECT_LE(verdict.excess_cells, verdict.allowance_cells);
}

TEST(Trace, ThePaperSolverLagsBehindTheExactOneButFollows) {
  const MongeSurface surface = make_sinusoid(100);
  const std::vector<HipSample> path = stroke(surface, 2000, 0.002);
  scene::HapticsConfig haptics;
  const TraceResult exact = trace(surface, path, haptics, {});
  haptics.solver = scene::HapticsConfig::Solver::paper;
  const TraceResult paper = trace(surface, path, haptics, {});
  EXPECT_EQ(paper.summary.not_a_number, 0U);
  EXPECT_EQ(paper.summary.contacts, 2000U);
  double worst = 0.0;
  for (std::size_t k = 0; k < path.size(); ++k)
    worst = std::max(worst, (exact.rows[k].proxy_m - paper.rows[k].proxy_m).norm());
  EXPECT_LE(worst, 2.0 * surface.lattice.spacing_m) << "it chatters at creases, but within a cell or two";
  EXPECT_GT(paper.summary.residual_cells_max, exact.summary.residual_cells_max);
}

}  // namespace sparsha::haptics::test
