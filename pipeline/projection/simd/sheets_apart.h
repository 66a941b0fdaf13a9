// Tangent discs of thin sheets, whose two faces are nearer than neighbours are. Included once for each instruction set.
#pragma once

#include "pipeline/projection/simd/disc_planes.h"

namespace {

// A gap across the plane is one between two sheets where it exceeds these.
constexpr float kGapNoises = 3.0F;
constexpr float kGapSpacings = 0.3F;
constexpr std::size_t kMostAcross = 32;  // neighbours that are looked at for a gap

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

}  // namespace
