// Units, poses and the common origin: scan = pose * units * p, rounded once.
#include <cmath>
#include <random>
#include <sstream>

#include <gmock/gmock.h>
#include <Eigen/Geometry>

#include "base/files/files.h"
#include "base/threads/progress.h"
#include "pipeline/scan/empty_returns.h"
#include "pipeline/scan/set.h"
#include "pipeline/scan/statistics.h"
#include "pipeline/scan/units.h"
#include "scene/scene.h"
#include "tests/support/scan_files.h"

namespace sparsha::pipeline {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::ScanFolder;

scene::ScanConfig config_of(const std::filesystem::path& file, scene::LengthUnit unit = scene::LengthUnit::automatic) {
  scene::ScanConfig config;
  config.file = file;
  config.units.unit = unit;
  return config;
}

Eigen::Vector3d point(const Cloud& cloud, std::size_t i) {
  return cloud.origin_m + Eigen::Map<const Eigen::Vector3f>(cloud.xyz1() + 4 * i).cast<double>();
}

TEST(LoadScan, AppliesUnitsThenPose) {
  const ScanFolder folder;
  scene::ScanConfig config = config_of(folder.write("a.xyz", "1000 0 0\n0 2000 0\n"), scene::LengthUnit::mm);
  config.pose.topLeftCorner<3, 3>() = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  config.pose.topRightCorner<3, 1>() = Eigen::Vector3d(0, 0, 5);
  Progress progress;
  const Cloud cloud = load_scan(config, progress);
  ASSERT_EQ(cloud.size(), 2U);
  const double rounding = 5.0 * 1.2e-7;  // float32 of numbers up to 5
  EXPECT_LT((point(cloud, 0) - Eigen::Vector3d(0, 1, 5)).norm(), rounding);
  EXPECT_LT((point(cloud, 1) - Eigen::Vector3d(-2, 0, 5)).norm(), rounding);
}

TEST(LoadScan, KnowsAllUnits) {
  const ScanFolder folder;
  const auto file = folder.write("a.xyz", "0 0 0\n1 0 0\n");
  Progress progress;
  const auto x_of = [&](scene::LengthUnit unit) {
    scene::ScanConfig config = config_of(file, unit);
    config.units.longest_side_m = 0.3;
    return point(load_scan(config, progress), 1).x();
  };
  EXPECT_EQ(x_of(scene::LengthUnit::m), 1.0);
  EXPECT_FLOAT_EQ(static_cast<float>(x_of(scene::LengthUnit::cm)), 0.01F);
  EXPECT_FLOAT_EQ(static_cast<float>(x_of(scene::LengthUnit::mm)), 0.001F);
  EXPECT_FLOAT_EQ(static_cast<float>(x_of(scene::LengthUnit::ft)), 0.3048F);
  EXPECT_FLOAT_EQ(static_cast<float>(x_of(scene::LengthUnit::us_ft)), static_cast<float>(1200.0 / 3937.0));
  EXPECT_FLOAT_EQ(static_cast<float>(x_of(scene::LengthUnit::longest_side)), 0.3F);
}

TEST(LoadScan, KeepsATenthOfAMillimetreOfGeoreferencedPoints) {
  const ScanFolder folder;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> offset(-200.0, 200.0);
  std::ostringstream text;
  text.precision(15);
  std::vector<Eigen::Vector3d> truth;
  for (int i = 0; i < 1000; ++i) {
    truth.emplace_back(450000.0 + offset(random), 5412000.0 + offset(random), 300.0 + offset(random));
    text << truth.back().x() << ' ' << truth.back().y() << ' ' << truth.back().z() << '\n';
  }
  Progress progress;
  const Cloud cloud = load_scan(config_of(folder.write("utm.xyz", text.str())), progress);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    EXPECT_LT((point(cloud, i) - truth[i]).cwiseAbs().maxCoeff(), 1e-4 / 2);
  }
  EXPECT_THAT(progress.warnings(), IsEmpty()) << "georeferenced scans may be long";
}

TEST(LoadScan, KeepsTheBitsOfAFloatScanNearItsOwnZero) {
  const ScanFolder folder;
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\nelement vertex 1000\nproperty float x\nproperty float y\n"
      "property float z\nend_header\n";
  std::mt19937 random(1);
  std::uniform_real_distribution<float> coordinate(-0.4F, 0.4F);
  std::vector<float> numbers(3000);
  for (float& v : numbers) testing::put(bytes, v = coordinate(random));
  Progress progress;
  const Cloud cloud = load_scan(config_of(folder.write("a.ply", bytes)), progress);
  EXPECT_EQ(cloud.origin_m, Eigen::Vector3d::Zero());
  for (std::size_t i = 0; i < 1000; ++i) {
    for (std::size_t k = 0; k < 3; ++k) ASSERT_EQ(cloud.xyz1()[4 * i + k], numbers[3 * i + k]);
    ASSERT_EQ(cloud.xyz1()[4 * i + 3], 1.0F) << "as PCL has it";
  }
}

TEST(LoadScans, ChooseAnOriginFromTheSetOfPointsAlone) {
  const ScanFolder folder;
  std::mt19937 random(9);
  std::normal_distribution<double> spread(0.0, 3.0);
  std::vector<std::string> rows;
  for (int i = 0; i < 20000; ++i) {
    std::ostringstream row;
    row.precision(15);
    row << 1000.3 + spread(random) << ' ' << -77.8 + spread(random) << ' ' << 5.5 + spread(random) << '\n';
    rows.push_back(row.str());
  }
  for (int i = 0; i < 40; ++i) rows.push_back("1e9 1e9 -1e9\n");  // far outliers must not matter
  const auto join = [&](std::size_t begin, std::size_t end) {
    std::string text;
    for (std::size_t i = begin; i < end; ++i) text += rows[i];
    return text;
  };
  Progress progress;
  const Cloud first = load_scans(
      {config_of(folder.write("a.xyz", join(0, 7000))), config_of(folder.write("b.xyz", join(7000, rows.size())))},
      progress);
  const Cloud swapped = load_scans(
      {config_of(folder.write("b2.xyz", join(7000, rows.size()))), config_of(folder.write("a2.xyz", join(0, 7000)))},
      progress);
  std::shuffle(rows.begin(), rows.end(), random);
  const Cloud shuffled = load_scans({config_of(folder.write("c.xyz", join(0, rows.size())))}, progress);
  EXPECT_EQ(first.origin_m, swapped.origin_m);
  EXPECT_EQ(first.origin_m, shuffled.origin_m);
  EXPECT_EQ(first.origin_m, first.origin_m.array().round().matrix()) << "whole metres";
  EXPECT_LT((first.origin_m - Eigen::Vector3d(1000.3, -77.8, 5.5)).cwiseAbs().maxCoeff(), 1.0);
  EXPECT_EQ(first.size(), rows.size());
}

TEST(LoadScans, JoinColoursFacesAndCountsOfAllFiles) {
  const ScanFolder folder;
  const auto a = folder.write("a.obj", "v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 0 1 0 1 0 0\nf 1 2 3\n");
  const auto b = folder.write("b.obj", "v nan 0 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nf 2 3 4\n");
  Progress progress;
  std::vector<scene::ScanSource> sources;
  const Cloud cloud = load_scans({config_of(a), config_of(b)}, progress, &sources);
  EXPECT_EQ(cloud.size(), 6U);
  EXPECT_EQ(cloud.invalid, 1U);
  EXPECT_THAT(cloud.rgba, ElementsAre(0xFF0000FFU, 0xFF0000FFU, 0xFF0000FFU, kNoColour, kNoColour, kNoColour));
  using Face = std::array<std::uint32_t, 3>;
  EXPECT_THAT(cloud.faces, ElementsAre(Face{0, 1, 2}, Face{3, 4, 5}));
  ASSERT_EQ(sources.size(), 2U);
  EXPECT_EQ(sources[1].file, b);
  EXPECT_EQ(sources[1].points, 4U);
  EXPECT_EQ(sources[1].sha256,
            sha256(std::as_bytes(std::span(std::string_view("v nan 0 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nf 2 3 4\n")))));
}

TEST(LoadScan, WarnsOfMetresThatCannotBe) {
  const ScanFolder folder;
  const auto bust = folder.write("bust.xyz", "0 0 0\n250 0 0\n0 467 0\n");
  Progress progress;
  (void)load_scan(config_of(bust), progress);
  EXPECT_THAT(progress.warnings(), ElementsAre(HasSubstr("467 m long in metres")));
  Progress silent;
  (void)load_scan(config_of(bust, scene::LengthUnit::mm), silent);
  EXPECT_THAT(silent.warnings(), IsEmpty()) << "the user has said so";
}

TEST(LoadScan, RefusesEmptyScansAndScansWithoutAValidPoint) {
  const ScanFolder folder;
  Progress progress;
  const auto refuse = [&](const std::filesystem::path& file, const char* message) {
    try {
      (void)load_scan(config_of(file), progress);
      ADD_FAILURE() << message;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      EXPECT_THAT(error.what(), HasSubstr(message));
    }
  };
  refuse(folder.write("n.obj", "v nan 0 0\n"), "none of the 1 points is valid");
  refuse(folder.write("z.pts", "0\n"), "no points");
  refuse("/nowhere/at/all.ply", "all.ply");
  scene::ScanConfig config = config_of(folder.write("same.xyz", "1 1 1\n1 1 1\n"), scene::LengthUnit::longest_side);
  config.units.longest_side_m = 1.0;
  EXPECT_THROW((void)load_scan(config, progress), Error);
}

TEST(LoadScans, LeaveOutAScanWithoutPointsBesideOthersAndNameIt) {
  const ScanFolder folder;
  const auto first = folder.write("a.xyz", "0 0 0\n1 0 0\n1 2 0\n"), last = folder.write("b.xyz", "0 3 1\n0 4 1\n");
  const std::string ply = "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\n";
  const std::vector<std::filesystem::path> empty = {
      folder.write("none.ply", ""),
      folder.write("none.e57", ""),
      folder.write("mark.xyz", "\xEF\xBB\xBF"),
      folder.write("comment.txt", "# nothing\n"),
      folder.write("zero.pts", "0\n"),
      folder.write("zero.ply", ply + "property float z\nend_header\n"),
      folder.write("zero.obj", "# nothing\n"),
      folder.write("zero.stl", "solid a\nendsolid a\n"),
      folder.write("zero.off", "OFF\n0 0 0\n"),
      folder.write("nan.obj", "v nan 0 0\n"),
      folder.write("zero.gltf", R"({"asset": {"version": "2.0"}})"),
  };
  for (const std::filesystem::path& file : empty) {
    Progress progress;
    scene::ScanConfig posed = config_of(file);
    posed.pose(0, 3) = 1.0;
    std::vector<scene::ScanSource> sources;
    const Cloud cloud = load_scans({config_of(first), posed, config_of(last)}, progress, &sources);
    ASSERT_EQ(cloud.size(), 5U) << file;
    EXPECT_EQ((point(cloud, 3) - Eigen::Vector3d(0, 3, 1)).norm(), 0.0) << file;
    EXPECT_THAT(cloud.stations, IsEmpty()) << file;
    EXPECT_THAT(progress.warnings(),
                ::testing::Contains(AllOf(HasSubstr(file.filename().string()), HasSubstr("the scan is left out"))));
    ASSERT_EQ(sources.size(), 3U);
    EXPECT_EQ(sources[1].points, 0U) << file;
    EXPECT_THROW((void)load_scan(config_of(file), progress), Error) << "it is alone";
    EXPECT_THROW((void)load_scans({config_of(file), config_of(file)}, progress), Error) << "there is no other";
  }
  Progress progress;
  EXPECT_THROW((void)load_scans({config_of(first), config_of("/nowhere/at/all.ply")}, progress), Error)
      << "a scan that is missing is none without points";
}

TEST(LoadScan, CountsPointsBeyondFloatAsInvalidAndDropsTheirFaces) {
  const ScanFolder folder;
  Progress progress;
  const Cloud cloud = load_scan(
      config_of(folder.write("f.obj", "v 1e200 0 0\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 2 3 4\n")), progress);
  EXPECT_EQ(cloud.size(), 3U);
  EXPECT_EQ(cloud.invalid, 1U);
  EXPECT_THAT(cloud.faces, ElementsAre(std::array<std::uint32_t, 3>{0, 1, 2}));
}

TEST(StreamScan, GivesTheSamePointsAsReadingAtOnce) {
  const ScanFolder folder;
  std::string text = "v 0 0 0 1 0 0\n";
  for (int i = 0; i < 10000; ++i) text += "v " + std::to_string(i) + " 1 " + (i % 7 == 0 ? "nan" : "2") + " 0 0 1\n";
  text += "f 1 2 3\nf 3 4 5\n";
  const auto file = folder.write("a.obj", text);
  const RawScan whole = read_scan(file);
  std::vector<Eigen::Vector3d> points;
  std::vector<std::uint32_t> rgba;
  const RawScan rest = stream_scan(file, [&](const PointBlock& block) {
    points.insert(points.end(), block.points.begin(), block.points.end());
    rgba.insert(rgba.end(), block.rgba.begin(), block.rgba.end());
  });
  EXPECT_EQ(points, whole.points);
  EXPECT_EQ(rgba, whole.rgba);
  EXPECT_EQ(rest.faces, whole.faces);
  EXPECT_EQ(rest.records, whole.records);
  EXPECT_EQ(rest.invalid, whole.invalid);
  EXPECT_TRUE(rest.points.empty());
}

TEST(ScanSet, StreamsTheVeryPointsThatItLoads) {
  const ScanFolder folder;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> at(450000.0, 450010.0);
  std::ostringstream first, second;
  first.precision(17);
  for (int i = 0; i < 9000; ++i) first << at(random) << ' ' << at(random) << ' ' << 0.001 * i << '\n';
  second << "1e40 0 0\n450001 450002 3\nnan 0 0\n";  // beyond float32, good, invalid
  const std::vector<scene::ScanConfig> scans = {config_of(folder.write("a.xyz", first.str()), scene::LengthUnit::m),
                                                config_of(folder.write("b.xyz", second.str()), scene::LengthUnit::cm)};
  Progress progress;
  const Cloud cloud = load_scans(scans, progress);
  ScanSet set(scans, ScanSet::Keep::disk, true, progress);
  for (int round = 0; round < 2; ++round) {
    std::size_t seen = 0;
    const std::uint64_t beyond = set.stream(
        [&](const CloudBlock& block) {
          for (const Eigen::Vector3f& p : block.points) {
            ASSERT_LT(seen, cloud.size());
            EXPECT_TRUE(std::equal(p.begin(), p.end(), cloud.xyz1() + 4 * seen++));
          }
        },
        progress);
    EXPECT_EQ(seen, cloud.size());
    EXPECT_EQ(beyond + set.invalid(), cloud.invalid);
  }
  const std::vector<scene::ScanSource> sources = set.sources();
  ASSERT_EQ(sources.size(), 2U);
  EXPECT_EQ(sources[0].sha256, sha256(MappedFile(scans[0].file).bytes()));
  EXPECT_EQ(sources[1].points, 3U);
}

/// A wall 2 m away as a depth camera writes it: x y z and colour, with `empty` places that gave no answer between.
std::string wall_of_a_depth_camera(std::int64_t points, std::int64_t empty) {
  std::mt19937 random(17);
  std::uniform_real_distribution<double> at(-0.5, 0.5);
  std::ostringstream text;
  for (std::int64_t i = 0; i < points; ++i) {
    text << at(random) << ' ' << at(random) << " 2 10 20 30\n";
    for (std::int64_t k = i * empty / points; k < (i + 1) * empty / points; ++k) text << "0 0 0 0 0 0\n";
  }
  return text.str();
}

TEST(ScanSet, CountsThePlacesThatADepthCameraDidNotSeeAsInvalidInMemoryAndStreamed) {
  constexpr int kSeen = 9000, kEmpty = 3000;
  const ScanFolder folder;
  const scene::ScanConfig scan =
      config_of(folder.write("camera.xyz", wall_of_a_depth_camera(kSeen, kEmpty)), scene::LengthUnit::m);
  Progress memory, disk;
  const Cloud cloud = load_scans({scan}, memory);
  ASSERT_EQ(cloud.size(), static_cast<std::size_t>(kSeen));
  EXPECT_EQ(cloud.rgba.size(), cloud.size());
  EXPECT_EQ(cloud.invalid, static_cast<std::uint64_t>(kEmpty));
  EXPECT_EQ(cloud.origin_m, Eigen::Vector3d(0, 0, 2));
  const ScanSet set({scan}, ScanSet::Keep::disk, false, disk);
  EXPECT_EQ(set.points(), cloud.size());
  EXPECT_EQ(set.invalid(), cloud.invalid);
  EXPECT_EQ(set.origin_m(), cloud.origin_m);
  std::size_t seen = 0;
  (void)set.stream(
      [&](const CloudBlock& block) {
        ASSERT_EQ(block.rgba.size(), block.points.size());
        for (std::size_t i = 0; i < block.points.size(); ++i, ++seen) {
          ASSERT_LT(seen, cloud.size());
          EXPECT_TRUE(std::equal(block.points[i].begin(), block.points[i].end(), cloud.xyz1() + 4 * seen));
          EXPECT_EQ(block.rgba[i], cloud.rgba[seen]);
        }
      },
      disk);
  EXPECT_EQ(seen, cloud.size());
  for (const Progress* progress : {&memory, &disk}) {
    EXPECT_THAT(progress->warnings(), ElementsAre(HasSubstr("3000 of 12000 points stand at 0 0 0")));
  }
}

TEST(ScanSet, OfFewPointsAFewAtTheOriginAreEmptyReturns) {
  const ScanFolder folder;
  const auto file = folder.write("wall.xyz", wall_of_a_depth_camera(700, 9));
  for (const ScanSet::Keep keep : {ScanSet::Keep::quickest, ScanSet::Keep::disk}) {
    Progress progress;
    const ScanSet set({config_of(file, scene::LengthUnit::m)}, keep, false, progress);
    EXPECT_EQ(set.points(), 700U);
    EXPECT_EQ(set.invalid(), 9U);
    EXPECT_THAT(progress.warnings(), ElementsAre(HasSubstr("9 of 709 points stand at 0 0 0")));
  }
}

TEST(ScanSet, ASurfaceThroughTheOriginKeepsItsPointsThere) {
  const ScanFolder folder;
  for (const int at_origin : {1, 16}) {
    const auto file = folder.write("wall.xyz", wall_of_a_depth_camera(9000, at_origin));
    for (const ScanSet::Keep keep : {ScanSet::Keep::quickest, ScanSet::Keep::disk}) {
      Progress progress;
      const ScanSet set({config_of(file, scene::LengthUnit::m)}, keep, false, progress);
      EXPECT_EQ(set.points(), 9000U + static_cast<unsigned>(at_origin));
      EXPECT_EQ(set.invalid(), 0U);
      EXPECT_THAT(progress.warnings(), IsEmpty());
    }
  }
}

TEST(ScanSet, AStationsPlaceIsNoSurfaceEither) {
  RawScan scan;
  scan.stations = {{0, Eigen::Vector3d(1, 2, 3)}, {50, Eigen::Vector3d(4, 5, 6)}};
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d stood = *scan.stations[i < 50 ? 0 : 1].place;
    scan.points.push_back(i % 2 == 0 ? stood : Eigen::Vector3d(stood + Eigen::Vector3d(0, 0, 1 + i)));
  }
  drop_what_is_no_surface(scan);
  ASSERT_EQ(scan.points.size(), 50U);
  EXPECT_EQ(scan.invalid, 50U);
  EXPECT_EQ(scan.stations[1].first, 25U);
  EXPECT_EQ(scan.points[25], Eigen::Vector3d(4, 5, 6 + 1 + 51)) << "the first of the second station's";
}

TEST(SurveyScan, OfAStreamSaysWhatTheWholeScanSays) {
  const ScanFolder folder;
  constexpr int kPoints = 150'000;
  std::mt19937 random(11);
  std::uniform_real_distribution<double> at(0.0, 2.0);
  std::ostringstream text;
  for (int i = 0; i < kPoints; ++i) {
    const double x = at(random), y = at(random);
    text << x << ' ' << y << ' ' << 0.1 * std::sin(3.0 * x) << '\n';
  }
  text << "5000 5000 5000\n";
  const std::filesystem::path file = folder.write("a.xyz", text.str());
  Progress progress;
  const ScanStatistics whole = scan_statistics(file, progress);
  const ScanStatistics stream = scan_statistics(file, progress, 0);
  ASSERT_EQ(stream.scan.points, whole.scan.points);
  EXPECT_EQ(stream.scan.points.size(), 100'000U);
  EXPECT_EQ(stream.scan.records, kPoints + 1U);
  EXPECT_EQ(stream.scan.records, whole.scan.records);
  EXPECT_EQ(stream.runs.runs(), whole.runs.runs());
  EXPECT_EQ(stream.spacing, whole.spacing);
  // A median of 4096 distances that scatter by half of themselves, of points that are uniform: 0.47 / sqrt(density).
  const double expected = 0.47 * std::sqrt(2.0 * 2.0 / kPoints);
  EXPECT_NEAR(stream.spacing, expected, 4.0 * 0.6 * expected / std::sqrt(4096.0) + 0.03 * expected);
}

TEST(InspectScan, FindsExtentSpacingAndDuplicates) {
  const ScanFolder folder;
  std::string text;
  for (int i = 0; i < 50; ++i) {
    for (int j = 0; j < 40; ++j) text += std::to_string(0.25 * i) + " " + std::to_string(0.25 * j) + " 0\n";
  }
  text += "0.25 0.25 0\n0.25 0.25 0\n0.5 0.5 0\n";
  const ScanInfo info = inspect_scan(folder.write("g.xyz", text));
  EXPECT_EQ(info.points, 2003U);
  EXPECT_EQ(info.duplicates, 3U);
  EXPECT_FLOAT_EQ(static_cast<float>(info.spacing_m), 0.25F);
  EXPECT_EQ(info.min_m, Eigen::Vector3d(0, 0, 0));
  EXPECT_EQ(info.max_m, Eigen::Vector3d(12.25, 9.75, 0));
  EXPECT_EQ(info.units, "unknown");
}

TEST(InspectScan, CountsThePlacesThatADepthCameraDidNotSeeAsInvalid) {
  const ScanFolder folder;
  const auto file = folder.write("camera.xyz", wall_of_a_depth_camera(9000, 3000));
  const ScanInfo info = inspect_scan(file);
  EXPECT_EQ(info.points, 12000U);
  EXPECT_EQ(info.invalid, 3000U);
  EXPECT_EQ(info.min_m.z(), 2.0);
  EXPECT_THAT(info.warnings, ElementsAre(HasSubstr("3000 of 12000 points stand at 0 0 0")));
  const auto large = folder.write("large.xyz", wall_of_a_depth_camera(150'000, 30'000));
  Progress progress;
  for (const std::uint64_t large_bytes : {std::uint64_t{0}, ~std::uint64_t{0}}) {
    const ScanStatistics statistics = scan_statistics(large, progress, large_bytes);
    EXPECT_EQ(statistics.scan.invalid, 30'000U);
    for (const Eigen::Vector3d& p : statistics.scan.points) ASSERT_EQ(p.z(), 2.0);
  }
}

TEST(GuessUnit, DoubtsMetresOnlyWhereTheyAreImplausible) {
  const auto doubt = [](double side, double away = 0.0) {
    return doubt_metres(Eigen::Vector3d::Constant(away), Eigen::Vector3d::Constant(away + side));
  };
  EXPECT_FALSE(doubt(0.15));
  EXPECT_FALSE(doubt(30.0));
  EXPECT_FALSE(doubt(300.0, 450000.0));
  EXPECT_FALSE(doubt(0.0));
  ASSERT_TRUE(doubt(467.0));
  EXPECT_EQ(doubt(467.0)->unit, scene::LengthUnit::mm);
  EXPECT_TRUE(doubt(1e-4));
}

TEST(GuessUnit, DoubtsMetresOfMillimetresThatLieFarFromZero) {
  const auto doubt = [](double side, const Eigen::Vector3d& corner) {
    return doubt_metres(corner, corner + side * Eigen::Vector3d(1, 0.8, 0.1));
  };
  const auto unit = [&](double side, const Eigen::Vector3d& corner) {
    const std::optional<UnitGuess> guess = doubt(side, corner);
    return guess ? guess->unit : scene::LengthUnit::automatic;
  };
  EXPECT_EQ(unit(15000, {0, 0, 0}), scene::LengthUnit::mm) << "a facade";
  EXPECT_EQ(unit(12000, {-6000, -12000, 0}), scene::LengthUnit::mm);
  EXPECT_EQ(unit(150, {12500, 23400, 1000}), scene::LengthUnit::mm) << "a plaque, 26 m from the scanner's zero";
  EXPECT_FALSE(doubt(15000, {0, 0, 0})->may_be_metres);
  const Eigen::Vector3d near_grids[] = {{30000, 30000, 20}, {24000, 20800, 40}, {-7300, -35200, 60}};
  for (const Eigen::Vector3d& grid : near_grids) {  // Singapore, Berlin, Japan
    ASSERT_TRUE(doubt(300, grid)) << grid;
    EXPECT_TRUE(doubt(300, grid)->may_be_metres) << grid;
  }
  EXPECT_EQ(unit(500, {5.12e8, 5.4e9, 1e5}), scene::LengthUnit::mm) << "of UTM";
  EXPECT_EQ(unit(30, {5.12e8, 5.4e9, 1e5}), scene::LengthUnit::mm);
  ASSERT_TRUE(doubt(500, {5.12e8, 5.4e9, 1e5}));
  EXPECT_THAT(doubt(500, {5.12e8, 5.4e9, 1e5})->reason, HasSubstr("5400000 km from zero in metres, "));
  const Eigen::Vector3d grids[] = {{450000, 5400000, 300},       // UTM
                                   {166100, 300, 20},            // near the equator
                                   {32450000, 5400000, 300},     // with the zone's number
                                   {3450000, 5400000, 300},      // Gauss-Krueger
                                   {2600000, 1200000, 500},      // Swiss
                                   {530000, 180000, 10},         // British
                                   {155000, 463000, 0},          // Dutch
                                   {-8238000, 4970000, 10},      // the maps' of the web
                                   {4075000, 931000, 4801000}};  // from the centre of the Earth
  for (const Eigen::Vector3d& grid : grids) {
    for (const double site : {0.3, 3.0, 30.0, 100.0, 300.0}) EXPECT_FALSE(doubt(site, grid)) << grid << ", " << site;
  }
  EXPECT_FALSE(doubt(30, {1000, 5000, 100}));
  for (const double seconds : {10.0, 100.0}) EXPECT_FALSE(doubt(seconds, {1.7e9, 3, 1})) << "a time";
  EXPECT_FALSE(doubt(3e10, {3e10, 3e10, 3e10})) << "damage that no unit explains";
}

}  // namespace
}  // namespace sparsha::pipeline
