#include "pipeline/layers/layer_fit.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>

#include "pipeline/layers/ridge.h"

namespace sparsha::pipeline {
namespace {

constexpr double kReach = 2.5;  // scales; as the whole windows'
constexpr double kQuadraticWidth = 1.5;
// Of the quartics' Gaussians, in scales, and where they end, in widths. Wider than 2 a quartic no longer follows tori
// and waves of 14 scales; narrower it carries more noise than a whole window wherever it follows anything.
constexpr double kWideWidth = 2.0, kNarrowWidth = 1.2, kQuarticReach = 2.0;
// What the wide quartic leaves, in squares of the noise, from which on and up to which the narrow one comes in: the
// mean square of the 100 to 200 nodes of a half window varies by 0.1 to 0.15 (one sigma).
constexpr double kNoMoreThanNoise = 1.3, kMoreThanNoise = 2.0;
// Share of a whole window that is missing where the quartic has fully taken over from the whole window's own fit.
constexpr double kTakenOver = 0.25;
constexpr int kFewest = 6;
constexpr double kMostGain = 40.0;

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

Derivatives blend(double share, const Derivatives& a, const Derivatives& b) {
  return {blend(share, a.h_x, b.h_x), blend(share, a.h_y, b.h_y), blend(share, a.h_xx, b.h_xx),
          blend(share, a.h_xy, b.h_xy), blend(share, a.h_yy, b.h_yy)};
}
/// Both fits see the same noise: no less than what is between theirs.
NoiseGain blend(double share, const NoiseGain& a, const NoiseGain& b) {
  return {blend(share, a.bend_x, b.bend_x), blend(share, a.bend_y, b.bend_y), blend(share, a.twist, b.twist),
          blend(share, a.covariance, b.covariance)};
}

}  // namespace

OwnLayerFit::Weights::Weights(double scale, int stride, int most_radius, double width, double reach)
    : radius(std::clamp(static_cast<int>(std::lround(reach * width * scale / stride)), 1, most_radius)) {
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

/// Weighted sums over the nodes of a layer, by powers of y and of x.
template <std::size_t Degree>
struct OwnLayerFit::Sums {
  ridge::Moments<2 * Degree + 1> moments{}, noise{};  ///< of weights, of squared weights
  ridge::Moments<Degree + 1> data{};                  ///< of weights times the texture above the node's own
  double squares = 0;                                 ///< of weights times its squares
  [[nodiscard]] double nodes() const { return moments[0][0] * moments[0][0] / noise[0][0]; }
};

OwnLayerFit::OwnLayerFit(double scale, double spacing_m, const NoiseGain& whole)
    : scale_(scale), spacing_m_(spacing_m), whole_(whole) {
  const double reach = std::max(kQuadraticWidth * kReach, kWideWidth * kQuarticReach) * scale;
  stride_ = std::max(1, static_cast<int>(std::ceil(reach / LayerWindow::kMostRadius)));
  radius_ = std::clamp(static_cast<int>(std::lround(reach / stride_)), 2, LayerWindow::kMostRadius);
  const auto weights = [&](double width, double end) {
    return std::make_shared<const Weights>(scale, stride_, radius_, width, end);
  };
  quadratic_ = weights(kQuadraticWidth, kReach);
  as_whole_ = weights(1, kReach);
  wide_ = weights(kWideWidth, kQuarticReach);
  narrow_ = weights(kNarrowWidth, kQuarticReach);
}

/// How much of a whole window is missing, by its weights.
double OwnLayerFit::missing_share() const {
  const Weights& weights = *as_whole_;
  double present = 0, all = 0;
  for (int dy = -weights.radius; dy <= weights.radius; ++dy) {
    const double weight = weights.weight[static_cast<std::size_t>(dy + radius_)];
    all += weight * weights.before[static_cast<std::size_t>(2 * radius_ + 1)][0];
    for_runs(window_.row(dy), [&](std::size_t first, std::size_t end) {
      present += weight * (weights.before[end][0] - weights.before[first][0]);
    });
  }
  return 1 - present / all;
}

template <std::size_t Degree>
OwnLayerFit::Sums<Degree> OwnLayerFit::sums(const Weights& weights, const TextureView& texture, int i, int j) const {
  constexpr std::size_t kMoments = 2 * Degree + 1;
  Sums<Degree> result;
  const auto step = static_cast<std::size_t>(stride_);
  const double own =
      static_cast<double>(texture.at(static_cast<std::size_t>(j) * texture.row_nodes + static_cast<std::size_t>(i)));
  for (int dy = -weights.radius; dy <= weights.radius; ++dy) {
    std::array<double, 2 * kPowers> row_sums{};
    std::array<double, Degree + 1> row_data{};
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
        row_sums[p] += weights.before[end][p] - weights.before[first][p];
        row_sums[kPowers + p] += weights.before[end][kPowers + p] - weights.before[first][kPowers + p];
      }
      for (std::size_t k = first; k < end; ++k) {
        const double h = static_cast<double>(texture.at(row + k * step)) - own;
        for (std::size_t p = 0; p <= Degree; ++p) row_data[p] += h * weights.data[k][p];
        row_squares += h * h * weights.data[k][0];
      }
    });
    const auto n = static_cast<std::size_t>(dy + radius_);
    double factor = weights.weight[n], square = factor * factor;
    result.squares += factor * row_squares;
    for (std::size_t q = 0; q < kMoments; ++q) {
      for (std::size_t p = 0; p + q < kMoments; ++p) {
        result.moments[q][p] += factor * row_sums[p];
        result.noise[q][p] += square * row_sums[kPowers + p];
      }
      for (std::size_t p = 0; p + q <= Degree; ++p) result.data[q][p] += factor * row_data[p];
      factor *= weights.place[n];
      square *= weights.place[n];
    }
  }
  return result;
}

namespace {

using ridge::Cholesky;
using ridge::dot;
using ridge::entry;
using ridge::kHigher;
using ridge::kQuadratic;
using ridge::kQuartic;
using ridge::kTerms;
using ridge::Matrix;
using ridge::Moments;
using ridge::Vector;

constexpr std::array<double, 3> kBends{2, 1, 2};  // h_xx, h_xy, h_yy over the coefficients of x^2, xy, y^2

/// Weights of the data's moments in the three second derivatives, before kBends.
template <std::size_t Terms>
using Response = std::array<Vector<Terms>, 3>;

template <std::size_t Terms, std::size_t Powers>
NoiseGain noise_gain(const Moments<Powers>& noise, const Response<Terms>& response, double unit_4) {
  std::array<Vector<Terms>, 3> product{};
  for (std::size_t a = 0; a < Terms; ++a)
    for (std::size_t b = 0; b < Terms; ++b) {
      const double square = entry(noise, a, b);
      for (std::size_t k = 0; k < 3; ++k) product[k][a] += square * response[k][b];
    }
  const auto covariance = [&](std::size_t a, std::size_t b) {
    return kBends[a] * kBends[b] * dot(response[a], product[b]) / unit_4;
  };
  return {covariance(0, 0), covariance(2, 2), covariance(1, 1), covariance(0, 2)};
}

template <std::size_t Terms, std::size_t Powers>
Vector<Terms> right_side(const Moments<Powers>& data, std::size_t first) {
  Vector<Terms> right;
  for (std::size_t a = 0; a < Terms; ++a) right[a] = data[kTerms[first + a][1]][kTerms[first + a][0]];
  return right;
}

template <std::size_t Powers>
Matrix<kQuadratic> quadratic_matrix(const Moments<Powers>& moments) {
  Matrix<kQuadratic> matrix{};
  for (std::size_t a = 0; a < kQuadratic; ++a)
    for (std::size_t b = 0; b <= a; ++b) matrix[a][b] = entry(moments, a, b);
  return matrix;
}

/// Of the quadratic terms of a fit in scales.
Derivatives derivatives_of(const Vector<kQuadratic>& c, double scale) {
  const double unit_2 = scale * scale;
  return {c[1] / scale, c[2] / scale, 2 * c[3] / unit_2, c[4] / unit_2, 2 * c[5] / unit_2};
}

/// A priori the higher terms are those of a smooth random surface: variances as if derivatives were those of a Gaussian
/// process some three scales long, that of x^3 being 1. The strengths are standard deviations of x^3 in noises, from
/// one that leaves a quadratic to one that leaves the terms free.
constexpr Vector<kHigher> kPrior{1, 1.8, 1.8, 1, 0.04 * 0.4375, 0.04, 0.04 * 1.35, 0.04, 0.04 * 0.4375};
constexpr std::array<double, 6> kStrengths{0.02, 0.06, 0.2, 0.6, 2, 10};

/// The ridge regressions of all strengths for the higher terms, from what the quadratic ones leave of the system. They
/// are solved side by side.
class Regressions {
 public:
  /// One number for each strength.
  using Lanes = std::array<double, kStrengths.size()>;

  explicit Regressions(const Matrix<kHigher>& system) {
    Lanes determinant;
    determinant.fill(1);
    for (std::size_t a = 0; a < kHigher; ++a) {
      for (std::size_t b = 0; b <= a; ++b) {
        Lanes sum;
        for (std::size_t n = 0; n < sum.size(); ++n) sum[n] = system[a][b] + (a == b ? precision(n, a) : 0.0);
        for (std::size_t k = 0; k < b; ++k) subtract(factor_[a][k], factor_[b][k], sum);
        if (a != b) {
          for (std::size_t n = 0; n < sum.size(); ++n) factor_[a][b][n] = sum[n] * inverse_[b][n];
          continue;
        }
        for (std::size_t n = 0; n < sum.size(); ++n) {
          solvable_ = solvable_ && sum[n] > 0;
          determinant[n] *= sum[n] / precision(n, a);
          inverse_[a][n] = 1 / std::sqrt(sum[n]);
        }
      }
    }
    for (std::size_t n = 0; n < determinant.size(); ++n) half_log_[n] = 0.5 * std::log(determinant[n]);
  }
  [[nodiscard]] bool solvable() const { return solvable_; }

  /// The mean of the solutions for `right` by their marginal likelihoods, which are kept for mean(). `explained`
  /// becomes by how much the freest solution lowers the sum of squares.
  Vector<kHigher> average(const Vector<kHigher>& right, double variance, double& explained) {
    Lanes evidence{};
    const std::array<Lanes, kHigher> solutions = solve(right, evidence);
    for (std::size_t n = 0; n < evidence.size(); ++n) evidence[n] = 0.5 * evidence[n] / variance - half_log_[n];
    const double most = *std::max_element(evidence.begin(), evidence.end());
    double total = 0;
    for (std::size_t n = 0; n < evidence.size(); ++n) total += shares_[n] = std::exp(evidence[n] - most);
    for (double& share : shares_) share /= total;
    explained = 0;
    for (std::size_t a = 0; a < kHigher; ++a) {
      const double c = solutions[a].back();
      explained += c * (right[a] + precision(kStrengths.size() - 1, a) * c);
    }
    return mean(solutions);
  }
  /// The same mean for another right side.
  [[nodiscard]] Vector<kHigher> mean(const Vector<kHigher>& right) const {
    Lanes squares{};
    return mean(solve(right, squares));
  }

 private:
  static constexpr double precision(std::size_t strength, std::size_t term) {
    return 1 / (kStrengths[strength] * kStrengths[strength] * kPrior[term]);
  }
  static void subtract(const Lanes& factor, const Lanes& from, Lanes& sum) {
    for (std::size_t n = 0; n < sum.size(); ++n) sum[n] -= factor[n] * from[n];
  }
  /// `squares` becomes what each solution times the right side is.
  [[nodiscard]] std::array<Lanes, kHigher> solve(const Vector<kHigher>& right, Lanes& squares) const {
    std::array<Lanes, kHigher> x;
    for (std::size_t a = 0; a < kHigher; ++a) {
      x[a].fill(right[a]);
      for (std::size_t k = 0; k < a; ++k) subtract(factor_[a][k], x[k], x[a]);
      for (std::size_t n = 0; n < squares.size(); ++n) {
        x[a][n] *= inverse_[a][n];
        squares[n] += x[a][n] * x[a][n];
      }
    }
    for (std::size_t a = kHigher; a-- > 0;) {
      for (std::size_t k = a + 1; k < kHigher; ++k) subtract(factor_[k][a], x[k], x[a]);
      for (std::size_t n = 0; n < squares.size(); ++n) x[a][n] *= inverse_[a][n];
    }
    return x;
  }
  [[nodiscard]] Vector<kHigher> mean(const std::array<Lanes, kHigher>& solutions) const {
    Vector<kHigher> result;
    for (std::size_t a = 0; a < kHigher; ++a)
      result[a] = std::inner_product(shares_.begin(), shares_.end(), solutions[a].begin(), 0.0);
    return result;
  }

  std::array<std::array<Lanes, kHigher>, kHigher> factor_;  // the lower half, but for the diagonal
  std::array<Lanes, kHigher> inverse_;                      // of the diagonal
  Lanes half_log_{}, shares_{};
  bool solvable_ = true;
};

/// Cubic and quartic terms of the surface that is a quadric over its tangent plane and has the quadratic terms `c`
/// above the picture's plane: with z2 = c3 x^2 + c4 xy + c5 y^2, p its slope, H its Hessian, g = 1 + p^2 and l = p'Hx /
/// g they are z2 l and z2 l^2 + z2^2 p'Hp / (2 g^2). All in one unit of length, in which the window reaches `reach`.
Vector<kHigher> tilted_quadric(const Vector<kQuadratic>& c, double reach) {
  const double px = c[1], py = c[2], g = 1 + px * px + py * py;
  const double slope_bend = 2 * px * px * c[3] + 2 * px * py * c[4] + 2 * py * py * c[5];
  double lx = (2 * px * c[3] + py * c[4]) / g, ly = (px * c[4] + 2 * py * c[5]) / g;
  // Where the series would not converge in the window, less of it.
  const double less = 1 / std::max(1.0, 2 * reach * std::hypot(lx, ly));
  lx *= less;
  ly *= less;
  const double quartic = less * less * slope_bend / (2 * g * g);
  const std::array<double, 3> z2{c[3], c[4], c[5]}, l2{lx * lx, 2 * lx * ly, ly * ly};
  Vector<kHigher> terms{};
  for (std::size_t k = 0; k < 3; ++k) {
    terms[k] += z2[k] * lx;
    terms[k + 1] += z2[k] * ly;
    for (std::size_t m = 0; m < 3; ++m) terms[4 + k + m] += z2[k] * l2[m] + quartic * z2[k] * z2[m];
  }
  return terms;
}

}  // namespace

std::optional<OwnLayerFit::Fitted> OwnLayerFit::fit_quadratic(const Weights& weights, const TextureView& texture, int i,
                                                              int j, Quadratic& quadratic) const {
  const Sums<2> sum = sums<2>(weights, texture, i, j);
  const Cholesky<kQuadratic> factor(quadratic_matrix(sum.moments));
  if (!factor.solvable()) return std::nullopt;
  const double unit_4 = scale_ * scale_ * scale_ * scale_;
  Response<kQuadratic> response{};
  for (std::size_t k = 0; k < 3; ++k) {
    response[k][3 + k] = 1;
    response[k] = factor.solve(response[k]);
  }
  quadratic = factor.solve(right_side<kQuadratic>(sum.data, 0));
  return Fitted{derivatives_of(quadratic, scale_), noise_gain(sum.noise, response, unit_4)};
}

// With the factor L of the quadratic block, B = L^-1 M01 and y = L^-1 b0, the higher terms c solve
// (M11 - B'B + precision) c = b1 - B'y, and the quadratic ones are L^-T (y - B c).
std::optional<OwnLayerFit::Quartic> OwnLayerFit::fit_quartic(const Weights& weights, const TextureView& texture, int i,
                                                             int j, double noise_m) const {
  const Sums<4> sum = sums<4>(weights, texture, i, j);
  const Cholesky<kQuadratic> factor(quadratic_matrix(sum.moments));
  if (!factor.solvable()) return std::nullopt;
  std::array<Vector<kQuadratic>, kHigher> mixed{};  // columns of B
  Matrix<kHigher> system{};
  const Vector<kQuadratic> y = factor.forward(right_side<kQuadratic>(sum.data, 0));
  Vector<kHigher> right = right_side<kHigher>(sum.data, kQuadratic);
  for (std::size_t a = 0; a < kHigher; ++a) {
    for (std::size_t b = 0; b < kQuadratic; ++b) mixed[a][b] = entry(sum.moments, kQuadratic + a, b);
    mixed[a] = factor.forward(mixed[a]);
    right[a] -= dot(mixed[a], y);
    for (std::size_t b = 0; b <= a; ++b)
      system[a][b] = entry(sum.moments, kQuadratic + a, kQuadratic + b) - dot(mixed[a], mixed[b]);
  }
  Regressions regressions(system);
  if (!regressions.solvable()) return std::nullopt;
  const auto quadratic = [&](const Vector<kHigher>& higher) {
    Vector<kQuadratic> left = y;
    for (std::size_t a = 0; a < kHigher; ++a)
      for (std::size_t b = 0; b < kQuadratic; ++b) left[b] -= mixed[a][b] * higher[a];
    return factor.backward(left);
  };

  const double variance = noise_m * noise_m, length_m = scale_ * spacing_m_;
  const double unit_4 = scale_ * scale_ * scale_ * scale_;
  double explained = 0, without = 0;
  Vector<kQuadratic> c = quadratic(regressions.average(right, variance, explained));
  for (double& term : c) term /= length_m;
  Vector<kHigher> expected = tilted_quadric(c, kQuarticReach * kWideWidth), beyond = right;
  for (double& term : expected) term *= length_m;
  for (std::size_t a = 0; a < kHigher; ++a)
    for (std::size_t b = 0; b < kHigher; ++b) beyond[a] -= (a >= b ? system[a][b] : system[b][a]) * expected[b];
  Vector<kHigher> higher = regressions.average(beyond, variance, without);
  for (std::size_t a = 0; a < kHigher; ++a) higher[a] += expected[a];

  Response<kQuartic> response{};
  Response<kQuadratic> alone{};
  for (std::size_t k = 0; k < 3; ++k) {
    Vector<kQuadratic> unit{};
    unit[3 + k] = 1;
    unit = factor.forward(unit);
    alone[k] = factor.backward(unit);
    Vector<kHigher> through;
    for (std::size_t a = 0; a < kHigher; ++a) through[a] = dot(mixed[a], unit);
    through = regressions.mean(through);
    for (std::size_t a = 0; a < kHigher; ++a) {
      for (std::size_t b = 0; b < kQuadratic; ++b) unit[b] += mixed[a][b] * through[a];
      response[k][kQuadratic + a] = -through[a];
    }
    unit = factor.backward(unit);
    std::copy(unit.begin(), unit.end(), response[k].begin());
  }
  Quartic result;
  result.fitted = {derivatives_of(quadratic(higher), scale_), noise_gain(sum.noise, response, unit_4)};
  result.least_gain = noise_gain(sum.noise, alone, unit_4).rms();
  const double nodes = sum.nodes();
  if (nodes > kQuartic + 1) {
    const double left = sum.squares - dot(y, y) - explained;
    result.misfit_2 = std::max(0.0, left / sum.moments[0][0]) * nodes / (nodes - kQuartic);
  }
  return result;
}

std::optional<Quadratic> OwnLayerFit::quadratic(const TextureView& texture, const SurfaceLinks& links, int i, int j) {
  window_.find(links, i, j, radius_);
  if (window_.count() < kFewest) return std::nullopt;
  Quadratic quadratic{};
  const std::optional<Fitted> fitted = fit_quadratic(*quadratic_, texture, i, j, quadratic);
  if (!fitted || !(fitted->gain.rms() <= kMostGain * kMostGain * whole_.rms())) return std::nullopt;
  return quadratic;
}

bool OwnLayerFit::fit(const TextureView& texture, const SurfaceLinks& links, int i, int j, const TextureNoise& noise,
                      Derivatives& result, NoiseGain& gain) {
  window_.find(links, i, j, radius_);
  if (window_.count() < kFewest) return false;
  const std::optional<Quartic> wide = fit_quartic(*wide_, texture, i, j, noise.bend_m);
  if (!wide || !(wide->least_gain <= kMostGain * kMostGain * whole_.rms())) return false;
  result = wide->fitted.derivatives;
  gain = wide->fitted.gain;
  const double misfit_2 = wide->misfit_2 / (noise.node_m * noise.node_m);
  const auto take = [&](double share, const Fitted& other) {
    result = blend(share, other.derivatives, result);
    gain = blend(share, other.gain, gain);
  };
  if (misfit_2 > kNoMoreThanNoise) {
    const std::optional<Quartic> narrow = fit_quartic(*narrow_, texture, i, j, noise.bend_m);
    if (narrow)
      take(std::min(1.0, (misfit_2 - kNoMoreThanNoise) / (kMoreThanNoise - kNoMoreThanNoise)), narrow->fitted);
  }
  const double whole = 1 - missing_share() / kTakenOver;
  if (whole > 0) {
    Quadratic quadratic{};
    const std::optional<Fitted> as_whole = fit_quadratic(*as_whole_, texture, i, j, quadratic);
    if (as_whole) take(std::min(1.0, whole), *as_whole);
  }
  return true;
}

}  // namespace sparsha::pipeline
