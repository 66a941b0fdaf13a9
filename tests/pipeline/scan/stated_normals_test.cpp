// Normals as files state them, in every format that can, beside the points that they belong to.
#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <string>

#include "base/files/files.h"
#include "base/threads/progress.h"
#include "pipeline/scan/set.h"
#include "tests/support/test_folder.h"

namespace sparsha::pipeline {
namespace {

using test::TestFolder;

constexpr std::size_t kPoints = 5;

Eigen::Vector3d point(std::size_t k) {
  const auto v = static_cast<double>(k);
  return {0.25 * v, 1.0 - v, 0.5 * v * v};
}
Eigen::Vector3d normal(std::size_t k) { return Eigen::Vector3d(k % 2 == 0 ? 0.6 : -0.6, 0.0, k % 3 == 0 ? 0.8 : -0.8); }

std::string row(std::size_t k, double length = 1.0) {
  const Eigen::Vector3d p = point(k);
  const Eigen::Vector3d n = length * normal(k);
  std::string text;
  for (const double v : {p.x(), p.y(), p.z(), n.x(), n.y(), n.z()}) text += std::to_string(v) + " ";
  return text + "\n";
}
std::string rows(double length = 1.0) {
  std::string text;
  for (std::size_t k = 0; k < kPoints; ++k) text += row(k, length);
  return text;
}

std::string binary(bool doubles) {
  std::string bytes;
  for (std::size_t k = 0; k < kPoints; ++k) {
    for (const Eigen::Vector3d& v : {point(k), normal(k)}) {
      for (int axis = 0; axis < 3; ++axis) {
        std::array<char, 8> value{};
        const auto single = static_cast<float>(v[axis]);
        doubles ? std::memcpy(value.data(), &v[axis], 8) : std::memcpy(value.data(), &single, 4);
        bytes.append(value.data(), doubles ? 8 : 4);
      }
    }
  }
  return bytes;
}

std::string ply_header(const std::string& encoding, const std::string& type) {
  std::string text = "ply\nformat " + encoding + " 1.0\nelement vertex " + std::to_string(kPoints) + "\n";
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz"}) text += "property " + type + " " + name + "\n";
  return text + "end_header\n";
}

std::string pcd_header(const std::string& data) {
  return "VERSION 0.7\nFIELDS x y z normal_x normal_y normal_z\nSIZE 4 4 4 4 4 4\nTYPE F F F F F F\n"
         "COUNT 1 1 1 1 1 1\nWIDTH 5\nHEIGHT 1\nPOINTS 5\nDATA " +
         data + "\n";
}

std::vector<Station> stations_of(scene::ScanConfig scan, ScanSet::Keep keep) {
  if (scan.units.unit == scene::LengthUnit::automatic) scan.units.unit = scene::LengthUnit::m;
  Progress progress;
  return ScanSet({scan}, keep, false, progress).stations();
}

/// Expects the true normal beside each point; both turned by `turn`, points scaled first.
void expect_normals(const std::vector<Station>& stations, const Eigen::Matrix3d& turn, double scale,
                    const std::string& what) {
  ASSERT_EQ(stations.size(), 1U) << what;
  const Station& stated = stations[0];
  ASSERT_EQ(stated.seen_m.size(), kPoints) << what;
  ASSERT_EQ(stated.normals.size(), kPoints) << what;
  EXPECT_TRUE(stated.declared);
  for (std::size_t i = 0; i < kPoints; ++i) {
    bool found = false;
    for (std::size_t k = 0; k < kPoints; ++k) {
      if ((stated.seen_m[i] - turn * point(k) * scale).norm() > 1e-6) continue;
      found = true;
      EXPECT_LT((stated.normals[i].cast<double>() - turn * normal(k)).norm(), 1e-6) << what;
    }
    EXPECT_TRUE(found) << what;
  }
}

TEST(StatedNormals, AreReadOfEveryFormatThatHasThem) {
  const TestFolder folder;
  const std::pair<const char*, std::string> files[] = {
      {"ascii.ply", ply_header("ascii", "float") + rows()},
      {"float.ply", ply_header("binary_little_endian", "float") + binary(false)},
      {"double.ply", ply_header("binary_little_endian", "double") + binary(true)},
      {"ascii.pcd", pcd_header("ascii") + rows()},
      {"binary.pcd", pcd_header("binary") + binary(false)},
      {"named.csv", "x y z nx ny nz\n" + rows()},
      {"unnamed.xyz", rows()},
  };
  for (const auto& [name, content] : files) {
    write_file(folder / name, content);
    for (const auto keep : {ScanSet::Keep::quickest, ScanSet::Keep::disk}) {
      scene::ScanConfig scan;
      scan.file = folder / name;
      expect_normals(stations_of(scan, keep), Eigen::Matrix3d::Identity(), 1.0, name);
    }
  }
}

TEST(StatedNormals, TurnWithTheirScanAndHaveUnitLength) {
  const TestFolder folder;
  write_file(folder / "a.ply", ply_header("ascii", "float") + rows(7.0));
  scene::ScanConfig scan;
  scan.file = folder / "a.ply";
  scan.units.unit = scene::LengthUnit::mm;
  Eigen::Matrix3d turn;
  turn << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  scan.pose.topLeftCorner<3, 3>() = turn;
  std::vector<Station> stations = stations_of(scan, ScanSet::Keep::disk);
  ASSERT_EQ(stations.size(), 2U) << "a pose says where a scanner stood, too";
  stations.erase(stations.begin());
  expect_normals(stations, turn, 0.001, "posed");
}

TEST(StatedNormals, ThatAreZeroOrNoNumbersSayNothing) {
  const TestFolder folder;
  write_file(folder / "a.ply",
             ply_header("ascii", "float") + row(0) + "1 2 3 0 0 0\n4 5 6 nan 0 1\n" + row(3) + row(4));
  scene::ScanConfig scan;
  scan.file = folder / "a.ply";
  const std::vector<Station> stations = stations_of(scan, ScanSet::Keep::quickest);
  ASSERT_EQ(stations.size(), 1U);
  EXPECT_EQ(stations[0].normals.size(), 3U);
  write_file(folder / "none.ply",
             ply_header("ascii", "float") + "1 2 3 0 0 0\n4 5 6 0 0 0\n1 1 1 0 0 0\n2 2 2 0 0 0\n3 3 3 0 0 0\n");
  scan.file = folder / "none.ply";
  EXPECT_TRUE(stations_of(scan, ScanSet::Keep::quickest).empty());
}

TEST(StatedNormals, ColoursBehindCoordinatesAreNoNormals) {
  const TestFolder folder;
  write_file(folder / "c.xyz", "0 0 0 0.6 0.8 0.0\n1 0 0 0.1 0.2 0.3\n0 1 0 0.5 0.5 0.5\n1 1 0 1 1 1\n");
  scene::ScanConfig scan;
  scan.file = folder / "c.xyz";
  EXPECT_TRUE(stations_of(scan, ScanSet::Keep::quickest).empty());
}

}  // namespace
}  // namespace sparsha::pipeline
