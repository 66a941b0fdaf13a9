#include "haptics/effects/grain.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "base/hash.h"
#include "base/smooth_step.h"

namespace sparsha::haptics {
namespace {

constexpr unsigned kNodes = 256;              // per side of the tile, a power of two
constexpr int kLowest = 16;                   // waves per side of the tile
constexpr double kBand = 1.2599210498948732;  // a third of an octave
constexpr std::uint64_t kSeed = 0x5350415253484101ULL;
constexpr double kTileExponent = 3.5;  // of the density over the plane inside a band

constexpr double kStillMPerS = 0.005;  // an encoder's flicker seems to move so fast
constexpr double kMovingMPerS = 0.020;
constexpr double kSlowS = 0.016;
constexpr double kFastS = 0.004;
constexpr double kPeriodShare = 0.05;
constexpr double kWhole = 0.46;         // waves per tick up to which a band is whole
constexpr double kNyquist = 0.5;        // and from which it is gone
constexpr double kShortestM = 0.00012;  // at the hand: shorter waves are below an encoder's steps
constexpr double kSteepest = 0.5;

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

GrainField::Value GrainField::at(int b, double x_m, double y_m) const noexcept {
  const Band& band = band_[index(b)];
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
  const std::array<const float*, 4> corners = {node(i, j), node(i + 1, j), node(i, j + 1), node(i + 1, j + 1)};
  const std::array<double, 4> shares = {(1.0 - s) * (1.0 - t), s * (1.0 - t), (1.0 - s) * t, s * t};
  double height = 0.0;
  double slope_x = 0.0;
  double slope_y = 0.0;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    height += shares[k] * static_cast<double>(corners[k][0]);
    slope_x += shares[k] * static_cast<double>(corners[k][1]);
    slope_y += shares[k] * static_cast<double>(corners[k][2]);
  }
  Value value;
  value.height_m = band.deviation_m * height;
  const double steepness = band.deviation_m * band.per_m;
  value.slope = steepness * Eigen::Vector2d(band.cosine * slope_x + band.sine * slope_y,
                                            band.cosine * slope_y - band.sine * slope_x);
  return value;
}

Grain::Output Grain::update(const Input& input, const GrainField& field) noexcept {
  Output output;
  const double period_s = std::max(input.period_s, 0.1 * input.nominal_period_s);
  period_s_ = period_s_ > 0.0 ? period_s_ + kPeriodShare * (period_s - period_s_) : input.nominal_period_s;
  const Eigen::Vector3d velocity = input.contact ? Eigen::Vector3d(input.moved_m / period_s) : Eigen::Vector3d::Zero();
  slow_m_per_s_ += (velocity - slow_m_per_s_) * std::min(1.0, period_s / kSlowS);
  fast_m_per_s_ += (velocity - fast_m_per_s_) * std::min(1.0, period_s / kFastS);
  const double speed = slow_m_per_s_.norm();
  const double share = smooth_step((speed - kStillMPerS) / (kMovingMPerS - kStillMPerS));
  if (!input.contact || !(share > 0.0) || !input.place_m.allFinite()) return output;
  const double per_tick_m =
      std::max(speed, fast_m_per_s_.norm()) / input.scale * std::max({period_s_, input.nominal_period_s, period_s});
  double variance_m2 = 0.0;
  for (int band = 0; band < field.bands(); ++band) {
    const double highest_per_m = field.highest_per_m(band);
    const double waves = highest_per_m * per_tick_m;
    if (waves >= kNyquist || highest_per_m * kShortestM > input.scale) break;
    const double weight = share * std::clamp((kNyquist - waves) / (kNyquist - kWhole), 0.0, 1.0);
    const GrainField::Value value = field.at(band, input.place_m.x(), input.place_m.y());
    output.slope += weight * value.slope;
    variance_m2 += std::pow(weight * field.deviation_m(band), 2);
  }
  output.deviation_m = std::sqrt(variance_m2);
  const double steepness = output.slope.norm();
  if (steepness > kSteepest) output.slope *= kSteepest / steepness;
  return output;
}

}  // namespace sparsha::haptics
