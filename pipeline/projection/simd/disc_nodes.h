// Heights at nodes from tangent discs: the highest group of discs that surrounds a node. Included once for each
// instruction set.
#pragma once

#include "pipeline/projection/simd/discs.h"
#include "pipeline/projection/simd/kernels.h"
#include "pipeline/projection/simd/vectors.h"

namespace {

using sparsha::pipeline::DiscLayer;
using sparsha::pipeline::DiscNodeKernel;

// A foot this near to a node, in spacings of its points, is beneath it.
constexpr float kBeneath = 0.05F;
// A layer with a foot this near reaches the node: no lower one is the front there.
constexpr float kReaches = 0.25F;
// Layers whose gap is this near to the least one, as a multiple of it, are hard to tell apart.
constexpr float kHardlyApart = 1.15F;

/// The discs over one node: places relative to the node, heights of the disc at the node.
struct Cover {
  float* height;
  float* x;
  float* y;
  float* slope_x;
  float* slope_y;
  float* point;    // height of the disc's point
  float* spacing;  // of the points about it
  float* weight;   // (1 - r^2 / R^2)^2
  float* facing;
  float* towards_x;  // unit vector from the node to the foot; zero where the foot is beneath the node
  float* towards_y;
  std::uint32_t* found;
  std::uint32_t* sorted;
  std::size_t count = 0;
  float low = 0.0F, high = 0.0F, least_spacing = 0.0F, most_spacing = 0.0F;
  bool all_quadrants = false;  // feet in each, and none of them beneath the node
  bool all_towards = false;    // all discs face the viewer
};

SPARSHA_INLINE Cover cover_in(const DiscNodeKernel& k) {
  const std::size_t room = DiscNodeKernel::kMostDiscs + DiscNodeKernel::kReadAhead;
  float* s = k.scratch;
  Cover c;
  c.height = s;
  c.x = s + room;
  c.y = s + 2 * room;
  c.slope_x = s + 3 * room;
  c.slope_y = s + 4 * room;
  c.point = s + 5 * room;
  c.spacing = s + 6 * room;
  c.weight = s + 7 * room;
  c.facing = s + 8 * room;
  c.towards_x = s + 9 * room;
  c.towards_y = s + 10 * room;
  c.found = reinterpret_cast<std::uint32_t*>(s + 11 * room);
  c.sorted = reinterpret_cast<std::uint32_t*>(s + 12 * room);
  return c;
}

// Finds the discs [begin, end) that cover the node.
SPARSHA_INLINE void find_discs(const DiscNodeKernel& k, std::size_t begin, std::size_t end, float x, float y,
                               Cover& c) {
  // Copies: the compiler must assume that a write to `found` changes the kernel's own pointers.
  const float* const foot_x = k.x;
  const float* const foot_y = k.y;
  const float* const slope_x = k.slope_x;
  const float* const slope_y = k.slope_y;
  const float* const radius2 = k.radius2;
  std::uint32_t* const found = c.found;
  std::size_t count = c.count;
  for (std::size_t p = begin; p < end && count + kLanes <= DiscNodeKernel::kMostDiscs; p += kLanes) {
    const Floats dx = x - load(foot_x + p);
    const Floats dy = y - load(foot_y + p);
    const Floats rise = load(slope_x + p) * dx + load(slope_y + p) * dy;
    std::uint32_t lanes = lanes_of(dx * dx + dy * dy + rise * rise < load(radius2 + p));
    if (end - p < kLanes) lanes &= (1U << (end - p)) - 1U;
    count += write_lanes(lanes, static_cast<std::uint32_t>(p), found + count);
  }
  c.count = count;
}

// Reads the discs `numbers` and works out all that is asked about them. A group that begins at `last_begin` or before
// may then be read eight at a time: values beyond the last disc repeat it.
SPARSHA_INLINE void read_discs(const DiscNodeKernel& k, const std::uint32_t* numbers, float x, float y,
                               std::size_t last_begin, Cover& c) {
  Floats low = all(__builtin_inff());
  Floats high = all(-__builtin_inff());
  Floats least_spacing = low;
  Floats most_spacing = high;
  Ints quadrants[4] = {};
  Ints astray{};
  const std::size_t padded = last_begin > 0 ? c.count + kLanes : c.count;
  for (std::size_t first = 0; first < padded; first += kLanes) {
    Floats rows[kLanes];
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const std::size_t d = first + lane < c.count ? first + lane : c.count - 1;
      rows[lane] = load(k.records + sparsha::pipeline::kDiscRecord * numbers[d]);
    }
    transpose(rows);
    const Floats dx = rows[0] - x;
    const Floats dy = rows[1] - y;
    const Floats rise = rows[3] * dx + rows[4] * dy;
    const Floats height = rows[2] - rise;
    const Floats flat2 = dx * dx + dy * dy;
    const Floats left = most(1.0F - (flat2 + rise * rise) / rows[6], Floats{});
    const Floats spacing = root(rows[6]) * k.per_reach;
    const Ints aside = flat2 >= (kBeneath * kBeneath) * spacing * spacing;
    const Floats per_flat = masked(aside, 1.0F / root(choose(aside, flat2, all(1.0F))));
    const Ints right = aside & (dx > 0.0F);
    const Ints left_of = aside & (dx < 0.0F);
    quadrants[0] |= right & (dy > 0.0F);
    quadrants[1] |= right & (dy < 0.0F);
    quadrants[2] |= left_of & (dy > 0.0F);
    quadrants[3] |= left_of & (dy < 0.0F);
    astray |= rows[7] != 1.0F;
    store(c.height + first, height);
    store(c.x + first, dx);
    store(c.y + first, dy);
    store(c.slope_x + first, rows[3]);
    store(c.slope_y + first, rows[4]);
    store(c.point + first, rows[2] + rows[5]);
    store(c.spacing + first, spacing);
    store(c.weight + first, left * left);
    store(c.facing + first, rows[7]);
    store(c.towards_x + first, dx * per_flat);
    store(c.towards_y + first, dy * per_flat);
    low = least(low, height);
    high = most(high, height);
    least_spacing = least(least_spacing, spacing);
    most_spacing = most(most_spacing, spacing);
  }
  c.low = -largest(-low);
  c.high = largest(high);
  c.least_spacing = -largest(-least_spacing);
  c.most_spacing = largest(most_spacing);
  c.all_quadrants = any(quadrants[0]) && any(quadrants[1]) && any(quadrants[2]) && any(quadrants[3]);
  c.all_towards = !any(astray);
}

// Narrows the discs to the highest group, down to `low`, with the next disc at `next`. False when the spacings of
// single discs have to tell where the group ends; nothing is changed then.
SPARSHA_INLINE bool narrow_to_group(const DiscNodeKernel& k, Cover& c, float& low, float& next) {
  const float apart = k.link_noise_m + k.link_spacings * c.least_spacing;
  const Floats none = all(-__builtin_inff());
  low = c.high;
  for (;;) {
    Floats lowest = all(low);
    for (std::size_t p = 0; p < c.count; p += kLanes) {
      const Floats height = load(c.height + p);
      lowest = least(lowest, choose(low - height <= apart, height, lowest));
    }
    const float reached = -largest(-lowest);
    if (reached == low) break;
    low = reached;
  }
  Floats below = none;
  for (std::size_t p = 0; p < c.count; p += kLanes) {
    const Floats height = load(c.height + p);
    below = most(below, choose(height < low, height, none));
  }
  next = largest(below);
  if (low - next <= k.link_noise_m + k.link_spacings * c.most_spacing) return false;
  std::size_t size = 0;
  for (std::size_t p = 0; p < c.count; p += kLanes) {
    const Floats height = load(c.height + p);
    std::uint32_t* to = c.sorted + size;
    const std::size_t more = write_lanes(lanes_of(height >= low), static_cast<std::uint32_t>(p), to);
    for (std::size_t n = 0; n < more; ++n) to[n] = c.found[to[n]];
    size += more;
  }
  c.count = size;
  return true;
}

// The discs' numbers, the highest first; equal ones in the order in which they were found.
SPARSHA_INLINE void sort_discs(Cover& c) {
  store(c.height + c.count, all(-__builtin_inff()));
  std::size_t ranks = 0;
  for (std::size_t d = 0; d < c.count; ++d) {
    const Floats mine = all(c.height[d]);
    Ints higher{};
    for (std::size_t p = 0; p < c.count; p += kLanes) higher -= load(c.height + p) > mine;
    const auto rank = static_cast<std::size_t>(total(higher));
    ranks += rank;
    c.sorted[rank] = c.found[d];
  }
  if (ranks == c.count * (c.count - 1) / 2) [[likely]]
    return;
  for (std::size_t d = 0; d < c.count; ++d) {
    std::size_t rank = 0;
    for (std::size_t p = 0; p < c.count; ++p) {
      rank += c.height[p] > c.height[d] || (c.height[p] == c.height[d] && p < d) ? 1U : 0U;
    }
    c.sorted[rank] = c.found[d];
  }
}

// True when the feet of discs [begin, end) lie all around the node: in each of 32 directions one within about 92
// degrees, or one beneath the node itself.
SPARSHA_INLINE bool surround(const Cover& c, std::size_t begin, std::size_t end) {
  constexpr float kLimit = 0.03F;
  const Floats along_x = {1.0F,        0.98078528F, 0.92387953F, 0.83146961F,
                          0.70710678F, 0.55557023F, 0.38268343F, 0.19509032F};
  const Floats along_y = {0.0F,        0.19509032F, 0.38268343F, 0.55557023F,
                          0.70710678F, 0.83146961F, 0.92387953F, 0.98078528F};
  Floats high = all(-1.0F);
  Floats low = all(1.0F);
  Floats side_high = high;
  Floats side_low = low;
  for (std::size_t d = begin; d < end; ++d) {
    const Floats x = all(c.towards_x[d]);
    const Floats y = all(c.towards_y[d]);
    const Floats along = along_x * x + along_y * y;
    const Floats across = along_x * y - along_y * x;
    high = most(high, along);
    low = least(low, along);
    side_high = most(side_high, across);
    side_low = least(side_low, across);
  }
  return !any((high < -kLimit) | (low > kLimit) | (side_high < -kLimit) | (side_low > kLimit));
}

// True when discs [begin, end) are a layer whose edge the node is at: no front, and neither is what lies below.
SPARSHA_INLINE bool reaches(const Cover& c, std::size_t begin, std::size_t end) {
  for (std::size_t d = begin; d < end; ++d) {
    const float near = kReaches * c.spacing[d];
    if (c.x[d] * c.x[d] + c.y[d] * c.y[d] < near * near) return true;
  }
  return false;
}

// The surface at the node by discs [begin, end): the mean of their points, each brought to the node along a surface
// whose slope and bending are those of the discs' normals.
SPARSHA_INLINE DiscLayer surface_of_group(const Cover& c, std::size_t begin, std::size_t end, float low, float high) {
  Floats sw{}, sx{}, sy{}, sa{}, sb{}, ss{}, xx{}, xy{}, yy{}, ax{}, ay{}, bx{}, by{};
  const auto lane_number = Ints{0, 1, 2, 3, 4, 5, 6, 7};
  const auto weights = [&](std::size_t p) __attribute__((always_inline)) {
    const Ints in = lane_number < static_cast<std::int32_t>(end - p);
    return masked(in, load(c.weight + p));
  };
  for (std::size_t p = begin; p < end; p += kLanes) {
    const Floats w = weights(p);
    sw += w;
    sx += w * load(c.x + p);
    sy += w * load(c.y + p);
    sa += w * load(c.slope_x + p);
    sb += w * load(c.slope_y + p);
    ss += w * load(c.spacing + p);
  }
  Eight sums = totals(sw, sx, sy, sa, sb, ss, Floats{}, Floats{});
  if (!(sums.at[0] > 1e-12F)) return {0.5F * (low + high), c.slope_x[begin], c.slope_y[begin], c.spacing[begin]};
  const float weight = sums.at[0];
  const float per_weight = 1.0F / weight;
  const float mean_x = sums.at[1] * per_weight;
  const float mean_y = sums.at[2] * per_weight;
  const float mean_a = sums.at[3] * per_weight;
  const float mean_b = sums.at[4] * per_weight;
  const float spacing = sums.at[5] * per_weight;
  for (std::size_t p = begin; p < end; p += kLanes) {
    const Floats w = weights(p);
    const Floats x = load(c.x + p) - mean_x;
    const Floats y = load(c.y + p) - mean_y;
    const Floats a = load(c.slope_x + p) - mean_a;
    const Floats b = load(c.slope_y + p) - mean_b;
    const Floats wx = w * x;
    const Floats wy = w * y;
    xx += wx * x;
    xy += wx * y;
    yy += wy * y;
    ax += wx * a;
    ay += wy * a;
    bx += wx * b;
    by += wy * b;
  }
  sums = totals(xx, xy, yy, ax, ay, bx, by, Floats{});
  // A little of the spacing squared keeps the bending of a thin support small.
  const float prior = 0.02F * weight * spacing * spacing;
  const float m_xx = sums.at[0] + prior;
  const float m_xy = sums.at[1];
  const float m_yy = sums.at[2] + prior;
  const float determinant = m_xx * m_yy - m_xy * m_xy;
  const float per = determinant > 0.0F ? 1.0F / determinant : 0.0F;
  const float bend_xx = (sums.at[3] * m_yy - sums.at[4] * m_xy) * per;
  const float bend_yy = (sums.at[6] * m_xx - sums.at[5] * m_xy) * per;
  const float bend_xy =
      0.5F * ((sums.at[4] * m_xx - sums.at[3] * m_xy) + (sums.at[5] * m_yy - sums.at[6] * m_xy)) * per;
  const float slope_x = mean_a - bend_xx * mean_x - bend_xy * mean_y;
  const float slope_y = mean_b - bend_xy * mean_x - bend_yy * mean_y;
  Floats sum{};
  const float reference = high;
  for (std::size_t p = begin; p < end; p += kLanes) {
    const Floats x = load(c.x + p);
    const Floats y = load(c.y + p);
    const Floats surface = slope_x * x + slope_y * y + 0.5F * (bend_xx * x * x + bend_yy * y * y) + bend_xy * x * y;
    sum += weights(p) * (load(c.point + p) - surface - reference);
  }
  const float height = reference + total(sum) * per_weight;
  const float margin = spacing * __builtin_sqrtf(1.0F + slope_x * slope_x + slope_y * slope_y);
  low -= margin;
  high += margin;
  return {height < low ? low : height > high ? high : height, slope_x, slope_y, spacing};
}

// What faces away of discs [begin, end), as a share of their weight: 1 all of it, -1 none.
SPARSHA_INLINE float away(const Cover& c, std::size_t begin, std::size_t end) {
  float weight = 1e-20F;
  float sum = 0.0F;
  for (std::size_t d = begin; d < end; ++d) {
    const float w = c.weight[d] + 1e-6F;
    weight += w;
    sum -= w * c.facing[d];
  }
  return sum / weight;
}

// Of a layer that surrounds the node: hardly a front if it faces away. `low` and `high` are its discs' heights.
SPARSHA_INLINE std::uint8_t decide_group(const DiscNodeKernel& k, const Cover& c, std::size_t begin, std::size_t end,
                                         float low, float high, float& height) {
  const float share = c.all_towards ? -1.0F : away(c, begin, end);
  height = surface_of_group(c, begin, end, low, high).height;
  if (share > k.most_away) return DiscNodeKernel::kAway;
  std::uint8_t verdict = DiscNodeKernel::kMeasured;
  if (share > -k.most_away) verdict |= DiscNodeKernel::kUnsure;
  return verdict;
}

// The verdict on the highest layer that surrounds the node, and whether the next below, at `next`, is hard to tell from
// it. `spacing` is that of the layer's lowest disc.
SPARSHA_INLINE std::uint8_t beware(const DiscNodeKernel& k, std::uint8_t verdict, float low, float next,
                                   float spacing) {
  const float apart = k.link_noise_m + k.link_spacings * spacing;
  const bool doubtful = low - next < kHardlyApart * apart && verdict != DiscNodeKernel::kAway;
  return doubtful ? static_cast<std::uint8_t>(verdict | DiscNodeKernel::kDoubtful) : verdict;
}

// Layers one after the other, where spacings have to tell them apart.
SPARSHA_APART std::uint8_t decide_by_sorting(const DiscNodeKernel& k, float x, float y, Cover& c, float& height) {
  sort_discs(c);
  read_discs(k, c.sorted, x, y, c.count - 1, c);
  std::size_t begin = 0;
  for (std::size_t d = 1; d <= c.count; ++d) {
    if (d < c.count) {
      const float spacing = c.spacing[d - 1] < c.spacing[d] ? c.spacing[d - 1] : c.spacing[d];
      if (c.height[d - 1] - c.height[d] <= k.link_noise_m + k.link_spacings * spacing) continue;
    }
    const bool layer = d - begin >= DiscNodeKernel::kLeastDiscs;
    if (layer && surround(c, begin, d)) {
      const std::uint8_t verdict = decide_group(k, c, begin, d, c.height[d - 1], c.height[begin], height);
      const float next = d < c.count ? c.height[d] : -__builtin_inff();
      return beware(k, verdict, c.height[d - 1], next, c.spacing[d - 1]);
    }
    if (layer && reaches(c, begin, d)) break;
    if (k.lines && surround(c, 0, d)) break;
    begin = d;
  }
  return DiscNodeKernel::kUnknown;
}

// Of all discs that were read: they are one layer.
SPARSHA_INLINE std::uint8_t decide_all(const DiscNodeKernel& k, const Cover& c, float low, float high, float& height) {
  if (!c.all_quadrants && !surround(c, 0, c.count)) return DiscNodeKernel::kUnknown;
  return decide_group(k, c, 0, c.count, low, high, height);
}

// The highest layer alone, where it surrounds the node and is so far above the next that no sorting is needed.
SPARSHA_INLINE std::uint8_t decide_by_layers(const DiscNodeKernel& k, float x, float y, Cover& c, float& height) {
  const std::size_t count = c.count;
  const float high = c.high;
  float low = 0.0F;
  float next = 0.0F;
  store(c.height + count, all(-__builtin_inff()));
  if (!narrow_to_group(k, c, low, next)) return decide_by_sorting(k, x, y, c, height);
  if (c.count >= DiscNodeKernel::kLeastDiscs) {
    read_discs(k, c.sorted, x, y, 0, c);
    const std::uint8_t verdict = decide_all(k, c, low, high, height);
    if (verdict != DiscNodeKernel::kUnknown) {
      std::size_t lowest = 0;
      while (c.height[lowest] != low) ++lowest;
      return beware(k, verdict, low, next, c.spacing[lowest]);
    }
    if (reaches(c, 0, c.count)) return DiscNodeKernel::kUnknown;
  }
  c.count = count;
  read_discs(k, c.found, x, y, 0, c);
  return decide_by_sorting(k, x, y, c, height);
}

// A layer that faces away is seen through a hole. Below the edge of a front, whose discs still cover the node, it is
// what every closed object has behind its silhouette. What lies deeper, as another form behind the hole, tells nothing.
SPARSHA_APART std::uint8_t tell_hole_from_edge(const DiscNodeKernel& k, const std::uint32_t* numbers, std::size_t count,
                                               float x, float y) {
  float towards = -__builtin_inff();
  float away = -__builtin_inff();
  float spacing = 0.0F;
  for (std::size_t d = 0; d < count; ++d) {
    const float* disc = k.records + sparsha::pipeline::kDiscRecord * numbers[d];
    const float height = disc[2] - (disc[3] * (disc[0] - x) + disc[4] * (disc[1] - y));
    if (disc[7] > 0.0F && height > towards) towards = height;
    if (disc[7] < 0.0F && height > away) {
      away = height;
      spacing = __builtin_sqrtf(disc[6]) * k.per_reach;
    }
  }
  const bool edge = towards >= away - (k.link_noise_m + k.link_spacings * spacing);
  return edge ? DiscNodeKernel::kEdge : DiscNodeKernel::kAway;
}

// Finds all discs that cover a node.
SPARSHA_INLINE void cover_node(const DiscNodeKernel& k, float x, float y, Cover& c) {
  c.count = 0;
  const auto column = static_cast<std::ptrdiff_t>((x - k.columns_x0_m) * k.per_side);
  const auto row = static_cast<std::ptrdiff_t>((y - k.columns_y0_m) * k.per_side);
  const auto first_row = static_cast<std::ptrdiff_t>(k.first_row);
  const std::ptrdiff_t last_row = static_cast<std::ptrdiff_t>(k.last_row) - 1;
  if (column < 0 || row < first_row || column >= static_cast<std::ptrdiff_t>(k.bins_x) || row > last_row) return;
  const std::ptrdiff_t rings = k.rings[row * static_cast<std::ptrdiff_t>(k.bins_x) + column];
  const std::ptrdiff_t last_column = static_cast<std::ptrdiff_t>(k.bins_x) - 1;
  const std::ptrdiff_t column0 = column > rings ? column - rings : 0;
  const std::ptrdiff_t column1 = column + rings < last_column ? column + rings : last_column;
  for (std::ptrdiff_t j = row > first_row + rings ? row - rings : first_row; j <= row + rings && j <= last_row; ++j) {
    const std::uint32_t* start = k.start + j * (last_column + 2);
    find_discs(k, start[column0], start[column1 + 1], x, y, c);
  }
}

SPARSHA_INLINE std::uint8_t decide_by_discs(const DiscNodeKernel& k, float x, float y, Cover& c, float& height) {
  cover_node(k, x, y, c);
  const std::size_t found = c.count;
  if (found < DiscNodeKernel::kLeastDiscs) return DiscNodeKernel::kUnknown;
  read_discs(k, c.found, x, y, 0, c);
  const bool one_layer = c.high - c.low <= k.link_noise_m + k.link_spacings * c.least_spacing;
  const std::uint8_t verdict =
      one_layer ? decide_all(k, c, c.low, c.high, height) : decide_by_layers(k, x, y, c, height);
  return verdict == DiscNodeKernel::kAway ? tell_hole_from_edge(k, c.found, found, x, y) : verdict;
}

SPARSHA_APART void fit_disc_nodes(const DiscNodeKernel& k, std::size_t j, float* height, std::uint8_t* verdict) {
  Cover cover = cover_in(k);
  const auto y = static_cast<float>(k.y0_m + static_cast<double>(j) * k.spacing_m);
  for (std::size_t i = 0; i < k.nx; ++i) {
    const auto x = static_cast<float>(k.x0_m + static_cast<double>(i) * k.spacing_m);
    verdict[i] = decide_by_discs(k, x, y, cover, height[i]);
  }
}

// Every layer that surrounds node (i, j), the highest first.
SPARSHA_APART std::size_t find_disc_layers(const DiscNodeKernel& k, std::size_t i, std::size_t j, DiscLayer* layers) {
  Cover c = cover_in(k);
  const auto x = static_cast<float>(k.x0_m + static_cast<double>(i) * k.spacing_m);
  const auto y = static_cast<float>(k.y0_m + static_cast<double>(j) * k.spacing_m);
  cover_node(k, x, y, c);
  if (c.count < DiscNodeKernel::kLeastDiscs) return 0;
  read_discs(k, c.found, x, y, 0, c);
  if (c.high - c.low <= k.link_noise_m + k.link_spacings * c.least_spacing) {
    if (!c.all_quadrants && !surround(c, 0, c.count)) return 0;
    layers[0] = surface_of_group(c, 0, c.count, c.low, c.high);
    return 1;
  }
  sort_discs(c);
  read_discs(k, c.sorted, x, y, c.count - 1, c);
  std::size_t found = 0;
  std::size_t begin = 0;
  for (std::size_t d = 1; d <= c.count && found < DiscNodeKernel::kMostLayers; ++d) {
    if (d < c.count) {
      const float spacing = c.spacing[d - 1] < c.spacing[d] ? c.spacing[d - 1] : c.spacing[d];
      if (c.height[d - 1] - c.height[d] <= k.link_noise_m + k.link_spacings * spacing) continue;
    }
    if (d - begin >= DiscNodeKernel::kLeastDiscs && surround(c, begin, d)) {
      layers[found++] = surface_of_group(c, begin, d, c.height[d - 1], c.height[begin]);
    }
    begin = d;
  }
  return found;
}

}  // namespace
