// Descent and ray casting on bicubic patches, beside their bilinear siblings in descent.h and ray_march.h. Nothing here
// is a low-degree polynomial, so slopes are evaluated where needed and roots are bracketed.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "haptics/proxy/bicubic_patch.h"
#include "haptics/proxy/descent.h"
#include "haptics/proxy/tangent_cone.h"

namespace sparsha::haptics {

/// Newton where the Hessian is safely positive and the step keeps to the quadrant or edge; else the projection itself.
[[nodiscard]] inline Segment descent_direction(const BicubicPatch& patch, const CellPoint& p, const Pull& pull,
                                               const CellVector& w, const TangentProjection& tangent, Freedom s,
                                               Freedom t) noexcept {
  constexpr double kSafelyPositive = 1e-3;
  const double hss = 1.0 + pull.fs * pull.fs - w.z * patch.second_ss(p.s, p.t);
  const double htt = 1.0 + pull.ft * pull.ft - w.z * patch.second_tt(p.s, p.t);
  if (tangent.ds == 0.0 || tangent.dt == 0.0) {
    const bool safe_s = hss > kSafelyPositive * (1.0 + pull.fs * pull.fs);
    const bool safe_t = htt > kSafelyPositive * (1.0 + pull.ft * pull.ft);
    return {tangent.ds != 0.0 && safe_s ? pull.bs / hss : tangent.ds,
            tangent.dt != 0.0 && safe_t ? pull.bt / htt : tangent.dt};
  }
  const double hst = pull.fs * pull.ft - w.z * patch.second_st(p.s, p.t);
  const double determinant = hss * htt - hst * hst;
  if (hss > 0.0 && determinant > kSafelyPositive * hss * htt) {
    const Segment newton{(pull.bs * htt - pull.bt * hst) / determinant, (pull.bt * hss - pull.bs * hst) / determinant};
    if (allows(s, newton.ds) && allows(t, newton.dt)) return newton;
  }
  return {tangent.ds, tangent.dt};
}

/// d D / d tau along a straight segment of a bicubic patch.
class CurveSlope {
 public:
  CurveSlope(const BicubicPatch& patch, const CellPoint& p, const CellVector& w, const Segment& d) noexcept
      : patch_(patch), p_(p), w_(w), d_(d), start_(patch.height(p.s, p.t)) {}

  [[nodiscard]] double operator()(double tau) const noexcept {
    const double s = p_.s + tau * d_.ds;
    const double t = p_.t + tau * d_.dt;
    const double z = w_.z - (patch_.height(s, t) - start_);
    const double rise = patch_.slope_s(s, t) * d_.ds + patch_.slope_t(s, t) * d_.dt;
    return -((w_.x - tau * d_.ds) * d_.ds + (w_.y - tau * d_.dt) * d_.dt + z * rise);
  }

 private:
  const BicubicPatch& patch_;
  const CellPoint& p_;
  CellVector w_;
  Segment d_;
  double start_;
};

/// How far along the segment, at most to `end`, D falls: up to the first place where its slope turns, looked for in
/// quarters; a small overshoot of a Newton step counts as the minimum.
[[nodiscard]] inline double descent_length(const CurveSlope& slope, double end) noexcept {
  constexpr double kSmall = 0.1;  // of the slope at the start
  constexpr int kPieces = 4;
  constexpr int kHalvings = 50;
  const double small = kSmall * std::abs(slope(0.0));
  double low = 0.0;
  for (int piece = 1; piece <= kPieces; ++piece) {
    double high = end * piece / kPieces;
    const double at_high = slope(high);
    if (at_high <= 0.0) {
      low = high;
      continue;
    }
    if (piece == kPieces && at_high <= small) return end;
    for (int k = 0; k < kHalvings; ++k) {
      const double middle = 0.5 * (low + high);
      const double value = slope(middle);
      if (value <= 0.0 && value >= -small && middle > 0.0) return middle;
      (value <= 0.0 ? low : high) = middle;
    }
    return low > 0.0 ? low : high;
  }
  return end;
}

namespace bicubic {

inline constexpr int kDegree = 6;

/// Bernstein coefficients on [0, 1] of the first `degree` + 1 powers.
inline void to_bernstein(const double* power, int degree, double* bernstein) noexcept {
  double choose_n = 1.0;  // C(degree, k)
  double scaled[kDegree + 1];
  for (int k = 0; k <= degree; ++k) {
    scaled[k] = power[k] / choose_n;
    choose_n *= static_cast<double>(degree - k) / (k + 1);
  }
  for (int i = 0; i <= degree; ++i) {
    double choose_i = 1.0;  // C(i, k)
    bernstein[i] = 0.0;
    for (int k = 0; k <= i; ++k) {
      bernstein[i] += choose_i * scaled[k];
      choose_i *= static_cast<double>(i - k) / (k + 1);
    }
  }
}

inline constexpr double kNarrow = 1e-15;

/// Do the coefficients turn from not negative to negative once, and stay so? Then the polynomial does in [0, 1], by the
/// variation diminishing property (Farin 2002).
inline bool turns_once(const double* b, int degree) noexcept {
  int first = 0;
  while (first <= degree && b[first] >= 0.0) ++first;
  for (int i = first; i <= degree; ++i)
    if (b[i] >= 0.0) return false;
  return first > 0 && first <= degree;
}

/// The root in [0, 1] of a polynomial that turns once: Newton's steps, halved where they leave what holds the root.
inline double only_root(const double* b, int degree) noexcept {
  constexpr int kMostSteps = 60;
  double low = 0.0;
  double high = 1.0;
  double at = b[0] / (b[0] - b[degree]);
  for (int step = 0; step < kMostSteps; ++step) {
    double row[kDegree + 1];
    std::copy(b, b + degree + 1, row);
    for (int left = degree; left > 1; --left)
      for (int i = 0; i < left; ++i) row[i] += at * (row[i + 1] - row[i]);
    const double slope = degree * (row[1] - row[0]);
    const double value = row[0] + at * (row[1] - row[0]);
    (value < 0.0 ? high : low) = at;
    double next = at - value / slope;
    if (!(next >= low && next <= high)) next = 0.5 * (low + high);
    if (std::abs(next - at) < kNarrow || high - low < kNarrow) return next;
    at = next;
  }
  return low;
}

/// First place in [low, low + width] where the polynomial goes below zero, or infinity: de Casteljau subdivision, left
/// half first. `splits` bounds the work on grazing rays; used up, the place reached counts as the hit.
inline double first_negative(const double* b, int degree, double low, double width, int& splits) noexcept {
  constexpr double kMiss = std::numeric_limits<double>::infinity();
  if (*std::min_element(b, b + degree + 1) >= 0.0) return kMiss;
  if (b[0] < 0.0 || width < kNarrow || splits <= 0) return low;
  if (turns_once(b, degree)) return low + width * only_root(b, degree);
  --splits;
  double left[kDegree + 1] = {};
  double right[kDegree + 1];  // in place: the triangle's last entries are the right half
  std::copy(b, b + degree + 1, right);
  for (int level = 0; level <= degree; ++level) {
    left[level] = right[0];
    for (int i = 0; i < degree - level; ++i) right[i] = 0.5 * (right[i] + right[i + 1]);
  }
  const double hit = first_negative(left, degree, low, 0.5 * width, splits);
  return hit < kMiss ? hit : first_negative(right, degree, low + 0.5 * width, 0.5 * width, splits);
}

}  // namespace bicubic

/// The smallest tau in [0, end] at which the ray p + tau w dips below the patch; a value beyond `end` when it does not.
[[nodiscard]] inline double ray_patch_hit(const BicubicPatch& patch, const CellPoint& p, const CellVector& w,
                                          double end, bool leaving) noexcept {
  constexpr double kMiss = std::numeric_limits<double>::infinity();
  constexpr int kMostSplits = 300;
  const double ds = end * w.x;
  const double dt = end * w.y;
  // The height along the ray, u = tau / end: Horner in polynomials of u.
  double f[bicubic::kDegree + 1] = {};
  for (int k = 3; k >= 0; --k) {
    double row[4] = {};
    for (int l = 3; l >= 0; --l) {
      for (int n = 3; n > 0; --n) row[n] = row[n] * p.t + row[n - 1] * dt;
      row[0] = row[0] * p.t + patch.c[k][l];
    }
    for (int n = bicubic::kDegree; n > 0; --n) f[n] = f[n] * p.s + f[n - 1] * ds;
    f[0] *= p.s;
    for (int n = 0; n < 4; ++n) f[n] += row[n];
  }
  double gap[bicubic::kDegree + 1];
  for (int n = 0; n <= bicubic::kDegree; ++n) gap[n] = -f[n];
  gap[0] += p.z;
  gap[1] += end * w.z;
  double bernstein[bicubic::kDegree + 1];
  int splits = kMostSplits;
  double hit;
  if (leaving || gap[0] <= 0.0) {
    // On the surface: the root at zero is divided out.
    if (gap[1] < 0.0) return 0.0;
    bicubic::to_bernstein(gap + 1, bicubic::kDegree - 1, bernstein);
    hit = bicubic::first_negative(bernstein, bicubic::kDegree - 1, 0.0, 1.0, splits);
  } else {
    bicubic::to_bernstein(gap, bicubic::kDegree, bernstein);
    hit = bicubic::first_negative(bernstein, bicubic::kDegree, 0.0, 1.0, splits);
  }
  return hit < kMiss ? hit * end : kMiss;
}

}  // namespace sparsha::haptics
