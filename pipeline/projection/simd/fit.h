// Robust plane and quadric of one node's window, eight points at a time; included once for each instruction set.
#pragma once

#include "pipeline/projection/simd/kernels.h"
#include "pipeline/projection/simd/vectors.h"

namespace {

constexpr float kTukey = 4.685F;  // 95 % efficiency under Gaussian noise
constexpr int kRounds = 3;
// Residuals of a plane that are still noise: the largest in scales, and the weighted mean of squares in scales squared.
// A quarter more than noise alone would give; robust weights at three scales would waste points that are right.
constexpr float kBent = 4.5F;
constexpr float kRough = 2.5F;
// Where layers may mix, smaller residuals are suspected already.
constexpr float kSuspect = 3.0F;
constexpr float kNoiseLoss = 0.14F;  // weighted mean of Tukey's loss under Gaussian noise

// Points as a node sees them, in arrays that may be read and written up to 24 elements beyond the last point.
struct Window {
  float* u;  // from the node, in spacings
  float* v;
  float* w;  // kernel weights of the points that count
  float* z;  // metres, relative to a reference height
};

/// Eight points of a window that count, and others with z = 0.
struct Weighted {
  Floats u, v, z, kernel;
  Ints counts;
};
SPARSHA_INLINE Weighted load_weighted(const Window& window, std::size_t p) {
  const Floats kernel = load(window.w + p);
  const Ints counts = kernel > 0.0F;
  return {load(window.u + p), load(window.v + p), masked(counts, load(window.z + p)), kernel, counts};
}

struct Plane {
  float c, gu, gv;  // metres, metres per spacing
  float mu, mv;     // centroid of the weights
  bool good;
};

struct Moments {
  Floats w, u, v, z, uu, uv, vv, uz, vz;
};

SPARSHA_INLINE void add(Moments& m, Floats w, Floats u, Floats v, Floats z) {
  const Floats wu = w * u;
  const Floats wv = w * v;
  m.w += w;
  m.u += wu;
  m.v += wv;
  m.z += w * z;
  m.uu += wu * u;
  m.uv += wu * v;
  m.vv += wv * v;
  m.uz += wu * z;
  m.vz += wv * z;
}

// Weight of the prior in the normal equations: of slopes, and of the coefficients of second order.
struct Prior {
  float slope, bend;
};

SPARSHA_INLINE Plane solve(const Moments& m, float ridge) {
  Plane plane{};
  const Eight sums = totals(m.w, m.u, m.v, m.z, m.uu, m.uv, m.vv, m.uz);
  const float w = sums.at[0];
  if (!(w > 0.0F)) return plane;
  const float per_w = 1.0F / w;
  const float u = sums.at[1];
  const float v = sums.at[2];
  plane.mu = u * per_w;
  plane.mv = v * per_w;
  const float mz = sums.at[3] * per_w;
  const float prior = ridge + 1e-6F * w;
  const float uu = sums.at[4] - u * plane.mu + prior;
  const float vv = sums.at[6] - v * plane.mv + prior;
  const float uv = sums.at[5] - u * plane.mv;
  const float uz = sums.at[7] - u * mz;
  const float vz = total(m.vz) - v * mz;
  const float determinant = uu * vv - uv * uv;
  if (!(determinant > 0.0F)) return plane;
  const float per_determinant = 1.0F / determinant;
  plane.gu = (uz * vv - vz * uv) * per_determinant;
  plane.gv = (vz * uu - uz * uv) * per_determinant;
  plane.c = mz - plane.gu * plane.mu - plane.gv * plane.mv;
  plane.good = true;
  return plane;
}

// z = c[0] + c[1] u + c[2] v + c[3] u^2 + c[4] u v + c[5] v^2; a plane has no more than three terms.
struct Quadric {
  float c[6];
};

SPARSHA_INLINE Floats residuals(const Quadric& q, Floats u, Floats v, Floats z) {
  return z - q.c[0] - u * (q.c[1] + q.c[3] * u + q.c[4] * v) - v * (q.c[2] + q.c[5] * v);
}

// Weighted least squares; `per_scale` = 0 weights by the kernel alone, else Tukey's biweight about `about` as well.
SPARSHA_INLINE bool fit_quadric(const Window& window, std::size_t count, float per_scale, Prior prior,
                                const Quadric& about, Quadric& result) {
  Floats sums[32];
  for (int s = 0; s < 32; ++s) sums[s] = Floats{};
  for (std::size_t p = 0; p < count; p += kLanes) {
    const auto [u, v, z, kernel, counts] = load_weighted(window, p);
    const Floats r = residuals(about, u, v, z) * per_scale;
    const Floats b = masked(counts, most(Floats{}, 1.0F - r * r));
    const Floats w = kernel * b * b;
    const Floats uu = u * u;
    const Floats uv = u * v;
    const Floats vv = v * v;
    const Floats terms[6] = {all(1.0F), u, v, uu, uv, vv};
    int s = 0;
    for (int i = 0; i < 6; ++i) {
      const Floats wi = w * terms[i];
      for (int j = 0; j <= i; ++j) sums[s++] += wi * terms[j];
    }
    for (int i = 0; i < 6; ++i) sums[s++] += w * terms[i] * z;
  }
  Eight summed[4];
  for (int e = 0; e < 4; ++e) {
    const Floats* part = sums + 8 * e;
    summed[e] = totals(part[0], part[1], part[2], part[3], part[4], part[5], part[6], part[7]);
  }
  float a[6][6];
  int s = 0;
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j <= i; ++j, ++s) a[i][j] = summed[s / 8].at[s % 8];
  }
  for (int i = 0; i < 6; ++i, ++s) result.c[i] = summed[s / 8].at[s % 8];
  const float weight = a[0][0];
  for (int i = 1; i < 6; ++i) a[i][i] += (i < 3 ? prior.slope : prior.bend) + 1e-7F * weight;
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j <= i; ++j) {
      float sum = a[i][j];
      for (int m = 0; m < j; ++m) sum -= a[i][m] * a[j][m];
      if (i == j) {
        if (!(sum > 1e-5F * a[i][i])) return false;
        a[i][i] = __builtin_sqrtf(sum);
      } else {
        a[i][j] = sum / a[j][j];
      }
    }
  }
  for (int i = 0; i < 6; ++i) {
    for (int m = 0; m < i; ++m) result.c[i] -= a[i][m] * result.c[m];
    result.c[i] /= a[i][i];
  }
  for (int i = 5; i >= 0; --i) {
    for (int m = i + 1; m < 6; ++m) result.c[i] -= a[m][i] * result.c[m];
    result.c[i] /= a[i][i];
  }
  return true;
}

struct Loss {
  float mean;     // of Tukey's, 0 to 1, weighted
  float worst;    // residual, of kTukey scales
  float support;  // points with weight
};

SPARSHA_INLINE Loss loss_of(const Window& window, std::size_t count, float per_scale, const Quadric& q) {
  Floats sum{};
  Floats weight{};
  Floats points{};
  Floats worst{};
  for (std::size_t p = 0; p < count; p += kLanes) {
    const auto [u, v, z, kernel, counts] = load_weighted(window, p);
    const Floats r = residuals(q, u, v, z) * per_scale;
    const Floats b = most(Floats{}, 1.0F - r * r);
    worst = most(worst, masked(counts, absolute(r)));
    sum += masked(counts, kernel * (1.0F - b * b * b));
    weight += kernel;
    points += masked(counts, all(1.0F));
  }
  return {total(sum) / total(weight), largest(worst), total(points)};
}

SPARSHA_INLINE bool fit_tukey_plane(const Window& window, std::size_t count, float per_scale, float ridge,
                                    Plane& plane) {
  for (int round = 0; round < kRounds; ++round) {
    Moments robust{};
    for (std::size_t p = 0; p < count; p += kLanes) {
      const auto [u, v, z, kernel, counts] = load_weighted(window, p);
      const Floats r = (z - plane.gu * u - plane.gv * v - plane.c) * per_scale;
      const Floats b = masked(counts, most(Floats{}, 1.0F - r * r));
      add(robust, kernel * b * b, u, v, z);
    }
    plane = solve(robust, ridge);
    if (!plane.good) return false;
  }
  return true;
}

struct RobustFit {
  float c, gu, gv;  // height and slopes at the node
  float loss;       // 0 when the residuals are noise
};

// Tukey's plane or quadric, whichever explains the points better.
SPARSHA_APART RobustFit fit_bent(const Window& window, std::size_t count, float per_scale, Prior prior, Plane plane) {
  float bent_loss = 2.0F;
  Quadric bent{};
  if (fit_quadric(window, count, 0.0F, prior, bent, bent)) {
    Loss loss = loss_of(window, count, per_scale, bent);
    // Noise about a quadric needs no robust weights.
    if (loss.worst * kTukey > kBent || loss.mean > 1.2F * kNoiseLoss) {
      bool fitted = true;
      for (int round = 0; round < kRounds && fitted; ++round) {
        const Quadric about = bent;
        fitted = fit_quadric(window, count, per_scale, prior, about, bent);
      }
      loss = loss_of(window, count, per_scale, bent);
      if (!fitted) loss.mean = 2.0F;
    }
    if (loss.support >= 10.0F) bent_loss = loss.mean;
  }
  if (!fit_tukey_plane(window, count, per_scale, prior.slope, plane)) return {plane.c, plane.gu, plane.gv, 1.0F};
  const Loss loss = loss_of(window, count, per_scale, {{plane.c, plane.gu, plane.gv, 0, 0, 0}});
  // Three more coefficients earn their variance only with a clearly better fit.
  if (bent_loss * (1.0F + 6.0F / loss.support) >= loss.mean) return {plane.c, plane.gu, plane.gv, loss.mean};
  return {bent.c[0], bent.c[1], bent.c[2], bent_loss};
}

// The plane as it is when its residuals are within `noise` scales, else what fits better.
SPARSHA_INLINE RobustFit refine(const Window& window, std::size_t count, float weight, float scale, float noise,
                                Prior prior, const Plane& plane) {
  Floats residual{};
  Floats squares{};
  for (std::size_t p = 0; p < count; p += kLanes) {
    const auto [u, v, z, kernel, counts] = load_weighted(window, p);
    const Floats r = masked(counts, absolute(z - plane.gu * u - plane.gv * v - plane.c));
    residual = most(residual, r);
    squares += kernel * (r * r);
  }
  const float worst = largest(residual);
  if (worst <= noise * scale && total(squares) <= kRough * (scale * scale) * weight) {
    return {plane.c, plane.gu, plane.gv, 0.0F};
  }
  const float per_scale = 1.0F / (kTukey * scale);
  if (worst > kBent * scale) return fit_bent(window, count, per_scale, prior, plane);
  Plane robust = plane;
  if (!fit_tukey_plane(window, count, per_scale, prior.slope, robust)) return {plane.c, plane.gu, plane.gv, 1.0F};
  const Loss loss = loss_of(window, count, per_scale, {{robust.c, robust.gu, robust.gv, 0, 0, 0}});
  return {robust.c, robust.gu, robust.gv, loss.mean};
}

// All points, weighted by the compact kernel alone.
SPARSHA_INLINE void fit_all_points(const sparsha::pipeline::LayerKernel& k, std::size_t count,
                                   sparsha::pipeline::LayerFit& fit) {
  const Window window{k.u, k.v, k.w, k.z};
  // What lies beyond the last point is far outside the kernel.
  store(window.u + count, all(1e3F));
  store(window.v + count, all(1e3F));
  store(window.z + count, Floats{});
  Moments moments{};
  Ints support{};
  for (std::size_t p = 0; p < count; p += kLanes) {
    const Floats u = load(window.u + p);
    const Floats v = load(window.v + p);
    const Floats t = most(Floats{}, 1.0F - (u * u + v * v) * k.per_r2);
    const Floats w = t * t;
    support -= w > 0.0F;
    store(window.w + p, w);
    add(moments, w, u, v, load(window.z + p));
  }
  fit.support = static_cast<std::uint32_t>(total(support));
  const Plane plane = solve(moments, k.ridge);
  fit.good = plane.good;
  if (!plane.good) return;
  const RobustFit robust = refine(window, count, total(moments.w), k.scale_m, kSuspect, {k.ridge, k.bend_ridge}, plane);
  fit.height_m = robust.c;
  fit.slope_u_m = robust.gu;
  fit.slope_v_m = robust.gv;
  fit.loss = robust.loss;
}

}  // namespace
