// Tangent discs: for each point the plane through its nearest neighbours in space, found in columns of points that are
// sorted by height. Included once for each instruction set.
#pragma once

#include "pipeline/projection/simd/kernels.h"
#include "pipeline/projection/simd/vectors.h"

namespace {

using sparsha::pipeline::DiscKernel;

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
// A gap across the plane is one between two sheets where it exceeds these.
constexpr float kGapNoises = 3.0F;
constexpr float kGapSpacings = 0.3F;
constexpr std::size_t kMostAcross = 32;  // neighbours that are looked at for a gap

/// Candidates for neighbours of points, and how far they are from one of them.
struct Candidates {
  float* x;
  float* y;
  float* z;
  float* r2;  // squared distances
  std::size_t count = 0;
};

// The first or the second of two lists.
SPARSHA_INLINE Candidates candidates_in(const DiscKernel& k, std::size_t list) {
  const std::size_t room = DiscKernel::kMostCandidates + DiscKernel::kReadAhead;
  float* s = k.scratch + list * 4 * room;
  return {s, s + room, s + 2 * room, s + 3 * room, 0};
}

// Points [begin, end), appended as far as there is room.
SPARSHA_INLINE void append(const DiscKernel& k, std::size_t begin, std::size_t end, Candidates& to) {
  const std::size_t room = DiscKernel::kMostCandidates - to.count;
  const std::size_t here = end - begin < room ? end - begin : room;
  for (std::size_t p = 0; p < here; p += kLanes) {
    store(to.x + to.count + p, load(k.x + begin + p));
    store(to.y + to.count + p, load(k.y + begin + p));
    store(to.z + to.count + p, load(k.z + begin + p));
  }
  to.count += here;
}

// Beyond the last candidate are some that are infinitely far away.
SPARSHA_INLINE void finish(Candidates& c) { store(c.x + c.count, all(__builtin_inff())); }

SPARSHA_INLINE void measure(const DiscKernel& k, std::size_t point, Candidates& c) {
  const float x = k.x[point];
  const float y = k.y[point];
  const float z = k.z[point];
  for (std::size_t p = 0; p < c.count; p += kLanes) {
    const Floats dx = load(c.x + p) - x;
    const Floats dy = load(c.y + p) - y;
    const Floats dz = load(c.z + p) - z;
    store(c.r2 + p, dx * dx + dy * dy + dz * dz);
  }
}

SPARSHA_INLINE std::int32_t count_within(const Candidates& c, float r2) {
  Ints within{};
  for (std::size_t p = 0; p < c.count; p += kLanes) within -= load(c.r2 + p) <= r2;
  return total(within);
}

// First point of [begin, end), which descend in z, that is lower than `z` (or as low, when `equal` is).
SPARSHA_INLINE std::size_t first_below(const float* heights, std::size_t begin, std::size_t end, float z, bool equal) {
  while (begin < end) {
    const std::size_t middle = begin + (end - begin) / 2;
    const bool above = equal ? heights[middle] > z : heights[middle] >= z;
    if (above) {
      begin = middle + 1;
    } else {
      end = middle;
    }
  }
  return begin;
}

// Candidates from `rings` columns to each side, within `reach` in z.
SPARSHA_APART void gather_wide(const DiscKernel& k, std::size_t row, std::size_t column, std::size_t rings,
                               std::size_t point, Candidates& to) {
  const float z = k.z[point];
  const float reach = k.side_m * static_cast<float>(rings);
  to.count = 0;
  const std::size_t row0 = row > k.first_row + rings ? row - rings : k.first_row;
  const std::size_t row1 = row + rings < k.last_row ? row + rings : k.last_row - 1;
  const std::size_t column0 = column > rings ? column - rings : 0;
  const std::size_t column1 = column + rings < k.bins_x ? column + rings : k.bins_x - 1;
  for (std::size_t j = row0; j <= row1; ++j) {
    for (std::size_t i = column0; i <= column1; ++i) {
      const std::uint32_t* bin = k.start + j * k.bins_x + i;
      const std::size_t begin = first_below(k.z, bin[0], bin[1], z + reach, true);
      append(k, begin, first_below(k.z, begin, bin[1], z - reach, false), to);
    }
  }
  finish(to);
  measure(k, point, to);
}

/// The columns around one, and where a window of heights that moves down stands in each.
struct Windows {
  std::uint32_t begin[9], end[9], last[9];
  std::size_t count = 0;
};

SPARSHA_INLINE Windows windows_around(const DiscKernel& k, std::size_t row, std::size_t column) {
  Windows w;
  for (std::size_t j = row > k.first_row ? row - 1 : row; j <= row + 1 && j < k.last_row; ++j) {
    for (std::size_t i = column > 0 ? column - 1 : 0; i <= column + 1 && i < k.bins_x; ++i) {
      const std::uint32_t* bin = k.start + j * k.bins_x + i;
      if (bin[0] == bin[1]) continue;
      w.begin[w.count] = w.end[w.count] = bin[0];
      w.last[w.count++] = bin[1];
    }
  }
  return w;
}

// The first of points [begin, end), which descend in z, that is not above `z` (or not as high, when `equal` is): few
// steps from `begin`.
SPARSHA_INLINE std::uint32_t next_below(const float* heights, std::uint32_t begin, std::uint32_t end, float z,
                                        bool equal) {
  for (;;) {
    const Floats here = load(heights + begin);
    std::uint32_t lanes = lanes_of(equal ? here >= z : here > z);
    if (end - begin < kLanes) lanes &= (1U << (end - begin)) - 1U;
    const auto above = static_cast<std::uint32_t>(__builtin_ctz(~lanes));
    begin += above;
    if (above < kLanes) return begin;
  }
}

// Candidates for the points from `top` down to `bottom` of the column in the middle.
SPARSHA_INLINE void gather_near(const DiscKernel& k, Windows& w, float top, float bottom, Candidates& to) {
  top += k.side_m;
  bottom -= k.side_m;
  to.count = 0;
  for (std::size_t c = 0; c < w.count; ++c) {
    w.begin[c] = next_below(k.z, w.begin[c], w.last[c], top, false);
    if (w.end[c] < w.begin[c]) w.end[c] = w.begin[c];
    w.end[c] = next_below(k.z, w.end[c], w.last[c], bottom, true);
    append(k, w.begin[c], w.end[c], to);
  }
  finish(to);
}

// The squared radius that holds about the wanted number of candidates, no more than `most`; 0 when they are too few.
SPARSHA_INLINE float neighbourhood2(const DiscKernel& k, const Candidates& c, float most, std::int32_t& count) {
  count = count_within(c, most);
  if (count < k.least) return 0.0F;
  float r2 = most;
  // On a surface the number within grows as the squared radius.
  for (int round = 0; round < 6 && (count > k.wanted + 3 || count < k.wanted - 3); ++round) {
    float next = r2 * static_cast<float>(k.wanted) / static_cast<float>(count);
    next = next < most ? next : most;
    if (next == r2) break;
    r2 = next;
    count = count_within(c, r2);
    if (count < 1) count = 1;
  }
  if (count >= k.least) return r2;
  r2 = most;
  count = count_within(c, most);
  return r2;
}

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

// The neighbourhood of a point, among the candidates near or, when they are too few, from farther columns.
SPARSHA_INLINE void add_point(const DiscKernel& k, std::size_t row, std::size_t column, std::size_t point,
                              Candidates& near, DiscBatch& batch) {
  measure(k, point, near);
  std::int32_t count = 0;
  float r2 = neighbourhood2(k, near, k.side_m * k.side_m, count);
  if (r2 > 0.0F) {
    add_moments(k, near, r2, count, point, batch);
    return;
  }
  Candidates far = candidates_in(k, 1);
  for (std::size_t rings = 2; r2 == 0.0F && rings <= k.rings; ++rings) {
    gather_wide(k, row, column, rings, point, far);
    const float reach = k.side_m * static_cast<float>(rings);
    r2 = neighbourhood2(k, far, reach * reach, count);
  }
  if (r2 > 0.0F) add_moments(k, far, r2, count, point, batch);
}

// Once more, from all points within `columns` columns, those of a row whose squared radius is 0. A scanner's lines are
// often farther apart than the points on them, so that the nearest points all lie on one line and tell no plane.
SPARSHA_APART void widen(const DiscKernel& k, std::size_t row, float columns) {
  DiscBatch batch;
  batch.flatness = 0.2F;             // what is wide may hold two surfaces
  batch.reach_of_neighbours = 1.0F;  // to the next line
  Candidates far = candidates_in(k, 1);
  const float r2 = columns * columns * k.side_m * k.side_m;
  const auto rings = static_cast<std::size_t>(__builtin_ceilf(columns));
  const std::uint32_t* const start = k.start + row * k.bins_x;
  std::size_t column = 0;
  const std::size_t end = start[k.bins_x];
  for (std::size_t first = start[0]; first < end; first += kLanes) {
    std::uint32_t lanes = lanes_of(load(k.radius2 + first) == 0.0F);
    if (end - first < kLanes) lanes &= (1U << (end - first)) - 1U;
    for (; lanes != 0; lanes &= lanes - 1U) {
      const std::size_t p = first + static_cast<std::size_t>(__builtin_ctz(lanes));
      while (start[column + 1] <= p) ++column;
      k.radius2[p] = kNoDisc;
      gather_wide(k, row, column, rings, p, far);
      const std::int32_t count = count_within(far, r2);
      if (count >= k.least) add_moments(k, far, r2, count, p, batch);
      if (batch.size == kLanes) write_discs(k, batch);
    }
  }
  if (batch.size > 0) write_discs(k, batch);
}

// The neighbourhood of a point from as many columns as it takes; 0 when its points are too few.
SPARSHA_INLINE float neighbourhood_of(const DiscKernel& k, std::size_t row, std::size_t column, std::size_t point,
                                      Candidates& c, std::int32_t& count) {
  float r2 = 0.0F;
  for (std::size_t rings = 1; r2 == 0.0F && rings <= k.rings; ++rings) {
    gather_wide(k, row, column, rings, point, c);
    const float reach = k.side_m * static_cast<float>(rings);
    r2 = neighbourhood2(k, c, reach * reach, count);
  }
  return r2;
}

/// What lies across a plane through a point: up to `above` and down to `below` it is the point's own sheet.
struct Across {
  float nx, ny, nz;
  float below = -__builtin_inff(), above = __builtin_inff();
};

/// Neighbours of a point along two directions in a plane and across it, ascending across.
struct AcrossPlane {
  float u[kMostAcross], v[kMostAcross], across[kMostAcross];
  std::size_t size = 0;

  void put(float a, float b, float h) {
    std::size_t at = size++;
    for (; at > 0 && across[at - 1] > h; --at) {
      u[at] = u[at - 1];
      v[at] = v[at - 1];
      across[at] = across[at - 1];
    }
    u[at] = a;
    v[at] = b;
    across[at] = h;
  }
  [[nodiscard]] std::size_t widest() const {
    std::size_t found = 1;
    for (std::size_t p = 2; p < size; ++p) {
      if (across[p] - across[p - 1] > across[found] - across[found - 1]) found = p;
    }
    return found;
  }
};

// Looks for the gaps next to the point among what lies within the squared radius. False when there is none. A plane
// through two faces leans to where they overlap: the slope that those on both sides of the widest gap have in common
// is taken out.
SPARSHA_INLINE bool find_gap(const DiscKernel& k, const Candidates& c, float r2, std::int32_t count, std::size_t point,
                             Across& across) {
  constexpr int kRounds = 3;
  if (static_cast<std::size_t>(count) > kMostAcross || count < 4) return false;
  AcrossPlane around;
  for (int round = 0; round < kRounds; ++round) {
    const float per = 1.0F / __builtin_sqrtf(across.nz * across.nz + across.nx * across.nx);
    const float ux = across.nz * per;
    const float uz = -across.nx * per;
    const float vx = across.ny * uz;
    const float vy = across.nz * ux - across.nx * uz;
    const float vz = -across.ny * ux;
    around.size = 0;
    for (std::size_t p = 0; p < c.count && around.size < kMostAcross; ++p) {
      if (!(c.r2[p] <= r2)) continue;
      const float x = c.x[p] - k.x[point];
      const float y = c.y[p] - k.y[point];
      const float z = c.z[p] - k.z[point];
      around.put(x * ux + z * uz, x * vx + y * vy + z * vz, x * across.nx + y * across.ny + z * across.nz);
    }
    if (round + 1 == kRounds) break;
    const std::size_t cut = around.widest();
    float uu = 0.0F, uv = 0.0F, vv = 0.0F, uh = 0.0F, vh = 0.0F;
    for (std::size_t side = 0; side < 2; ++side) {
      const std::size_t begin = side == 0 ? 0 : cut;
      const std::size_t end = side == 0 ? cut : around.size;
      const float share = 1.0F / static_cast<float>(end - begin);
      float mu = 0.0F, mv = 0.0F, mh = 0.0F;
      for (std::size_t p = begin; p < end; ++p) {
        mu += share * around.u[p];
        mv += share * around.v[p];
        mh += share * around.across[p];
      }
      for (std::size_t p = begin; p < end; ++p) {
        const float u = around.u[p] - mu;
        const float v = around.v[p] - mv;
        const float h = around.across[p] - mh;
        uu += u * u;
        uv += u * v;
        vv += v * v;
        uh += u * h;
        vh += v * h;
      }
    }
    const float determinant = uu * vv - uv * uv;
    if (!(determinant > 1e-6F * uu * vv)) break;
    const float a = (uh * vv - vh * uv) / determinant;
    const float b = (vh * uu - uh * uv) / determinant;
    const float nx = across.nx - a * ux - b * vx;
    const float ny = across.ny - b * vy;
    const float nz = across.nz - a * uz - b * vz;
    const float length = 1.0F / __builtin_sqrtf(nx * nx + ny * ny + nz * nz);
    across.nx = nx * length;
    across.ny = ny * length;
    across.nz = nz * length;
  }
  const float spacing = __builtin_sqrtf(r2 * 3.14159265F / static_cast<float>(count));
  const float gap = kGapNoises * k.noise_m + kGapSpacings * spacing;
  for (std::size_t p = 1; p < around.size; ++p) {
    if (around.across[p] - around.across[p - 1] <= gap) continue;
    const float middle = 0.5F * (around.across[p] + around.across[p - 1]);
    if (middle < 0.0F) across.below = middle;
    if (middle > 0.0F && middle < across.above) across.above = middle;
  }
  return across.below > -__builtin_inff() || across.above < __builtin_inff();
}

// Leaves candidates of the point's own sheet within reach.
SPARSHA_INLINE void keep_sheet(const DiscKernel& k, const Across& across, std::size_t point, Candidates& c) {
  for (std::size_t p = 0; p < c.count; p += kLanes) {
    const Floats h = (load(c.x + p) - k.x[point]) * across.nx + (load(c.y + p) - k.y[point]) * across.ny +
                     (load(c.z + p) - k.z[point]) * across.nz;
    const Ints own = (h > across.below) & (h < across.above);
    store(c.r2 + p, choose(own, load(c.r2 + p), all(__builtin_inff())));
  }
}

// Once more those of a row whose squared radius was marked by its sign: neighbours of a thin sheet lie on its other
// face, too, and a plane through both is neither. Where a gap across the plane tells them apart, a point's own face is
// fitted alone; else its disc stays.
SPARSHA_APART void tell_sheets_apart(const DiscKernel& k, std::size_t row) {
  DiscBatch batch;
  Candidates far = candidates_in(k, 1);
  const std::uint32_t* const start = k.start + row * k.bins_x;
  std::size_t column = 0;
  const std::size_t end = start[k.bins_x];
  for (std::size_t p = start[0]; p < end; ++p) {
    if (!(k.radius2[p] < 0.0F) || k.radius2[p] == kNoDisc) continue;
    while (start[column + 1] <= p) ++column;
    k.radius2[p] = -k.radius2[p];
    const float per_length = 1.0F / __builtin_sqrtf(1.0F + k.slope_x[p] * k.slope_x[p] + k.slope_y[p] * k.slope_y[p]);
    Across across{-k.slope_x[p] * per_length, -k.slope_y[p] * per_length, per_length};
    std::int32_t count = 0;
    float r2 = neighbourhood_of(k, row, column, p, far, count);
    if (!(r2 > 0.0F) || !find_gap(k, far, r2, count, p, across)) continue;
    k.radius2[p] = kNoDisc;
    r2 = 0.0F;
    for (std::size_t rings = 1; r2 == 0.0F && rings < k.rings; ++rings) {
      gather_wide(k, row, column, rings, p, far);
      keep_sheet(k, across, p, far);
      const float reach = k.side_m * static_cast<float>(rings);
      r2 = neighbourhood2(k, far, reach * reach, count);
    }
    if (r2 > 0.0F) add_moments(k, far, r2, count, p, batch);
    if (batch.size == kLanes) write_discs(k, batch);
  }
  if (batch.size > 0) write_discs(k, batch);
}

SPARSHA_APART void fit_discs(const DiscKernel& k, std::size_t row) {
  DiscBatch batch;
  batch.thick_again = k.noise_m >= 0.0F;
  Candidates near = candidates_in(k, 0);
  for (std::size_t column = 0; column < k.bins_x; ++column) {
    const std::size_t bin = row * k.bins_x + column;
    const std::size_t end = k.start[bin + 1];
    if (k.start[bin] == end) continue;
    for (std::size_t p = k.start[bin]; p < end; ++p) k.radius2[p] = kNoDisc;
    Windows windows = windows_around(k, row, column);
    for (std::size_t begin = k.start[bin]; begin < end && k.z[begin] >= k.needed_m[bin];) {
      // Points at nearly one height have nearly the same candidates.
      std::size_t last = begin + 1;
      while (last < end && k.z[begin] - k.z[last] <= 0.5F * k.side_m && k.z[last] >= k.needed_m[bin]) ++last;
      gather_near(k, windows, k.z[begin], k.z[last - 1], near);
      for (std::size_t p = begin; p < last; ++p) {
        add_point(k, row, column, p, near, batch);
        if (batch.size == kLanes) write_discs(k, batch);
      }
      begin = last;
    }
  }
  if (batch.size > 0) write_discs(k, batch);
  if (k.noise_m >= 0.0F) tell_sheets_apart(k, row);
  constexpr float kWider[] = {1.2F, 1.6F, 2.0F, 3.0F};  // columns
  for (const float columns : kWider) widen(k, row, columns);
  const auto widest = static_cast<float>(k.rings);
  for (float columns = 1.4F * kWider[3]; columns < 1.2F * widest; columns *= 1.4F) {
    widen(k, row, columns < widest ? columns : widest);
  }
}

}  // namespace
