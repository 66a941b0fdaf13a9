#include "pipeline/filter/mesh_pieces.h"

#include <algorithm>
#include <array>

#include <Eigen/Geometry>

#include "base/numbers/groups.h"
#include "pipeline/scan/places.h"

namespace sparsha::pipeline {
namespace {

double area_of(const Cloud& mesh, const std::array<std::uint32_t, 3>& face) {
  const auto corner = [&](std::size_t k) -> Eigen::Vector3d {
    return Eigen::Map<const Eigen::Vector3f>(mesh.xyz1() + std::size_t{4} * face[k]).cast<double>();
  };
  return 0.5 * (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm();
}

}  // namespace

std::vector<std::uint8_t> corners_of_large_pieces(const Cloud& mesh, double least_share) {
  Places places;
  const auto place = [&](std::uint32_t corner) {
    const float* const p = mesh.xyz1() + std::size_t{4} * corner;
    return places.number(p[0], p[1], p[2]);
  };
  std::vector<std::array<std::uint32_t, 3>> faces;
  faces.reserve(mesh.faces.size());
  for (const auto& [a, b, c] : mesh.faces) faces.push_back({place(a), place(b), place(c)});
  Groups groups(places.size());
  for (const auto& [a, b, c] : faces) {
    groups.join(a, b);
    groups.join(a, c);
  }
  std::vector<double> areas(places.size(), 0.0);
  double all = 0.0;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const double area = area_of(mesh, mesh.faces[f]);
    areas[groups.of(faces[f][0])] += area;
    all += area;
  }
  std::vector<std::uint8_t> stays(mesh.size(), 0);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (!(areas[groups.of(faces[f][0])] >= least_share * all)) continue;
    for (const std::uint32_t corner : mesh.faces[f]) stays[corner] = 1;
  }
  return stays;
}

double share_of_area_lost(const Cloud& mesh, const std::vector<std::uint8_t>& keep) {
  double all = 0.0;
  double lost = 0.0;
  for (const auto& face : mesh.faces) {
    const double area = area_of(mesh, face);
    all += area;
    if (std::any_of(face.begin(), face.end(), [&](std::uint32_t corner) { return keep[corner] == 0; })) lost += area;
  }
  return all > 0.0 ? lost / all : 0.0;
}

}  // namespace sparsha::pipeline
