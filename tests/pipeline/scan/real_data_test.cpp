// Every real scan file: the points that its source names, or refusal for the true reason. Hostile files: at once and
// in little memory.
#include <cmath>
#include <ctime>
#include <set>

#include <gmock/gmock.h>

#include "base/system.h"
#include "base/threads/progress.h"
#include "tests/support/scan_files.h"

namespace sparsha::pipeline {
namespace {

using ::testing::HasSubstr;

struct Expected {
  const char* file;
  std::uint64_t points;
  std::uint64_t invalid;
  std::array<double, 3> extent;  ///< file units, to the digits given; {} when there is none
  std::size_t faces;
  bool colour;
  const char* error;  ///< part of the message; null when the file reads
};

// Points and extents are those of the collection's own table, made with other programs.
const Expected kFiles[] = {
    {"heritage/lion_takanawa.copc.laz", 341989, 0, {4.2, 5.68, 4.57}, 0, true, nullptr},
    {"heritage/nefertiti-lowres.obj", 35002, 0, {238.7, 494.7, 362.6}, 70000, false, nullptr},
    {"heritage/demosthenes-low-res.obj", 8394, 0, {1.751, 2.694, 1.535}, 16719, false, nullptr},
    {"heritage/lionstatue.obj", 31825, 0, {1.041, 1.793, 2.801}, 63338, false, nullptr},
    {"heritage/laurana.ply", 25160, 0, {467.6, 496.2, 260.1}, 50000, true, nullptr},
    {"heritage/igea.ply", 134345, 0, {0.06911, 0.09934, 0.09908}, 268686, false, nullptr},
    {"heritage/oni.ply", 1435, 0, {0.5888, 1, 0.7537}, 0, false, nullptr},
    {"heritage/sceaux/Sparse.ply", 12683, 0, {15.41, 48.11, 5.439}, 0, true, nullptr},
    {"heritage/sceaux/scene_mesh_refine.ply", 87685, 0, {8.239, 3.424, 4.863}, 174899, false, nullptr},
    {"scans/bunny_range/bun000.ply", 40256, 0, {0.1557, 0.1522, 0.1174}, 0, false, nullptr},
    {"scans/bunny_range/bun045.ply", 40097, 0, {0.1472, 0.1534, 0.1387}, 0, false, nullptr},
    {"scans/bunny_range/bun180.ply", 40251, 0, {0.1562, 0.1535, 0.09511}, 0, false, nullptr},
    {"scans/bunny_range/top3.ply", 36023, 0, {0.193, 0.1118, 0.142}, 0, false, nullptr},
    {"scans/bunny_range/bun.conf", 0, 0, {}, 0, false, "Stanford's list of scans"},
    {"scans/bun_zipper.ply", 35947, 0, {0.1557, 0.1543, 0.1207}, 69451, false, nullptr},
    {"scans/armadillo_range/ArmadilloBack_0.ply", 19283, 0, {0.1878, 0.2805, 0.2384}, 0, false, nullptr},
    {"scans/armadillo_range/ArmadilloBack_10.ply", 29915, 0, {0.21, 0.1492, 0.2144}, 0, false, nullptr},
    {"scans/lato000.ply", 44461, 0, {98.12, 108.4, 75.25}, 86766, false, nullptr},
    {"scans/bunny.stl", 34834, 0, {0.1557, 0.1207, 0.1543}, 69451, false, nullptr},
    {"scans/bunnyData.pts", 30571, 0, {0.1557, 0.1473, 0.1207}, 0, false, nullptr},
    {"scans/bunnyFloat.e57", 30571, 0, {0.1557, 0.1473, 0.1207}, 0, false, nullptr},
    {"scans/bunnyInt21.e57", 30571, 0, {0.1557, 0.1473, 0.1207}, 0, false, nullptr},
    {"scans/tinyCartesianFloatRgb.e57", 2090, 0, {3.005, 3.002, 3.007}, 0, true, nullptr},
    {"scans/table_scene_mug_stereo_textured.pcd", 307200, 97920, {1.172, 0.69, 1.903}, 0, true, nullptr},
    {"scans/room_scan1.pcd", 112586, 0, {29.25, 14.47, 3.061}, 0, false, nullptr},
    {"scans/qcompass_example_data.laz", 268035, 0, {14.06, 10.83, 2.365}, 0, true, nullptr},
    {"scans/samp11-utm.pcd", 38010, 0, {133.9, 302.5, 108.8}, 0, false, nullptr},
    {"scans/1.2-with-color.las", 1065, 0, {3363, 4636, 179.8}, 0, true, nullptr},
    {"scans/1.2-with-color.obj", 911, 0, {3363, 4636, 177.1}, 1672, true, nullptr},
    {"scans/Example.asc", 7817, 0, {22.67, 36.71, 143.8}, 0, true, nullptr},
    {"scans/points_agisoft.xyz", 100, 0, {16.5, 41.4, 12.39}, 0, true, nullptr},
    {"hostile/missingheader.pcd", 0, 0, {}, 0, false, "no PCD header"},
    {"hostile/autzen-utm.pcd", 1065, 0, {998.8, 1387, 54.8}, 0, true, nullptr},
    {"hostile/utm17_comma.pcd", 10, 0, {4.35, 1.98, 0.18}, 0, false, nullptr},
    {"hostile/input_cloud.pcd", 56423, 0, {2.548, 1.33, 0.1393}, 0, false, nullptr},
    {"hostile/colored_cloud.pcd", 1000, 0, {1.376, 0.2752, 0.65}, 0, true, nullptr},
    {"hostile/stereo_left.pcd", 0, 0, {}, 0, false, "no x, y and z"},
    {"hostile/ism_train_horse.pcd", 3400, 0, {68.33, 302.6, 207.2}, 0, false, nullptr},
    {"hostile/bunny.pcd", 397, 0, {0.1535, 0.1471, 0.1128}, 0, false, nullptr},
    {"hostile/float_inf_point_cloud.ply", 16, 3, {318, 241, 7}, 0, false, nullptr},
    {"hostile/int_point_cloud.ply", 16, 0, {388, 268, 7}, 0, false, nullptr},
    {"hostile/duplicated_pcloud.ply", 5395, 0, {1, 0.7759, 0.4828}, 0, false, nullptr},
    {"hostile/bunny_duplicates.ply", 2895, 0, {0.9989, 0.9795, 0.7701}, 5766, false, nullptr},
    {"hostile/points_ascii_with_lists.ply", 5, 0, {0.00175, 0.0007496, 0.002159}, 0, false, nullptr},
    {"hostile/cube_binary_header_with_RN_newline.ply", 8, 0, {1, 1, 1}, 12, false, nullptr},
    {"hostile/issue623.ply", 24, 0, {3.754, 3.754, 3.754}, 0, false, nullptr},
    {"hostile/sized_dims.ply", 0, 0, {}, 0, false, "no x, y and z"},
    {"hostile/empty.ply", 0, 0, {}, 0, false, "empty"},
    {"hostile/ply_empty_bin.ply", 0, 0, {}, 0, false, nullptr},
    {"hostile/crash-30d6d0f7c529b3b66b4131700b7a4580cd7082df.ply", 0, 0, {}, 0, false, "header"},
    {"hostile/inf_nan.obj", 3, 3, {}, 0, false, nullptr},
    {"hostile/cube_mtllib_after_g.obj", 8, 0, {1, 1, 1}, 12, false, nullptr},
    {"hostile/malformed.obj", 8, 0, {1, 1, 1}, 8, false, nullptr},
    {"hostile/box_UTF16BE.obj", 0, 0, {}, 0, false, "UTF-16"},
    {"hostile/number_formats.obj", 15, 0, {1e10, 40, 3.1e10}, 1, false, nullptr},
    {"hostile/invalid-relative-vertex-index.obj", 0, 0, {}, 0, false, "no vertices"},
    {"hostile/degenerate_mesh.obj", 3, 0, {0, 0, 0}, 1, false, nullptr},
    {"hostile/sphere_binary_solid_header.stl", 682, 0, {20, 20, 20}, 1360, false, nullptr},
    {"hostile/triangle_with_empty_solid.stl", 3, 0, {2, 2, 0}, 1, false, nullptr},
    {"hostile/stl_empty_bin.stl", 0, 0, {}, 0, false, "no facets"},
    {"hostile/crlf_test.txt", 10, 0, {4.35, 1.98, 0.18}, 0, false, nullptr},
    {"hostile/badheader.txt", 8, 0, {4.5, 1, 5.5}, 0, false, nullptr},
    {"hostile/utm17_3.txt", 11, 0, {4.35, 1.98, 0.18}, 0, false, nullptr},
    {"hostile/quoted.txt", 9, 0, {29, 24, 0}, 0, false, nullptr},
    {"hostile/chameleon4k.pts", 0, 0, {}, 0, false, "binary data of no known format"},
    {"hostile/garbage_nVariableLength.las", 0, 0, {}, 0, false, "719 points, only 718"},
    {"hostile/bad_vlr_count.las", 10, 0, {4.35, 1.98, 0.18}, 0, true, nullptr},
    {"hostile/no-points.las", 0, 0, {}, 0, false, nullptr},
    {"hostile/point10-1.0.las", 1, 0, {0, 0, 0}, 0, false, nullptr},
    {"hostile/epsg_4326.las", 5380, 0, {0.0228, 0.0106, 39.04}, 0, false, nullptr},
    {"hostile/broken_coder.laz", 0, 0, {}, 0, false, "coder"},
    {"hostile/corrupt_crc.e57", 0, 0, {}, 0, false, "checksum"},
    {"hostile/ZeroPoints.e57", 0, 0, {}, 0, false, nullptr},
    {"hostile/A_B.e57", 6, 0, {}, 0, true, nullptr},
    {"hostile/tiny_spherical.e57", 360, 180, {1, 1, 1}, 0, false, nullptr},
    {"hostile/cartesian_invalid_state_single.e57", 3, 2, {0, 0, 0}, 0, false, nullptr},
    {"audio/stone-impact.wav", 0, 0, {}, 0, false, "a recording of sound"},
    {"audio/metal-impact.wav", 0, 0, {}, 0, false, "a recording of sound"},
    {"audio/perc_bell.flac", 0, 0, {}, 0, false, "a recording of sound"},
};

Eigen::Vector3d extent_of(const RawScan& scan) {
  Eigen::Vector3d low = scan.points.front();
  Eigen::Vector3d high = low;
  for (const Eigen::Vector3d& p : scan.points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return high - low;
}

void check(const Expected& expected, const std::filesystem::path& file) {
  SCOPED_TRACE(expected.file);
  RawScan scan;
  try {
    scan = read_scan(file);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    EXPECT_THAT(error.what(), HasSubstr(file.string()));
    ASSERT_NE(expected.error, nullptr) << error.what();
    EXPECT_THAT(error.what(), HasSubstr(expected.error));
    return;
  }
  ASSERT_EQ(expected.error, nullptr) << "read, though " << expected.error;
  EXPECT_EQ(scan.records, expected.points);
  EXPECT_EQ(scan.invalid, expected.invalid);
  EXPECT_EQ(scan.points.size(), expected.points - expected.invalid);
  EXPECT_EQ(scan.faces.size(), expected.faces);
  EXPECT_EQ(scan.rgba.size(), expected.colour ? scan.points.size() : 0);
  EXPECT_TRUE(scan.intensity.empty() || scan.intensity.size() == scan.points.size());
  EXPECT_GE(scan.fields.size(), 3U);
  if (scan.points.empty() || std::string_view(expected.file) == "hostile/A_B.e57") return;
  const Eigen::Vector3d extent = extent_of(scan);
  for (int k = 0; k < 3; ++k) {
    const double named = expected.extent[static_cast<std::size_t>(k)];
    EXPECT_NEAR(extent[k], named, 0.005 * named + 1e-12) << "axis " << k;  // three digits are certain
  }
}

TEST(RealScans, AllReadAsTheirSourcesSayOrAreRefusedForTheTrueReason) {
  SPARSHA_REAL_SCANS_OR_SKIP(folder);
  for (const Expected& expected : kFiles) check(expected, folder / expected.file);
}

TEST(RealScans, AreAllInTheTable) {
  SPARSHA_REAL_SCANS_OR_SKIP(folder);
  std::set<std::string> named;
  for (const Expected& expected : kFiles) named.insert(expected.file);
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const std::filesystem::path path = std::filesystem::relative(entry.path(), folder);
    // data/reported has a table of its own (expected.tsv); data/laz and its table serve a reader of LAZ.
    const std::string part = path.begin()->string();
    if (part == "reported" || part == "laz" || path == "laz_expected.tsv") continue;
    if (!entry.is_regular_file() || entry.path().extension() == ".md") continue;
    EXPECT_EQ(named.count(path.generic_string()), 1U) << entry.path();
  }
}

TEST(HostileScans, TakeUnderTwoSecondsAndTwoHundredMegabytesEach) {
  SPARSHA_REAL_SCANS_OR_SKIP(folder);
  const std::uint64_t before = system::peak_rss_bytes();
  for (const Expected& expected : kFiles) {
    if (std::string_view(expected.file).substr(0, 8) != "hostile/") continue;
    const std::clock_t start = std::clock();  // the process's own time: others may keep the machine busy
    try {
      (void)inspect_scan(folder / expected.file);
    } catch (const Error&) {
    }
    const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    EXPECT_LT(seconds, 2.0) << expected.file;
  }
  EXPECT_LT(system::peak_rss_bytes() - before, 200U << 20);
}

TEST(RealScans, OfTheSamePointsInTwoFormatsAgree) {
  SPARSHA_REAL_SCANS_OR_SKIP(folder);
  const RawScan single = read_scan(folder / "scans/bunnyFloat.e57");
  const RawScan packed = read_scan(folder / "scans/bunnyInt21.e57");
  const RawScan text = read_scan(folder / "scans/bunnyData.pts");
  ASSERT_EQ(single.points.size(), packed.points.size());
  ASSERT_EQ(single.points.size(), text.points.size());
  for (std::size_t i = 0; i < single.points.size(); ++i) {
    // Packed in steps of a micrometre, and rounded to float32.
    ASSERT_LT((single.points[i] - packed.points[i]).cwiseAbs().maxCoeff(), 0.51e-6);
  }
  // The text has them in another order.
  const auto micrometres = [](const RawScan& scan) {
    std::multiset<std::array<long, 3>> places;
    for (const Eigen::Vector3d& p : scan.points) {
      places.insert({std::lround(p.x() * 1e6), std::lround(p.y() * 1e6), std::lround(p.z() * 1e6)});
    }
    return places;
  };
  EXPECT_EQ(micrometres(packed), micrometres(text));
}

TEST(RealScans, KnowTheirUnits) {
  SPARSHA_REAL_SCANS_OR_SKIP(folder);
  EXPECT_EQ(inspect_scan(folder / "hostile/bad_vlr_count.las").units, "m");
  EXPECT_EQ(inspect_scan(folder / "scans/bunnyFloat.e57").units, "m");
  EXPECT_EQ(inspect_scan(folder / "heritage/oni.ply").units, "unknown");
  EXPECT_EQ(inspect_scan(folder / "hostile/epsg_4326.las").units, "degrees");
  scene::ScanConfig config;
  config.file = folder / "hostile/epsg_4326.las";
  Progress progress;
  try {
    (void)load_scan(config, progress);
    FAIL() << "degrees were built";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    EXPECT_THAT(error.what(), HasSubstr("degrees"));
  }
  config.file = folder / "heritage/laurana.ply";
  (void)load_scan(config, progress);
  EXPECT_THAT(progress.warnings(), ::testing::ElementsAre(HasSubstr("units: mm")));
}

TEST(RealScans, HaveTheDuplicatesTheirSourcesName) {
  SPARSHA_REAL_SCANS_OR_SKIP(folder);
  EXPECT_EQ(inspect_scan(folder / "scans/room_scan1.pcd").duplicates, 56427U);
  EXPECT_EQ(inspect_scan(folder / "scans/Example.asc").duplicates, 251U);
  EXPECT_EQ(inspect_scan(folder / "hostile/duplicated_pcloud.ply").duplicates, 1345U);
}

}  // namespace
}  // namespace sparsha::pipeline
