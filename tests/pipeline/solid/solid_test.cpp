// Closed meshes of whole objects whose surface is known. Lengths are in mean point spacings unless a name says metres.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "base/error.h"
#include "pipeline/charts/charts.h"
#include "pipeline/solid/cell_polygons.h"
#include "pipeline/solid/closed_mesh.h"
#include "scene/solid/winding.h"
#include "tests/support/clouds.h"
#include "tests/support/mesh_faults.h"
#include "tests/support/whole_surface.h"

namespace sparsha::test {
namespace {

using pipeline::ClosedMesh;
using pipeline::Holes;

constexpr std::size_t kFew = 20'000;

struct Meshed {
  ObjectScan scan;
  scene::Charts charts;
  ClosedMesh mesh;

  [[nodiscard]] Eigen::Vector3d place_m(std::size_t vertex) const {
    return charts.origin_m + mesh.vertices_m[vertex].cast<double>();
  }
};

scene::Charts charts_of(const Points& points, double spacing_m) {
  ThreadPool pool(2);
  Progress progress;
  scene::GridConfig grid;
  grid.spacing_m = spacing_m;
  return pipeline::make_charts(make_cloud(points), Eigen::Matrix4d::Identity(), grid, 0.0, {pool, progress}).charts;
}

ClosedMesh mesh_of(const scene::Charts& charts, Holes holes = Holes::close, unsigned threads = 2) {
  ThreadPool pool(threads);
  Progress progress;
  return pipeline::make_closed_mesh(charts, holes, {pool, progress});
}

Meshed mesh_object(const ClosedObject& object, std::size_t points) {
  ScanOptions options;
  options.points = points;
  options.noise_spacings = 0.1;
  options.seed = 11;
  Meshed result;
  result.scan = scan_object(object, options);
  result.charts = charts_of(result.scan.points, result.scan.spacing_m);
  result.mesh = mesh_of(result.charts);
  return result;
}

struct Errors {
  double median = 0.0, p99 = 0.0;
  double far = 0.0;  ///< share that is more than 3 spacings from the surface; the others do not count it
};

/// Of vertices and middles of triangles, by the exact distance where the object knows it, else by exact points.
Errors errors_of(const Meshed& meshed, const ClosedObject& object) {
  std::vector<Eigen::Vector3d> places;
  for (std::size_t v = 0; v < meshed.mesh.vertices_m.size(); v += 3) places.push_back(meshed.place_m(v));
  for (std::size_t t = 0; t < meshed.mesh.triangles.size(); t += 5) {
    const auto& c = meshed.mesh.triangles[t];
    places.emplace_back((meshed.place_m(c[0]) + meshed.place_m(c[1]) + meshed.place_m(c[2])) / 3.0);
  }
  const bool exact = std::isfinite(object.distance_m(places.front()));
  const double spacing = meshed.scan.spacing_m;
  const WholeSurface truth(object, exact ? 1 : 15 * meshed.scan.points.size(), spacing);
  std::vector<double> errors;
  for (const Eigen::Vector3d& p : places) {
    double error = 0.0;
    if (exact) {
      error = std::abs(object.distance_m(p)) / spacing;
    } else {
      const SurfacePoint* near = truth.nearest(p, 3.0 * spacing);
      error = near == nullptr ? 4.0 : std::abs(near->normal.dot(p - near->position_m)) / spacing;
    }
    if (error <= 3.0) errors.push_back(error);
  }
  std::sort(errors.begin(), errors.end());
  return {errors[errors.size() / 2], errors[errors.size() * 99 / 100],
          1.0 - static_cast<double>(errors.size()) / static_cast<double>(places.size())};
}

MeshFaults expect_closed(const std::string& name, const ClosedMesh& mesh) {
  const MeshFaults faults = find_mesh_faults(mesh.vertices_m, mesh.triangles);
  EXPECT_EQ(faults.open_edges, 0U) << name;
  EXPECT_EQ(faults.bad_edges, 0U) << name;
  EXPECT_EQ(faults.pinched, 0U) << name;
  EXPECT_EQ(faults.flat, 0U) << name;
  EXPECT_EQ(faults.crossings, 0U) << name;
  EXPECT_GT(mesh.facts.volume_m3, 0.0) << name;
  return faults;
}

void show(const std::string& name, const Meshed& m, const Errors& errors) {
  std::printf(
      "%-24s %7zu vertices, %u shells, %u crumbs, median %.3f, 99th percentile %.3f, %.2f %% far, %.2f %% unseen\n",
      name.c_str(), m.mesh.vertices_m.size(), m.mesh.facts.shells, m.mesh.facts.crumbs, errors.median, errors.p99,
      100.0 * errors.far, 100.0 * m.mesh.facts.unseen());
}

/// A plate of so many spacings between 2 m wide faces.
NamedObject plate(double spacings, std::size_t points, const Eigen::Matrix3d& view) {
  const double spacing = std::sqrt(8.0 / static_cast<double>(points));  // edges hardly count
  return {"plate of " + std::to_string(spacings), make_box({1.0, 1.0, 0.5 * spacings * spacing}, view)};
}

struct Expected {
  NamedObject named;
  std::uint32_t shells;
  long euler;
  double volume_m3;
  double p99;
};

TEST(ClosedMesh, IsOneManifoldOnTheSurfaceOfEachObject) {
  constexpr double kPi = 3.14159265358979323846;
  const Eigen::Matrix3d straight = Eigen::Matrix3d::Identity();
  const auto plate_m3 = [](double spacings) { return 4.0 * spacings * std::sqrt(8.0 / kFew); };
  const std::vector<Expected> all{
      {{"torus", make_torus()}, 1, 0, 2.0 * kPi * kPi * 0.16, 0.15},
      {{"two spheres", make_two_spheres()}, 2, 4, 4.0 / 3.0 * kPi * 1.125, 0.15},
      {{"vase", make_vase(turned(48.0, 0.0))}, 1, 2, 0.0, 0.2},
      {{"knot", make_knot()}, 1, 0, 0.0, 0.15},
      {{"coin", make_coin()}, 1, 2, 0.0, 0.2},
      {{"cube", make_box({0.6, 0.6, 0.6}, straight)}, 1, 2, 1.728, 0.5},
      {{"cube on a corner", make_box({0.6, 0.6, 0.6}, turned(35.3, 45.0))}, 1, 2, 1.728, 0.5},
      {plate(5.0, kFew, straight), 1, 2, plate_m3(5.0), 0.5},
      {plate(5.0, kFew, turned(30.0, 20.0)), 1, 2, plate_m3(5.0), 0.5},
      {plate(3.5, kFew, turned(30.0, 20.0)), 1, 2, plate_m3(3.5), 0.5},
      {plate(3.0, kFew, turned(30.0, 20.0)), 1, 2, plate_m3(3.0), 0.5}};
  for (const Expected& expected : all) {
    const std::string& name = expected.named.name;
    const Meshed meshed = mesh_object(*expected.named.object, kFew);
    EXPECT_EQ(expect_closed(name, meshed.mesh).euler, expected.euler) << name;
    EXPECT_EQ(meshed.mesh.facts.shells, expected.shells) << name;
    EXPECT_LE(meshed.mesh.facts.unseen(), 0.001) << name;
    if (expected.volume_m3 > 0.0) {
      EXPECT_NEAR(meshed.mesh.facts.volume_m3 / expected.volume_m3, 1.0, 0.01) << name;
    }
    const Errors errors = errors_of(meshed, *expected.named.object);
    show(name, meshed, errors);
    EXPECT_LE(errors.median, 0.06) << name;
    EXPECT_LE(errors.p99, expected.p99) << name;
    EXPECT_EQ(errors.far, 0.0) << name;
  }
}

TEST(RealScanClosedMesh, IsManifoldForMeshesOpenOrClosed) {
  const char* folder = std::getenv("SPARSHA_SCANS_DIR");
  const std::vector<NamedObject> objects = mesh_objects(folder == nullptr ? "" : folder);
  if (objects.empty()) GTEST_SKIP() << "SPARSHA_SCANS_DIR has no meshes";
  for (const NamedObject& named : objects) {
    const Meshed meshed = mesh_object(*named.object, kFew);
    expect_closed(named.name, meshed.mesh);
    EXPECT_EQ(meshed.mesh.facts.shells, 1U) << named.name;
    const Errors errors = errors_of(meshed, *named.object);
    show(named.name, meshed, errors);
    EXPECT_LE(errors.median, 0.06) << named.name;
    EXPECT_LE(errors.far, 1.2 * meshed.mesh.facts.unseen() + 0.01) << named.name;
  }
}

/// The larger of two balls without its lowest part, below `y`.
Points open_ball(double y, double& spacing_m) {
  const ObjectScan scan = scan_object(*make_two_spheres(), [] {
    ScanOptions options;
    options.points = kFew;
    options.noise_spacings = 0.1;
    return options;
  }());
  spacing_m = scan.spacing_m;
  Points open;
  for (const auto& p : scan.points) {
    const Eigen::Vector3d q(p[0], p[1], p[2]);
    if ((q - Eigen::Vector3d(0.0, 0.0, -0.6)).norm() < 1.1 && q.y() > y) open.push_back(p);
  }
  return open;
}

TEST(ClosedMesh, SaysWhatNoScanSawAndLeavesItOpenByChoice) {
  double spacing_m = 0.0;
  const Points open = open_ball(-0.8, spacing_m);
  const scene::Charts charts = charts_of(open, spacing_m);
  const ClosedMesh closed = mesh_of(charts);
  EXPECT_EQ(expect_closed("closed", closed).euler, 2);
  // The cap's area is 2 pi (1 - 0.8); what closes it is no less than the disc over it, pi (1 - 0.8^2), and no more.
  EXPECT_GT(closed.facts.unseen(), 0.36 / 4.0 * 0.8);
  EXPECT_LT(closed.facts.unseen(), 0.40 / 4.0 * 1.2);
  const ClosedMesh left = mesh_of(charts, Holes::leave);
  EXPECT_EQ(left.facts.unseen(), closed.facts.unseen());
  const MeshFaults faults = find_mesh_faults(left.vertices_m, left.triangles);
  EXPECT_EQ(faults.bad_edges, 0U);
  EXPECT_GT(faults.open_edges, 50U);
  EXPECT_LT(faults.open_edges, 400U) << "one border, and none at places that were seen";
  for (const Eigen::Vector3f& p : left.vertices_m) {
    ASSERT_NEAR((charts.origin_m + p.cast<double>() - Eigen::Vector3d(0.0, 0.0, -0.6)).norm(), 1.0, 2.0 * spacing_m);
  }
}

TEST(ClosedMesh, IsRefusedWhereHalfOfItWouldBeMadeUp) {
  scene::Charts charts;
  charts.spacing_m = 0.01;
  scene::Sheet sheet;
  sheet.nx = sheet.ny = 60;
  sheet.height_m.assign(3600, 0.0F);
  sheet.slope_u.assign(3600, 0.0F);
  sheet.slope_v.assign(3600, 0.0F);
  sheet.mask.assign(3600, scene::Sheet::kMeasured);
  for (int j = 0; j < 60; ++j) {
    for (int i = 0; i < 60; ++i) sheet.height_m[sheet.index(i, j)] = 0.02F * std::sin(0.2F * static_cast<float>(i));
  }
  charts.sheets.push_back(sheet);
  EXPECT_THROW((void)mesh_of(charts), Error);
  EXPECT_NO_THROW((void)mesh_of(charts, Holes::leave));
  EXPECT_THROW((void)mesh_of({}), Error);
  charts.spacing_m = 1e-12;  // then heights are more spacings than can be counted
  EXPECT_THROW((void)mesh_of(charts), Error);
}

TEST(ClosedMesh, IsTheSameForAnyNumberOfThreads) {
  double spacing_m = 0.0;
  const Points open = open_ball(-0.6, spacing_m);
  const scene::Charts charts = charts_of(open, spacing_m);
  const ClosedMesh one = mesh_of(charts, Holes::close, 1);
  const ClosedMesh three = mesh_of(charts, Holes::close, 3);
  EXPECT_EQ(one.triangles, three.triangles);
  ASSERT_EQ(one.vertices_m.size(), three.vertices_m.size());
  EXPECT_EQ(
      std::memcmp(one.vertices_m.data(), three.vertices_m.data(), one.vertices_m.size() * sizeof(Eigen::Vector3f)), 0);
}

TEST(CubePolygons, OfAllCubesAreClosedApartFromEachOtherAndNotInTheFaces) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> along(0.02F, 0.98F);
  for (unsigned inside = 0; inside < 256; ++inside) {
    for (int trial = 0; trial < 20; ++trial) {
      std::array<std::array<float, 3>, 12> places{};
      std::vector<Eigen::Vector3f> vertices;
      for (std::size_t edge = 0; edge < 12; ++edge) {
        const int low = pipeline::cube_edges()[edge].low;
        places[edge] = {static_cast<float>(low & 1), static_cast<float>(low >> 1 & 1), static_cast<float>(low >> 2)};
        places[edge][edge / 4] = along(random);
        vertices.emplace_back(places[edge][0], places[edge][1], places[edge][2]);
      }
      std::vector<std::array<std::uint32_t, 3>> triangles;
      std::size_t edges = 0;
      for (const pipeline::CubeLoop& loop : pipeline::cube_loops(inside)) {
        ASSERT_GE(loop.size(), 3U);
        edges += loop.size();
        const pipeline::LoopTriangles cut = pipeline::cut_loop(loop, places);
        for (const auto& t : cut) {
          triangles.push_back({loop[t[0]], loop[t[1]], loop[t[2]]});
          EXPECT_FALSE(pipeline::share_face(loop[t[0]], loop[t[1]]) && pipeline::share_face(loop[t[1]], loop[t[2]]) &&
                       pipeline::share_face(loop[t[2]], loop[t[0]]) && loop.size() > 3);
        }
        if (!cut.empty()) continue;
        Eigen::Vector3f middle = Eigen::Vector3f::Zero();
        for (const std::uint8_t edge : loop) middle += vertices[edge] / static_cast<float>(loop.size());
        vertices.push_back(middle);
        for (std::size_t k = 0; k < loop.size(); ++k) {
          triangles.push_back({static_cast<std::uint32_t>(vertices.size() - 1), loop[k], loop[(k + 1) % loop.size()]});
        }
      }
      std::size_t changes = 0;
      for (const pipeline::CubeEdge& edge : pipeline::cube_edges()) {
        changes += ((inside >> static_cast<unsigned>(edge.low) ^ inside >> static_cast<unsigned>(edge.high)) & 1U);
      }
      EXPECT_EQ(edges, changes) << inside;
      if (triangles.empty()) continue;
      const MeshFaults faults = find_mesh_faults(vertices, triangles);
      EXPECT_EQ(faults.crossings, 0U) << "cube " << inside;
      EXPECT_EQ(faults.bad_edges, 0U) << "cube " << inside;
    }
  }
}

TEST(WindingNumberOfCharts, IsOneInsideAndNothingOutside) {
  const Meshed meshed = mesh_object(*make_torus(turned(0.0, 0.0)), kFew);
  const scene::WindingNumber winding(meshed.charts);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> anywhere(-1.6, 1.6);
  const ObjectPtr torus = make_torus(turned(0.0, 0.0));
  for (int k = 0; k < 3000; ++k) {
    const Eigen::Vector3d p(anywhere(random), anywhere(random), anywhere(random));
    const double distance = torus->distance_m(p) / meshed.scan.spacing_m;
    if (std::abs(distance) < 2.0) continue;
    const Eigen::Vector3d at = (p - meshed.charts.origin_m) / meshed.charts.spacing_m;
    EXPECT_NEAR(winding.at(at.cast<float>()), distance < 0.0 ? 1.0 : 0.0, 0.12) << distance;
  }
}

}  // namespace
}  // namespace sparsha::test
