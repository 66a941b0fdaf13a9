#include "pipeline/layers/layer_fit.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>

namespace sparsha::pipeline {
namespace {

constexpr double kReach = 2.5;  // scales; as the whole windows'
// Widths of the three fits' Gaussians where half of the window is missing, in scales; the cubics come to them from 1 in
// even steps, so that a fit next to a whole window is that window's.
constexpr double kQuadraticWidth = 1.5, kCubicWidth = 1.2, kNarrowWidth = 0.6;
constexpr std::size_t kWidths = 16;
constexpr int kFewest = 6;
constexpr double kMostGain = 40.0;
// Squared difference of the two fits, in what noise gives it on the average, from which on the cubic counts.
constexpr double kClearly = 8.0, kClearlyNarrow = 14.0;
constexpr double kDegenerate = 1e-9;  // of a pivot, relative to its diagonal

/// Powers of x and y of the basis: 1, x, y, x^2, xy, y^2, x^3, x^2 y, x y^2, y^3; a quadratic has the first six.
constexpr std::array<std::array<int, 2>, 10> kTerms{
    {{0, 0}, {1, 0}, {0, 1}, {2, 0}, {1, 1}, {0, 2}, {3, 0}, {2, 1}, {1, 2}, {0, 3}}};

template <std::size_t Powers>
using Moments = std::array<std::array<double, Powers>, Powers>;

/// Weighted least squares by Cholesky factors of the normal equations.
template <std::size_t Terms, std::size_t Powers>
class Solver {
 public:
  using Vector = std::array<double, Terms>;

  explicit Solver(const Moments<Powers>& moments) {
    for (std::size_t a = 0; a < Terms; ++a)
      for (std::size_t b = 0; b <= a; ++b) factor_[a][b] = entry(moments, a, b);
    for (std::size_t a = 0; a < Terms; ++a) {
      const double diagonal = factor_[a][a];
      for (std::size_t b = 0; b <= a; ++b) {
        double sum = factor_[a][b];
        for (std::size_t k = 0; k < b; ++k) sum -= factor_[a][k] * factor_[b][k];
        if (a == b) {
          if (!(sum > kDegenerate * diagonal)) return;
          factor_[a][a] = std::sqrt(sum);
        } else {
          factor_[a][b] = sum / factor_[b][b];
        }
      }
    }
    solvable_ = true;
  }
  [[nodiscard]] bool solvable() const { return solvable_; }

  /// Solutions for a right side and for the units of h_xx, h_xy and h_yy, which are solved side by side.
  [[nodiscard]] std::array<Vector, 4> solve(const Vector& right) const {
    std::array<std::array<double, 4>, Terms> x{};
    for (std::size_t a = 0; a < Terms; ++a) x[a][0] = right[a];
    for (std::size_t unit = 1; unit < 4; ++unit) x[unit + 2][unit] = 1;
    for (std::size_t a = 0; a < Terms; ++a) {
      for (std::size_t k = 0; k < a; ++k) subtract(factor_[a][k], x[k], x[a]);
      for (double& value : x[a]) value /= factor_[a][a];
    }
    for (std::size_t a = Terms; a-- > 0;) {
      for (std::size_t k = a + 1; k < Terms; ++k) subtract(factor_[k][a], x[k], x[a]);
      for (double& value : x[a]) value /= factor_[a][a];
    }
    std::array<Vector, 4> solutions;
    for (std::size_t a = 0; a < Terms; ++a)
      for (std::size_t side = 0; side < 4; ++side) solutions[side][a] = x[a][side];
    return solutions;
  }
  /// M b, M the matrix of `moments`.
  static Vector product(const Moments<Powers>& moments, const Vector& b) {
    Vector rows{};  // column by column: the sums of all rows grow side by side
    for (std::size_t n = 0; n < Terms; ++n)
      for (std::size_t k = 0; k < Terms; ++k) rows[k] += entry(moments, k, n) * b[n];
    return rows;
  }
  static double entry(const Moments<Powers>& moments, std::size_t a, std::size_t b) {
    return moments[static_cast<std::size_t>(kTerms[a][1] + kTerms[b][1])]
                  [static_cast<std::size_t>(kTerms[a][0] + kTerms[b][0])];
  }

 private:
  static void subtract(double factor, const std::array<double, 4>& from, std::array<double, 4>& x) {
    for (std::size_t side = 0; side < 4; ++side) x[side] -= factor * from[side];
  }

  std::array<Vector, Terms> factor_{};
  bool solvable_ = false;
};

/// Calls body(first, end) for every run of set bits.
template <typename Body>
void for_runs(std::uint64_t bits, const Body& body) {
  while (bits != 0) {
    const int first = std::countr_zero(bits), end = first + std::countr_one(bits >> first);
    body(static_cast<std::size_t>(first), static_cast<std::size_t>(end));
    bits = end == 64 ? 0 : bits & (~std::uint64_t{0} << end);
  }
}

double blend(double share, double a, double b) { return b + share * (a - b); }

}  // namespace

OwnLayerFit::Weights::Weights(double scale, int stride, int most_radius, double width)
    : radius(std::clamp(static_cast<int>(std::lround(kReach * width * scale / stride)), 1, most_radius)) {
  for (int k = 0; k <= 2 * most_radius; ++k) {
    const auto n = static_cast<std::size_t>(k);
    const double u = (k - most_radius) * stride / scale;
    place[n] = u;
    weight[n] = std::abs(k - most_radius) <= radius ? std::exp(-0.5 * u * u / (width * width)) : 0.0;
    before[n + 1] = before[n];
    double power = 1;
    for (std::size_t p = 0; p < kPowers; ++p, power *= u) {
      before[n + 1][p] += weight[n] * power;
      before[n + 1][kPowers + p] += weight[n] * weight[n] * power;
      if (p < data[n].size()) data[n][p] = weight[n] * power;
    }
  }
}

OwnLayerFit::OwnLayerFit(double scale, const NoiseGain& whole) : scale_(scale), whole_(whole) {
  const double reach = kQuadraticWidth * kReach * scale;
  stride_ = std::max(1, static_cast<int>(std::ceil(reach / LayerWindow::kMostRadius)));
  radius_ = std::clamp(static_cast<int>(std::lround(reach / stride_)), 2, LayerWindow::kMostRadius);
  quadratic_ = std::make_shared<const Weights>(scale, stride_, radius_, kQuadraticWidth);
  const auto widths = [&](double last) {
    std::vector<Weights> weights;
    for (std::size_t k = 0; k <= kWidths; ++k)
      weights.emplace_back(scale, stride_, radius_, 1 + (last - 1) * static_cast<double>(k) / kWidths);
    return std::make_shared<const std::vector<Weights>>(std::move(weights));
  };
  cubic_ = widths(kCubicWidth);
  narrow_cubic_ = widths(kNarrowWidth);
}

/// How much of a whole window is missing, from 0 to kWidths for a half and more.
std::size_t OwnLayerFit::missing_share(const Weights& weights) const {
  double present = 0, all = 0;
  for (int dy = -weights.radius; dy <= weights.radius; ++dy) {
    const double weight = weights.weight[static_cast<std::size_t>(dy + radius_)];
    all += weight * weights.before[static_cast<std::size_t>(2 * radius_ + 1)][0];
    for_runs(window_.row(dy), [&](std::size_t first, std::size_t end) {
      present += weight * (weights.before[end][0] - weights.before[first][0]);
    });
  }
  return static_cast<std::size_t>(std::lround(kWidths * std::clamp(2 * (1 - present / all), 0.0, 1.0)));
}

template <std::size_t Terms>
std::optional<OwnLayerFit::Fitted> OwnLayerFit::fit_terms(const Weights& weights, const TextureView& texture, int i,
                                                          int j) const {
  constexpr std::size_t kDegree = Terms == 10 ? 3 : 2, kMoments = 2 * kDegree + 1;
  Moments<kMoments> moments{}, noise{};
  Moments<kDegree + 1> data{};
  double squares = 0;
  const auto step = static_cast<std::size_t>(stride_);
  const double own =
      static_cast<double>(texture.at(static_cast<std::size_t>(j) * texture.row_nodes + static_cast<std::size_t>(i)));
  for (int dy = -weights.radius; dy <= weights.radius; ++dy) {
    std::array<double, 2 * kPowers> sums{};
    std::array<double, 4> row_data{};
    double row_squares = 0;
    // Of column 0, which may lie before the lattice.
    const std::size_t row = static_cast<std::size_t>(j + dy * stride_) * texture.row_nodes +
                            static_cast<std::size_t>(i) - static_cast<std::size_t>(radius_) * step;
    const auto low = static_cast<std::size_t>(radius_ - weights.radius);
    const auto high = static_cast<std::size_t>(radius_ + weights.radius + 1);
    for_runs(window_.row(dy), [&](std::size_t first, std::size_t end) {
      first = std::max(first, low);
      end = std::min(end, high);
      if (first >= end) return;
      for (std::size_t p = 0; p < kMoments; ++p) {
        sums[p] += weights.before[end][p] - weights.before[first][p];
        sums[kPowers + p] += weights.before[end][kPowers + p] - weights.before[first][kPowers + p];
      }
      for (std::size_t k = first; k < end; ++k) {
        const double h = static_cast<double>(texture.at(row + k * step)) - own;
        for (std::size_t p = 0; p <= kDegree; ++p) row_data[p] += h * weights.data[k][p];
        row_squares += h * h * weights.data[k][0];
      }
    });
    const auto n = static_cast<std::size_t>(dy + radius_);
    double factor = weights.weight[n], square = factor * factor;
    squares += factor * row_squares;
    for (std::size_t q = 0; q < kMoments; ++q) {
      for (std::size_t p = 0; p + q < kMoments; ++p) {
        moments[q][p] += factor * sums[p];
        noise[q][p] += square * sums[kPowers + p];
      }
      for (std::size_t p = 0; p + q <= kDegree; ++p) data[q][p] += factor * row_data[p];
      factor *= weights.place[n];
      square *= weights.place[n];
    }
  }

  using Solver = Solver<Terms, kMoments>;
  const Solver solver(moments);
  if (!solver.solvable()) return std::nullopt;
  typename Solver::Vector right{};
  for (std::size_t a = 0; a < Terms; ++a)
    right[a] = data[static_cast<std::size_t>(kTerms[a][1])][static_cast<std::size_t>(kTerms[a][0])];
  const auto [c, xx, xy, yy] = solver.solve(right);
  const double unit_2 = scale_ * scale_, unit_4 = unit_2 * unit_2;

  Fitted fitted;
  std::copy_n(c.begin(), fitted.quadratic.size(), fitted.quadratic.begin());
  fitted.derivatives = {c[1] / scale_, c[2] / scale_, 2 * c[3] / unit_2, c[4] / unit_2, 2 * c[5] / unit_2};
  const auto dot = [](const auto& a, const auto& b) { return std::inner_product(a.begin(), a.end(), b.begin(), 0.0); };
  const typename Solver::Vector noise_yy = Solver::product(noise, yy);
  fitted.gain = {4 * dot(xx, Solver::product(noise, xx)) / unit_4, 4 * dot(yy, noise_yy) / unit_4,
                 dot(xy, Solver::product(noise, xy)) / unit_4, 4 * dot(xx, noise_yy) / unit_4};
  const double left = squares - dot(c, right);
  const double nodes = moments[0][0] * moments[0][0] / noise[0][0];
  if (nodes <= Terms + 1) return Terms == 6 ? std::optional(fitted) : std::nullopt;
  fitted.misfit_2 = std::max(0.0, left / moments[0][0]) * nodes / (nodes - Terms);
  return fitted;
}

std::optional<OwnLayerFit::Fitted> OwnLayerFit::fit_quadratic(const TextureView& texture, const SurfaceLinks& links,
                                                              int i, int j) {
  window_.find(links, i, j, radius_);
  if (window_.count() < kFewest) return std::nullopt;
  std::optional<Fitted> fitted = fit_terms<6>(*quadratic_, texture, i, j);
  if (fitted && !(fitted->gain.rms() <= kMostGain * kMostGain * whole_.rms())) fitted.reset();
  return fitted;
}

std::optional<Quadratic> OwnLayerFit::quadratic(const TextureView& texture, const SurfaceLinks& links, int i, int j) {
  const std::optional<Fitted> fitted = fit_quadratic(texture, links, i, j);
  return fitted ? std::optional(fitted->quadratic) : std::nullopt;
}

bool OwnLayerFit::fit(const TextureView& texture, const SurfaceLinks& links, int i, int j, double noise,
                      Derivatives& result, NoiseGain& gain) {
  const std::optional<Fitted> quadratic = fit_quadratic(texture, links, i, j);
  if (!quadratic) return false;
  result = quadratic->derivatives;
  gain = quadratic->gain;
  const std::size_t missing = missing_share(cubic_->front());
  for (const bool narrow : {false, true}) {
    const std::vector<Weights>& cubics = narrow ? *narrow_cubic_ : *cubic_;
    const std::optional<Fitted> cubic = fit_terms<10>(cubics[missing], texture, i, j);
    if (!cubic) break;
    const Derivatives& d = cubic->derivatives;
    const double xx = d.h_xx - result.h_xx, xy = d.h_xy - result.h_xy, yy = d.h_yy - result.h_yy;
    const double difference = (xx * xx + yy * yy) / 2 + xy * xy;
    const double expected =
        std::max(noise * noise, 0.05 * cubic->misfit_2) * std::max(0.0, cubic->gain.rms() - whole_.rms());
    const double share =
        expected > 0 ? std::max(0.0, 1 - (narrow ? kClearlyNarrow : kClearly) * expected / difference) : 1.0;
    if (!(share > 0)) break;
    result = {blend(share, d.h_x, result.h_x), blend(share, d.h_y, result.h_y), blend(share, d.h_xx, result.h_xx),
              blend(share, d.h_xy, result.h_xy), blend(share, d.h_yy, result.h_yy)};
    // What the earlier fit has of noise is in the cubic, too.
    const double square = share * share;
    gain = {blend(square, cubic->gain.bend_x, gain.bend_x), blend(square, cubic->gain.bend_y, gain.bend_y),
            blend(square, cubic->gain.twist, gain.twist), blend(square, cubic->gain.covariance, gain.covariance)};
  }
  return true;
}

}  // namespace sparsha::pipeline
