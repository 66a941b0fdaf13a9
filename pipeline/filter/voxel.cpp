#include "pipeline/filter/voxel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>
#include <unordered_map>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "base/numbers/exact_sum.h"
#include "base/numbers/hash.h"
#include "base/numbers/key_table.h"

namespace sparsha::pipeline {
namespace {

/// x, y, z in leaves from the scan frame's zero.
using Cell = std::array<std::int64_t, 3>;
struct CellHash {
  std::uint64_t operator()(const Cell& cell) const { return hash_cell(cell); }
};

constexpr double kUnits = 1 << 30;

struct VoxelColour {
  std::array<std::uint64_t, 4> channels{};

  void add(std::uint32_t rgba) {
    for (unsigned k = 0; k < 4; ++k) channels[k] += rgba >> (8 * k) & 255;
  }
  [[nodiscard]] std::uint32_t mean(std::uint64_t count) const {
    std::uint32_t rgba = kNoColour;
    for (unsigned k = 0; count > 0 && k < 4; ++k) {
      rgba |= static_cast<std::uint32_t>((channels[k] + count / 2) / count) << (8 * k);
    }
    return rgba;
  }
};
struct NoColour {};
struct NoIntensity {};

/// Sums over the points of a voxel. What the scan has not takes no memory; aligned so that one lies in no more than two
/// cache lines, without colour in one.
template <bool kColour, bool kIntensity>
struct alignas(kColour ? 32 : 64) Voxel {
  Cell key{};
  std::array<std::int64_t, 3> place{};  ///< in the cell, 2^-30 of a leaf
  std::uint64_t count = 0;
  [[no_unique_address]] std::conditional_t<kColour, VoxelColour, NoColour> colour;
  [[no_unique_address]] std::conditional_t<kIntensity, double, NoIntensity> intensity{};
};

/// Adds and gives what the sum was rounded by, which is exact (Knuth 1969, two-sum).
double add_and_keep_rest(double& sum, double value) {
  const double before = sum;
  sum += value;
  const double added = sum - before;
  return (before - (sum - added)) + (value - added);
}

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

/// Of one coordinate, in leaves from the scan frame's zero.
double leaves_of(const Eigen::Vector3d& origin_m, double leaf_m, const float* xyz, std::size_t axis) {
  return (origin_m[static_cast<Eigen::Index>(axis)] + static_cast<double>(xyz[axis])) / leaf_m;
}

float away_from_origin(const float* xyz) {
  return std::max(std::max(std::fabs(xyz[0]), std::fabs(xyz[1])), std::fabs(xyz[2]));
}

}  // namespace

class VoxelThinner::Implementation {
 public:
  Implementation(const Eigen::Vector3d& origin_m, double leaf_m) : origin_m_(origin_m), leaf_m_(leaf_m) {}
  virtual ~Implementation() = default;
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  virtual void add(const float* xyz, std::uint32_t rgba, float intensity) = 0;
  [[nodiscard]] virtual std::size_t voxels() = 0;
  [[nodiscard]] virtual Cloud finish() = 0;

 protected:
  Eigen::Vector3d origin_m_;
  double leaf_m_;
};

/// For scans with and without attributes.
template <bool kColour, bool kIntensity>
class VoxelThinner::Sums final : public Implementation {
 public:
  using Implementation::Implementation;

  void add(const float* xyz, std::uint32_t rgba, float intensity) override {
    if (const float away = away_from_origin(xyz); away > away_) {
      away_ = away;
      check_leaf(leaf_m_, static_cast<double>(away) + origin_m_.cwiseAbs().maxCoeff());
    }
    // A voxel is asked for some points before it is needed, since the way to memory takes longer than all the rest.
    Waiting& point = waiting_[next_ % kAhead];
    if (next_ >= kAhead) use(point);
    for (std::size_t k = 0; k < 3; ++k) {
      const double leaves = leaves_of(origin_m_, leaf_m_, xyz, k);
      const double below = std::floor(leaves);
      point.cell[k] = static_cast<std::int64_t>(below);
      point.place[k] = static_cast<std::int64_t>((leaves - below) * kUnits);
    }
    point.hash = hash_cell(point.cell);
    point.rgba = rgba;
    point.intensity = intensity;
    table_.prefetch_slot(point.hash);
    if (next_ >= kAhead / 2) table_.prefetch_record(waiting_[(next_ - kAhead / 2) % kAhead].hash);
    ++next_;
  }

  [[nodiscard]] std::size_t voxels() override {
    for (std::uint64_t k = next_ - std::min(next_, kAhead); k < next_; ++k) use(waiting_[k % kAhead]);
    next_ = 0;
    return table_.size();
  }

  [[nodiscard]] Cloud finish() override {
    std::vector<std::pair<Cell, std::uint32_t>> order;
    order.reserve(voxels());
    const auto all = table_.take();
    for (const auto& voxel : all) order.emplace_back(voxel.key, static_cast<std::uint32_t>(order.size()));
    std::sort(order.begin(), order.end(), [](const auto& a, const auto& b) {
      return std::lexicographical_compare(a.first.rbegin(), a.first.rend(), b.first.rbegin(), b.first.rend());
    });
    Cloud cloud;
    cloud.origin_m = origin_m_;
    cloud.resize_points(all.size());
    if (kColour) cloud.rgba.resize(all.size());
    if (kIntensity) cloud.intensity.resize(all.size());
    float* xyz = cloud.xyz1();
    for (std::size_t i = 0; i < all.size(); ++i, xyz += 4) {
      const auto& voxel = all[order[i].second];
      const double n = static_cast<double>(voxel.count);
      const Without without = without_of(order[i].second);
      for (std::size_t k = 0; k < 3; ++k) {
        const double place = static_cast<double>(voxel.place[k]) / (n * kUnits);
        const double coordinate = (static_cast<double>(voxel.key[k]) + place) * leaf_m_;
        xyz[k] = static_cast<float>(coordinate - origin_m_[static_cast<Eigen::Index>(k)]);
      }
      if constexpr (kColour) cloud.rgba[i] = voxel.colour.mean(voxel.count - without.colour);
      if constexpr (kIntensity) {
        const auto known = static_cast<double>(voxel.count - without.intensity);  // 0 / 0 is kNoIntensity
        cloud.intensity[i] = static_cast<float>(intensity(order[i].second, voxel.intensity) / known);
      }
    }
    return cloud;
  }

 private:
  struct Waiting {
    Cell cell;
    std::array<std::int64_t, 3> place;
    std::uint64_t hash;
    std::uint32_t rgba;
    float intensity;
  };
  static constexpr std::uint64_t kAhead = 16;
  /// Points of a voxel that have none.
  struct Without {
    std::uint64_t colour = 0;
    std::uint64_t intensity = 0;
  };

  void use(const Waiting& point) {
    const std::uint32_t number = table_.number(point.cell, point.hash);
    auto& voxel = table_[number];
    for (std::size_t k = 0; k < 3; ++k) voxel.place[k] += point.place[k];
    ++voxel.count;
    if constexpr (kColour) {
      point.rgba == kNoColour ? void(++without_[number].colour) : voxel.colour.add(point.rgba);
    }
    if constexpr (kIntensity) {
      if (std::isnan(point.intensity)) {
        ++without_[number].intensity;
        return;
      }
      const double rest = add_and_keep_rest(voxel.intensity, static_cast<double>(point.intensity));
      if (rest != 0.0 && std::isfinite(rest)) rests_[number].add(rest);
    }
  }
  [[nodiscard]] Without without_of(std::uint32_t number) const {
    const auto found = without_.find(number);
    return found == without_.end() ? Without() : found->second;
  }
  [[nodiscard]] double intensity(std::uint32_t number, double sum) const {
    if (!std::isfinite(sum)) return std::numeric_limits<double>::quiet_NaN();
    const auto rest = rests_.find(number);
    if (rest == rests_.end()) return sum;
    ExactSum exact = rest->second;
    exact.add(sum);
    return exact.value();
  }

  std::unordered_map<std::uint32_t, Without> without_;  ///< by voxel; scans that differ are few
  float away_ = -1.0F;                                  ///< farthest coordinate so far, from the origin
  std::array<Waiting, kAhead> waiting_{};
  std::uint64_t next_ = 0;  ///< points that came since all were used
  KeyTable<Voxel<kColour, kIntensity>, CellHash> table_;
  /// By voxel: what its sum of intensities was rounded by, with which the sum is exact and does not depend on the order
  /// of the points. Intensities of like size are never rounded: a double holds 2^29 times as much as a float.
  std::unordered_map<std::uint32_t, ExactSum> rests_;
};

VoxelThinner::VoxelThinner(const Eigen::Vector3d& origin_m, double leaf_m, bool colour, bool intensity) {
  if (colour && intensity) {
    implementation_ = std::make_unique<Sums<true, true>>(origin_m, leaf_m);
  } else if (colour) {
    implementation_ = std::make_unique<Sums<true, false>>(origin_m, leaf_m);
  } else if (intensity) {
    implementation_ = std::make_unique<Sums<false, true>>(origin_m, leaf_m);
  } else {
    implementation_ = std::make_unique<Sums<false, false>>(origin_m, leaf_m);
  }
}

VoxelThinner::~VoxelThinner() = default;

std::size_t VoxelThinner::voxels() const { return implementation_->voxels(); }

void VoxelThinner::add(const float* xyz, std::uint32_t rgba, float intensity) {
  implementation_->add(xyz, rgba, intensity);
}

Cloud VoxelThinner::finish() { return implementation_->finish(); }

void VoxelCounter::add(const float* xyz) {
  Cell cell{};
  for (std::size_t k = 0; k < cell.size(); ++k)
    cell[k] = static_cast<std::int64_t>(std::floor(leaves_of(origin_m_, leaf_m_, xyz, k)));
  const auto counts = [&](std::uint64_t hash) { return halvings_ == 0 || hash >> (64U - halvings_) == 0; };
  const std::uint64_t hash = hash_cell(cell);
  if (!counts(hash)) return;
  hashes_.insert(hash);
  while (hashes_.size() > kMost) {
    ++halvings_;
    std::erase_if(hashes_, [&](std::uint64_t other) { return !counts(other); });
  }
}

void thin_to_voxels(Cloud& cloud, double leaf_m, Progress& progress) {
  float away = 0.0F;
  for (std::size_t i = 0; i < cloud.size(); ++i) away = std::max(away, away_from_origin(cloud.xyz1() + 4 * i));
  check_leaf(leaf_m, static_cast<double>(away) + cloud.origin_m.cwiseAbs().maxCoeff());
  VoxelThinner thinner(cloud.origin_m, leaf_m, !cloud.rgba.empty(), !cloud.intensity.empty());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if ((i & 0xFFFF) == 0) progress.throw_if_cancelled();
    thinner.add(cloud.xyz1() + 4 * i, cloud.rgba.empty() ? kNoColour : cloud.rgba[i],
                cloud.intensity.empty() ? kNoIntensity : cloud.intensity[i]);
  }
  Cloud thinned = thinner.finish();
  cloud.points = std::move(thinned.points);
  cloud.rgba = std::move(thinned.rgba);
  cloud.intensity = std::move(thinned.intensity);
}

}  // namespace sparsha::pipeline
