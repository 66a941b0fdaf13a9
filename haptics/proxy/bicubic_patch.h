// Surfaces without creases: bicubic patches over the same nodes. Slopes are continuous across cells, so that the force
// has no creases to jump at. Lengths in cells.
// `haptics.surface: c1` passes through the nodes, with Catmull-Rom slopes (Catmull & Rom 1974) in both directions; at
// steps it overshoots by up to 7 %. `haptics.creases: rounded` is the uniform cubic B-spline (de Boor 1978): it never
// leaves the range of the nodes around it, and a groove oblique to the grid has no steps from node to node.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "haptics/proxy/bilinear_patch.h"
#include "haptics/proxy/hot.h"
#include "haptics/proxy/pair.h"

namespace sparsha::haptics {

/// f(s, t) = sum over k, l of c[k][l] s^k t^l.
struct BicubicPatch {
  double c[4][4] = {};

  [[nodiscard]] double height(double s, double t) const noexcept {
    return cubic(row(0, t), row(1, t), row(2, t), row(3, t), s);
  }
  [[nodiscard]] double slope_s(double s, double t) const noexcept {
    return row(1, t) + s * (2.0 * row(2, t) + s * 3.0 * row(3, t));
  }
  [[nodiscard]] double slope_t(double s, double t) const noexcept {
    return cubic(row_slope(0, t), row_slope(1, t), row_slope(2, t), row_slope(3, t), s);
  }
  [[nodiscard]] double second_ss(double s, double t) const noexcept { return 2.0 * row(2, t) + 6.0 * s * row(3, t); }
  [[nodiscard]] double second_st(double s, double t) const noexcept {
    return row_slope(1, t) + s * (2.0 * row_slope(2, t) + s * 3.0 * row_slope(3, t));
  }
  [[nodiscard]] double second_tt(double s, double t) const noexcept {
    const auto bend = [this, t](int k) { return 2.0 * c[k][2] + 6.0 * t * c[k][3]; };
    return cubic(bend(0), bend(1), bend(2), bend(3), s);
  }

 private:
  [[nodiscard]] static double cubic(double c0, double c1, double c2, double c3, double x) noexcept {
    return c0 + x * (c1 + x * (c2 + x * c3));
  }
  [[nodiscard]] double row(int k, double t) const noexcept { return cubic(c[k][0], c[k][1], c[k][2], c[k][3], t); }
  [[nodiscard]] double row_slope(int k, double t) const noexcept {
    return c[k][1] + t * (2.0 * c[k][2] + t * 3.0 * c[k][3]);
  }
};

enum class CubicBasis { catmull_rom, b_spline };

[[nodiscard]] SPARSHA_HOT inline double times(double factor, double value) noexcept { return factor * value; }
[[nodiscard]] SPARSHA_HOT inline Pair times(double factor, Pair value) noexcept { return both(factor) * value; }

/// The cubic between nodes 1 and 2 of four, by powers. `Value`: a double, or a Pair of two cubics at once.
template <CubicBasis kBasis, class Value>
SPARSHA_HOT inline void cubic_powers(Value z0, Value z1, Value z2, Value z3, Value power[4]) noexcept {
  if constexpr (kBasis == CubicBasis::catmull_rom) {
    const Value step = z2 - z1;
    const Value slope1 = times(0.5, z2 - z0);
    const Value slope2 = times(0.5, z3 - z1);
    power[0] = z1;
    power[1] = slope1;
    power[2] = times(3.0, step) - times(2.0, slope1) - slope2;
    power[3] = slope1 + slope2 - times(2.0, step);
  } else {
    const Value before = z1 - z0;
    const Value step = z2 - z1;
    const Value bend = step - before;
    power[0] = z1 + times(1.0 / 6.0, bend);
    power[1] = times(0.5, step + before);
    power[2] = times(0.5, bend);
    power[3] = times(1.0 / 6.0, ((z3 - z2) - step) - bend);
  }
}

/// Height and derivatives at one place of a patch.
struct PatchDerivatives {
  double z, fs, ft, fss, fst, ftt;
};

/// A patch as the smooth fast path evaluates it, all derivatives at once: powers along t, nodes along s.
template <CubicBasis kBasis>
class BicubicBands {
 public:
  BicubicBands() = default;
  /// Four rows of four nodes; `scale` to cells.
  SPARSHA_HOT BicubicBands(const float* corner, std::size_t row, double scale) noexcept {
    Pair low[4];
    Pair high[4];
    for (int l = 0; l < 4; ++l, corner += row) {
      low[l] = both(scale) * Pair{static_cast<double>(corner[0]), static_cast<double>(corner[1])};
      high[l] = both(scale) * Pair{static_cast<double>(corner[2]), static_cast<double>(corner[3])};
    }
    cubic_powers<kBasis>(low[0], low[1], low[2], low[3], low_);
    cubic_powers<kBasis>(high[0], high[1], high[2], high[3], high_);
  }

  [[nodiscard]] SPARSHA_HOT PatchDerivatives at(double s, double t) const noexcept {
    const Pair u = both(t);
    const auto value = [u](const Pair* c) { return c[0] + u * (c[1] + u * (c[2] + u * c[3])); };
    const auto slope = [u](const Pair* c) { return c[1] + u * (both(2.0) * c[2] + both(3.0) * u * c[3]); };
    const auto bend = [u](const Pair* c) { return both(2.0) * c[2] + both(6.0) * u * c[3]; };
    const Pair z_low = value(low_), z_high = value(high_);
    const Pair t_low = slope(low_), t_high = slope(high_);
    const Pair tt_low = bend(low_), tt_high = bend(high_);
    const Weights w = weights(s);
    const auto sum = [](Pair a, Pair low, Pair b, Pair high) {
      const Pair total = a * low + b * high;
      return total[0] + total[1];
    };
    return {sum(w.low, z_low, w.high, z_high),   sum(w.low1, z_low, w.high1, z_high),
            sum(w.low, t_low, w.high, t_high),   sum(w.low2, z_low, w.high2, z_high),
            sum(w.low1, t_low, w.high1, t_high), sum(w.low, tt_low, w.high, tt_high)};
  }

 private:
  /// Of nodes 0, 1 and 2, 3 along s, and their first and second derivatives.
  struct Weights {
    Pair low, high, low1, high1, low2, high2;
  };
  [[nodiscard]] SPARSHA_HOT static Weights weights(double s) noexcept {
    // The cubics of the unit vectors, by powers.
    Pair low[4];
    Pair high[4];
    cubic_powers<kBasis>(Pair{1.0, 0.0}, Pair{0.0, 1.0}, both(0.0), both(0.0), low);
    cubic_powers<kBasis>(both(0.0), both(0.0), Pair{1.0, 0.0}, Pair{0.0, 1.0}, high);
    const Pair u = both(s);
    const auto value = [u](const Pair* c) { return c[0] + u * (c[1] + u * (c[2] + u * c[3])); };
    const auto slope = [u](const Pair* c) { return c[1] + u * (both(2.0) * c[2] + u * (both(3.0) * c[3])); };
    const auto bend = [u](const Pair* c) { return both(2.0) * c[2] + u * (both(6.0) * c[3]); };
    return {value(low), value(high), slope(low), slope(high), bend(low), bend(high)};
  }

  Pair low_[4] = {};
  Pair high_[4] = {};
};

/// Beyond the border it goes on level, as the bilinear surface does.
template <CubicBasis kCubicBasis>
class BicubicSurface : public BilinearSurface {
 public:
  using Patch = BicubicPatch;
  static constexpr bool kHasFastPath = false;
  static constexpr CubicBasis kBasis = kCubicBasis;

  explicit BicubicSurface(const MongeSurface& surface) noexcept : BilinearSurface(surface) {}
  BicubicSurface(const MongeSurface& surface, double cells_per_m) noexcept : BilinearSurface(surface, cells_per_m) {}

  /// Patches may rise above their nodes, also at the border of a B-spline.
  [[nodiscard]] double highest() const noexcept { return std::numeric_limits<double>::infinity(); }

  /// Do the four rows and columns around this cell lie in the window?
  [[nodiscard]] SPARSHA_HOT bool is_deep(int i, int j) const noexcept {
    return static_cast<unsigned>(i - 1) < static_cast<unsigned>(std::max(0, nx() - 3)) &&
           static_cast<unsigned>(j - 1) < static_cast<unsigned>(std::max(0, ny() - 3));
  }
  /// Of a deep cell.
  [[nodiscard]] SPARSHA_HOT BicubicBands<kBasis> bands(int i, int j) const noexcept {
    return {heights() + node(i - 1, j - 1), static_cast<std::size_t>(nx()), cells_per_m()};
  }

  /// Is the whole patch surely below this height? Its weights add up to 1, and those below zero to no more than
  /// `kBelow`.
  [[nodiscard]] bool is_below(int i, int j, double z) const noexcept {
    if (!is_deep(i, j)) return false;
    constexpr double kBelow = kBasis == CubicBasis::b_spline ? 0.0 : 0.28125;
    const float* corner = heights() + node(i - 1, j - 1);
    float low = *corner;
    float high = low;
    for (int l = 0; l < 4; ++l, corner += nx())
      for (int k = 0; k < 4; ++k) {
        low = std::min(low, corner[k]);
        high = std::max(high, corner[k]);
      }
    const double top = static_cast<double>(high) + kBelow * (static_cast<double>(high) - static_cast<double>(low));
    return z > top * cells_per_m() + kRounding * (1.0 + std::abs(z));
  }

  [[nodiscard]] Patch patch(int i, int j) const noexcept {
    const int inner_i = std::clamp(i, 0, nx() - 2);
    const int inner_j = std::clamp(j, 0, ny() - 2);
    Patch patch = patch_inside(inner_i, inner_j);
    if (i < inner_i) freeze_s(patch, 0.0);
    if (i > inner_i) freeze_s(patch, 1.0);
    if (j < inner_j) freeze_t(patch, 0.0);
    if (j > inner_j) freeze_t(patch, 1.0);
    return patch;
  }
  [[nodiscard]] Patch patch_inside(int i, int j) const noexcept {
    double z[4][4];
    for (int l = 0; l < 4; ++l)
      for (int k = 0; k < 4; ++k) z[k][l] = node_height(i - 1 + k, j - 1 + l);
    double along_s[4][4];  // [power of s][node row]
    for (int l = 0; l < 4; ++l) {
      double power[4];
      cubic_powers<kBasis>(z[0][l], z[1][l], z[2][l], z[3][l], power);
      for (int k = 0; k < 4; ++k) along_s[k][l] = power[k];
    }
    Patch patch;
    for (int k = 0; k < 4; ++k)
      cubic_powers<kBasis>(along_s[k][0], along_s[k][1], along_s[k][2], along_s[k][3], patch.c[k]);
    return patch;
  }

 private:
  static constexpr double kRounding = 1e-9;  // cells, and of the height: generous

  /// Heights in cells; beyond the border the last slope goes on, so that a plane stays one.
  [[nodiscard]] double node_height(int i, int j) const noexcept {
    const int inner_i = std::clamp(i, 0, nx() - 1);
    const int inner_j = std::clamp(j, 0, ny() - 1);
    const double here = height_at(inner_i, inner_j);
    double beyond = here;
    if (i != inner_i) beyond += here - height_at(inner_i == 0 ? 1 : inner_i - 1, inner_j);
    if (j != inner_j) beyond += here - height_at(inner_i, inner_j == 0 ? 1 : inner_j - 1);
    return beyond;
  }
  static void freeze_s(Patch& patch, double s) noexcept {
    for (int l = 0; l < 4; ++l) {
      patch.c[0][l] += s * (patch.c[1][l] + patch.c[2][l] + patch.c[3][l]);
      patch.c[1][l] = patch.c[2][l] = patch.c[3][l] = 0.0;
    }
  }
  static void freeze_t(Patch& patch, double t) noexcept {
    for (auto& row : patch.c) {
      row[0] += t * (row[1] + row[2] + row[3]);
      row[1] = row[2] = row[3] = 0.0;
    }
  }
};

using C1Surface = BicubicSurface<CubicBasis::catmull_rom>;
using RoundedSurface = BicubicSurface<CubicBasis::b_spline>;

}  // namespace sparsha::haptics
