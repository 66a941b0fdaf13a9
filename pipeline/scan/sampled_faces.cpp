// In large faces the points are a low-discrepancy sequence (Roberts' R2), folded at the diagonal; a small one has one
// point or none.
#include "pipeline/scan/sampled_faces.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "base/error.h"
#include "base/numbers/hash.h"

namespace sparsha::pipeline {
namespace {

using Corners = std::array<Eigen::Vector3d, 3>;

/// From 0 to 1, of a hash.
double fraction(std::uint64_t hash) { return static_cast<double>(hash >> 11U) * 0x1p-53; }

/// The corners in an order that depends on their places alone.
Corners corners_of(const Cloud& mesh, const std::array<std::uint32_t, 3>& face) {
  Corners corners;
  for (std::size_t k = 0; k < 3; ++k) {
    if (face[k] >= mesh.size())
      throw input_error({}, "a face names point " + std::to_string(face[k]), "faces index existing points");
    corners[k] = Eigen::Map<const Eigen::Vector3f>(mesh.xyz1() + 4 * static_cast<std::size_t>(face[k])).cast<double>();
  }
  std::sort(corners.begin(), corners.end(), [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
  });
  return corners;
}

double area_of(const Corners& c) { return 0.5 * (c[1] - c[0]).cross(c[2] - c[0]).norm(); }

std::uint64_t hash_of(const Corners& corners, std::uint64_t seed) {
  std::uint64_t hash = seed;
  for (const Eigen::Vector3d& c : corners) {
    hash = mix_bits(hash ^ hash_words(std::array<std::uint64_t, 3>{std::bit_cast<std::uint64_t>(c.x() + 0.0),
                                                                   std::bit_cast<std::uint64_t>(c.y() + 0.0),
                                                                   std::bit_cast<std::uint64_t>(c.z() + 0.0)}));
  }
  return hash;
}

}  // namespace

double area_of_faces(const Cloud& mesh) {
  double area = 0.0;
  for (const auto& face : mesh.faces) area += area_of(corners_of(mesh, face));
  return area;
}

Cloud sample_faces(const Cloud& mesh, double spacing_m, std::uint64_t seed) {
  constexpr double kMost = 0x1p31;
  const double per_m2 = 1.0 / (spacing_m * spacing_m);
  if (!(area_of_faces(mesh) * per_m2 < kMost))
    throw input_error({}, "the faces would need more than 2^31 points", "a larger grid.spacing_mm");
  std::vector<Eigen::Vector3f> places;
  std::vector<bool> corner(mesh.size(), false);
  for (const auto& face : mesh.faces) {
    const Corners corners = corners_of(mesh, face);
    for (const std::uint32_t v : face) corner[v] = true;
    const std::uint64_t hash = hash_of(corners, seed);
    const std::uint64_t first = mix_bits(hash + 1), second = mix_bits(hash + 2);
    const auto count = static_cast<std::uint64_t>(area_of(corners) * per_m2 + fraction(hash));
    constexpr double kPlastic = 1.32471795724474602596;  // the root of x^3 = x + 1
    for (std::uint64_t k = 0; k < count; ++k) {
      double a = fraction(first) + static_cast<double>(k) / kPlastic;
      double b = fraction(second) + static_cast<double>(k) / (kPlastic * kPlastic);
      a -= std::floor(a);
      b -= std::floor(b);
      if (a + b > 1.0) a = 1.0 - a, b = 1.0 - b;
      places.emplace_back((corners[0] + a * (corners[1] - corners[0]) + b * (corners[2] - corners[0])).cast<float>());
    }
  }
  for (std::size_t n = 0; n < mesh.size(); ++n)
    if (!corner[n]) places.emplace_back(Eigen::Map<const Eigen::Vector3f>(mesh.xyz1() + 4 * n));
  Cloud cloud;
  cloud.origin_m = mesh.origin_m;
  cloud.stations = mesh.stations;
  cloud.resize_points(places.size());
  for (std::size_t n = 0; n < places.size(); ++n) std::copy_n(places[n].data(), 3, cloud.xyz1() + 4 * n);
  return cloud;
}

}  // namespace sparsha::pipeline
