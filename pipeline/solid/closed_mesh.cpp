// Polygons of all cubes, and what they are together.
#include "pipeline/solid/closed_mesh.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Geometry>
#include "base/error.h"
#include "base/numbers/groups.h"
#include "pipeline/solid/cell_polygons.h"
#include "pipeline/solid/cubes.h"
#include "pipeline/solid/lattice.h"
#include "scene/solid/winding.h"

namespace sparsha::pipeline {
namespace {

constexpr std::uint32_t kNone = SurfaceLattice::kNone;

/// Vertices and triangles of cubes, lengths in spacings.
class Polygons {
 public:
  explicit Polygons(SurfaceLattice& lattice) : lattice_(lattice) {}

  void add(const LatticePoint& cell) {
    std::array<std::uint32_t, 8> corner{};
    unsigned inside = 0;
    for (unsigned c = 0; c < 8; ++c) {
      corner[c] = lattice_.find(corner_of(cell, static_cast<int>(c)));
      inside |= lattice_.inside(corner[c]) ? 1U << c : 0U;
    }
    std::array<std::array<float, 3>, 12> places{};
    std::array<std::uint32_t, 12> numbers{};
    for (const CubeLoop& loop : cube_loops(inside)) {
      for (const std::uint8_t edge : loop) {
        const CubeEdge& ends = cube_edges()[edge];
        numbers[edge] =
            vertex(corner[static_cast<std::size_t>(ends.low)], corner[static_cast<std::size_t>(ends.high)], edge / 4);
        for (int axis = 0; axis < 3; ++axis) {
          places[edge][static_cast<std::size_t>(axis)] =
              vertices[numbers[edge]][axis] - static_cast<float>(cell[static_cast<std::size_t>(axis)]);
        }
      }
      add(loop, numbers, places);
    }
  }

  std::vector<Eigen::Vector3f> vertices;
  std::vector<bool> measured;  ///< of vertices
  std::vector<std::array<std::uint32_t, 3>> triangles;

 private:
  std::uint32_t vertex(std::uint32_t low, std::uint32_t high, int axis) {
    std::uint32_t& number = lattice_.vertex(low, axis);
    if (number != kNone) return number;
    const SurfaceLattice::Passage passage = lattice_.passage(low, high, axis);
    const LatticePoint at = lattice_.place(low);
    Eigen::Vector3f place(static_cast<float>(at[0]), static_cast<float>(at[1]), static_cast<float>(at[2]));
    place[axis] += passage.at;
    number = static_cast<std::uint32_t>(vertices.size());
    vertices.push_back(place);
    measured.push_back(passage.measured);
    return number;
  }

  void add(const CubeLoop& loop, const std::array<std::uint32_t, 12>& numbers,
           const std::array<std::array<float, 3>, 12>& places) {
    const LoopTriangles cut = cut_loop(loop, places);
    for (const auto& t : cut) triangles.push_back({numbers[loop[t[0]]], numbers[loop[t[1]]], numbers[loop[t[2]]]});
    if (!cut.empty()) return;
    Eigen::Vector3f middle = Eigen::Vector3f::Zero();
    bool seen = false;
    for (const std::uint8_t edge : loop) {
      middle += vertices[numbers[edge]] / static_cast<float>(loop.size());
      seen = seen || measured[numbers[edge]];
    }
    const auto number = static_cast<std::uint32_t>(vertices.size());
    vertices.push_back(middle);
    measured.push_back(seen);
    for (std::size_t k = 0; k < loop.size(); ++k) {
      triangles.push_back({number, numbers[loop[k]], numbers[loop[(k + 1) % loop.size()]]});
    }
  }

  SurfaceLattice& lattice_;
};

double area_of(const Polygons& mesh, const std::array<std::uint32_t, 3>& t) {
  const Eigen::Vector3d a = mesh.vertices[t[0]].cast<double>();
  return 0.5 * (mesh.vertices[t[1]].cast<double>() - a).cross(mesh.vertices[t[2]].cast<double>() - a).norm();
}

/// Six times the volume of a triangle's tetrahedron with the origin.
double volume6_of(const Polygons& mesh, const std::array<std::uint32_t, 3>& t) {
  return mesh.vertices[t[0]].cast<double>().dot(
      mesh.vertices[t[1]].cast<double>().cross(mesh.vertices[t[2]].cast<double>()));
}

/// Vertices over holes of the scan: those that no node tells, where such a place is more than two triangles from what
/// was measured. Narrower strips lie between sheets, at sharp edges.
std::vector<bool> over_holes(const Polygons& mesh) {
  constexpr int kRings = 2;
  std::vector<bool> near = mesh.measured;
  for (int ring = 0; ring < kRings; ++ring) {
    const std::vector<bool> before = near;
    for (const auto& t : mesh.triangles) {
      if (!before[t[0]] && !before[t[1]] && !before[t[2]]) continue;
      for (const std::uint32_t v : t) near[v] = true;
    }
  }
  Groups patches(mesh.vertices.size());
  for (const auto& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      if (!mesh.measured[a] && !mesh.measured[b]) patches.join(a, b);
    }
  }
  std::vector<bool> wide(mesh.vertices.size(), false);
  for (std::uint32_t v = 0; v < near.size(); ++v) {
    if (!near[v]) wide[patches.of(v)] = true;
  }
  std::vector<bool> result(mesh.vertices.size());
  for (std::uint32_t v = 0; v < near.size(); ++v) result[v] = !mesh.measured[v] && wide[patches.of(v)];
  return result;
}

/// Vertices by their first use, and only those that are used.
void number_anew(ClosedMesh& mesh, const std::vector<Eigen::Vector3f>& vertices, double spacing_m) {
  std::vector<std::uint32_t> number(vertices.size(), kNone);
  for (auto& triangle : mesh.triangles) {
    for (std::uint32_t& corner : triangle) {
      if (number[corner] == kNone) {
        number[corner] = static_cast<std::uint32_t>(mesh.vertices_m.size());
        mesh.vertices_m.emplace_back((vertices[corner].cast<double>() * spacing_m).cast<float>());
      }
      corner = number[corner];
    }
  }
}

ClosedMesh collect(Polygons&& polygons, double spacing_m, Holes holes) {
  constexpr double kCrumb = 50.0;  // area of a ball with a radius of 2, squares of the spacing
  Groups shells(polygons.vertices.size());
  for (const auto& t : polygons.triangles) {
    shells.join(t[0], t[1]);
    shells.join(t[1], t[2]);
  }
  std::vector<double> area(polygons.vertices.size(), 0.0);
  for (const auto& t : polygons.triangles) area[shells.of(t[0])] += area_of(polygons, t);
  ClosedMesh mesh;
  for (const double of_shell : area) {
    if (of_shell > 0.0) ++(of_shell < kCrumb ? mesh.facts.crumbs : mesh.facts.shells);
  }
  const std::vector<bool> hole = over_holes(polygons);
  const double m2 = spacing_m * spacing_m;
  for (const auto& t : polygons.triangles) {
    if (area[shells.of(t[0])] < kCrumb) continue;
    const double here_m2 = area_of(polygons, t) * m2;
    const bool closing = hole[t[0]] || hole[t[1]] || hole[t[2]];
    mesh.facts.area_m2 += here_m2;
    mesh.facts.volume_m3 += volume6_of(polygons, t) / 6.0 * spacing_m * m2;
    if (closing) mesh.facts.closing_m2 += here_m2;
    if (!closing || holes == Holes::close) mesh.triangles.push_back(t);
  }
  number_anew(mesh, polygons.vertices, spacing_m);
  return mesh;
}

/// A scan of one side encloses nothing but a skin, or has nearly as large a back.
bool mostly_made_up(const ClosedMeshFacts& facts, double spacing_m) {
  constexpr double kMuch = 0.45, kSome = 0.3, kSkinSpacings = 1.5;
  const bool skin = facts.volume_m3 < kSkinSpacings * spacing_m * facts.area_m2;
  return facts.unseen() > (skin ? kSome : kMuch);
}

}  // namespace

ClosedMesh make_closed_mesh(const scene::Charts& charts, Holes holes, const Context& context) {
  SurfaceLattice lattice(charts);
  std::vector<std::uint64_t> cells;
  {
    const scene::WindingNumber winding(charts);
    cells = surface_cubes(lattice, winding, context);
  }
  Polygons polygons(lattice);
  for (const std::uint64_t cell : cells) polygons.add(SurfaceLattice::point_of(cell));
  ClosedMesh mesh = collect(std::move(polygons), charts.spacing_m, holes);
  if (mesh.facts.shells == 0 || mesh.triangles.empty()) {
    throw Error(ErrorKind::input, {}, "the sheets of the scene enclose nothing", "scans from all sides of the object");
  }
  if (holes == Holes::close && mostly_made_up(mesh.facts, charts.spacing_m)) {
    throw Error(ErrorKind::input, {},
                fmt::format("no scan saw {:.0f} % of what would be the surface of a closed mesh",
                            100.0 * mesh.facts.closing_m2 / mesh.facts.area_m2),
                "scans from all sides, or --holes leave");
  }
  return mesh;
}

}  // namespace sparsha::pipeline
