// Tables of points after public bug reports, as they lie beside the real scans: each reads as its table of expected
// values says, or is refused where that says so.
#include <gmock/gmock.h>

#include "tests/support/scan_files.h"

namespace sparsha::pipeline {
namespace {

using ::testing::HasSubstr;

struct Reported {
  const char* file;
  std::uint64_t points;  ///< valid ones
  std::array<double, 3> extent;
  bool colour;
  const char* error;  ///< part of the message, from the line on; null when the file reads
};

// Extents are those that another program finds in the columns that hold coordinates.
const Reported kTables[] = {
    {"r03_semicolon_header.pts", 546, {0.5, 0.4, 0.042888}, true, nullptr},
    {"r09_bw_then_colour.pts", 546, {0.5, 0.4, 0.04289}, true, nullptr},
    {"r10_colour_then_bw.pts", 546, {0.5, 0.4, 0.04289}, true, nullptr},
    {"r12_nodata.xyz", 530, {0.5, 0.4, 0.0429}, false, nullptr},
    {"r13_surfer_blank.csv", 530, {0.5, 0.4, 0.0429}, false, nullptr},
    {"r15_points3D.txt", 546, {0.5, 0.4, 0.0428887}, true, nullptr},
    {"r15b_points3D_unordered.txt", 546, {0.5, 0.4, 0.0428887}, true, nullptr},
    {"r17_number_first.txt", 546, {0.5, 0.4, 0.0429}, false, nullptr},
    {"r18_name_first.csv", 0, {}, false, ":1: error: no rows of numbers"},
    {"r19_sep_line.csv", 546, {0.5, 0.4, 0.0429}, false, nullptr},
    {"r20_all_commas.csv", 0, {}, false, ":1: error: commas stand both"},
    {"r21_units_row.csv", 546, {500.0, 400.0, 42.89}, false, nullptr},
    {"r33_profile.xyz", 500, {0.499, 0.0, 0.01314}, false, nullptr},
    {"r36_twice.xyz", 1092, {0.5, 0.4, 0.043}, false, nullptr},
    {"r37_ctrl_z.xyz", 546, {0.5, 0.4, 0.04289}, false, nullptr},
    {"r38_nul_tail.xyz", 0, {}, false, ":547: error:"},
    {"r39_blank_lines.txt", 546, {0.5, 0.4, 0.0429}, true, nullptr},
    {"r40_bars.txt", 0, {}, false, ":1: error: the values of"},
    {"r92_units_in_names.txt", 546, {0.5, 0.4, 0.0429}, true, nullptr},
    {"r93_reordered.csv", 546, {0.5, 0.4, 0.0429}, false, nullptr},
    {"r102_points3D_site.txt", 300, {15.0, 12.0, 1.2342}, true, nullptr},
    {"r104_numbered_5m.txt", 546, {5.0, 4.0, 0.4289}, false, nullptr},
    {"r112_french_nbsp.txt", 0, {}, false, ":2: error:"},
    {"r113_german_thousands.csv", 0, {}, false, ":2: error:"},
    {"r114_unicode_minus.txt", 0, {}, false, ":1: error:"},
    {"r118_remark_with_blank.txt", 546, {5.0, 4.0, 0.4289}, false, nullptr},
    {"r119_id_named_short_rows.csv", 546, {5.0, 4.0, 0.4289}, true, nullptr},
};

TEST(ReportedTables, AreReadByTheirNamesOrRefused) {
  SPARSHA_REAL_SCANS_OR_SKIP(folder);
  for (const Reported& expected : kTables) {
    SCOPED_TRACE(expected.file);
    RawScan scan;
    try {
      scan = read_scan(folder / "reported" / expected.file);
    } catch (const Error& error) {
      ASSERT_NE(expected.error, nullptr) << error.what();
      EXPECT_THAT(error.what(), HasSubstr(std::string(expected.file) + expected.error));
      continue;
    }
    ASSERT_EQ(expected.error, nullptr) << "read";
    ASSERT_EQ(scan.points.size(), expected.points);
    EXPECT_EQ(!scan.rgba.empty(), expected.colour);
    Eigen::Vector3d low = scan.points.front();
    Eigen::Vector3d high = low;
    for (const Eigen::Vector3d& p : scan.points) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    for (int k = 0; k < 3; ++k) {
      const double extent = expected.extent[static_cast<std::size_t>(k)];
      EXPECT_NEAR((high - low)[k], extent, 1e-9 * (1.0 + extent)) << "axis " << k;
    }
  }
  const RawScan millimetres = read_scan(folder / "reported/r21_units_row.csv");
  EXPECT_EQ(millimetres.unit, scene::LengthUnit::mm);
  const RawScan fractions = read_scan(folder / "reported/r03_semicolon_header.pts");
  EXPECT_EQ(fractions.rgba.front() & 0xFFFFFFU, 0x408000U) << "colours from 0 to 1: 0, 0.5, 0.25";
}

}  // namespace
}  // namespace sparsha::pipeline
