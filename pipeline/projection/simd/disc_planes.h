// The planes through neighbourhoods of several points at once. Included once for each instruction set.
#pragma once

#include "pipeline/projection/simd/neighbourhood.h"

namespace {

// What stands for a squared radius: there is no disc.
constexpr float kNoDisc = -__builtin_inff();
// Points are thicker than noise and form where their standard deviation across the plane exceeds these. On the edge of
// a box it is 0.3 spacings.
constexpr float kThickNoises = 2.0F;
constexpr float kThickSpacings = 0.4F;
// Points far apart lie in a plane where their standard deviation across it is below these, spacings.
constexpr float kThin = 0.2F;
constexpr float kThinFar = 0.12F;
constexpr float kFar = 1.5F;  // times as far apart as the densest that must

/// Sums over neighbourhoods of up to eight points, one per lane.
struct DiscBatch {
  float count[kLanes], r2[kLanes];
  float flatness = 0.5F;             // the least variance by the middle one is below
  float reach_of_neighbours = 0.0F;  // squared: discs reach at least so many times as far as their neighbours
  bool thick_again = false;          // what is thicker than noise and form is marked for a second look
  float sum[9][kLanes];              // x y z xx xy xz yy yz zz
  std::uint32_t point[kLanes];
  std::size_t size = 0;
};

SPARSHA_INLINE void add_moments(const DiscKernel& k, const Candidates& c, float r2, std::int32_t count,
                                std::size_t point, DiscBatch& batch) {
  const float x0 = k.x[point];
  const float y0 = k.y[point];
  const float z0 = k.z[point];
  Floats s[9] = {};
  for (std::size_t p = 0; p < c.count; p += kLanes) {
    const Ints in = load(c.r2 + p) <= r2;
    const Floats x = masked(in, load(c.x + p) - x0);
    const Floats y = masked(in, load(c.y + p) - y0);
    const Floats z = masked(in, load(c.z + p) - z0);
    s[0] += x;
    s[1] += y;
    s[2] += z;
    s[3] += x * x;
    s[4] += x * y;
    s[5] += x * z;
    s[6] += y * y;
    s[7] += y * z;
    s[8] += z * z;
  }
  const Eight eight = totals(s[0], s[1], s[2], s[3], s[4], s[5], s[6], s[7]);
  for (std::size_t m = 0; m < 8; ++m) batch.sum[m][batch.size] = eight.at[m];
  batch.sum[8][batch.size] = total(s[8]);
  batch.count[batch.size] = static_cast<float>(count);
  batch.r2[batch.size] = r2;
  batch.point[batch.size++] = static_cast<std::uint32_t>(point);
}

// The normal of a plane through points, and the eigenvalues of their covariance as shares of its trace.
struct PlaneAxis {
  Floats nx, ny, nz;  ///< the length is 1 / per_length
  Floats per_length;
  Ints known;  ///< there is such an axis
  Floats least, middle, largest;
  Floats trace;
};

// The eigenvector of the smallest eigenvalue of a covariance (Hoppe et al. 1992).
SPARSHA_INLINE PlaneAxis plane_axis(Floats xx, Floats xy, Floats xz, Floats yy, Floats yz, Floats zz) {
  const Floats trace = xx + yy + zz;
  const Ints spread = trace > 0.0F;
  const Floats unit = choose(spread, 1.0F / choose(spread, trace, all(1.0F)), Floats{});
  xx *= unit;
  xy *= unit;
  xz *= unit;
  yy *= unit;
  yz *= unit;
  zz *= unit;
  // Of the characteristic polynomial t^3 - t^2 + minors t - determinant, Newton's steps from 0 climb to the least root.
  const Floats minors = xx * yy - xy * xy + xx * zz - xz * xz + yy * zz - yz * yz;
  const Floats determinant = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
  Floats t{};
  for (int step = 0; step < 8; ++step) {
    const Floats value = ((t - 1.0F) * t + minors) * t - determinant;
    const Floats slope = (3.0F * t - 2.0F) * t + minors;
    const Ints rising = slope > 1e-9F;
    t -= choose(rising, value / choose(rising, slope, all(1.0F)), Floats{});
  }
  t = most(t, Floats{});
  // The other two: their sum is 1 - t, their product minors - t (1 - t).
  const Floats half = 0.5F * (1.0F - t);
  const Floats product = minors - t * (1.0F - t);
  const Floats apart = root(most(half * half - product, Floats{}));
  const Floats middle = half - apart;
  const Floats largest = half + apart;
  // The axis is orthogonal to the rows of the matrix less t: the longest of their three cross products.
  const Floats a = xx - t;
  const Floats b = yy - t;
  const Floats c = zz - t;
  Floats nx = xy * yz - xz * b;
  Floats ny = xz * xy - a * yz;
  Floats nz = a * b - xy * xy;
  Floats longest = nx * nx + ny * ny + nz * nz;
  const auto offer = [&](Floats ox, Floats oy, Floats oz) __attribute__((always_inline)) {
    const Floats length = ox * ox + oy * oy + oz * oz;
    const Ints longer = length > longest;
    nx = choose(longer, ox, nx);
    ny = choose(longer, oy, ny);
    nz = choose(longer, oz, nz);
    longest = choose(longer, length, longest);
  };
  offer(xy * c - xz * yz, xz * xz - a * c, a * yz - xy * xz);
  offer(b * c - yz * yz, xz * yz - xy * c, xy * yz - xz * b);
  const Ints known = longest > 0.0F;
  const Floats per_length = choose(known, 1.0F / root(choose(known, longest, all(1.0F))), Floats{});
  return {nx, ny, nz, per_length, known, t, middle, largest, trace};
}

// Whether points far apart lie in a plane. Those scattered in space lie 0.6 spacings off one, and few of them much less
// by chance; the farther apart they are, the more of the object a plane through them would cover.
SPARSHA_INLINE Ints is_thin(const DiscKernel& k, const PlaneAxis& axis, Floats spacing2) {
  const Floats across2 = axis.least * axis.trace;
  const float dense2 = k.dense_spacing_m * k.dense_spacing_m;
  const Ints far = spacing2 > kFar * kFar * dense2;
  const Floats thin2 = choose(far, all(kThinFar * kThinFar), all(kThin * kThin));
  return (spacing2 <= dense2) | (across2 <= thin2 * spacing2 + k.noise_m * k.noise_m);
}

// Planes of the batch. The squared radius of points with too narrow a neighbourhood is 0.
SPARSHA_APART void write_discs(const DiscKernel& k, DiscBatch& batch) {
  for (std::size_t lane = batch.size; lane < kLanes; ++lane) {
    for (auto& sum : batch.sum) sum[lane] = 0.0F;
    batch.count[lane] = batch.r2[lane] = 1.0F;
  }
  const Floats per_count = 1.0F / load(batch.count);
  const Floats mx = load(batch.sum[0]) * per_count;
  const Floats my = load(batch.sum[1]) * per_count;
  const Floats mz = load(batch.sum[2]) * per_count;
  const PlaneAxis axis = plane_axis(load(batch.sum[3]) * per_count - mx * mx, load(batch.sum[4]) * per_count - mx * my,
                                    load(batch.sum[5]) * per_count - mx * mz, load(batch.sum[6]) * per_count - my * my,
                                    load(batch.sum[7]) * per_count - my * mz, load(batch.sum[8]) * per_count - mz * mz);
  const Ints down = axis.nz < 0.0F;
  const Floats sign = choose(down, -axis.per_length, axis.per_length);
  const Floats nx = axis.nx * sign;
  const Floats ny = axis.ny * sign;
  const Floats nz = axis.nz * sign;

  const Floats spacing2 = load(batch.r2) * 3.14159265F * per_count;
  const Ints narrow = (axis.middle < k.narrow * axis.largest) | (axis.middle * axis.trace < k.least_width2);
  const Ints good = axis.known & ~narrow & (nz >= k.least_nz) & (spacing2 <= k.most_spacing_m * k.most_spacing_m) &
                    (axis.least <= batch.flatness * axis.middle) & is_thin(k, axis, spacing2);
  const Floats upright = choose(good, nz, all(1.0F));
  const Floats slope_x = -nx / upright;
  const Floats slope_y = -ny / upright;
  // The point's distance above the plane, along z, and the foot of its perpendicular.
  const Floats offset = mx * nx + my * ny + mz * nz;
  const Floats above = -offset / upright;
  const Floats reach2 = most(spacing2 * k.reach * k.reach, load(batch.r2) * batch.reach_of_neighbours);
  Floats radius2 = choose(good, reach2, choose(narrow, Floats{}, all(kNoDisc)));
  if (batch.thick_again) {
    const Floats across2 = axis.least * axis.trace;
    const Ints thick = (across2 > kThickNoises * kThickNoises * k.noise_m * k.noise_m) &
                       (across2 > kThickSpacings * kThickSpacings * spacing2);
    radius2 = choose(good & thick, -radius2, radius2);
  }
  for (std::size_t lane = 0; lane < batch.size; ++lane) {
    const std::size_t p = batch.point[lane];
    k.foot_x[p] = k.x[p] + offset[lane] * nx[lane];
    k.foot_y[p] = k.y[p] + offset[lane] * ny[lane];
    k.foot_z[p] = k.z[p] + offset[lane] * nz[lane];
    k.slope_x[p] = slope_x[lane];
    k.slope_y[p] = slope_y[lane];
    k.above[p] = above[lane];
    k.radius2[p] = radius2[lane];
  }
  batch.size = 0;
}

}  // namespace
