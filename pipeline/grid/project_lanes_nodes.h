// The node kernel's body, included once for each instruction set after project_lanes.h.
#pragma once

#include "pipeline/grid/project_kernel.h"
#include "pipeline/grid/project_lanes.h"

namespace {

constexpr float kTukey = 4.685F;  // 95 % efficiency under Gaussian noise
constexpr int kRounds = 2;

struct alignas(32) Window {
  float u[sparsha::pipeline::NodeKernel::kMostPoints + 24];  // from the node, in spacings
  float v[sparsha::pipeline::NodeKernel::kMostPoints + 24];
  float w[sparsha::pipeline::NodeKernel::kMostPoints + 24];  // kernel weights of the points in the band
  float z[sparsha::pipeline::NodeKernel::kMostPoints + 24];  // metres, relative to the reference height
};

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

SPARSHA_INLINE void take(const sparsha::pipeline::NodeKernel& k, std::size_t from, std::size_t to, float node_x,
                         float node_y, float per_spacing, float reference, Window& window) {
  store(window.u + to, (load(k.x + from) - node_x) * per_spacing);
  store(window.v + to, (load(k.y + from) - node_y) * per_spacing);
  store(window.z + to, load(k.z + from) - reference);
}

// Copies the points of bins [begin[r], end[r]) of each row, relative to node and reference height; returns how many.
SPARSHA_INLINE std::size_t gather(const sparsha::pipeline::NodeKernel& k, const std::uint32_t* first_bin,
                                  std::size_t reach, float node_x, float node_y, float per_spacing, float reference,
                                  Window& window) {
  std::size_t count = 0;
  for (std::size_t row = 0; row <= 2 * reach; ++row) {
    const std::size_t begin = first_bin[row * k.bins_x];
    const std::size_t end = first_bin[row * k.bins_x + 2 * reach + 1];
    // Two vectors whatever the row holds: a loop of one, two or three would be guessed wrong every other time.
    take(k, begin, count, node_x, node_y, per_spacing, reference, window);
    take(k, begin + kLanes, count + kLanes, node_x, node_y, per_spacing, reference, window);
    for (std::size_t p = begin + 2 * kLanes; p < end; p += kLanes) {
      take(k, p, count + (p - begin), node_x, node_y, per_spacing, reference, window);
    }
    count += end - begin;
  }
  // What was read beyond the last point is far outside every kernel and band.
  store(window.u + count, all(1e3F));
  store(window.v + count, all(1e3F));
  store(window.z + count, all(-1e18F));
  return count;
}

SPARSHA_INLINE std::size_t count_points(const sparsha::pipeline::NodeKernel& k, const std::uint32_t* first_bin,
                                        std::size_t reach) {
  std::size_t count = 0;
  for (std::size_t row = 0; row <= 2 * reach; ++row) {
    count += first_bin[row * k.bins_x + 2 * reach + 1] - first_bin[row * k.bins_x];
  }
  return count;
}

// Fourth highest of the nine bins' highest points, for eight nodes from column i on: robust against empty bins, bins
// that show the back, and outliers.
SPARSHA_INLINE Floats reference_heights(const float* const* tops, std::size_t i) {
  Floats first = all(-__builtin_inff());
  Floats second = first;
  Floats third = first;
  Floats fourth = first;
  for (int row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) {
      Floats next = load(tops[row] + i + column);
      Floats lower = least(first, next);
      first = most(first, next);
      next = least(second, lower);
      second = most(second, lower);
      lower = least(third, next);
      third = most(third, next);
      fourth = most(fourth, lower);
    }
  }
  return fourth;
}

// True when the points out of the band lie to another side of the node than those in it: perhaps a step.
SPARSHA_INLINE bool lopsided(const Window& window, std::size_t count, float band) {
  Floats in_count{};
  Floats in_u{};
  Floats in_v{};
  Floats out_count{};
  Floats out_u{};
  Floats out_v{};
  for (std::size_t p = 0; p < count; p += kLanes) {
    const Ints in = absolute(load(window.z + p)) <= band;
    const Floats u = load(window.u + p);
    const Floats v = load(window.v + p);
    const Ints out = ~in & (u < 100.0F);
    in_count += masked(in, all(1.0F));
    in_u += masked(in, u);
    in_v += masked(in, v);
    out_count += masked(out, all(1.0F));
    out_u += masked(out, u);
    out_v += masked(out, v);
  }
  const Eight sums = totals(in_count, in_u, in_v, out_count, out_u, out_v, Floats{}, Floats{});
  const float per_in = 1.0F / sums.at[0];
  const float per_out = 1.0F / sums.at[3];
  const float du = sums.at[1] * per_in - sums.at[4] * per_out;
  const float dv = sums.at[2] * per_in - sums.at[5] * per_out;
  return du * du + dv * dv > 0.8F;
}

// True when the node lies inside the hull of the band's points within `radius` but for `tolerance`, in eight
// directions.
SPARSHA_INLINE bool surrounded(const Window& window, std::size_t count, float band, float radius, float tolerance) {
  constexpr float kHalfRoot = 0.70710678F;
  Floats high[4];
  Floats low[4];
  for (int d = 0; d < 4; ++d) {
    high[d] = all(-1e9F);
    low[d] = all(1e9F);
  }
  Ints near{};
  for (std::size_t p = 0; p < count; p += kLanes) {
    const Floats u = load(window.u + p);
    const Floats v = load(window.v + p);
    const Ints inside = (absolute(load(window.z + p)) <= band) & (u * u + v * v <= radius * radius);
    near -= inside;
    const Floats along[4] = {u, v, (u + v) * kHalfRoot, (u - v) * kHalfRoot};
    for (int d = 0; d < 4; ++d) {
      high[d] = most(high[d], choose(inside, along[d], all(-1e9F)));
      low[d] = least(low[d], choose(inside, along[d], all(1e9F)));
    }
  }
  if (total(near) < 4) return false;
  for (int d = 0; d < 4; ++d) {
    if (largest(high[d]) < -tolerance || largest(-low[d]) < -tolerance) return false;
  }
  return true;
}

// z = c[0] + c[1] u + c[2] v + c[3] u^2 + c[4] u v + c[5] v^2; a plane has no more than three terms.
struct Quadric {
  float c[6];
};

SPARSHA_INLINE Floats residuals(const Quadric& q, Floats u, Floats v, Floats z) {
  return z - q.c[0] - u * (q.c[1] + q.c[3] * u + q.c[4] * v) - v * (q.c[2] + q.c[5] * v);
}

// Weighted least squares; `per_scale` = 0 weights by the kernel alone, else Tukey's biweight about `about` as well.
SPARSHA_INLINE bool fit_quadric(const Window& window, std::size_t count, float per_scale, float ridge,
                                const Quadric& about, Quadric& result) {
  Floats sums[32];
  for (int s = 0; s < 32; ++s) sums[s] = Floats{};
  for (std::size_t p = 0; p < count; p += kLanes) {
    const Floats u = load(window.u + p);
    const Floats v = load(window.v + p);
    const Floats kernel = load(window.w + p);
    const Ints weighs = kernel > 0.0F;
    const Floats z = masked(weighs, load(window.z + p));
    const Floats r = residuals(about, u, v, z) * per_scale;
    const Floats b = masked(weighs, most(Floats{}, 1.0F - r * r));
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
  for (int i = 1; i < 6; ++i) a[i][i] += ridge + 1e-6F * weight;
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

// Weighted mean of Tukey's loss, 0 to 1, and how many points have weight.
SPARSHA_INLINE float mean_loss(const Window& window, std::size_t count, float per_scale, const Quadric& q,
                               float& support) {
  Floats sum{};
  Floats weight{};
  Floats points{};
  for (std::size_t p = 0; p < count; p += kLanes) {
    const Floats u = load(window.u + p);
    const Floats v = load(window.v + p);
    const Floats kernel = load(window.w + p);
    const Ints weighs = kernel > 0.0F;
    const Floats z = masked(weighs, load(window.z + p));
    const Floats r = residuals(q, u, v, z) * per_scale;
    const Floats b = most(Floats{}, 1.0F - r * r);
    sum += masked(weighs, kernel * (1.0F - b * b * b));
    weight += kernel;
    points += masked(weighs, all(1.0F));
  }
  support = total(points);
  return total(sum) / total(weight);
}

SPARSHA_INLINE bool fit_tukey_plane(const Window& window, std::size_t count, float per_scale, float ridge,
                                    Plane& plane) {
  for (int round = 0; round < kRounds; ++round) {
    Moments robust{};
    for (std::size_t p = 0; p < count; p += kLanes) {
      const Floats u = load(window.u + p);
      const Floats v = load(window.v + p);
      const Floats kernel = load(window.w + p);
      const Ints weighs = kernel > 0.0F;
      const Floats z = masked(weighs, load(window.z + p));
      const Floats r = (z - plane.gu * u - plane.gv * v - plane.c) * per_scale;
      const Floats b = masked(weighs, most(Floats{}, 1.0F - r * r));
      add(robust, kernel * b * b, u, v, z);
    }
    plane = solve(robust, ridge);
    if (!plane.good) return false;
  }
  return true;
}

// Tukey's plane or quadric, whichever explains the points better; false when neither does.
SPARSHA_INLINE bool fit_bent(const sparsha::pipeline::NodeKernel& k, const Window& window, std::size_t count,
                             float per_scale, Plane plane, float& height) {
  float support = 0.0F;
  float bent_loss = 2.0F;
  Quadric bent{};
  if (fit_quadric(window, count, 0.0F, k.ridge, bent, bent)) {
    bool fitted = true;
    for (int round = 0; round < kRounds && fitted; ++round) {
      const Quadric about = bent;
      fitted = fit_quadric(window, count, per_scale, k.ridge, about, bent);
    }
    const float loss = mean_loss(window, count, per_scale, bent, support);
    if (fitted && support >= 10.0F) bent_loss = loss;
  }
  // Gaussian noise alone costs 0.14; near that no plane needs to be asked.
  if (bent_loss > 0.17F) {
    if (!fit_tukey_plane(window, count, per_scale, k.ridge, plane)) return false;
    const float loss = mean_loss(window, count, per_scale, {{plane.c, plane.gu, plane.gv, 0, 0, 0}}, support);
    // Three more coefficients earn their variance only with a clearly better fit.
    if (bent_loss * (1.0F + 6.0F / support) >= loss) {
      height = plane.c;
      return loss <= 0.3F;
    }
  }
  height = bent.c[0];
  return bent_loss <= 0.3F;
}

enum Verdict { kDecided, kWider, kHard };

// Decides a window of 2 reach + 1 nodes a side, unless it is not one simple layer.
SPARSHA_INLINE Verdict fit_node(const sparsha::pipeline::NodeKernel& k, Window& window, std::size_t count,
                                std::size_t reach, float& height) {
  Ints in_count{};
  Ints above_count{};
  for (std::size_t p = 0; p < count; p += kLanes) {
    const Floats z = load(window.z + p);
    in_count -= absolute(z) <= k.band_m;
    above_count -= z > k.band_m;
  }
  const auto in = static_cast<std::size_t>(total(in_count));
  const auto above = static_cast<std::size_t>(total(above_count));
  if (in < 9) return kWider;
  if (in * 4 < count) return kHard;
  // One or two points above the front may be a front that chance has thinned.
  if (above > 0 && count < 24) return kWider;
  if (above >= 3 && above * 12 >= count) return kHard;
  const float per_r2 = k.per_r2[reach - 1][in];
  Moments moments{};
  for (std::size_t p = 0; p < count; p += kLanes) {
    const Floats u = load(window.u + p);
    const Floats v = load(window.v + p);
    const Ints inside = absolute(load(window.z + p)) <= k.band_m;
    const Floats z = masked(inside, load(window.z + p));
    const Floats t = masked(inside, most(Floats{}, 1.0F - (u * u + v * v) * per_r2));
    const Floats w = t * t;
    store(window.w + p, w);
    add(moments, w, u, v, z);
  }
  Plane plane = solve(moments, k.ridge);
  if (!plane.good) return kHard;
  const float off_centre2 = plane.mu * plane.mu + plane.mv * plane.mv;
  if (off_centre2 > 0.0625F && count - in - above >= 3 && lopsided(window, count, k.band_m)) return kHard;
  // A centroid within half a spacing proves that the node is surrounded.
  if (off_centre2 > 0.25F || reach > 1) {
    const float nodes = reach > 1 ? 25.0F : 9.0F;
    const float spacing2 = nodes / static_cast<float>(in);
    const float spacing = spacing2 > 1.0F ? __builtin_sqrtf(spacing2) : 1.0F;
    if (!surrounded(window, count, k.band_m, 1.5F * spacing, 0.5F * spacing)) return kHard;
  }

  Floats residual{};
  for (std::size_t p = 0; p < count; p += kLanes) {
    const Floats u = load(window.u + p);
    const Floats v = load(window.v + p);
    const Floats z = load(window.z + p);
    const Ints weighs = load(window.w + p) > 0.0F;
    residual = most(residual, masked(weighs, absolute(z - plane.gu * u - plane.gv * v - plane.c)));
  }
  const float worst = largest(residual);
  if (worst <= 3.0F * k.scale_m) {
    height = plane.c;
    return kDecided;
  }
  const float per_scale = 1.0F / (kTukey * k.scale_m);
  if (worst > 4.5F * k.scale_m) {
    // More than noise: a bend, if a quadric explains what a plane does not.
    return fit_bent(k, window, count, per_scale, plane, height) ? kDecided : kHard;
  }
  if (!fit_tukey_plane(window, count, per_scale, k.ridge, plane)) return kHard;
  height = plane.c;
  return kDecided;
}

SPARSHA_INLINE void fit_row(const sparsha::pipeline::NodeKernel& k, std::size_t j, float* height,
                            std::uint8_t* decided) {
  Window window;
  // Column i of these is the bin at the left of node i's 3x3 window; bin of the first of its 5x5 window.
  const std::size_t bin = (j + k.margin - 1) * k.bins_x + k.margin - 1;
  const std::uint32_t* first_bin = k.start + bin;
  const float* tops[3] = {k.top + bin, k.top + bin + k.bins_x, k.top + bin + 2 * k.bins_x};
  const float per_spacing = static_cast<float>(1.0 / k.spacing_m);
  const float node_y = static_cast<float>(k.y0_m + static_cast<double>(j) * k.spacing_m);
  for (std::size_t first = 0; first < k.nx; first += kLanes) {
    float reference[kLanes];
    store(reference, reference_heights(tops, first));
    const std::size_t last = first + kLanes < k.nx ? first + kLanes : k.nx;
    for (std::size_t i = first; i < last; ++i) {
      decided[i] = 0;
      const float z = reference[i - first];
      if (!(z > -1e18F)) continue;
      const float node_x = static_cast<float>(k.x0_m + static_cast<double>(i) * k.spacing_m);
      Verdict verdict = kWider;
      float above_reference = 0.0F;
      for (std::size_t reach = 1; reach <= 2 && verdict == kWider; ++reach) {
        const std::uint32_t* corner = reach == 1 ? first_bin + i : first_bin + i - k.bins_x - 1;
        const std::size_t count = count_points(k, corner, reach);
        if (count < 9) continue;
        if (count > static_cast<std::size_t>(sparsha::pipeline::NodeKernel::kMostPoints)) break;
        gather(k, corner, reach, node_x, node_y, per_spacing, z, window);
        verdict = fit_node(k, window, count, reach, above_reference);
      }
      if (verdict != kDecided) continue;
      height[i] = z + above_reference;
      decided[i] = 1;
    }
  }
}

}  // namespace
