// Notes on disk, and what measures measure, judged by closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "base/error.h"
#include "tests/support/scenes.h"
#include "tests/support/test_folder.h"
#include "viewer/marks/notes.h"
#include "viewer/marks/profile.h"

namespace sparsha::viewer::test {
namespace {

using sparsha::test::scene_of;

std::string text_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

Notes some_notes() {
  Notes notes;
  notes.pins = {{{450000.1234, 5412000.25, 0.1}, "Crack \"A\" \\ new"},
                {{0.0, -1e-7, 2.0}, "\xE0\xA4\xA8\xE0\xA4\xBE\xE0\xA4\x95"}};
  notes.measures = {{Measure::Kind::distance, {{0, 0, 0}, {0.1, 0.2, 0.2}}},
                    {Measure::Kind::angle, {{1, 0, 0}, {0, 0, 0}, {0, 2, 0}}},
                    {Measure::Kind::profile, {{0, 0, 0}, {1.0 / 3.0, 0, 0}}}};
  notes.section = Section{{0.5, 0.25, 0.125}, {0.6, -0.8, 0.0}};
  notes.parallel = true;
  return notes;
}

TEST(Notes, ComeBackAsTheyWereWrittenToTheLastBit) {
  const sparsha::test::TestFolder folder;
  const Notes notes = some_notes();
  write_notes(notes, folder / "notes.yaml");
  const Notes back = read_notes(folder / "notes.yaml");
  ASSERT_EQ(back.pins.size(), 2U);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(back.pins[k].at_m, notes.pins[k].at_m);
    EXPECT_EQ(back.pins[k].text, notes.pins[k].text);
  }
  ASSERT_EQ(back.measures.size(), 3U);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(back.measures[k].kind, notes.measures[k].kind);
    EXPECT_EQ(back.measures[k].points_m, notes.measures[k].points_m);
  }
  ASSERT_TRUE(back.section);
  EXPECT_EQ(back.section->at_m, notes.section->at_m);
  EXPECT_LT((back.section->out - notes.section->out).norm(), 1e-15);
  EXPECT_TRUE(back.parallel);
  const std::string first = text_of(folder / "notes.yaml");
  write_notes(notes, folder / "notes.yaml");
  EXPECT_EQ(text_of(folder / "notes.yaml"), first);
  EXPECT_TRUE(read_notes(folder / "missing.yaml").empty());
  write_notes({}, folder / "empty.yaml");
  EXPECT_TRUE(read_notes(folder / "empty.yaml").empty());
}

TEST(Notes, WhatIsDamagedOrHostileIsAnErrorOfTheInputAtItsPlace) {
  const sparsha::test::TestFolder folder;
  const auto refuse = [&](const std::string& text) {
    std::ofstream(folder / "notes.yaml") << text;
    try {
      static_cast<void>(read_notes(folder / "notes.yaml"));
      ADD_FAILURE() << "accepted: " << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input) << text;
      EXPECT_GT(error.place().line, 0) << text;
    }
  };
  refuse("pins: 3\n");
  refuse("pins:\n  - {at_m: [1, 2], text: a}\n");
  refuse("pins:\n  - {at_m: [1, 2, .nan], text: a}\n");
  refuse("pins:\n  - {at: [1, 2, 3], text: a}\n");
  refuse("measures:\n  - {kind: volume, points_m: [[0, 0, 0], [1, 1, 1]]}\n");
  refuse("measures:\n  - {kind: angle, points_m: [[0, 0, 0], [1, 1, 1]]}\n");
  refuse("section: {at_m: [0, 0, 0], out: [0, 0, 0]}\n");
  refuse("pins:\n  - {at_m: [1, 2, 3], text: \"" + std::string(2001, 'x') + "\"}\n");
  refuse("unknown: 1\n");
  // Control characters, which a terminal would interpret, do not come in.
  std::ofstream(folder / "notes.yaml") << "pins:\n  - {at_m: [1, 2, 3], text: \"a\\x1b[2Jb\"}\n";
  EXPECT_EQ(read_notes(folder / "notes.yaml").pins.at(0).text, "a[2Jb");
}

TEST(Notes, StayOnTheObjectThroughAnotherOrientation) {
  Eigen::Affine3d turn = Eigen::Translation3d(3.0, -2.0, 0.5) *
                         Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, 3).normalized()) * Eigen::Scaling(1.0);
  const Notes notes = some_notes();
  const Notes there = moved(notes, turn.matrix());
  EXPECT_LT((there.pins[1].at_m - turn * notes.pins[1].at_m).norm(), 1e-12);
  for (std::size_t k = 0; k < notes.measures.size(); ++k)
    EXPECT_NEAR(value_of(there.measures[k]), value_of(notes.measures[k]), 1e-12) << "a rigid motion changes no measure";
  const Notes back = moved(there, turn.inverse().matrix());
  EXPECT_LT((back.measures[0].points_m[1] - notes.measures[0].points_m[1]).norm(), 1e-12);
  EXPECT_LT((back.section->out - notes.section->out).norm(), 1e-12);
}

TEST(Measures, DistanceAndAngleAreThoseOfGeometry) {
  const Notes notes = some_notes();
  EXPECT_DOUBLE_EQ(value_of(notes.measures[0]), 0.3);
  EXPECT_DOUBLE_EQ(value_of(notes.measures[1]), std::numbers::pi / 2.0);
  EXPECT_EQ(value_text(notes.measures[0]), "30 cm");
  EXPECT_EQ(value_text(notes.measures[1]), "90 degrees");
}

TEST(Profile, IsTheBilinearSurfaceAndKnowsWhatIsFilledOrUnknown) {
  // A plane is bilinear: the profile is exact but for the rounding of stored heights.
  const auto plane = [](double x_m, double y_m) {
    return x_m > 0.15 ? std::numeric_limits<double>::quiet_NaN() : 0.02 * x_m - 0.05 * y_m;
  };
  const Eigen::Vector3d origin(450000.0, 5412000.0, 100.0);
  const auto fill = [](scene::Layers& layers) {
    const scene::Lattice& lattice = layers.grid.lattice;
    for (int j = 0; j < lattice.ny; ++j)
      for (int i = 0; i <= lattice.nx / 8; ++i) layers.grid.state[lattice.index(i, j)] = scene::NodeState::filled;
  };
  const auto scene = scene_of(plane, {201, 101, 0.001, 1, origin}, {}, fill);
  const Eigen::Vector3d from = origin + Eigen::Vector3d(0.0103, 0.0207, 0.0),
                        to = origin + Eigen::Vector3d(0.1804, 0.0911, 0.0);
  const std::vector<ProfileSample> profile = profile_along(*scene, from, to);
  const double length_m = (to - from).head<2>().norm();
  ASSERT_EQ(profile.size(), static_cast<std::size_t>(std::ceil(length_m / 0.001)) + 1);
  EXPECT_DOUBLE_EQ(profile.back().along_m, length_m);
  int unknown = 0, filled = 0;
  for (const ProfileSample& s : profile) {
    const double x_m = s.at_m.x() - origin.x(), y_m = s.at_m.y() - origin.y();
    if (x_m > 0.150001) {
      EXPECT_TRUE(std::isnan(s.at_m.z()));
      EXPECT_EQ(s.state, scene::NodeState::unknown);
      ++unknown;
    } else if (x_m < 0.1499) {
      EXPECT_NEAR(s.at_m.z(), origin.z() + plane(x_m, y_m), 1e-9);
      EXPECT_EQ(s.state, x_m < 0.026 ? scene::NodeState::filled : scene::NodeState::measured) << x_m;
      filled += s.state == scene::NodeState::filled ? 1 : 0;
    }
  }
  EXPECT_GT(unknown, 20);
  EXPECT_GT(filled, 10);
  EXPECT_TRUE(std::isnan(surface_height_m(*scene, origin.x() - 0.01, origin.y())));
  EXPECT_NEAR(surface_height_m(*scene, origin.x() + 0.1, origin.y() + 0.1), 100.0 + plane(0.1, 0.1), 1e-9);

  const sparsha::test::TestFolder folder;
  write_profile(profile, folder / "profile.csv");
  std::istringstream lines(text_of(folder / "profile.csv"));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "along_m,x_m,y_m,z_m,state");
  std::size_t rows = 0;
  while (std::getline(lines, line)) {
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), 4);
    const double along_m = std::stod(line);
    EXPECT_EQ(along_m, profile[rows].along_m);
    if (std::isnan(profile[rows].at_m.z())) {
      EXPECT_NE(line.find(",,unknown"), std::string::npos) << line;
    }
    ++rows;
  }
  EXPECT_EQ(rows, profile.size());
}

TEST(Profile, OfALineOfOnePointOrOutsideIsNoProblem) {
  const auto scene = scene_of([](double, double) { return 0.01; }, {51, 51, 0.001, 1});
  EXPECT_EQ(profile_along(*scene, {0.01, 0.01, 0}, {0.01, 0.01, 0}).size(), 2U);
  for (const ProfileSample& s : profile_along(*scene, {-1.0, -1.0, 0}, {-0.5, 5.0, 0}))
    EXPECT_TRUE(std::isnan(s.at_m.z()));
  EXPECT_TRUE(profile_along(*scene, {0, 0, 0}, {std::nan(""), 0, 0}).empty());
  EXPECT_EQ(profile_along(*scene, {-1e6, 0, 0}, {1e6, 0, 0}).size(), 20'000U);
  for (const double far_m : {1e12, 1e30, 1e150}) {  // cells that no int counts
    EXPECT_TRUE(std::isnan(surface_height_m(*scene, far_m, -far_m)));
    const std::vector<ProfileSample> profile = profile_along(*scene, {-far_m, 0.01, 0}, {-0.5 * far_m, 0.01, 0});
    EXPECT_EQ(profile.size(), 20'000U);
    EXPECT_TRUE(std::ranges::all_of(profile, [](const ProfileSample& s) { return std::isnan(s.at_m.z()); }));
  }
  const auto one = scene_of([](double, double) { return 0.5; }, {1, 1, 0.001, 1});
  EXPECT_DOUBLE_EQ(surface_height_m(*one, 0.0, 0.0), 0.5);
}

TEST(Measures, AsATableKeepEveryDigit) {
  const sparsha::test::TestFolder folder;
  write_measures(some_notes().measures, folder / "m.csv");
  std::istringstream lines(text_of(folder / "m.csv"));
  std::string header, distance, angle;
  std::getline(lines, header);
  std::getline(lines, distance);
  std::getline(lines, angle);
  EXPECT_EQ(header, "kind,value,unit,x1_m,y1_m,z1_m,x2_m,y2_m,z2_m,x3_m,y3_m,z3_m");
  EXPECT_EQ(std::count(distance.begin(), distance.end(), ','), std::count(header.begin(), header.end(), ','));
  EXPECT_EQ(distance.substr(0, 9), "distance,");
  EXPECT_DOUBLE_EQ(std::stod(distance.substr(9)), 0.3);
  EXPECT_EQ(angle, "angle,90,degree,1,0,0,0,0,0,0,2,0");
}

}  // namespace
}  // namespace sparsha::viewer::test
