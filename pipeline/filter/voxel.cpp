#include "pipeline/filter/voxel.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "pipeline/base/error.h"
#include "pipeline/base/hash.h"

namespace sparsha::pipeline {
namespace {

struct Voxel {
  std::array<std::int64_t, 3> cell{};    ///< x, y, z in leaves from the scan frame's zero
  std::array<std::int64_t, 3> offset{};  ///< sum of the points' places in the cell, 2^-30 of a leaf
  std::array<std::uint64_t, 4> colour{};
  double intensity = 0.0;
  std::uint64_t count = 0;
};

constexpr double kUnits = 1 << 30;

/// Voxels by cell; open addressing.
class VoxelTable {
 public:
  VoxelTable() : slots_(1024, kFree) {}

  Voxel& at(const std::array<std::int64_t, 3>& cell) {
    if (voxels_.size() * 2 >= slots_.size()) grow();
    std::size_t slot = place(cell);
    while (slots_[slot] != kFree && voxels_[slots_[slot]].cell != cell) slot = (slot + 1) & (slots_.size() - 1);
    if (slots_[slot] == kFree) {
      slots_[slot] = static_cast<std::uint32_t>(voxels_.size());
      voxels_.emplace_back().cell = cell;
    }
    return voxels_[slots_[slot]];
  }
  [[nodiscard]] std::vector<Voxel>& voxels() { return voxels_; }

 private:
  static constexpr std::uint32_t kFree = ~std::uint32_t{0};

  [[nodiscard]] std::size_t place(const std::array<std::int64_t, 3>& cell) const {
    return static_cast<std::size_t>(hash_cell(cell)) & (slots_.size() - 1);
  }
  void grow() {
    slots_.assign(slots_.size() * 2, kFree);
    for (std::size_t i = 0; i < voxels_.size(); ++i) {
      std::size_t slot = place(voxels_[i].cell);
      while (slots_[slot] != kFree) slot = (slot + 1) & (slots_.size() - 1);
      slots_[slot] = static_cast<std::uint32_t>(i);
    }
  }

  std::vector<std::uint32_t> slots_;
  std::vector<Voxel> voxels_;
};

/// `far_m` is how far the scan reaches from the scan frame's zero.
void check_leaf(double leaf_m, double far_m) {
  // Below this the cell's number, or the place in it, has no exact double.
  const double least = std::ldexp(far_m, -45);
  if (leaf_m < least) {
    throw usage_error(
        fmt::format("voxel leaf of {} mm is too small for a scan that reaches {} m from zero", leaf_m * 1000.0, far_m),
        fmt::format("at least {} mm", least * 1000.0));
  }
}

float away_from_origin(const float* xyz) {
  return std::max(std::max(std::fabs(xyz[0]), std::fabs(xyz[1])), std::fabs(xyz[2]));
}

std::uint32_t mean_colour(const Voxel& voxel) {
  std::uint32_t rgba = 0;
  for (unsigned k = 0; k < 4; ++k) {
    rgba |= static_cast<std::uint32_t>((voxel.colour[k] + voxel.count / 2) / voxel.count) << (8 * k);
  }
  return rgba;
}

void write_back(const std::vector<Voxel>& voxels, double leaf_m, Cloud& cloud) {
  cloud.resize_points(voxels.size());
  if (!cloud.rgba.empty()) cloud.rgba.resize(voxels.size());
  if (!cloud.intensity.empty()) cloud.intensity.resize(voxels.size());
  float* const xyz = cloud.xyz1();
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    const Voxel& voxel = voxels[i];
    const double n = static_cast<double>(voxel.count);
    for (std::size_t k = 0; k < 3; ++k) {
      const double place = static_cast<double>(voxel.offset[k]) / (n * kUnits);
      const double coordinate = (static_cast<double>(voxel.cell[k]) + place) * leaf_m;
      xyz[4 * i + k] = static_cast<float>(coordinate - cloud.origin_m[static_cast<Eigen::Index>(k)]);
    }
    if (!cloud.rgba.empty()) cloud.rgba[i] = mean_colour(voxel);
    if (!cloud.intensity.empty()) cloud.intensity[i] = static_cast<float>(voxel.intensity / n);
  }
}

}  // namespace

struct VoxelThinner::Implementation {
  Eigen::Vector3d origin_m;
  double leaf_m;
  bool colour;
  bool intensity;
  float away = -1.0F;  ///< farthest coordinate so far, from the origin
  VoxelTable table;
};

VoxelThinner::VoxelThinner(const Eigen::Vector3d& origin_m, double leaf_m, bool colour, bool intensity)
    : implementation_(std::make_unique<Implementation>()) {
  implementation_->origin_m = origin_m;
  implementation_->leaf_m = leaf_m;
  implementation_->colour = colour;
  implementation_->intensity = intensity;
}

VoxelThinner::~VoxelThinner() = default;

std::size_t VoxelThinner::voxels() const { return implementation_->table.voxels().size(); }

void VoxelThinner::add(const float* xyz, std::uint32_t rgba, float intensity) {
  Implementation& self = *implementation_;
  if (const float away = away_from_origin(xyz); away > self.away) {
    self.away = away;
    check_leaf(self.leaf_m, static_cast<double>(away) + self.origin_m.cwiseAbs().maxCoeff());
  }
  std::array<std::int64_t, 3> cell{};
  std::array<std::int64_t, 3> offset{};
  for (std::size_t k = 0; k < 3; ++k) {
    const double leaves = (self.origin_m[static_cast<Eigen::Index>(k)] + static_cast<double>(xyz[k])) / self.leaf_m;
    const double below = std::floor(leaves);
    cell[k] = static_cast<std::int64_t>(below);
    offset[k] = static_cast<std::int64_t>((leaves - below) * kUnits);
  }
  Voxel& voxel = self.table.at(cell);
  for (std::size_t k = 0; k < 3; ++k) voxel.offset[k] += offset[k];
  if (self.colour) {
    for (unsigned k = 0; k < 4; ++k) voxel.colour[k] += rgba >> (8 * k) & 255;
  }
  if (self.intensity) voxel.intensity += static_cast<double>(intensity);
  ++voxel.count;
}

Cloud VoxelThinner::finish() {
  Implementation& self = *implementation_;
  std::vector<Voxel>& voxels = self.table.voxels();
  std::sort(voxels.begin(), voxels.end(), [](const Voxel& a, const Voxel& b) {
    return std::lexicographical_compare(a.cell.rbegin(), a.cell.rend(), b.cell.rbegin(), b.cell.rend());
  });
  Cloud cloud;
  cloud.origin_m = self.origin_m;
  if (self.colour) cloud.rgba.resize(voxels.size());
  if (self.intensity) cloud.intensity.resize(voxels.size());
  write_back(voxels, self.leaf_m, cloud);
  return cloud;
}

void thin_to_voxels(Cloud& cloud, double leaf_m, Progress& progress) {
  float away = 0.0F;
  for (std::size_t i = 0; i < cloud.size(); ++i) away = std::max(away, away_from_origin(cloud.xyz1() + 4 * i));
  check_leaf(leaf_m, static_cast<double>(away) + cloud.origin_m.cwiseAbs().maxCoeff());
  VoxelThinner thinner(cloud.origin_m, leaf_m, !cloud.rgba.empty(), !cloud.intensity.empty());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if ((i & 0xFFFF) == 0) progress.throw_if_cancelled();
    thinner.add(cloud.xyz1() + 4 * i, cloud.rgba.empty() ? 0U : cloud.rgba[i],
                cloud.intensity.empty() ? 0.0F : cloud.intensity[i]);
  }
  Cloud thinned = thinner.finish();
  cloud.points = std::move(thinned.points);
  cloud.rgba = std::move(thinned.rgba);
  cloud.intensity = std::move(thinned.intensity);
}

}  // namespace sparsha::pipeline
