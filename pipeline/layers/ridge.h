// Small symmetric systems of fits by polynomials of two variables.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>

namespace sparsha::pipeline::ridge {

template <std::size_t Powers>
using Moments = std::array<std::array<double, Powers>, Powers>;  ///< [power of y][power of x]
template <std::size_t Terms>
using Vector = std::array<double, Terms>;
template <std::size_t Terms>
using Matrix = std::array<Vector<Terms>, Terms>;

/// Powers of x and y of the basis: 1, x, y, x^2, xy, y^2, then the cubic and the quartic terms.
inline constexpr std::array<std::array<std::size_t, 2>, 15> kTerms{{{0, 0},
                                                                    {1, 0},
                                                                    {0, 1},
                                                                    {2, 0},
                                                                    {1, 1},
                                                                    {0, 2},
                                                                    {3, 0},
                                                                    {2, 1},
                                                                    {1, 2},
                                                                    {0, 3},
                                                                    {4, 0},
                                                                    {3, 1},
                                                                    {2, 2},
                                                                    {1, 3},
                                                                    {0, 4}}};
inline constexpr std::size_t kQuadratic = 6, kHigher = 9, kQuartic = kQuadratic + kHigher;

/// Of the normal equations of terms a and b.
template <std::size_t Powers>
double entry(const Moments<Powers>& moments, std::size_t a, std::size_t b) {
  return moments[kTerms[a][1] + kTerms[b][1]][kTerms[a][0] + kTerms[b][0]];
}

template <std::size_t Terms>
double dot(const Vector<Terms>& a, const Vector<Terms>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

/// Lower factor of a symmetric matrix, of which the lower half is read.
template <std::size_t Terms>
class Cholesky {
 public:
  Cholesky() = default;
  explicit Cholesky(const Matrix<Terms>& matrix) : factor_(matrix) {
    for (std::size_t a = 0; a < Terms; ++a)
      for (std::size_t b = 0; b <= a; ++b) {
        double sum = factor_[a][b];
        for (std::size_t k = 0; k < b; ++k) sum -= factor_[a][k] * factor_[b][k];
        if (a == b) {
          if (!(sum > kDegenerate * matrix[a][a])) return;
          factor_[a][a] = std::sqrt(sum);
          inverse_[a] = 1 / factor_[a][a];
        } else {
          factor_[a][b] = sum * inverse_[b];
        }
      }
    solvable_ = true;
  }
  [[nodiscard]] bool solvable() const { return solvable_; }
  [[nodiscard]] double diagonal(std::size_t a) const { return factor_[a][a]; }

  /// L^-1 v.
  [[nodiscard]] Vector<Terms> forward(Vector<Terms> v) const {
    for (std::size_t a = 0; a < Terms; ++a) {
      for (std::size_t k = 0; k < a; ++k) v[a] -= factor_[a][k] * v[k];
      v[a] *= inverse_[a];
    }
    return v;
  }
  /// L^-T v.
  [[nodiscard]] Vector<Terms> backward(Vector<Terms> v) const {
    for (std::size_t a = Terms; a-- > 0;) {
      v[a] *= inverse_[a];
      for (std::size_t k = 0; k < a; ++k) v[k] -= factor_[a][k] * v[a];
    }
    return v;
  }
  [[nodiscard]] Vector<Terms> solve(const Vector<Terms>& v) const { return backward(forward(v)); }

 private:
  static constexpr double kDegenerate = 1e-9;  // of a pivot, relative to its diagonal

  Matrix<Terms> factor_{};
  Vector<Terms> inverse_{};
  bool solvable_ = false;
};

}  // namespace sparsha::pipeline::ridge
