// Vertices where a scanner saw nothing are a hole, and vertices of the surface stay.
#include "pipeline/scan/empty_returns.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <sstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <Eigen/Geometry>

#include "base/threads/progress.h"
#include "pipeline/scan/set.h"
#include "pipeline/scan/statistics.h"
#include "tests/support/doubted_scans.h"
#include "tests/support/scan_files.h"

namespace sparsha::pipeline {
namespace {

using ::testing::AllOf;
using testing::config_of;
using ::testing::ElementsAre;
using testing::Face;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::kUtm;
using testing::Points;
using testing::scan_of;
using testing::ScanFolder;
using testing::square_mesh;

TEST(NoSurface, VerticesOfAMeshWhereADepthCameraSawNothingAreAHole) {
  RawScan scan = square_mesh();
  for (const std::uint32_t j : {9U, 10U, 11U})
    for (const std::uint32_t i : {9U, 10U, 11U}) scan.points[21 * j + i].setZero();
  drop_what_is_no_surface(scan);
  EXPECT_EQ(scan.points.size(), 441U - 9U);
  EXPECT_EQ(scan.invalid, 9U);
  EXPECT_EQ(scan.faces.size(), 800U - 30U) << "two triangles of each of 16 squares, but two at corners";
  for (const auto& face : scan.faces)
    for (const std::uint32_t v : face) EXPECT_EQ(scan.points.at(v).z(), -0.6);
  EXPECT_THAT(scan.warnings, ElementsAre(AllOf(HasSubstr("9 of 441 vertices"), HasSubstr("30 faces"))));
}

TEST(NoSurface, APictureThatIsMostlyEmptyIsStillAMesh) {
  RawScan scan = square_mesh();
  const std::size_t seen = scan.points.size();
  scan.points.resize(10 * seen, Eigen::Vector3d::Zero());
  drop_what_is_no_surface(scan);
  EXPECT_EQ(scan.points.size(), seen);
  EXPECT_EQ(scan.invalid, 9 * seen);
  EXPECT_THAT(scan.warnings, ElementsAre(HasSubstr("3969 of 4410 vertices stand at 0 0 0")));
}

TEST(NoSurface, VerticesOfAMeshThroughTheOriginStay) {
  // A cone of 100 triangles that share nothing: its apex is at 0 0 0 a hundred times.
  Points corners;
  std::vector<Face> faces;
  for (std::uint32_t k = 0; k < 100; ++k) {
    const auto at = [&](double turn) {
      return Eigen::Vector3d(std::cos(0.0628 * turn), std::sin(0.0628 * turn), -0.5);
    };
    corners.insert(corners.end(), {Eigen::Vector3d::Zero(), at(k), at(k + 1)});
    faces.push_back({3 * k, 3 * k + 1, 3 * k + 2});
  }
  RawScan cone = scan_of(corners, faces);
  drop_what_is_no_surface(cone);
  EXPECT_THAT(cone.warnings, IsEmpty());
  EXPECT_EQ(cone.points.size(), 300U);
  // A seam of copies of one vertex, as textures need them, among ordinary edges.
  RawScan seam = square_mesh();
  for (Eigen::Vector3d& p : seam.points) p.z() = 0.0;
  for (int copy = 0; copy < 6; ++copy) {
    const auto n = static_cast<std::uint32_t>(seam.points.size());
    seam.points.push_back(seam.points[220]);
    seam.faces.push_back({n, 221, 242});
  }
  ASSERT_TRUE(seam.points[220].isZero(1e-12));
  for (const std::size_t n : {220U, 441U, 442U, 443U, 444U, 445U, 446U}) seam.points[n].setZero();
  drop_what_is_no_surface(seam);
  EXPECT_EQ(seam.points.size(), 447U);
}

TEST(NoSurface, VerticesInBulkAtAnyOtherPlaceAreAHoleToo) {
  std::mt19937 random(26);
  std::normal_distribution<double> rounding(0.0, 1e-6);
  // As other programs write what is missing, the camera's place in a moved mesh, and there with rounding.
  for (const Eigen::Vector3d& shift : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(2, 3, 1), kUtm}) {
    for (const Eigen::Vector3d& place :
         {Eigen::Vector3d(-1, -1, -1), Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.05, 0.1, 0.4)}) {
      for (const double off : {0.0, 1.0}) {
        SCOPED_TRACE(fmt::format("shift {} place {} rounding {}", shift.x(), place.x(), off));
        RawScan scan = square_mesh();
        for (Eigen::Vector3d& p : scan.points) p += shift;
        for (const std::uint32_t j : {9U, 10U, 11U})
          for (const std::uint32_t i : {9U, 10U, 11U}) {
            const Eigen::Vector3d noise(rounding(random), rounding(random), rounding(random));
            scan.points[21 * j + i] = shift + place + off * noise;
          }
        drop_what_is_no_surface(scan);
        EXPECT_EQ(scan.points.size(), 441U - 9U);
        EXPECT_EQ(scan.faces.size(), 800U - 30U);
        for (const Eigen::Vector3d& p : scan.points) EXPECT_NEAR(p.z(), shift.z() - 0.6, 1e-9);
        EXPECT_THAT(scan.warnings, ElementsAre(AllOf(HasSubstr("9 of 441 vertices stand"), HasSubstr("30 faces"))));
      }
    }
  }
  RawScan scattered = square_mesh();
  for (const std::size_t n : {50U, 120U, 200U, 250U, 333U}) scattered.points[n] = {2, 3, 1};
  drop_what_is_no_surface(scattered);
  EXPECT_EQ(scattered.points.size(), 436U);
  EXPECT_EQ(scattered.faces.size(), 800U - 30U);
  RawScan empty = square_mesh();
  for (Eigen::Vector3d& p : empty.points) p += Eigen::Vector3d(2, 3, 1);
  empty.points.resize(4410, Eigen::Vector3d(2, 3, 1));
  drop_what_is_no_surface(empty);
  EXPECT_EQ(empty.points.size(), 441U);
}

TEST(NoSurface, VerticesTogetherThatBelongToTheSurfaceStay) {
  // A fine detail, 441 vertices within a hundredth of an edge, joined to large triangles.
  RawScan detail = square_mesh();
  const auto first = static_cast<std::uint32_t>(detail.points.size());
  const RawScan fine = square_mesh();
  for (const Eigen::Vector3d& p : fine.points) {
    detail.points.emplace_back(Eigen::Vector3d(0.21, 0.2, -0.6) + 1e-4 * (p + Eigen::Vector3d(0, 0, 0.6)));
  }
  for (const auto& [a, b, c] : fine.faces) detail.faces.push_back({a + first, b + first, c + first});
  for (std::uint32_t k = 0; k < 20; ++k) detail.faces.push_back({440, first + 21 * k, first + 21 * (k + 1)});
  drop_what_is_no_surface(detail);
  EXPECT_EQ(detail.points.size(), 882U);
  EXPECT_THAT(detail.warnings, IsEmpty());
  // A steep cone whose apex has a copy for each of its 200 sectors, with and without collapsed triangles, beside a
  // sheet or standing on it, with its apex at 0 0 0 or elsewhere.
  for (const bool lathe : {false, true})
    for (const bool joined : {false, true})
      for (const double height : {0.0, 1.0}) {
        SCOPED_TRACE(fmt::format("lathe {} joined {} height {}", lathe, joined, height));
        RawScan cone = square_mesh();
        const auto apex = static_cast<std::uint32_t>(cone.points.size());
        for (int k = 0; k < 200; ++k) cone.points.emplace_back(0.0, 0.0, height);
        for (const double radius : {0.2, 0.201})
          for (int k = 0; k < 200; ++k)
            cone.points.emplace_back(radius * std::cos(k * 0.0314), radius * std::sin(k * 0.0314), -0.6);
        for (std::uint32_t k = 0; k < 200; ++k) {
          const std::uint32_t next = (k + 1) % 200;
          const std::uint32_t ring = apex + 200;
          cone.faces.push_back({apex + k, ring + k, ring + next});
          if (lathe) cone.faces.push_back({apex + k, ring + next, apex + next});
          if (joined) {
            cone.faces.push_back({ring + k, ring + 200 + k, ring + next});
            cone.faces.push_back({ring + next, ring + 200 + k, ring + 200 + next});
          }
        }
        const std::size_t faces = cone.faces.size();
        drop_what_is_no_surface(cone);
        EXPECT_EQ(cone.faces.size(), faces);
        EXPECT_EQ(cone.points.size(), joined ? 1041U : 841U);
      }
}

TEST(NoSurface, TheBaseOfATurnedVesselStaysThoughItsAxisHasManyVertices) {
  // A cup of 96 segments, its base joined to its wall, each segment with a vertex of its own on the axis.
  constexpr std::uint32_t kSegments = 96, kRows = 100;
  for (const Eigen::Vector3d& axis : {Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(0, 0, 0)}) {
    Points points;
    std::vector<Face> faces;
    for (std::uint32_t row = 0; row < kRows; ++row)
      for (std::uint32_t k = 0; k < kSegments; ++k) {
        const double turn = k * 2.0 * 3.14159265358979 / kSegments;
        points.push_back(axis + Eigen::Vector3d(0.05 * std::cos(turn), 0.05 * std::sin(turn), 0.001 * row));
      }
    for (std::uint32_t k = 0; k < kSegments; ++k) {
      const std::uint32_t next = (k + 1) % kSegments;
      for (std::uint32_t row = 0; row + 1 < kRows; ++row) {
        faces.push_back({row * kSegments + k, row * kSegments + next, (row + 1) * kSegments + k});
        faces.push_back({row * kSegments + next, (row + 1) * kSegments + next, (row + 1) * kSegments + k});
      }
      faces.push_back({k, next, static_cast<std::uint32_t>(points.size())});
      points.push_back(axis);
    }
    RawScan cup = scan_of(points, faces);
    drop_what_is_no_surface(cup);
    EXPECT_THAT(cup.warnings, IsEmpty()) << axis;
    EXPECT_EQ(cup.faces.size(), faces.size()) << axis;
  }
}

TEST(NoSurface, VerticesOfNoFaceAreLeftOutAndSaidUnlessMostAre) {
  RawScan scan = square_mesh();
  scan.points.emplace_back(0, -180, -400);
  scan.points.emplace_back(251, -180, 90);
  drop_what_is_no_surface(scan);
  EXPECT_EQ(scan.points.size(), 441U);
  EXPECT_EQ(scan.invalid, 2U);
  EXPECT_THAT(scan.warnings, ElementsAre(HasSubstr("2 of 443 vertices belong to no face; they are left out")));
  EXPECT_NEAR(median_spacing(scan.points), 0.02, 1e-6);
  RawScan cloud = square_mesh();
  cloud.faces.resize(5);
  drop_what_is_no_surface(cloud);
  EXPECT_EQ(cloud.points.size(), 441U);
  EXPECT_EQ(cloud.invalid, 0U);
  EXPECT_THAT(cloud.warnings, ElementsAre(HasSubstr("taken as points")));
}

TEST(NoSurface, OfAMeshIsTheSameWhetherStreamedOrNot) {
  const ScanFolder folder;
  std::ostringstream text;
  text << "ply\nformat ascii 1.0\nelement vertex 444\nproperty float x\nproperty float y\nproperty float z\n"
          "element face 800\nproperty list uchar int vertex_indices\nend_header\n";
  RawScan mesh = square_mesh();
  for (const std::uint32_t n : {220U, 221U, 222U, 241U, 242U}) mesh.points[n].setZero();
  for (const Eigen::Vector3d& p : mesh.points) text << p.x() << ' ' << p.y() << ' ' << p.z() << '\n';
  text << "700 0 0\n0 900 0\nnan 0 0\n";
  for (const auto& [a, b, c] : mesh.faces) text << "3 " << a << ' ' << b << ' ' << c << '\n';
  const auto file = folder.write("a.ply", text.str());
  Progress first;
  Progress second;
  ScanSet memory({config_of(file, scene::LengthUnit::m)}, ScanSet::Keep::quickest, false, first);
  ScanSet streamed({config_of(file, scene::LengthUnit::m)}, ScanSet::Keep::disk, false, second);
  EXPECT_EQ(memory.points(), 436U);
  EXPECT_EQ(streamed.points(), memory.points());
  EXPECT_EQ(streamed.invalid(), memory.invalid());
  EXPECT_EQ(streamed.faces(), memory.faces());
  EXPECT_EQ(streamed.origin_m(), memory.origin_m());
  EXPECT_EQ(first.warnings(), second.warnings());
  const Cloud a = memory.load(memory.origin_m(), first);
  const Cloud b = streamed.load(streamed.origin_m(), second);
  ASSERT_EQ(a.size(), b.size());
  EXPECT_TRUE(std::equal(a.xyz1(), a.xyz1() + 4 * a.size(), b.xyz1()));
  EXPECT_EQ(a.faces, b.faces);
  EXPECT_EQ(first.warnings(), second.warnings());
}

}  // namespace
}  // namespace sparsha::pipeline
