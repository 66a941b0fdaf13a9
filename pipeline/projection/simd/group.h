// Eight nodes at a time, one per lane: nodes whose 3x3 window is one smooth band in front. Included once for each
// instruction set.
#pragma once

#include "pipeline/projection/simd/fit.h"
#include "pipeline/projection/simd/kernels.h"
#include "pipeline/projection/simd/nodes.h"
#include "pipeline/projection/simd/slots.h"
#include "pipeline/projection/simd/vectors.h"

namespace {

// Fourth highest of the nine bins' highest points, for eight nodes from column i on: robust against empty bins, bins
// that show the back, and outliers.
SPARSHA_INLINE Floats reference_heights(const SlotRow* const* rows, std::size_t column) {
  Floats first = all(kAbsent);
  Floats second = first;
  Floats third = first;
  Floats fourth = first;
  for (int row = 0; row < 3; ++row) {
    for (std::size_t a = 0; a < 3; ++a) {
      Floats next = load(rows[row]->z[0] + column + a);
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

/// What is known of eight nodes after a look at their windows.
struct GroupResult {
  Floats reference;  ///< metres; kAbsent when fewer than four bins hold points
  Floats height;     ///< above the reference
  Ints decided;
  Ints wider;  ///< the window is too small to decide; neither: the node takes the slow path
};

SPARSHA_INLINE Ints larger(Ints a, Ints b) { return (a & (a > b)) | (b & ~(a > b)); }
SPARSHA_INLINE std::int32_t largest(Ints a) {
  Ints b = larger(a, __builtin_shufflevector(a, a, 4, 5, 6, 7, 0, 1, 2, 3));
  b = larger(b, __builtin_shufflevector(b, b, 2, 3, 0, 1, 6, 7, 4, 5));
  return b[0] > b[1] ? b[0] : b[1];
}
SPARSHA_INLINE Ints load_ints(const std::int32_t* p) {
  Ints value;
  __builtin_memcpy(&value, p, sizeof(value));
  return value;
}

/// The slots of eight nodes' windows from column `column` on; of each row so many as its fullest bin fills.
struct GroupWindow {
  const SlotRow* const* rows;
  std::size_t column;
  std::size_t slots[3];
};

// use(u, v, z) for slot after slot: eight points from their nodes, in spacings, and their heights; kAbsent where there
// is none.
template <class Use>
SPARSHA_INLINE void for_slots(const GroupWindow& window, const Use& use) {
  for (int b = 0; b < 3; ++b) {
    const SlotRow& row = *window.rows[b];
    const float* u = row.u[0] + window.column;
    const float* v = row.v[0] + window.column;
    const float* z = row.z[0] + window.column;
    const float node_v = static_cast<float>(b - 1);
    for (std::size_t s = 0; s < window.slots[b]; ++s, u += kColumns, v += kColumns, z += kColumns) {
      for (int a = 0; a < 3; ++a) use(load(u + a) + static_cast<float>(a - 1), load(v + a) + node_v, load(z + a));
    }
  }
}

SPARSHA_APART GroupResult fit_group(const sparsha::pipeline::NodeKernel& k, const SlotRow* const* rows,
                                    std::size_t column) {
  GroupResult result{};
  result.reference = reference_heights(rows, column);
  Ints count{};
  Ints fullest{};  // of each node's nine bins
  GroupWindow window{rows, column, {}};
  for (int b = 0; b < 3; ++b) {
    const Ints left = load_ints(rows[b]->count + column);
    const Ints middle = load_ints(rows[b]->count + column + 1);
    const Ints right = load_ints(rows[b]->count + column + 2);
    count += left + middle + right;
    const Ints most_of_row = larger(larger(left, middle), right);
    fullest = larger(fullest, most_of_row);
    const std::int32_t most_points = largest(most_of_row);
    window.slots[b] = most_points < static_cast<std::int32_t>(kSlots) ? static_cast<std::size_t>(most_points) : kSlots;
  }
  // A node's own bins decide, whoever its neighbours in the group are: results do not depend on how a grid is cut.
  const Ints there = (result.reference > kAbsent) & (fullest <= static_cast<std::int32_t>(kSlots));
  if (!any(there)) return result;

  const Floats low = result.reference - k.band_m;
  const Floats high = result.reference + k.band_m;
  Ints not_below{};
  Ints above{};
  for_slots(window, [&](Floats, Floats, Floats here) {
    not_below -= here >= low;
    above -= here > high;
  });
  const Ints in = not_below - above;
  // One or two points above the front may be a front that chance has thinned.
  const Ints thin = (in < 9) | ((above > 0) & (count < 24));
  result.wider = there & thin;
  const Ints open = there & ~thin & (in * 4 >= count) & ~((above >= 3) & (above * 12 >= count));
  if (!any(open)) return result;

  static_assert(9 * kSlots < sparsha::pipeline::NodeKernel::kLeastRadii);
  float radii[kLanes];
  for (std::size_t lane = 0; lane < kLanes; ++lane) radii[lane] = k.per_r2[0][in[lane]];
  const Floats per_r2 = load(radii);
  float weights[9 * kSlots * kLanes];
  Moments m{};
  float* weight = weights;
  for_slots(window, [&](Floats u, Floats v, Floats here) {
    const Ints inside = (here >= low) & (here <= high);
    const Floats t = masked(inside, most(Floats{}, 1.0F - (u * u + v * v) * per_r2));
    const Floats w = t * t;
    store(weight, w);
    weight += kLanes;
    add(m, w, u, v, here - result.reference);
  });

  const Floats per_w = 1.0F / m.w;
  const Floats mu = m.u * per_w;
  const Floats mv = m.v * per_w;
  const Floats mz = m.z * per_w;
  const Floats prior = k.ridge + 1e-6F * m.w;
  const Floats uu = m.uu - m.u * mu + prior;
  const Floats vv = m.vv - m.v * mv + prior;
  const Floats uv = m.uv - m.u * mv;
  const Floats uz = m.uz - m.u * mz;
  const Floats vz = m.vz - m.v * mz;
  const Floats determinant = uu * vv - uv * uv;
  const Floats per_determinant = 1.0F / determinant;
  const Floats gu = (uz * vv - vz * uv) * per_determinant;
  const Floats gv = (vz * uu - uz * uv) * per_determinant;
  result.height = mz - gu * mu - gv * mv;
  const Floats off_centre2 = mu * mu + mv * mv;

  const Floats at_node = result.height + result.reference;
  Floats worst{};
  Floats squares{};
  weight = weights;
  for_slots(window, [&](Floats u, Floats v, Floats here) {
    const Floats w = load(weight);
    weight += kLanes;
    const Floats r = masked(w > 0.0F, absolute(here - at_node - gu * u - gv * v));
    worst = most(worst, r);
    squares += w * (r * r);
  });
  // A centroid near the node proves that the node is surrounded; points below it may be the other side of a step.
  const Ints central = (off_centre2 <= 0.25F) & ((off_centre2 <= kOffCentre2) | (count - not_below < 3));
  const Ints smooth = (worst <= kBent * k.scale_m) & (squares <= kRough * (k.scale_m * k.scale_m) * m.w);
  result.decided = open & (m.w > 0.0F) & (determinant > 0.0F) & central & smooth;
  return result;
}

SPARSHA_INLINE void fit_rows(const sparsha::pipeline::NodeKernel& k, std::size_t j_begin, std::size_t j_end,
                             float* heights, std::uint8_t* verdict) {
  static thread_local SlotRow ring[3];
  constexpr std::size_t kStride = sparsha::pipeline::NodeKernel::kScratch / 4;
  Window window{k.scratch, k.scratch + kStride, k.scratch + 2 * kStride, k.scratch + 3 * kStride};
  for (std::size_t first = 0; first < k.nx; first += kTile) {
    const std::size_t last = first + kTile < k.nx ? first + kTile : k.nx;
    fill_slots(k, static_cast<std::ptrdiff_t>(j_begin) - 1, first, ring[0]);
    fill_slots(k, static_cast<std::ptrdiff_t>(j_begin), first, ring[1]);
    for (std::size_t j = j_begin; j < j_end; ++j) {
      fill_slots(k, static_cast<std::ptrdiff_t>(j) + 1, first, ring[(j - j_begin + 2) % 3]);
      const SlotRow* rows[3];
      for (std::size_t b = 0; b < 3; ++b) rows[b] = &ring[(j - j_begin + b) % 3];
      float* height = heights + (j - j_begin) * k.nx;
      std::uint8_t* done = verdict + (j - j_begin) * k.nx;
      for (std::size_t i = first; i < last; i += kLanes) {
        const GroupResult group = fit_group(k, rows, i - first);
        const std::size_t lanes = last - i < kLanes ? last - i : kLanes;
        for (std::size_t lane = 0; lane < lanes; ++lane) {
          if (group.decided[lane] != 0) {
            height[i + lane] = group.reference[lane] + group.height[lane];
            done[i + lane] = kDecided;
          } else {
            const std::size_t reach = group.wider[lane] != 0 ? 2 : 1;
            done[i + lane] = fit_alone(k, window, i + lane, j, reach, group.reference[lane], height + i + lane);
          }
        }
      }
    }
  }
}

}  // namespace
