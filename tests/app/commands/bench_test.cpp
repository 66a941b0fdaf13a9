// The open benchmark as another program's author meets it: exported files are read here by a reader of the test's own,
// forces are computed here in closed form, and the judge is asked about right, wrong and hostile results.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "tests/app/program.h"

namespace sparsha {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr double kStiffness = 500.0;  // N/m, as protocol.md says
constexpr double kTurn = 2.0 * std::numbers::pi;

using Vector = std::array<double, 3>;

double length(const Vector& v) { return std::hypot(v[0], v[1], v[2]); }

/// Numbers of a file, row by row; what separates them does not matter.
std::vector<std::vector<double>> rows_of(const fs::path& file, bool header) {
  std::ifstream stream(file);
  std::vector<std::vector<double>> rows;
  std::string line;
  if (header) std::getline(stream, line);
  while (std::getline(stream, line)) {
    for (char& c : line)
      if (c == ',') c = ' ';
    std::istringstream words(line);
    rows.emplace_back();
    for (double value = 0.0; words >> value;) rows.back().push_back(value);
  }
  return rows;
}

/// 0.3 x + 0.2 y - z = 0.25: the foot of the perpendicular.
Vector force_on_plane(const Vector& hand) {
  const double deep = 0.3 * hand[0] + 0.2 * hand[1] - 0.25 - hand[2];
  if (deep <= 0.0) return {};
  const double along = kStiffness * deep / (0.3 * 0.3 + 0.2 * 0.2 + 1.0);
  return {-0.3 * along, -0.2 * along, along};
}

/// A ball of radius 1 m about (0.5, 0.5, -0.85).
Vector force_on_cap(const Vector& hand) {
  const Vector out = {hand[0] - 0.5, hand[1] - 0.5, hand[2] + 0.85};
  const double away = length(out);
  if (away >= 1.0) return {};
  const double along = kStiffness * (1.0 - away) / away;
  return {along * out[0], along * out[1], along * out[2]};
}

/// The nearest point by descent on x and y alone: half the squared distance and its gradient.
Vector force_on_sinusoid(const Vector& hand) {
  const auto z = [](double x, double y) { return 0.05 * std::sin(kTurn * x) * std::sin(kTurn * y); };
  if (hand[2] >= z(hand[0], hand[1])) return {};
  double x = hand[0];
  double y = hand[1];
  for (int k = 0; k < 2000; ++k) {
    const double rise = z(x, y) - hand[2];
    const double step_x = (x - hand[0]) + rise * 0.05 * kTurn * std::cos(kTurn * x) * std::sin(kTurn * y);
    const double step_y = (y - hand[1]) + rise * 0.05 * kTurn * std::sin(kTurn * x) * std::cos(kTurn * y);
    x -= 0.7 * step_x;
    y -= 0.7 * step_y;
    if (std::hypot(step_x, step_y) < 1e-15) break;
  }
  return {kStiffness * (x - hand[0]), kStiffness * (y - hand[1]), kStiffness * (z(x, y) - hand[2])};
}

const std::map<std::string, std::function<Vector(const Vector&)>> kClosedForms = {{"plane", force_on_plane},
                                                                                  {"cap", force_on_cap},
                                                                                  {"sinusoid", force_on_sinusoid},
                                                                                  {"sinusoid-fast", force_on_sinusoid},
                                                                                  {"sinusoid-deep", force_on_sinusoid}};

struct Row {
  std::string name;
  double t_s = 0.0;
  Vector force{};
};

std::string csv_of(const std::vector<Row>& rows) {
  std::string text = "case,t_s,force_x_n,force_y_n,force_z_n\n";
  char line[200];
  for (const Row& row : rows) {
    std::snprintf(line, sizeof line, "%s,%.17g,%.17g,%.17g,%.17g\n", row.name.c_str(), row.t_s, row.force[0],
                  row.force[1], row.force[2]);
    text += line;
  }
  return text;
}

class Bench : public Program {
 protected:
  void SetUp() override {
    Program::SetUp();
    ASSERT_EQ(run("bench export data").code, 0);
  }
  std::vector<Row> closed_form(const std::string& name) const {
    std::vector<Row> rows;
    for (const auto& row : rows_of(folder_ / "data" / "paths" / (name + ".csv"), true))
      rows.push_back({name, row.at(0), kClosedForms.at(name)({row.at(1), row.at(2), row.at(3)})});
    return rows;
  }
  json judged(const std::vector<Row>& rows) {
    write("results.csv", csv_of(rows));
    const Outcome outcome = run("bench judge data results.csv --json");
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return json::parse(outcome.out);
  }
  /// The message that results of this text get.
  std::string refused(const std::string& text) {
    write("results.csv", text);
    const Outcome outcome = run("bench judge data results.csv");
    EXPECT_EQ(outcome.code, 3) << outcome.out;
    EXPECT_EQ(outcome.out, "");
    return outcome.err;
  }
};

TEST_F(Bench, ForcesByAnIndependentClosedFormAgreeWithTheTruthToRounding) {
  std::vector<Row> rows;
  for (const auto& [name, form] : kClosedForms)
    for (const Row& row : closed_form(name)) rows.push_back(row);
  const json verdict = judged(rows);
  ASSERT_EQ(verdict["cases"].size(), kClosedForms.size());
  for (const json& one : verdict["cases"]) {
    EXPECT_TRUE(one["pass"]) << one;
    // Positions have 17 digits; a descent that stops within 1e-15 m of 2 mm.
    EXPECT_LT(one["error"]["max"], 1e-9) << one;
    EXPECT_LT(one["angle_deg"]["p99"], 1e-7) << one;
    EXPECT_EQ(one["ghost"], 0.0);
  }
  EXPECT_EQ(verdict["absent"], json({"ridge", "step", "stone"}));
}

TEST_F(Bench, AForceThatIsWrongInOneTickIsFoundWithItsLine) {
  std::vector<Row> rows = closed_form("plane");
  for (double& value : rows[777].force) value = -value;
  const json one = judged(rows)["cases"][0];
  EXPECT_FALSE(one["pass"]);
  EXPECT_NEAR(one["error"]["max"], 2.0, 1e-9);
  EXPECT_EQ(one["worst"]["line"], 779);  // the header is line 1
  EXPECT_NEAR(one["worst"]["t_s"], 0.777, 1e-9);
  EXPECT_NEAR(one["lost"], 1.0 / 2000.0, 1e-12);
  EXPECT_NEAR(one["jumps"], 2.0 / 2000.0, 1e-12);
  const Outcome table = run("bench judge data results.csv");
  EXPECT_THAT(table.out, AllOf(HasSubstr("fail"), HasSubstr("results.csv:779")));
}

TEST_F(Bench, ErrorsAreMeasuredAsWhatTheyAre) {
  const std::vector<Row> right = closed_form("cap");
  const auto changed = [&](const std::function<void(Row&)>& change) {
    std::vector<Row> rows = right;
    for (Row& row : rows) change(row);
    return judged(rows)["cases"][0];
  };
  const auto longer = [](double factor) {
    return [factor](Row& row) {
      for (double& value : row.force) value *= factor;
    };
  };
  const json tenth = changed(longer(1.1));
  EXPECT_NEAR(tenth["error"]["median"], 0.1, 1e-9);
  EXPECT_NEAR(tenth["size"]["p99"], 0.1, 1e-9);
  EXPECT_NEAR(tenth["angle_deg"]["p99"], 0.0, 1e-6);
  EXPECT_EQ(tenth["felt"], 1.0);
  EXPECT_FALSE(tenth["pass"]);
  EXPECT_TRUE(changed(longer(1.05))["pass"]) << "5 % are not felt";

  // Turned by 3 degrees about an axis across the force.
  const double turn = 3.0 * std::numbers::pi / 180.0;
  const json turned = changed([turn](Row& row) {
    const Vector f = row.force;
    const double across = std::hypot(f[0], f[2]);
    if (across == 0.0) return;
    const Vector axis = {f[2] / across, 0.0, -f[0] / across};
    const Vector side = {axis[1] * f[2] - axis[2] * f[1], axis[2] * f[0] - axis[0] * f[2],
                         axis[0] * f[1] - axis[1] * f[0]};
    for (std::size_t k = 0; k < 3; ++k) row.force[k] = std::cos(turn) * f[k] + std::sin(turn) * side[k];
  });
  EXPECT_NEAR(turned["angle_deg"]["median"], 3.0, 1e-6);
  EXPECT_NEAR(turned["size"]["p99"], 0.0, 1e-9);
  EXPECT_NEAR(turned["error"]["median"], 2.0 * std::sin(0.5 * turn), 1e-9);

  const json nothing = changed([](Row& row) { row.force = {}; });
  EXPECT_EQ(nothing["lost"], 1.0);
  EXPECT_EQ(nothing["error"]["median"], 1.0);
  const json everywhere = changed([](Row& row) {
    if (length(row.force) == 0.0) row.force = {0.0, 0.0, 0.5};
  });
  const auto without =
      std::count_if(right.begin(), right.end(), [](const Row& row) { return length(row.force) == 0.0; });
  EXPECT_NEAR(everywhere["ghost"], static_cast<double>(without) / 100.0, 1e-12);  // 50 ticks down, 50 up
  EXPECT_EQ(everywhere["error"]["max"], judged(right)["cases"][0]["error"]["max"]);
  EXPECT_FALSE(everywhere["pass"]);
}

TEST_F(Bench, AForceThatIsWrongWhereTheSurfaceIsMetOrLeftDoesNotPass) {
  const std::vector<Row> right = closed_form("plane");
  for (const std::size_t tick : {45U, 2055U}) {  // in contact, on the way down and up, not beside a judged tick
    ASSERT_GT(length(right[tick].force), 0.0);
    for (const double factor : {0.0, -1.0, 1e4}) {
      std::vector<Row> rows = right;
      for (double& value : rows[tick].force) value *= factor;
      const json one = judged(rows)["cases"][0];
      EXPECT_FALSE(one["pass"]) << tick << " times " << factor;
      EXPECT_NEAR(one["ghost"], 0.01, 1e-12) << tick << " times " << factor;
      EXPECT_LT(one["error"]["max"], 1e-9);
    }
  }
}

TEST_F(Bench, TimesAreReportedAndNotJudged) {
  std::string text = "tick_ns,case,t_s,force_x_n,force_y_n,force_z_n,remark\n";
  int tick = 0;
  for (const Row& row : closed_form("plane")) {
    std::string line = csv_of({row});
    line.erase(0, line.find('\n') + 1);
    line.pop_back();
    text += std::to_string(100 + tick++ % 2) + "," + line + ",ours\n";
  }
  write("results.csv", text);
  const Outcome outcome = run("bench judge data results.csv --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const json one = json::parse(outcome.out)["cases"][0];
  EXPECT_TRUE(one["pass"]);
  EXPECT_EQ(one["tick_ns"]["p50"], 101.0);
  EXPECT_EQ(one["tick_ns"]["p99"], 101.0);
  const Outcome plain = run("bench judge data results.csv --plain");
  EXPECT_THAT(plain.out, StartsWith("Case plane passes."));
}

TEST_F(Bench, HostileResultsGetAnErrorWithFileLineColumnAndExpectation) {
  const std::string header = "case,t_s,force_x_n,force_y_n,force_z_n\n";
  const std::vector<Row> right = closed_form("plane");
  std::vector<std::string> lines;
  {
    std::istringstream stream(csv_of(right));
    for (std::string line; std::getline(stream, line);) lines.push_back(line + "\n");
  }
  const auto joined = [&](const std::function<void(std::vector<std::string>&)>& change) {
    std::vector<std::string> some = lines;
    change(some);
    std::string text;
    for (const std::string& line : some) text += line;
    return text;
  };
  EXPECT_THAT(refused(""), StartsWith("results.csv: error: the file is empty; a header"));
  EXPECT_THAT(refused(" \r\n\n"), StartsWith("results.csv: error: the file is empty"));
  EXPECT_THAT(refused(header), StartsWith("results.csv:2:1: error: no rows; forces for at least one of sinusoid"));
  EXPECT_THAT(refused("case,t_s,force_x_n,force_y_n\n"),
              StartsWith("results.csv:1: error: the header has no column force_z_n; case,t_s"));
  EXPECT_THAT(refused("case,t_s,case,force_x_n,force_y_n,force_z_n\n"),
              StartsWith("results.csv:1:10: error: column case a second time; each column once"));
  EXPECT_THAT(refused(header + "sphere,0,0,0,0\n"),
              StartsWith("results.csv:2:1: error: `sphere` is no case of the benchmark; one of sinusoid"));
  EXPECT_THAT(refused(header + "../../../etc/passwd,0,0,0,0\n"), HasSubstr("is no case of the benchmark"));
  EXPECT_THAT(refused(header + "plane,0,nan,0,0\n"),
              StartsWith("results.csv:2:9: error: `nan` is not finite; a finite number of newtons"));
  EXPECT_THAT(refused(header + "plane,0,0,-inf,0\n"), StartsWith("results.csv:2:11: error: `-inf` is not finite"));
  EXPECT_THAT(refused(header + "plane,0,0,0,one\n"), StartsWith("results.csv:2:13: error: `one` is not a number"));
  EXPECT_THAT(refused(header + "plane,0,0,0,1e300\n"), StartsWith("results.csv:2:13: error: `1e300` is out of range"));
  EXPECT_THAT(refused(header + "plane,0,0,0,\n"), StartsWith("results.csv:2:13: error: `` is not a number"));
  EXPECT_THAT(refused(header + "plane,0,0,0\n"),
              StartsWith("results.csv:2:1: error: the row has 4 fields; 5, as many"));
  EXPECT_THAT(refused(header + "plane,0,0,0,0\n\nplane,0.001,0,0,0\n"),
              StartsWith("results.csv:3:1: error: the row has 1 field;"));
  EXPECT_THAT(refused(header + "plane,0.5,0,0,0\n"), StartsWith("results.csv:2:7: error: time `0.5` out of order; 0,"));
  // The two lines exchanged, one left out, one twice, the last ones missing, more than there are.
  EXPECT_THAT(refused(joined([](auto& some) { std::swap(some[500], some[501]); })),
              AllOf(StartsWith("results.csv:501:7: error: time"), HasSubstr("out of order")));
  EXPECT_THAT(refused(joined([](auto& some) { some.erase(some.begin() + 1000); })),
              AllOf(StartsWith("results.csv:1001:7: error: time"), HasSubstr("out of order")));
  EXPECT_THAT(refused(joined([](auto& some) { some.insert(some.begin() + 9, some[9]); })),
              StartsWith("results.csv:11:7: error: time"));
  EXPECT_THAT(refused(joined([](auto& some) { some.pop_back(); })),
              StartsWith("results.csv:2101:1: error: case plane ends after 2 099 rows; 2 100, one for each tick"));
  EXPECT_THAT(refused(joined([](auto& some) { some.push_back(some.back()); })),
              StartsWith("results.csv:2102:1: error: case plane has more rows than ticks"));
  EXPECT_THAT(refused(joined([](auto& some) {
                const auto again = some;
                some.insert(some.end(), again.begin() + 1, again.end());
              })),
              StartsWith("results.csv:2102:1: error: case plane has more rows than ticks"));
  // A file of one long line without an end, and one of bytes.
  EXPECT_THAT(refused(std::string(30000000, ',')), StartsWith("results.csv:1: error: the header has 30000001 columns"));
  EXPECT_THAT(refused(std::string(5000000, '\0')), StartsWith("results.csv:1: error: the header has no column case"));
  EXPECT_THAT(refused(header + std::string(20000000, '7') + ",0,0,0,0\n"), HasSubstr("is no case of the benchmark"));
}

TEST_F(Bench, AMillionRowsTooManyEndAtTheFirst) {
  std::string text = csv_of(closed_form("plane"));
  const std::string row = "plane,2.1,0,0,0\n";
  text.reserve(text.size() + 1000000 * row.size());
  for (int k = 0; k < 1000000; ++k) text += row;
  EXPECT_THAT(refused(text), StartsWith("results.csv:2102:1: error: case plane has more rows than ticks"));
}

TEST_F(Bench, ADamagedBenchmarkIsRefused) {
  write("results.csv", csv_of(closed_form("plane")));
  const std::string truth = text_of(folder_ / "data" / "truth" / "plane.csv");
  const auto message = [&] {
    const Outcome outcome = run("bench judge data results.csv");
    EXPECT_EQ(outcome.code, 3);
    return outcome.err;
  };
  std::string changed = truth;
  changed[changed.size() / 2] = changed[changed.size() / 2] == '1' ? '2' : '1';
  write("data/truth/plane.csv", changed);
  EXPECT_THAT(message(), StartsWith("data/truth/plane.csv: error: the file is not the one that was exported"));
  fs::remove(folder_ / "data" / "truth" / "plane.csv");
  EXPECT_THAT(message(), HasSubstr("data/truth/plane.csv"));
  write("data/truth/plane.csv", truth);
  ASSERT_EQ(run("bench judge data results.csv").code, 0) << "as it was";
  const std::string cases = text_of(folder_ / "data" / "cases.csv");
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = cases;
    text.replace(text.find(from), from.size(), to);
    write("data/cases.csv", text);
    return message();
  };
  EXPECT_THAT(with("plane,plane,", "../plane,plane,"), HasSubstr("is no name of a case"));
  EXPECT_THAT(with(",2100,", ",2100.5,"), HasSubstr("cases.csv:2:"));
  EXPECT_THAT(with(",2100,", ",1e300,"), HasSubstr("out of range"));
  EXPECT_THAT(with("cap,cap,", "plane,cap,"), HasSubstr("case plane a second time"));
  fs::remove(folder_ / "data" / "cases.csv");
  EXPECT_THAT(message(), StartsWith("data: error: no cases.csv in it"));
}

TEST_F(Bench, ExportedFilesAreWhatTheProtocolSays) {
  EXPECT_EQ(text_of(folder_ / "data" / "protocol.md"),
            text_of(fs::path(SPARSHA_SOURCE_DIR) / "protocol" / "protocol.md"));
  for (const char* name : {"plane", "cap", "sinusoid", "ridge", "step", "stone"}) {
    const auto path = rows_of(folder_ / "data" / "paths" / (std::string(name) + ".csv"), true);
    const auto truth = rows_of(folder_ / "data" / "truth" / (std::string(name) + ".csv"), true);
    const auto in = rows_of(folder_ / "data" / "paths" / (std::string(name) + ".traj"), false);
    const auto out = rows_of(folder_ / "data" / "truth" / (std::string(name) + ".traj"), false);
    ASSERT_EQ(path.size(), 2100U);
    ASSERT_EQ(truth.size(), path.size());
    ASSERT_EQ(in.size(), path.size());
    ASSERT_EQ(out.size(), path.size());
    int judged = 0;
    for (std::size_t tick = 0; tick < path.size(); ++tick) {
      ASSERT_EQ(path[tick].size(), 4U);
      ASSERT_EQ(truth[tick].size(), 9U);
      ASSERT_EQ(in[tick].size(), 8U);
      ASSERT_EQ(out[tick].size(), 8U);
      judged += truth[tick][8] == 1.0 ? 1 : 0;
      const bool contact = truth[tick][7] == 1.0;
      EXPECT_EQ(out[tick][7], truth[tick][7]);
      EXPECT_EQ(in[tick][7], 0.0);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        // The force is the spring's from the hand to the proxy, in every file.
        EXPECT_NEAR(truth[tick][4 + axis], kStiffness * (truth[tick][1 + axis] - path[tick][1 + axis]),
                    contact ? 1e-12 : 0.0);
        EXPECT_NEAR(in[tick][1 + axis], 1e3 * path[tick][1 + axis], 1e-12);
        EXPECT_NEAR(out[tick][1 + axis], 1e3 * truth[tick][1 + axis], 1e-12);
        EXPECT_EQ(in[tick][4 + axis], 0.0);
        EXPECT_EQ(out[tick][4 + axis], truth[tick][4 + axis]);
      }
    }
    EXPECT_EQ(judged, 2000) << name;
    const Outcome info = run("info data/surfaces/" + std::string(name) + ".ply --json");
    ASSERT_EQ(info.code, 0) << info.err;
    EXPECT_EQ(json::parse(info.out)["points"], 201 * 201);
  }
}

TEST_F(Bench, TheSameBytesEachTimeAndAFolderWithOtherFilesIsLeftAlone) {
  ASSERT_EQ(run("bench export again").code, 0);
  for (const auto& entry : fs::recursive_directory_iterator(folder_ / "data")) {
    if (!entry.is_regular_file()) continue;
    const fs::path same = folder_ / "again" / fs::relative(entry.path(), folder_ / "data");
    EXPECT_EQ(text_of(entry.path()), text_of(same)) << entry.path();
  }
  EXPECT_EQ(run("bench export again").code, 0) << "an older export is replaced";
  fs::create_directories(folder_ / "thesis");
  write("thesis/chapter.txt", "text");
  const Outcome refused = run("bench export thesis");
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err, HasSubstr("thesis holds other files"));
  EXPECT_EQ(text_of(folder_ / "thesis" / "chapter.txt"), "text");
}

}  // namespace
}  // namespace sparsha
