#include "scene/material/grain_field.h"

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "base/numbers/hash.h"

namespace sparsha::scene {
namespace {

constexpr unsigned kNodes = 256;              // per side of the tile, a power of two
constexpr int kLowest = 16;                   // waves per side of the tile
constexpr double kBand = 1.2599210498948732;  // a third of an octave
constexpr std::uint64_t kSeed = 0x5350415253484101ULL;
constexpr double kLeastShare = 0.01;    // of a plane that counts
constexpr double kApart_m = 1.7320508;  // between the places of one tile that the planes of a surface in space have
constexpr double kTileExponent = 3.5;   // of the density over the plane inside a band

double unit(std::uint64_t word) { return static_cast<double>(hash_word(kSeed + word) >> 11U) * 0x1p-53; }

/// Height and slopes (per node) of waves between kLowest and kBand times that, standard deviation of the heights 1:
/// {h, dh/dx, dh/dy, 0} per node. Phases by a hash: the same in every run.
std::vector<float> make_tile() {
  std::array<double, kNodes> cosine{};
  for (unsigned i = 0; i < kNodes; ++i) cosine[i] = std::cos(2.0 * std::numbers::pi * i / kNodes);
  constexpr unsigned kMask = kNodes - 1;
  std::vector<double> sums(std::size_t{3} * kNodes * kNodes);
  double variance = 0.0;
  const int most = static_cast<int>(kLowest * kBand);
  for (int v = 0; v <= most; ++v)
    for (int u = -most; u <= most; ++u) {
      if (v == 0 && u <= 0) continue;  // the other half of the plane says the same
      const double q = std::hypot(u, v);
      if (q < kLowest || q >= kLowest * kBand) continue;
      const double amplitude = std::pow(q / kLowest, -0.5 * kTileExponent);
      variance += 0.5 * amplitude * amplitude;
      const auto phase = static_cast<unsigned>(
          hash_word(kSeed ^ (static_cast<std::uint64_t>(v) << 32U) ^ static_cast<std::uint64_t>(u + 2 * most)));
      const double along_x = amplitude * 2.0 * std::numbers::pi * u / kNodes;
      const double along_y = amplitude * 2.0 * std::numbers::pi * v / kNodes;
      std::size_t at = 0;
      for (unsigned y = 0; y < kNodes; ++y) {
        unsigned turn = phase + static_cast<unsigned>(v) * y;
        for (unsigned x = 0; x < kNodes; ++x, at += 3, turn += static_cast<unsigned>(u)) {
          const double even = cosine[turn & kMask];
          const double odd = cosine[(turn + kNodes / 4) & kMask];  // minus the sine
          sums[at] += amplitude * even;
          sums[at + 1] += along_x * odd;
          sums[at + 2] += along_y * odd;
        }
      }
    }
  const double unit_share = 1.0 / std::sqrt(variance);
  std::vector<float> tile(std::size_t{4} * kNodes * kNodes);
  for (std::size_t node = 0; node < std::size_t{kNodes} * kNodes; ++node)
    for (std::size_t k = 0; k < 3; ++k) tile[4 * node + k] = static_cast<float>(unit_share * sums[3 * node + k]);
  return tile;
}

}  // namespace

// The density over the plane is c q^-(p + 1): along any straight line it integrates to level * (q / from)^-p.
GrainField::GrainField(const HeightSpectrum& spectrum) {
  if (!(spectrum.level_m3 > 0.0) || !(spectrum.from_per_m > 0.0)) return;
  static const std::vector<float> kTile = make_tile();
  tile_ = kTile.data();
  const double p = spectrum.exponent;
  const double plane = std::tgamma(0.5 * (p + 1.0)) / (std::sqrt(std::numbers::pi) * std::tgamma(0.5 * p));
  for (int b = 0; b < kBands; ++b) {
    Band& band = band_[index(b)];
    const double ratio = std::pow(kBand, b);
    const double whole = std::abs(p - 1.0) < 1e-6 ? std::log(kBand) : (1.0 - std::pow(kBand, 1.0 - p)) / (p - 1.0);
    const double variance_m2 =
        2.0 * std::numbers::pi * plane * spectrum.level_m3 * spectrum.from_per_m * std::pow(ratio, 1.0 - p) * whole;
    band.deviation_m = std::sqrt(variance_m2);
    const double lowest_per_m = spectrum.from_per_m * ratio;
    band.highest_per_m = lowest_per_m * kBand;
    band.per_m = lowest_per_m / kLowest * kNodes;
    const auto seed = static_cast<std::uint64_t>(b) * 3;
    const double angle = 2.0 * std::numbers::pi * unit(seed);
    band.cosine = std::cos(angle);
    band.sine = std::sin(angle);
    band.shift_x = kNodes * unit(seed + 1);
    band.shift_y = kNodes * unit(seed + 2);
  }
  bands_ = kBands;
}

GrainField::Corners GrainField::corners(const Band& band, double x_m, double y_m) const noexcept {
  // Within one tile first: places may be thousands of kilometres from the origin.
  const auto within = [](double nodes) { return nodes - kNodes * std::floor(nodes / kNodes); };
  const double x = within((band.cosine * x_m - band.sine * y_m) * band.per_m + band.shift_x);
  const double y = within((band.sine * x_m + band.cosine * y_m) * band.per_m + band.shift_y);
  const double floor_x = std::floor(x);
  const double floor_y = std::floor(y);
  const double s = x - floor_x;
  const double t = y - floor_y;
  const auto node = [&](unsigned i, unsigned j) { return tile_ + std::size_t{4} * (j % kNodes * kNodes + i % kNodes); };
  const auto i = static_cast<unsigned>(floor_x);
  const auto j = static_cast<unsigned>(floor_y);
  return {{node(i, j), node(i + 1, j), node(i, j + 1), node(i + 1, j + 1)},
          {(1.0 - s) * (1.0 - t), s * (1.0 - t), (1.0 - s) * t, s * t}};
}

GrainField::Value GrainField::at(int b, double x_m, double y_m) const noexcept {
  const Band& band = band_[index(b)];
  const Corners around = corners(band, x_m, y_m);
  double height = 0.0;
  double slope_x = 0.0;
  double slope_y = 0.0;
  for (std::size_t k = 0; k < around.nodes.size(); ++k) {
    height += around.shares[k] * static_cast<double>(around.nodes[k][0]);
    slope_x += around.shares[k] * static_cast<double>(around.nodes[k][1]);
    slope_y += around.shares[k] * static_cast<double>(around.nodes[k][2]);
  }
  Value value;
  value.height_m = band.deviation_m * height;
  const double steepness = band.deviation_m * band.per_m;
  value.slope = steepness * Eigen::Vector2d(band.cosine * slope_x + band.sine * slope_y,
                                            band.cosine * slope_y - band.sine * slope_x);
  return value;
}

double GrainField::height_m(int b, double x_m, double y_m) const noexcept {
  const Band& band = band_[index(b)];
  const Corners around = corners(band, x_m, y_m);
  double height = 0.0;
  for (std::size_t k = 0; k < around.nodes.size(); ++k)
    height += around.shares[k] * static_cast<double>(around.nodes[k][0]);
  return band.deviation_m * height;
}

Eigen::Vector3d GrainField::shares(const Eigen::Vector3d& normal) noexcept {
  const Eigen::Vector3d squares = normal.cwiseAbs2();
  const double length = squares.norm();
  return length > 0.0 ? Eigen::Vector3d(squares / length) : Eigen::Vector3d::UnitZ();
}

namespace {

/// Where a place of space lies over the plane across an axis.
Eigen::Vector2d over_plane_m(const Eigen::Vector3d& place_m, int axis) {
  return {place_m[(axis + 1) % 3] + kApart_m * (2 - axis), place_m[(axis + 2) % 3]};
}

}  // namespace

double GrainField::height_m(int b, const Eigen::Vector3d& place_m, const Eigen::Vector3d& shares) const noexcept {
  double height = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    if (!(shares[axis] > kLeastShare)) continue;
    const Eigen::Vector2d over_m = over_plane_m(place_m, axis);
    height += shares[axis] * height_m(b, over_m.x(), over_m.y());
  }
  return height;
}

Eigen::Vector3d GrainField::slope(int b, const Eigen::Vector3d& place_m, const Eigen::Vector3d& shares) const noexcept {
  Eigen::Vector3d slope = Eigen::Vector3d::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    if (!(shares[axis] > kLeastShare)) continue;
    const Eigen::Vector2d over_m = over_plane_m(place_m, axis);
    const Eigen::Vector2d along = shares[axis] * at(b, over_m.x(), over_m.y()).slope;
    slope[(axis + 1) % 3] += along.x();
    slope[(axis + 2) % 3] += along.y();
  }
  return slope;
}

}  // namespace sparsha::scene
