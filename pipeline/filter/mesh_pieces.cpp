#include "pipeline/filter/mesh_pieces.h"

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>

#include <Eigen/Geometry>

#include "base/numbers/hash.h"
#include "base/numbers/key_table.h"

namespace sparsha::pipeline {
namespace {

struct Place {
  std::array<std::uint32_t, 3> key;  ///< the bits of x, y and z
};
struct PlaceHash {
  std::uint64_t operator()(const std::array<std::uint32_t, 3>& key) const {
    return hash_words(std::array<std::uint64_t, 2>{std::uint64_t{key[0]} << 32U | key[1], key[2]});
  }
};

class Places {
 public:
  explicit Places(const Cloud& mesh) : xyz1_(mesh.xyz1()) {}

  std::uint32_t number(std::uint32_t corner) {
    const float* const p = xyz1_ + std::size_t{4} * corner;
    // -0.0 and 0.0 are the same place.
    const auto bits = [](float value) { return std::bit_cast<std::uint32_t>(value + 0.0F); };
    return table_.number({bits(p[0]), bits(p[1]), bits(p[2])});
  }
  [[nodiscard]] std::size_t size() const { return table_.size(); }

 private:
  const float* xyz1_;
  KeyTable<Place, PlaceHash> table_;
};

class Groups {
 public:
  explicit Groups(std::size_t count) : above_(count) { std::iota(above_.begin(), above_.end(), 0U); }

  std::uint32_t of(std::uint32_t i) {
    while (above_[i] != i) i = above_[i] = above_[above_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = of(a);
    b = of(b);
    above_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> above_;
};

double area_of(const Cloud& mesh, const std::array<std::uint32_t, 3>& face) {
  const auto corner = [&](std::size_t k) -> Eigen::Vector3d {
    return Eigen::Map<const Eigen::Vector3f>(mesh.xyz1() + std::size_t{4} * face[k]).cast<double>();
  };
  return 0.5 * (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm();
}

}  // namespace

std::vector<std::uint8_t> corners_of_large_pieces(const Cloud& mesh, double least_share) {
  Places places(mesh);
  std::vector<std::array<std::uint32_t, 3>> faces;
  faces.reserve(mesh.faces.size());
  for (const auto& [a, b, c] : mesh.faces) faces.push_back({places.number(a), places.number(b), places.number(c)});
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
