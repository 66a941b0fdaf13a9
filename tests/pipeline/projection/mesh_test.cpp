// Meshes: exact heights at the nodes, shared edges, vertical triangles, and meshes beside plain points.
#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "tests/support/clouds.h"

namespace sparsha::test {
namespace {

using pipeline::PointClass;
using scene::NodeState;

scene::GridConfig unit_square(double spacing_m) {
  scene::GridConfig config;
  config.bounds_m = {0.0, 0.0, 1.0, 1.0};
  config.spacing_m = spacing_m;
  return config;
}

double height(const pipeline::Projection& p, int i, int j) {
  return static_cast<double>(p.grid.height_m[p.grid.lattice.index(i, j)]) + p.grid.lattice.origin_m.z();
}

// n x n quads over the unit square, each cut along alternating diagonals.
pipeline::Cloud lattice_mesh(int n, const HeightFunction& f) {
  Points points;
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) points.push_back({double(i) / n, double(j) / n, f(double(i) / n, double(j) / n)});
  }
  pipeline::Cloud cloud = make_cloud(points);
  const auto at = [n](int i, int j) { return static_cast<std::uint32_t>(j * (n + 1) + i); };
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      if ((i + j) % 2 == 0) {
        cloud.faces.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
        cloud.faces.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
      } else {
        cloud.faces.push_back({at(i, j), at(i, j + 1), at(i + 1, j)});  // wound the other way
        cloud.faces.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
      }
    }
  }
  return cloud;
}

constexpr double kFloat = 1.2e-7;  // of numbers around one

TEST(MeshProjection, NodesOnSharedEdgesAndVerticesAreMeasured) {
  // Every node of the grid lies on a vertex, an edge or a diagonal of the mesh.
  const auto plane = [](double x, double y) { return 0.25 * x - 0.5 * y; };
  const pipeline::Projection p = project_cloud(lattice_mesh(8, plane), unit_square(1.0 / 16.0));
  for (int j = 0; j <= 16; ++j) {
    for (int i = 0; i <= 16; ++i) {
      ASSERT_EQ(p.grid.state[p.grid.lattice.index(i, j)], NodeState::measured) << i << ' ' << j;
      EXPECT_NEAR(height(p, i, j), plane(i / 16.0, j / 16.0), 4.0 * kFloat);
    }
  }
}

TEST(MeshProjection, HeightsAreExactInsideTriangles) {
  const auto plane = [](double x, double y) { return 3.0 * x - 2.0 * y + 0.1; };
  const pipeline::Projection p = project_cloud(lattice_mesh(7, plane), unit_square(0.003));
  for (int j = 0; j < p.grid.lattice.ny; ++j) {
    for (int i = 0; i < p.grid.lattice.nx; ++i) {
      ASSERT_EQ(p.grid.state[p.grid.lattice.index(i, j)], NodeState::measured);
      EXPECT_NEAR(height(p, i, j), plane(p.grid.lattice.x_m(i), p.grid.lattice.y_m(j)), 16.0 * kFloat);
    }
  }
}

TEST(MeshProjection, TheHighestTriangleWinsAndHiddenVerticesAreOccluded) {
  pipeline::Cloud cloud = lattice_mesh(4, [](double, double) { return 0.0; });
  const pipeline::Cloud upper = lattice_mesh(4, [](double x, double) { return 0.5 + 0.1 * x; });
  Points points;
  for (int layer = 0; layer < 2; ++layer) {
    for (int j = 0; j <= 4; ++j) {
      for (int i = 0; i <= 4; ++i) points.push_back({i / 4.0, j / 4.0, layer == 0 ? 0.0 : 0.5 + 0.1 * i / 4.0});
    }
  }
  pipeline::Cloud both = make_cloud(points);
  both.faces = cloud.faces;
  for (std::array<std::uint32_t, 3> face : upper.faces) {
    for (std::uint32_t& v : face) v += 25;
    both.faces.push_back(face);
  }
  const pipeline::Projection p = project_cloud(both, unit_square(0.05));
  EXPECT_NEAR(height(p, 10, 10), 0.5 + 0.1 * 0.5, 4.0 * kFloat);
  EXPECT_EQ(p.occluded, 25U);
  EXPECT_EQ(p.used, 25U);
}

TEST(MeshProjection, VerticalTrianglesCountWhereTheyContainANode) {
  // A wall in the plane x = 0.5 over a floor: the nodes on it get its upper edge.
  Points points{{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {1.0, 1.0, 0.0}, {0.0, 1.0, 0.0},
                {0.5, 0.0, 0.0}, {0.5, 1.0, 0.0}, {0.5, 0.5, 0.4}};
  pipeline::Cloud cloud = make_cloud(points);
  cloud.faces = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}};
  const pipeline::Projection p = project_cloud(cloud, unit_square(0.125));
  EXPECT_NEAR(height(p, 4, 4), 0.4, 4.0 * kFloat);
  EXPECT_NEAR(height(p, 4, 2), 0.2, 4.0 * kFloat);
  EXPECT_NEAR(height(p, 3, 4), 0.0, 4.0 * kFloat);
}

TEST(MeshProjection, AFaceThatNamesNoPointIsRefused) {
  pipeline::Cloud cloud = make_cloud({{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}});
  cloud.faces = {{0, 1, 3}};
  EXPECT_THROW(static_cast<void>(project_cloud(cloud, unit_square(0.1))), Error);
}

TEST(MeshProjection, PointsBesideAMeshAreProjectedToo) {
  // Left half: a mesh at z = 0.1. Right half: plain points at z = 0.2.
  pipeline::Cloud mesh = lattice_mesh(10, [](double, double) { return 0.1; });
  Points points;
  for (int j = 0; j <= 10; ++j) {
    for (int i = 0; i <= 10; ++i) points.push_back({0.05 * i, j / 10.0, 0.1});
  }
  std::mt19937_64 random(1);
  sample_surface(points, [](double, double) { return 0.2; }, 40000, {0.0002, 0.0}, random, {0.55, 0.0, 1.0, 1.0});
  pipeline::Cloud cloud = make_cloud(points);
  cloud.faces = mesh.faces;
  const pipeline::Projection p = project_cloud(cloud, unit_square(0.01));
  EXPECT_NEAR(height(p, 20, 50), 0.1, 4.0 * kFloat);
  EXPECT_NEAR(height(p, 80, 50), 0.2, 0.0002);
  EXPECT_EQ(p.grid.state[p.grid.lattice.index(20, 50)], NodeState::measured);
  EXPECT_EQ(p.grid.state[p.grid.lattice.index(80, 50)], NodeState::measured);
}

TEST(MeshProjection, ColourIsInterpolatedOverATriangle) {
  pipeline::Cloud cloud = make_cloud({{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}});
  cloud.faces = {{0, 1, 2}};
  cloud.rgba = {0xff000000U, 0xff0000c8U, 0xff00c800U};  // black, red 200, green 200
  scene::GridConfig config = unit_square(0.25);
  config.colour = true;
  const pipeline::Projection p = project_cloud(cloud, config);
  ASSERT_EQ(p.colour_rgba.size(), p.grid.lattice.count());
  EXPECT_EQ(p.colour_rgba[p.grid.lattice.index(2, 1)], 0xff003264U);
  EXPECT_EQ(p.colour_rgba[p.grid.lattice.index(4, 4)], 0U);
}

TEST(MeshProjection, CornersWithoutAColourLeaveItToTheOthers) {
  pipeline::Cloud cloud = make_cloud({{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {1.0, 1.0, 0.0}});
  cloud.faces = {{0, 1, 2}, {1, 3, 2}};
  cloud.rgba = {0xff0000c8U, pipeline::kNoColour, 0xff00c800U, pipeline::kNoColour};
  cloud.intensity = {pipeline::kNoIntensity, 2.0F, pipeline::kNoIntensity, pipeline::kNoIntensity};
  scene::GridConfig config = unit_square(0.25);
  config.colour = config.intensity = true;
  const pipeline::Projection p = project_cloud(cloud, config);
  EXPECT_EQ(p.colour_rgba[p.grid.lattice.index(1, 1)], 0xff004385U) << "red at 1/2, green at 1/4, the rest unknown";
  EXPECT_EQ(p.colour_rgba[p.grid.lattice.index(4, 4)], pipeline::kNoColour);
  EXPECT_EQ(p.intensity[p.grid.lattice.index(1, 1)], 2.0F);
}

// A flat mesh of n x n quads, `size_m` wide.
pipeline::Cloud flat_mesh(int n, double size_m) {
  pipeline::Cloud cloud = lattice_mesh(n, [](double, double) { return 0.0; });
  for (std::size_t k = 0; k < cloud.size(); ++k) {
    for (std::size_t axis = 0; axis < 2; ++axis) cloud.xyz1()[4 * k + axis] *= static_cast<float>(size_m);
  }
  return cloud;
}

std::uint32_t add_vertex(pipeline::Cloud& cloud, float x, float y, float z) {
  const std::size_t last = cloud.size();
  cloud.resize_points(last + 1);
  float* const p = cloud.xyz1() + 4 * last;
  p[0] = x;
  p[1] = y;
  p[2] = z;
  p[3] = 1.0F;
  return static_cast<std::uint32_t>(last);
}

TEST(MeshProjection, AFarVertexDoesNotStretchTheGridAndALargeFloorDoes) {
  const pipeline::Projection plain = project_cloud(flat_mesh(40, 1.0), {});
  pipeline::Cloud strayed = flat_mesh(40, 1.0);
  const std::uint32_t far = add_vertex(strayed, 150.0F, 0.5F, 0.0F);
  strayed.faces.push_back({0, 1, far});
  strayed.faces.push_back({1, 2, far});
  const pipeline::Projection p = project_cloud(strayed, {});
  EXPECT_EQ(p.grid.lattice.nx, plain.grid.lattice.nx);
  EXPECT_EQ(p.grid.lattice.ny, plain.grid.lattice.ny);
  EXPECT_EQ(p.outside, 1U);
  // Two triangles that carry area are a floor, however few their vertices.
  pipeline::Cloud with_floor = flat_mesh(40, 1.0);
  const std::array<std::uint32_t, 4> floor = {
      add_vertex(with_floor, -5.0F, -5.0F, -0.1F), add_vertex(with_floor, 5.0F, -5.0F, -0.1F),
      add_vertex(with_floor, 5.0F, 5.0F, -0.1F), add_vertex(with_floor, -5.0F, 5.0F, -0.1F)};
  with_floor.faces.push_back({floor[0], floor[1], floor[2]});
  with_floor.faces.push_back({floor[0], floor[2], floor[3]});
  const pipeline::Projection wide = project_cloud(with_floor, {});
  EXPECT_NEAR((wide.grid.lattice.nx - 1) * wide.grid.lattice.spacing_m, 10.0, wide.grid.lattice.spacing_m);
  EXPECT_EQ(wide.outside, 0U);
}

TEST(MeshProjection, AnAutomaticGridHasAtMostSixteenNodesACorner) {
  pipeline::Cloud triangle = make_cloud({{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.2}});
  triangle.faces.push_back({0, 1, 2});
  const pipeline::Projection p = project_cloud(triangle, {});
  EXPECT_LE(p.grid.lattice.count(), 48U);
  scene::GridConfig asked;
  asked.size = 300;
  EXPECT_EQ(project_cloud(triangle, asked).grid.lattice.nx, 300) << "who asks is given it";
}

}  // namespace
}  // namespace sparsha::test
