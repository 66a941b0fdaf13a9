// The C1 surface (`haptics.surface: c1`): bicubic patches through the same nodes, Catmull-Rom slopes (Catmull & Rom
// 1974) in both directions. Slopes are continuous across cells, so that the force has no creases to jump at; at steps
// it overshoots by up to 7 %. Lengths in cells.
#pragma once

#include <algorithm>
#include <limits>

#include "haptics/proxy/bilinear_patch.h"

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

/// Beyond the border it goes on level, as the bilinear surface does.
class C1Surface : public BilinearSurface {
 public:
  using Patch = BicubicPatch;
  static constexpr bool kHasFastPath = false;

  explicit C1Surface(const MongeSurface& surface) noexcept : BilinearSurface(surface) {}

  /// Patches may rise above their nodes.
  [[nodiscard]] double highest() const noexcept { return std::numeric_limits<double>::infinity(); }

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
      powers_of(z[0][l], z[1][l], z[2][l], z[3][l], power);
      for (int k = 0; k < 4; ++k) along_s[k][l] = power[k];
    }
    Patch patch;
    for (int k = 0; k < 4; ++k) powers_of(along_s[k][0], along_s[k][1], along_s[k][2], along_s[k][3], patch.c[k]);
    return patch;
  }

 private:
  /// The cubic between nodes 1 and 2 of four.
  static void powers_of(double z0, double z1, double z2, double z3, double power[4]) noexcept {
    const double step = z2 - z1;
    const double slope1 = 0.5 * (z2 - z0);
    const double slope2 = 0.5 * (z3 - z1);
    power[0] = z1;
    power[1] = slope1;
    power[2] = 3.0 * step - 2.0 * slope1 - slope2;
    power[3] = slope1 + slope2 - 2.0 * step;
  }
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

}  // namespace sparsha::haptics
