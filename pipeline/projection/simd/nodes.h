// A node decided alone: the points of its window eight at a time. For windows that are wide, crowded or more than one
// smooth band. Included once for each instruction set.
#pragma once

#include "pipeline/projection/simd/fit.h"
#include "pipeline/projection/simd/kernels.h"
#include "pipeline/projection/simd/vectors.h"

namespace {

constexpr float kAbsent = -1e18F;  ///< height of what is not there
// A centroid farther off than a quarter of a spacing, squared: where points lie below the front, a step is looked for.
constexpr float kOffCentre2 = 0.0625F;
// Where two layers lie apart: the front's mean place from the node, in spacings of its points, and from that of the
// others, in sides of the window; squares.
constexpr float kAside = 0.16F;
constexpr float kApart = 0.07F;
// Where fewer points than one in so many of the front lie below it, a wider window tells chance from a step.
constexpr std::size_t kPerBelow = 3;
// Nodes to each side of the window: thin fronts are left to NodeFitter from the second, chance from the third.
constexpr std::size_t kWide = 2;
constexpr std::size_t kWidest = 3;

SPARSHA_INLINE bool rank_descending(float* value, std::size_t count, std::uint32_t* rank) {
  store(value + count, all(-__builtin_inff()));
  std::size_t ranks = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const Floats mine = all(value[k]);
    Ints greater{};
    for (std::size_t p = 0; p < count; p += kLanes) greater -= load(value + p) > mine;
    rank[k] = static_cast<std::uint32_t>(total(greater));
    ranks += rank[k];
  }
  return ranks == count * (count - 1) / 2;
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

// True when the points in the band lie to one side of the node and those out of it to another: perhaps a step.
// `spacing` is that of the points in the band, `nodes` the area of the window.
SPARSHA_INLINE bool lopsided(const Window& window, std::size_t count, float band, float spacing, float nodes) {
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
  const float in_mean_u = sums.at[1] * per_in;
  const float in_mean_v = sums.at[2] * per_in;
  if (in_mean_u * in_mean_u + in_mean_v * in_mean_v <= kAside * spacing * spacing) return false;
  const float du = in_mean_u - sums.at[4] * per_out;
  const float dv = in_mean_v - sums.at[5] * per_out;
  return du * du + dv * dv > kApart * nodes;
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

/// NodeKernel::Verdict, and that a wider window has to tell.
enum Verdict : std::uint8_t {
  kHard = sparsha::pipeline::NodeKernel::kHard,
  kDecided = sparsha::pipeline::NodeKernel::kMeasured,
  kUnknown = sparsha::pipeline::NodeKernel::kUnknown,
  kWider
};

// Decides a window of 2 reach + 1 nodes per side, if it is one simple layer.
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
  if (in < 9) return reach < kWide ? kWider : kHard;
  if (in * 4 < count) return kHard;
  // One or two points above the front may be a front that chance has thinned.
  if (above > 0 && count < 24) return reach < kWide ? kWider : kHard;
  if (above >= 3 && above * 12 >= count) return kHard;
  const float per_r2 = k.per_r2[reach - 1][in < k.most_of[reach - 1] ? in : k.most_of[reach - 1]];
  Moments moments{};
  const auto side = static_cast<float>(2 * reach + 1);
  const float nodes = side * side;
  const float spacing2 = nodes / static_cast<float>(in);
  const float spacing = spacing2 > 1.0F ? __builtin_sqrtf(spacing2) : 1.0F;
  const float near2 = 2.25F * spacing * spacing;
  Ints near{};
  for (std::size_t p = 0; p < count; p += kLanes) {
    const Floats u = load(window.u + p);
    const Floats v = load(window.v + p);
    const Ints inside = absolute(load(window.z + p)) <= k.band_m;
    const Floats z = masked(inside, load(window.z + p));
    const Floats r2 = u * u + v * v;
    near -= inside & (r2 <= near2);
    const Floats t = masked(inside, most(Floats{}, 1.0F - r2 * per_r2));
    const Floats w = t * t;
    store(window.w + p, w);
    add(moments, w, u, v, z);
  }
  Plane plane = solve(moments, k.ridge);
  if (!plane.good) return kHard;
  const float off_centre2 = plane.mu * plane.mu + plane.mv * plane.mv;
  if (off_centre2 > kOffCentre2 && count - in - above >= 3 && lopsided(window, count, k.band_m, spacing, nodes)) {
    return reach < kWidest && (count - in - above) * kPerBelow <= in ? kWider : kHard;
  }
  // A centroid within half a spacing and points enough near by prove that the node is surrounded.
  if (off_centre2 > 0.25F * spacing * spacing || total(near) < 4) {
    const float tolerance = 0.5F * spacing;
    if (!surrounded(window, count, k.band_m, 1.5F * spacing, tolerance)) {
      if (reach < kWide) return kHard;
      // As far as NodeFitter would look for points all around.
      const float radius = 1.5F + 2.25F * (spacing - 1.0F);
      return surrounded(window, count, k.band_m, radius, tolerance) ? kHard : kUnknown;
    }
  }

  const RobustFit fit = refine(window, count, total(moments.w), k.scale_m, kBent, {k.ridge, k.ridge}, plane);
  height = fit.c;
  return fit.loss <= 0.3F ? kDecided : kHard;
}

// Reference height where fewer than four bins of the 3x3 window hold points: of those of the 5x5 window, the highest
// point of the bin that four ninths of them are above.
SPARSHA_INLINE float wider_reference(const sparsha::pipeline::NodeKernel& k, const std::uint32_t* corner) {
  float tops[25];
  std::size_t found = 0;
  for (std::size_t row = 0; row < 5; ++row) {
    const std::uint32_t* start = corner + row * k.bins_x;
    for (std::size_t column = 0; column < 5; ++column) {
      if (start[column] == start[column + 1]) continue;
      const float top = k.z[start[column]];
      std::size_t at = found++;
      for (; at > 0 && tops[at - 1] < top; --at) tops[at] = tops[at - 1];
      tops[at] = top;
    }
  }
  return found < 4 ? kAbsent : tops[found * 4 / 9];
}

// Node (i, j) from a window of `reach` nodes to each side or a wider one. `height` is written only when it is decided.
SPARSHA_APART Verdict fit_alone(const sparsha::pipeline::NodeKernel& k, Window& window, std::size_t i, std::size_t j,
                                std::size_t reach, float reference, float* height) {
  const auto corner_of = [&](std::size_t r) { return k.start + ((j + k.margin - r) * k.bins_x + i + k.margin - r); };
  if (!(reference > kAbsent)) {
    reach = kWide;
    reference = wider_reference(k, corner_of(reach));
    if (!(reference > kAbsent)) return kHard;
  }
  const float per_spacing = static_cast<float>(1.0 / k.spacing_m);
  const float node_x = static_cast<float>(k.x0_m + static_cast<double>(i) * k.spacing_m);
  const float node_y = static_cast<float>(k.y0_m + static_cast<double>(j) * k.spacing_m);
  for (;; ++reach) {
    const std::uint32_t* corner = corner_of(reach);
    const std::size_t count = count_points(k, corner, reach);
    if (count < 9) {
      if (reach < kWide) continue;
      return kHard;
    }
    if (count > sparsha::pipeline::NodeKernel::kMostPoints) return kHard;
    gather(k, corner, reach, node_x, node_y, per_spacing, reference, window);
    float above_reference = 0.0F;
    const Verdict verdict = fit_node(k, window, count, reach, above_reference);
    if (verdict == kWider) continue;
    if (verdict == kDecided) *height = reference + above_reference;
    return verdict;
  }
}

}  // namespace
