// Tables whose values may mean another thing than their places say: numbers of scans, normals and colours. They are
// told, or doubted, and plain tables are not.
#include <array>
#include <cmath>
#include <functional>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "pipeline/scan/set.h"
#include "pipeline/scan/statistics.h"
#include "scene/config/config.h"
#include "tests/pipeline/scan/formats/text/relief_table.h"
#include "tests/support/scan_files.h"

namespace sparsha::pipeline {
namespace {

using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// A relief of 30 x 20 points, fractions of a metre, row by row; `front` and `behind` give what stands around them.
std::string table_of(const std::function<std::string(int)>& front, const std::function<std::string(int)>& behind) {
  std::string text;
  for (int k = 0; k < 600; ++k) {
    const double x = 0.0101 * (k % 30), y = 0.0103 * (k / 30);
    text += fmt::format("{}{:.5f} {:.5f} {:.5f}{}\n", front(k), x, y, 0.1003 + 0.02 * std::sin(20.0 * x + 9.0 * y),
                        behind(k));
  }
  return text;
}
const auto kNothing = [](int) { return std::string(); };

TEST(TextTable, NumbersOfScansAndRingsInFrontOfCoordinatesAreDoubted) {
  const auto warnings = [](const std::function<std::string(int)>& front) {
    return read(table_of(front, kNothing)).warnings;
  };
  for (const char* constant : {"0 ", "1 ", "0.00000 "})
    EXPECT_THAT(warnings([&](int) { return std::string(constant); }),
                Contains(HasSubstr("in all rows, as scans are numbered")));
  EXPECT_THAT(warnings([](int k) { return fmt::format("{} ", k / 200); }),
              Contains(HasSubstr("few whole numbers (0 to 2)")));
  EXPECT_THAT(warnings([](int k) { return fmt::format("{} ", k % 16); }),
              Contains(HasSubstr("few whole numbers (0 to 15)")));
  EXPECT_THAT(warnings(kNothing), IsEmpty());
  // A flat wall in x y z, and one of profiles a millimetre apart with whole intensities.
  std::string wall, profiles;
  for (int k = 0; k < 600; ++k) {
    wall += fmt::format("0 {:.3f} {:.3f}\n", 0.01 * (k % 30), 0.01 * (k / 30));
    profiles +=
        fmt::format("{} {:.3f} {:.3f} {}\n", k / 30, 0.7013 * (k % 30), 0.1003 * std::sin(0.1 * k), 100 + k % 7);
  }
  EXPECT_THAT(read(wall).warnings, IsEmpty());
  EXPECT_THAT(read(profiles).warnings, IsEmpty());
}

TEST(TextTable, ProfilesConstantXSpheresAndHallsAreNotDoubted) {
  std::string stage, constant, sphere, grid, hall;
  for (int k = 0; k < 600; ++k) {
    const double a = 0.0713 * k, b = 0.0291 * k, y = 0.0101 * (k % 30) + 0.0003, z = 0.1003 * std::sin(0.1 * k) + 0.2;
    stage += fmt::format("{} {:.5f} {:.5f} 0.5{}\n", k / 30, y, z, k % 9 + 1);
    constant += fmt::format("12.345 {:.5f} {:.5f} 0.5{}\n", y, z, k % 9 + 1);
    const Eigen::Vector3d n(std::cos(a) * std::cos(b), std::sin(a) * std::cos(b), std::sin(b));
    sphere += fmt::format("{0:.6f} {1:.6f} {2:.6f} {0:.6f} {1:.6f} {2:.6f}\n", n.x(), n.y(), n.z());
    grid += fmt::format("{:.1f} {:.1f} {:.1f} 1.{} 2.5 3.5\n", 0.2 * (k % 6), 0.2 * (k / 6 % 6), 0.2 * (k / 36 % 6), k);
    hall += fmt::format("{} {} {}\n", 100.5 * (k % 30), 99.5 * (k / 30), k % 2 == 0 ? 10000 : 0);
  }
  for (const std::string& text : {stage, constant, sphere, grid}) {
    EXPECT_THAT(read(text).warnings, Not(Contains(AnyOf(HasSubstr("first column"), HasSubstr("first three columns")))))
        << text.substr(0, 60);
  }
  EXPECT_EQ(read(hall).points.size(), 600U) << "a ceiling at 10000 mm";
}

TEST(TextTable, NormalsColoursAndNorthInFrontAreDoubted) {
  const auto normal = [](int k) {
    const double a = 0.01 * k;
    return fmt::format("{:.6f} {:.6f} 0 ", std::cos(a), std::sin(a));
  };
  EXPECT_THAT(read(table_of(normal, kNothing)).warnings, Contains(HasSubstr("of length 1 in all rows")));
  const auto shares = [](int k) { return fmt::format("{:.5f} {:.5f} 1.00000 ", (k % 256) / 255.0, (k % 7) / 255.0); };
  EXPECT_THAT(read(table_of(shares, kNothing)).warnings, Contains(HasSubstr("steps of 1/255")));
  std::string north, east;
  for (int k = 0; k < 600; ++k) {
    const double x = 512345.01 + 0.25 * (k % 30), y = 5412345.03 + 0.25 * (k / 30), z = 30.003 + 0.1 * std::sin(k);
    north += fmt::format("{:.3f} {:.3f} {:.3f}\n", y, x, z);
    east += fmt::format("{:.3f} {:.3f} {:.3f}\n", x, y, z);
  }
  EXPECT_THAT(read(north).warnings, Contains(HasSubstr("the size of northings")));
  EXPECT_THAT(read(east).warnings, IsEmpty());
}

TEST(TextTable, ColoursBehindNormalsAreTakenAndThoseOfSixteenBitsAreSaid) {
  const auto both = [](int k) { return fmt::format(" 0.6 0.0 -0.8 {} 10 20", k % 256); };
  const RawScan scan = read(table_of(kNothing, both));
  ASSERT_EQ(scan.rgba.size(), 600U);
  EXPECT_EQ(scan.rgba[7], 0xFF140A07U);
  EXPECT_TRUE(scan.normals.size() == 600U && scan.normals[7].isApprox(Eigen::Vector3f(0.6F, 0.0F, -0.8F)));
  const auto words = [](int k) { return fmt::format(" {} 65535 {}", 100 * k, 2000 + k); };
  EXPECT_THAT(read(table_of(kNothing, words)).warnings, Contains(HasSubstr("colours of 16 bits")));
  // An intensity that never changes is no red.
  const auto constant = [](int k) { return fmt::format(" 128 {} {} {}", k % 256, 10 + k % 2, 20 + k % 3); };
  const RawScan grey = read(table_of(kNothing, constant));
  ASSERT_EQ(grey.rgba.size(), 600U);
  EXPECT_EQ(grey.rgba[7], 0xFF150B07U);
  const auto white = [](int k) { return fmt::format(" 255 255 255 {}", k % 256); };
  EXPECT_EQ(read(table_of(kNothing, white)).rgba.at(7), 0xFFFFFFFFU);
  EXPECT_EQ(grey.intensity.at(7), 128.0F);
}

TEST(TextTable, NormalsWithoutNegativePartsAreNoColours) {
  const auto normal = [](int k) {
    return fmt::format(" {:.6f} {:.6f} 0.800000", 0.6 * std::abs(std::sin(0.01 * k)),
                       0.6 * std::abs(std::cos(0.01 * k)));
  };
  const auto floor = [](int) { return std::string(" 0.0 0.0 1.0"); };
  const auto with = [&](const auto& before, const auto& behind) {
    return read(table_of(kNothing, [&](int k) { return before(k) + behind(k); }));
  };
  const auto colour = [](int k) { return fmt::format(" {} 10 20", k % 256); };
  const auto box = [](int k) { return std::string(k % 2 == 0 ? " 1 0 0" : " 0 1 0"); };
  EXPECT_THAT(with(kNothing, normal).fields, ElementsAre("x", "y", "z", "nx", "ny", "nz"));
  EXPECT_THAT(with(kNothing, floor).fields, ElementsAre("x", "y", "z", "nx", "ny", "nz"));
  const std::vector<RawScan> scans = {with(normal, colour), with(floor, colour), with(box, colour)};
  for (const RawScan& scan : scans) {
    EXPECT_THAT(scan.fields, ElementsAre("x", "y", "z", "nx", "ny", "nz", "red", "green", "blue"));
    EXPECT_EQ(scan.rgba.at(7), 0xFF140A07U);
  }
  EXPECT_EQ(scans[2].normals.at(7), Eigen::Vector3f(0.0F, 1.0F, 0.0F));
  const auto measured = [&](int k) { return fmt::format(" {:.3f}", 0.001 * k) + normal(k); };
  EXPECT_THAT(with(kNothing, measured).fields, ElementsAre("x", "y", "z", "intensity", "nx", "ny", "nz"));
}

TEST(TextTable, PrimaryColoursAreNoNormals) {
  const std::array<std::string, 5> corners = {" 1 0 0", " 0 1 0", " 0 0 1", " 1 1 0", " 0 0 0"};
  for (const std::size_t used : {std::size_t{3}, std::size_t{4}, std::size_t{5}}) {
    const RawScan scan = read(table_of(kNothing, [&](int k) { return corners[static_cast<std::size_t>(k) % used]; }));
    EXPECT_THAT(scan.fields, ElementsAre("x", "y", "z", "red", "green", "blue")) << used;
  }
}

TEST(TextTable, NormalsMayStandBehindColoursAndAnIntensity) {
  const auto wave = [](int k) { return fmt::format(" {:.6f} 0.0 {:.6f}", std::sin(0.01 * k), std::cos(0.01 * k)); };
  const auto intensity_first = [&](int k) { return fmt::format(" {} {} 10 20", k - 300, k % 256) + wave(k); };
  const auto intensity_last = [&](int k) { return fmt::format(" {} 10 20 {}", k % 256, k - 300) + wave(k); };
  const auto bytes = [&](int k) { return fmt::format(" {} 10 20 {}", k % 256, k % 200) + wave(k) + " 1"; };
  for (const auto& scan : {read(table_of(kNothing, intensity_first)), read(table_of(kNothing, intensity_last)),
                           read(table_of(kNothing, bytes))}) {
    EXPECT_THAT(scan.fields, AllOf(Contains("nx"), Contains("intensity")));
    EXPECT_EQ(scan.rgba.at(7), 0xFF140A07U);
    EXPECT_NEAR(scan.normals.at(7).x(), std::sin(0.07), 1e-6);
  }
  EXPECT_EQ(read(table_of(kNothing, intensity_first)).intensity.at(7), -293.0F);
  const auto flags = [](int k) { return fmt::format(" {} {} 10 20 1 0 0", k - 300, k % 256); };
  EXPECT_THAT(read(table_of(kNothing, flags)).normals, IsEmpty());
  EXPECT_EQ(read(table_of(kNothing, bytes)).intensity.at(7), 7.0F);
}

TEST(TextTable, NumbersOfPointsBeforeTheFirstOfJoinedTablesAreNoCoordinates) {
  std::string text;
  for (int k = 1; k <= 25; ++k) text += fmt::format("{} {:.3f} {:.3f} 0.5\n", k, 0.013 * k, 0.017 * k);
  for (int k = 0; k < 575; ++k) text += fmt::format("{:.3f} {:.3f} 0.7 10 20 30\n", 0.01 * (k % 30), 0.01 * (k / 30));
  EXPECT_TRUE(testing::error_of_bytes("a.txt", text));
}

TEST(TextTable, HeightsOfNoDataWithDecimalsAreNoDepth) {
  for (const char* none : {"-9999.99", "1e10"}) {
    std::string text = table_of(kNothing, kNothing);
    for (int k = 0; k < 5; ++k) text += fmt::format("0.0{} 0.1 {}\n", k, none);
    const RawScan scan = read(text);
    EXPECT_EQ(scan.points.size(), 600U) << none;
    EXPECT_EQ(scan.invalid, 5U) << none;
  }
}

}  // namespace
}  // namespace sparsha::pipeline
