// In large faces the points are a low-discrepancy sequence (Roberts' R2), folded at the diagonal; a small one has one
// point or none.
#include "pipeline/scan/sampled_faces.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "base/error.h"
#include "base/numbers/colour_sum.h"
#include "base/numbers/hash.h"

namespace sparsha::pipeline {
namespace {

using Corners = std::array<Eigen::Vector3d, 3>;
using Face = std::array<std::uint32_t, 3>;

/// From 0 to 1, of a hash.
double fraction(std::uint64_t hash) { return static_cast<double>(hash >> 11U) * 0x1p-53; }

/// The corners in an order that depends on their places alone, and on their colours where places are the same.
Face in_order(const Cloud& mesh, Face face) {
  for (const std::uint32_t v : face) {
    if (v >= mesh.size())
      throw input_error({}, "a face names point " + std::to_string(v), "faces index existing points");
  }
  std::sort(face.begin(), face.end(), [&](std::uint32_t a, std::uint32_t b) {
    const float* const p = mesh.xyz1() + 4 * static_cast<std::size_t>(a);
    const float* const q = mesh.xyz1() + 4 * static_cast<std::size_t>(b);
    if (!std::equal(p, p + 3, q)) return std::lexicographical_compare(p, p + 3, q, q + 3);
    return !mesh.rgba.empty() && mesh.rgba[a] < mesh.rgba[b];
  });
  return face;
}

Corners places_of(const Cloud& mesh, const Face& face) {
  Corners corners;
  for (std::size_t k = 0; k < 3; ++k)
    corners[k] = Eigen::Map<const Eigen::Vector3f>(mesh.xyz1() + 4 * static_cast<std::size_t>(face[k])).cast<double>();
  return corners;
}

/// Colours and intensities of sampled points, where they are asked for and the mesh has them.
class SampledAttributes {
 public:
  SampledAttributes(const Cloud& mesh, bool wanted)
      : mesh_(mesh), colour_(wanted && !mesh.rgba.empty()), intensity_(wanted && !mesh.intensity.empty()) {}

  /// Of a point between the corners of a face, by its shares of them, which add up to one. Corners that have none
  /// leave the others their share.
  void add(const Face& face, const std::array<double, 3>& share) {
    constexpr double kOne = 65536.0;
    ColourSum colour;
    double value = 0.0, known = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      if (colour_) colour.add(mesh_.rgba[face[k]], std::lround(kOne * share[k]));
      if (!intensity_ || !std::isfinite(mesh_.intensity[face[k]])) continue;
      value += share[k] * static_cast<double>(mesh_.intensity[face[k]]);
      known += share[k];
    }
    if (colour_) rgba.push_back(colour.mean());
    if (intensity_) intensity.push_back(known > 0.0 ? static_cast<float>(value / known) : kNoIntensity);
  }
  void add(std::size_t point) {
    if (colour_) rgba.push_back(mesh_.rgba[point]);
    if (intensity_) intensity.push_back(mesh_.intensity[point]);
  }

  std::vector<std::uint32_t> rgba;
  std::vector<float> intensity;

 private:
  const Cloud& mesh_;
  bool colour_, intensity_;
};

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
  for (const auto& face : mesh.faces) area += area_of(places_of(mesh, in_order(mesh, face)));
  return area;
}

Cloud sample_faces(const Cloud& mesh, double spacing_m, std::uint64_t seed, bool attributes) {
  constexpr double kMost = 0x1p31;
  const double per_m2 = 1.0 / (spacing_m * spacing_m);
  if (!(area_of_faces(mesh) * per_m2 < kMost))
    throw input_error({}, "the faces would need more than 2^31 points", "a larger grid.spacing_mm");
  std::vector<Eigen::Vector3f> places;
  SampledAttributes sampled(mesh, attributes);
  std::vector<bool> corner(mesh.size(), false);
  for (const Face& given : mesh.faces) {
    const Face face = in_order(mesh, given);
    const Corners corners = places_of(mesh, face);
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
      sampled.add(face, {1.0 - a - b, a, b});
    }
  }
  for (std::size_t n = 0; n < mesh.size(); ++n) {
    if (corner[n]) continue;
    places.emplace_back(Eigen::Map<const Eigen::Vector3f>(mesh.xyz1() + 4 * n));
    sampled.add(n);
  }
  Cloud cloud;
  cloud.origin_m = mesh.origin_m;
  cloud.stations = mesh.stations;
  cloud.resize_points(places.size());
  for (std::size_t n = 0; n < places.size(); ++n) std::copy_n(places[n].data(), 3, cloud.xyz1() + 4 * n);
  cloud.rgba = std::move(sampled.rgba);
  cloud.intensity = std::move(sampled.intensity);
  return cloud;
}

}  // namespace sparsha::pipeline
