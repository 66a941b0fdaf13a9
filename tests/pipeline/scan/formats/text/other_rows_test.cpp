// Tables whose rows are not x, y, z and colours alone: normals with intensities, paths of scanners, numbers that did
// not fit their columns.
#include <cmath>

#include <fmt/format.h>

#include "tests/support/scan_files.h"

namespace sparsha::pipeline::testing {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

RawScan read(const std::string& text) { return read_scan_bytes(text, "a.xyz"); }

/// Rows of numbers that rise and fall; `row` writes one of a place, a unit normal and a number from 0 to 1.
template <typename Row>
std::string rows(const Row& row) {
  std::string text;
  for (int k = 0; k < 50; ++k) {
    const double a = 0.7 * k;
    const std::string place = fmt::format("{:.3f} {:.3f} {:.3f}", std::sin(a), 2.0 + std::cos(3 * a), 0.01 * k);
    const std::string normal =
        fmt::format("{:.6f} {:.6f} {:.6f}", 0.6 * std::cos(a), 0.6 * std::sin(a), k % 2 == 0 ? 0.8 : -0.8);
    text += row(place, normal, k) + "\n";
  }
  return text;
}

TEST(OtherRows, NormalsIntensityAndColoursWithoutNamesAreToldByTheirValues) {
  const auto colours = [](int k) { return fmt::format("{} {} {}", k, 255 - k, 7 * k % 256); };
  for (const std::string intensity : {"0.5", "1500", "-12.25"}) {
    const RawScan normals_first = read(rows([&](const auto& place, const auto& normal, int k) {
      return place + " " + normal + " " + intensity + " " + colours(k);
    }));
    EXPECT_THAT(normals_first.table->columns,
                ElementsAre("x", "y", "z", "nx", "ny", "nz", "intensity", "red", "green", "blue"));
    EXPECT_EQ(normals_first.rgba[3], 0xFF15FC03U);
    EXPECT_EQ(normals_first.intensity[3], std::stof(intensity));
    EXPECT_NEAR(static_cast<double>(normals_first.normals[3].z()), -0.8, 1e-6);
    EXPECT_THAT(normals_first.notes, IsEmpty());
    const RawScan intensity_first = read(rows([&](const auto& place, const auto& normal, int k) {
      return place + " " + intensity + " " + normal + " " + colours(k);
    }));
    EXPECT_THAT(intensity_first.table->columns,
                ElementsAre("x", "y", "z", "intensity", "nx", "ny", "nz", "red", "green", "blue"));
  }
  const RawScan bytes = read(rows([&](const auto& place, const auto& normal, int k) {
    return place + " " + normal + " " + colours(k) + " " + std::to_string(k * 5);
  }));
  EXPECT_THAT(bytes.table->columns, ElementsAre("x", "y", "z", "nx", "ny", "nz", "red", "green", "blue", "intensity"));
  EXPECT_THAT(bytes.notes, Contains(HasSubstr("[x, y, z, nx, ny, nz, intensity, red, green, blue]")));
}

TEST(OtherRows, ThePathOfAScannerIsRefusedUnlessColumnsAskForItsPlaces) {
  const auto path = [](const std::string& header, const std::string& separator, const std::string& behind) {
    std::string text = header;
    for (int k = 0; k < 50; ++k) {
      const double a = 0.05 * k;
      text +=
          fmt::format("{1:.4f}{0}{2:.4f}{0}{3:.4f}{0}1.5{0}0{0}0{0}{4:.5f}{0}{5:.5f}{6}\n", separator,
                      1305031102.1758 + 0.033 * k, std::sin(a), std::cos(a), std::sin(a / 2), std::cos(a / 2), behind);
    }
    return text;
  };
  for (const std::string& text :
       {path("", " ", ""), path("# timestamp tx ty tz qx qy qz qw\n", " ", ""),
        path("# ground truth trajectory\n", " ", ""),
        path("#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z []\n", ",",
             ",0.1,0.2,0.3")}) {
    expect_refused("path.txt", text, "a time, a place and a quaternion are the path of a scanner");
  }
  for (const std::string header : {"timestamp x y z qx qy qz qw\n", "t x y z q_w q_x q_y q_z\n"})
    EXPECT_THAT(read(path(header, " ", "")).warnings, Contains(HasSubstr("names a quaternion for each row"))) << header;
  ReadOptions options;
  options.columns = {"skip", "x", "y", "z"};
  EXPECT_EQ(read_scan_bytes(path("", " ", ""), "path.txt", options).points.size(), 50U);
}

TEST(OtherRows, StarsInPlaceOfNumbersAreAnErrorThatNamesThem) {
  const auto with = [](int line, const std::string& row) {
    std::string text;
    for (int k = 1; k <= 40; ++k)
      text += k == line ? row + "\n" : fmt::format("{:8.3f} {:8.3f} {:8.3f} {:5.2f}\n", 0.1 * k, 0.2 * k, 0.3 * k, 0.5);
    return text;
  };
  for (const auto& [line, row, word] :
       std::vector<std::array<std::string, 3>>{{"20", "******** 1.0 2.0 0.5", "********"},
                                               {"20", "1.0 ******** 2.0 0.5", "********"},
                                               {"20", "1.0 2.0 3.0 *****", "*****"},
                                               {"20", "   1.000********   2.000 0.5", "1.000********"},
                                               {"1", "******** 1.0 2.0 0.5", "********"},
                                               {"1", "1.0 2.0 3.0 *****", "*****"}}) {
    const std::string text = with(std::stoi(line), row);
    expect_refused("a.xyz", text, "'" + word + "' stands where a number was wider than its column", std::stoi(line));
  }
  EXPECT_EQ(read("**** a survey of 1 2 3 ****\n" + with(0, "")).points.size(), 40U) << "a title";
  EXPECT_EQ(read("# ****\n" + with(20, "1 2 3 *")).points.size(), 40U) << "a single star stands for nothing";
}

}  // namespace
}  // namespace sparsha::pipeline::testing
