// COPC: what a box and a number of points need is read, and nothing else; hierarchies that lie.
#include "pipeline/scan/formats/las/copc.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>

#include <limits>
#include <random>
#include <tuple>

#include "base/threads/progress.h"
#include "pipeline/scan/set.h"
#include "tests/support/copc_file.h"

namespace sparsha::pipeline {
namespace {

using testing::CopcFile;
using testing::CopcNode;
using ::testing::HasSubstr;
using testing::ScanFolder;
using testing::set;
using testing::Stored;

/// `count` places in a node's cube, corners included.
std::vector<Stored> places_in(int level, const std::array<std::int32_t, 3>& cell, std::size_t count,
                              std::mt19937& random) {
  const int edge = static_cast<int>(CopcFile::kSide / CopcFile::kScale) >> level;
  std::uniform_int_distribution<int> within(0, edge);
  std::vector<Stored> points;
  for (std::size_t i = 0; i < count; ++i) {
    Stored p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = cell[k] * edge + (i < 2 ? static_cast<int>(i) * edge : within(random));
    points.push_back(p);
  }
  return points;
}

/// A root, the eight cells of level 1, and two of level 2.
std::vector<CopcNode> three_levels() {
  std::mt19937 random(5);
  std::vector<CopcNode> nodes = {{0, {0, 0, 0}, places_in(0, {0, 0, 0}, 40, random)}};
  for (int i = 0; i < 8; ++i) {
    const std::array<std::int32_t, 3> cell{i & 1, i >> 1 & 1, i >> 2};
    nodes.push_back({1, cell, places_in(1, cell, static_cast<std::size_t>(3 + 10 * i), random)});
  }
  nodes.push_back({2, {0, 0, 0}, places_in(2, {0, 0, 0}, 1, random)});
  nodes.push_back({2, {3, 3, 3}, {}});
  nodes.push_back({2, {3, 3, 2}, places_in(2, {3, 3, 2}, 90, random)});
  return nodes;
}

std::size_t points_of(const std::vector<CopcNode>& nodes) {
  std::size_t count = 0;
  for (const CopcNode& node : nodes) count += node.points.size();
  return count;
}

/// Wanted is what lies in the box, as file units have it.
ReadOptions in_box(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  ReadOptions options;
  options.region = [=](const Eigen::Vector3d& a, const Eigen::Vector3d& b, const auto& /*unit*/) {
    return (a.array() <= high.array()).all() && (b.array() >= low.array()).all();
  };
  return options;
}

std::vector<Eigen::Vector3d> within(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& low,
                                    const Eigen::Vector3d& high) {
  std::vector<Eigen::Vector3d> kept;
  for (const Eigen::Vector3d& p : points) {
    if ((p.array() >= low.array()).all() && (p.array() <= high.array()).all()) kept.push_back(p);
  }
  return kept;
}

TEST(Copc, TheWholeFileHasThePointsThatWentIn) {
  const std::vector<CopcNode> nodes = three_levels();
  for (const std::size_t second_page : {0, 4}) {
    const RawScan scan = read_scan_bytes(CopcFile(nodes, second_page).bytes, "a.laz");
    EXPECT_EQ(scan.format, "LAZ 1.4 pf6 COPC");
    EXPECT_THAT(scan.notes, ::testing::ElementsAre(HasSubstr("COPC: 3 levels in 11 chunks, points 1 to 0.25 apart"),
                                                   HasSubstr("box of the points is zero")));
    EXPECT_THAT(scan.warnings, ::testing::IsEmpty());
    ASSERT_EQ(scan.points.size(), points_of(nodes));
    std::size_t at = 0;
    for (const CopcNode& node : nodes) {
      for (const Stored& p : node.points) {
        EXPECT_EQ(scan.points[at++], Eigen::Vector3d(p[0] * 0.01, p[1] * 0.01, p[2] * 0.01));
      }
    }
  }
}

TEST(Copc, ABoxReadsItsChunksAloneAndMissesNoPoint) {
  const std::vector<CopcNode> nodes = three_levels();
  const CopcFile file(nodes, 4);
  const RawScan all = read_scan_bytes(file.bytes, "a.laz");
  std::mt19937 random(6);
  std::uniform_real_distribution<double> place(-2.0, 18.0);
  std::size_t partly = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const Eigen::Vector3d a(place(random), place(random), place(random)),
        b(place(random), place(random), place(random));
    const Eigen::Vector3d low = a.cwiseMin(b), high = a.cwiseMax(b);
    // Of chunks that the box does not need, every byte is spoilt.
    std::string spoilt = file.bytes;
    std::uint64_t left_out = 0;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const double edge = CopcFile::kSide / (1 << nodes[i].level);
      const Eigen::Vector3d corner = edge * Eigen::Vector3d(nodes[i].cell[0], nodes[i].cell[1], nodes[i].cell[2]);
      const bool apart =
          (corner.array() - 0.01 > high.array()).any() || (corner.array() + edge + 0.01 < low.array()).any();
      if (!apart) continue;
      std::fill_n(spoilt.begin() + static_cast<std::ptrdiff_t>(file.chunks[i]), file.sizes[i], '\xA5');
      left_out += nodes[i].points.size();
    }
    const RawScan some = read_scan_bytes(spoilt, "a.laz", in_box(low, high));
    EXPECT_EQ(within(some.points, low, high), within(all.points, low, high));
    EXPECT_EQ(some.unread, left_out);
    EXPECT_EQ(some.unread + some.records, all.records);
    partly += some.unread > 0 ? 1 : 0;
  }
  EXPECT_GT(partly, 50U);
}

TEST(Copc, ANumberOfPointsTakesWholeLevelsAndASpacingToo) {
  const std::vector<CopcNode> nodes = three_levels();
  const CopcFile file(nodes);
  ReadOptions options;
  options.enough = 1;
  EXPECT_EQ(read_scan_bytes(file.bytes, "a.laz", options).points.size(), 40U);
  options.enough = 40;
  EXPECT_EQ(read_scan_bytes(file.bytes, "a.laz", options).points.size(), 40U);
  options.enough = 41;
  EXPECT_EQ(read_scan_bytes(file.bytes, "a.laz", options).points.size(), points_of(nodes) - 91);
  options.enough = 1'000'000'000'000;
  EXPECT_EQ(read_scan_bytes(file.bytes, "a.laz", options).points.size(), points_of(nodes));
  las::Octree octree;
  octree.spacing = 1.0;
  for (const int level : {0, 1, 2, 3}) octree.nodes.push_back({level, {}, {}});
  EXPECT_EQ(octree.level_of_spacing(2.0), 0);
  EXPECT_EQ(octree.level_of_spacing(1.0), 0);
  EXPECT_EQ(octree.level_of_spacing(0.3), 2);
  EXPECT_EQ(octree.level_of_spacing(0.25), 2);
  EXPECT_EQ(octree.level_of_spacing(1e-9), 3);
}

TEST(Copc, APointRoundedOutOfItsCubeIsFoundAndOneFartherOutIsSaid) {
  const ReadOptions corner = in_box(Eigen::Vector3d::Constant(8.005), Eigen::Vector3d::Constant(8.5));
  const CopcNode other{2, {3, 3, 3}, {{1300, 1300, 1300}}};
  const RawScan near = read_scan_bytes(CopcFile({{1, {0, 0, 0}, {{801, 801, 801}}}, other}).bytes, "a.laz", corner);
  EXPECT_EQ(near.points.size(), 1U);
  EXPECT_EQ(near.unread, 1U);
  EXPECT_THAT(near.warnings, ::testing::IsEmpty());
  const CopcNode far{1, {1, 1, 1}, {{700, 801, 801}}};
  const RawScan stray = read_scan_bytes(CopcFile({far, other}).bytes, "a.laz", corner);
  EXPECT_THAT(stray.warnings, ::testing::ElementsAre(HasSubstr("1 points lie outside the cubes")));
}

/// Lies are said, and all points are read as LAZ.
void expect_read_as_laz(const std::string& bytes, const std::string& what) {
  const RawScan scan =
      read_scan_bytes(bytes, "a.laz", in_box(Eigen::Vector3d::Constant(1.0), Eigen::Vector3d::Constant(2.0)));
  EXPECT_EQ(scan.points.size(), points_of(three_levels())) << what;
  EXPECT_EQ(scan.format, "LAZ 1.4 pf6");
  EXPECT_THAT(scan.warnings, ::testing::ElementsAre(HasSubstr(what)));
}

TEST(Copc, AHierarchyThatLiesCostsNoPoint) {
  const CopcFile file(three_levels(), 4);
  const auto with = [&](std::size_t at, auto value) {
    std::string bytes = file.bytes;
    set(bytes, at, value);
    return bytes;
  };
  const std::size_t entry = file.hierarchy + 32, link = file.hierarchy + 32 * 8;
  expect_read_as_laz(with(entry + 28, std::int32_t{5}), "the nodes of the COPC hierarchy have");
  expect_read_as_laz(with(entry + 28, std::int32_t{-7}), "a node 1-0-0-0 with");
  expect_read_as_laz(with(entry, std::int32_t{31}), "a node 31-0-0-0 with");
  expect_read_as_laz(with(entry + 4, std::int32_t{2}), "a node 1-2-0-0 with");
  expect_read_as_laz(with(entry + 16, std::uint64_t{1} << 63U), "the COPC hierarchy gives 3 points");
  expect_read_as_laz(with(entry + 16, std::uint64_t{0}), "the COPC hierarchy gives 3 points");
  expect_read_as_laz(with(entry + 16, static_cast<std::uint64_t>(file.chunks[0])), "overlap in the file");
  expect_read_as_laz(with(entry + 24, std::numeric_limits<std::int32_t>::max()), "the COPC hierarchy gives 3 points");
  expect_read_as_laz(with(entry + 24, std::int32_t{-1}), "with -1 bytes");
  expect_read_as_laz(with(entry + 4, std::int32_t{1}), "a node of the COPC hierarchy is there twice");
  // A page that leads to itself, one beyond the file, one with part of an entry, one as large as all that memory.
  expect_read_as_laz(with(link + 16, static_cast<std::uint64_t>(file.hierarchy)), "is there twice");
  expect_read_as_laz(with(link + 16, std::uint64_t{1} << 60U), "does not fit the file");
  expect_read_as_laz(with(link + 24, std::int32_t{33}), "a page of the COPC hierarchy of 33 bytes");
  expect_read_as_laz(with(429 + 48, ~std::uint64_t{31}), "does not fit the file");
  expect_read_as_laz(with(429 + 24, 0.0), "no cube or spacing");
  expect_read_as_laz(with(429 + 32, std::numeric_limits<double>::quiet_NaN()), "no cube or spacing");
}

TEST(Copc, AFileThatIsCutAnywhereIsAnErrorOrHasAllItsPoints) {
  std::mt19937 random(7);
  const CopcNode root{0, {0, 0, 0}, places_in(0, {0, 0, 0}, 6, random)};
  const CopcFile file({root, {1, {1, 1, 1}, places_in(1, {1, 1, 1}, 5, random)}}, 1);
  const ReadOptions corner = in_box(Eigen::Vector3d::Zero(), Eigen::Vector3d::Constant(1.0));
  for (std::size_t size = 0; size < file.bytes.size(); ++size) {
    try {
      const RawScan scan = read_scan_bytes(std::string_view(file.bytes).substr(0, size), "a.laz", corner);
      EXPECT_EQ(scan.points.size(), 11U) << size;
      EXPECT_FALSE(scan.warnings.empty()) << size;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input) << size;
    }
  }
}

TEST(Copc, ChangedBytesGivePointsOrAnError) {
  const CopcFile file(three_levels(), 4);
  const ReadOptions corner = in_box(Eigen::Vector3d::Zero(), Eigen::Vector3d::Constant(1.0));
  std::mt19937 random(8);
  std::size_t errors = 0;
  for (int trial = 0; trial < 5000; ++trial) {
    std::string bytes = file.bytes;
    for (int change = 0; change < 3; ++change)
      bytes[375 + random() % (bytes.size() - 375)] = static_cast<char>(random());
    try {
      const RawScan scan = read_scan_bytes(bytes, "a.laz", corner);
      EXPECT_EQ(scan.points.size() + scan.invalid, scan.records);
    } catch (const Error&) {
      ++errors;
    }
  }
  EXPECT_GT(errors, 50U);
  EXPECT_LT(errors, 4950U);
}

using Row = std::tuple<float, float, float, std::uint32_t, float>;

/// What a crop leaves of a scan, whatever was read of it.
std::vector<Row> cropped(const scene::ScanConfig& scan, const scene::CropConfig& box, bool reads_all,
                         std::uint64_t& unread) {
  Progress progress;
  ScanPart part;
  if (!reads_all) part.box = box;
  ScanSet scans({scan}, ScanSet::Keep::disk, false, progress, {}, {}, part);
  unread = scans.unread();
  const Cloud cloud = scans.load(Eigen::Vector3d(0.0, 0.0, 0.0), progress);
  std::vector<Row> rows;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const float* const p = cloud.xyz1() + 4 * i;
    const Eigen::Array3d at(p[0], p[1], p[2]);
    if ((at < box.min_m.array()).any() || (at > box.max_m.array()).any()) continue;
    rows.emplace_back(p[0], p[1], p[2], cloud.rgba.empty() ? 0 : cloud.rgba[i], cloud.intensity[i]);
  }
  return rows;
}

TEST(RealScanCopc, ACropReadsLessAndKeepsTheSamePoints) {
  SPARSHA_REAL_SCANS_OR_SKIP(scans);
  scene::ScanConfig scan;
  scan.file = scans / "heritage/lion_takanawa.copc.laz";
  std::mt19937 random(9);
  std::uniform_real_distribution<double> place(-3.0, 3.0), turn(-3.0, 3.0);
  const Eigen::Vector3d centre(-2.14, 3.88, -0.60);
  std::size_t partly = 0, kept = 0;
  for (int trial = 0; trial < 4; ++trial) {
    Eigen::Vector3d a, b;
    for (int k = 0; k < 3; ++k) {
      a[k] = centre[k] + place(random);
      b[k] = centre[k] + (trial < 2 ? 3.0 : -3.0);
    }
    scene::CropConfig box{a.cwiseMin(b), a.cwiseMax(b)};
    if (trial % 2 == 1) {  // turned, moved and in another unit
      scan.pose.topLeftCorner<3, 3>() =
          Eigen::AngleAxisd(turn(random), Eigen::Vector3d(a + b).normalized()).toRotationMatrix();
      scan.pose.topRightCorner<3, 1>() = 0.1 * (a - b);
      scan.units.unit = scene::LengthUnit::ft;
      const Eigen::Vector3d middle = 0.3048 * (scan.pose.topLeftCorner<3, 3>() * centre);
      box.min_m = middle - 0.15 * (box.max_m - box.min_m);
      box.max_m = middle + 0.5 * (middle - box.min_m);
    } else {
      scan.pose.setIdentity();
      scan.units.unit = scene::LengthUnit::automatic;
    }
    std::uint64_t unread = 0, none = 0;
    const std::vector<Row> some = cropped(scan, box, false, unread);
    EXPECT_TRUE(some == cropped(scan, box, true, none)) << "trial " << trial;
    EXPECT_EQ(none, 0U);
    partly += unread > 0 ? 1 : 0;
    kept += some.empty() ? 0 : 1;
  }
  EXPECT_GE(partly, 2U);
  EXPECT_GE(kept, 2U);
}

}  // namespace
}  // namespace sparsha::pipeline
