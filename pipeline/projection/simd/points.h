// What is done to every point of a cloud, included once for each instruction set.
#pragma once

#include "pipeline/projection/simd/kernels.h"
#include "pipeline/projection/simd/vectors.h"

namespace {

// Four points' x, y and z from memory where each has its own four floats.
struct FourPoints {
  Quad x, y, z;
};
SPARSHA_INLINE FourPoints transpose(const float* p, std::size_t stride) {
  prefetch(p);
  const Quad a = load_four(p);
  const Quad b = load_four(p + stride);
  const Quad c = load_four(p + 2 * stride);
  const Quad d = load_four(p + 3 * stride);
  const Quad ab_low = __builtin_shufflevector(a, b, 0, 4, 1, 5);
  const Quad cd_low = __builtin_shufflevector(c, d, 0, 4, 1, 5);
  const Quad ab_high = __builtin_shufflevector(a, b, 2, 6, 3, 7);
  const Quad cd_high = __builtin_shufflevector(c, d, 2, 6, 3, 7);
  return {__builtin_shufflevector(ab_low, cd_low, 0, 1, 4, 5), __builtin_shufflevector(ab_low, cd_low, 2, 3, 6, 7),
          __builtin_shufflevector(ab_high, cd_high, 0, 1, 4, 5)};
}

SPARSHA_INLINE Quad affine(const double* row, Doubles x, Doubles y, Doubles z) {
  return __builtin_convertvector(row[0] * x + row[1] * y + row[2] * z + row[3], Quad);
}

SPARSHA_INLINE Quad lower(Quad a, Quad b) { return a < b ? a : b; }
SPARSHA_INLINE Quad higher(Quad a, Quad b) { return a > b ? a : b; }

SPARSHA_INLINE void orient(const float* xyz, std::size_t stride, std::size_t count, const double* matrix, float* x,
                           float* y, float* z, float* low, float* high) {
  float* const out[3] = {x, y, z};
  Quad least_of[3];
  Quad most_of[3];
  for (int r = 0; r < 3; ++r) {
    least_of[r] = Quad{} + __builtin_inff();
    most_of[r] = Quad{} - __builtin_inff();
  }
  std::size_t k = 0;
  if (stride >= 4) {
    for (; k + 4 <= count; k += 4) {
      const FourPoints p = transpose(xyz + k * stride, stride);
      const auto px = __builtin_convertvector(p.x, Doubles);
      const auto py = __builtin_convertvector(p.y, Doubles);
      const auto pz = __builtin_convertvector(p.z, Doubles);
      for (int r = 0; r < 3; ++r) {
        const Quad rounded = affine(matrix + 4 * r, px, py, pz);
        __builtin_memcpy(out[r] + k, &rounded, sizeof(rounded));
        least_of[r] = lower(rounded, least_of[r]);
        most_of[r] = higher(rounded, most_of[r]);
      }
    }
  }
  for (int r = 0; r < 3; ++r) {
    low[r] = least_of[r][0];
    high[r] = most_of[r][0];
    for (int lane = 1; lane < 4; ++lane) {
      if (least_of[r][lane] < low[r]) low[r] = least_of[r][lane];
      if (most_of[r][lane] > high[r]) high[r] = most_of[r][lane];
    }
  }
  for (; k < count; ++k) {
    const float* p = xyz + k * stride;
    for (int r = 0; r < 3; ++r) {
      const double* row = matrix + 4 * r;
      const auto rounded = static_cast<float>(row[0] * static_cast<double>(p[0]) + row[1] * static_cast<double>(p[1]) +
                                              row[2] * static_cast<double>(p[2]) + row[3]);
      out[r][k] = rounded;
      if (rounded < low[r]) low[r] = rounded;
      if (rounded > high[r]) high[r] = rounded;
    }
  }
}

// Writes p + lane for the first `lanes` lanes of a mask; returns how many are set.
SPARSHA_INLINE std::size_t list(Ints mask, std::size_t p, std::size_t lanes, std::uint32_t* drawn) {
  std::size_t found = 0;
  for (std::uint32_t bits = lanes_of(mask) & ((1U << lanes) - 1U); bits != 0; bits &= bits - 1) {
    drawn[found++] = static_cast<std::uint32_t>(p) + static_cast<std::uint32_t>(__builtin_ctz(bits));
  }
  return found;
}

// Writes which points a hash of the coordinates draws; the same point is drawn wherever it stands in the cloud.
SPARSHA_INLINE std::size_t draw(const float* xyz, std::size_t stride, std::size_t count, std::uint32_t limit,
                                std::uint32_t* drawn) {
  std::size_t found = 0;
  for (std::size_t k = 0; k < count; k += kLanes) {
    Floats x{};
    Floats y{};
    Floats z{};
    const std::size_t here = count - k < kLanes ? count - k : kLanes;
    if (here == kLanes && stride >= 4) {
      const FourPoints low = transpose(xyz + k * stride, stride);
      const FourPoints high = transpose(xyz + (k + 4) * stride, stride);
      x = __builtin_shufflevector(low.x, high.x, 0, 1, 2, 3, 4, 5, 6, 7);
      y = __builtin_shufflevector(low.y, high.y, 0, 1, 2, 3, 4, 5, 6, 7);
      z = __builtin_shufflevector(low.z, high.z, 0, 1, 2, 3, 4, 5, 6, 7);
    } else {
      for (std::size_t lane = 0; lane < here; ++lane) {
        x[lane] = xyz[(k + lane) * stride];
        y[lane] = xyz[(k + lane) * stride + 1];
        z[lane] = xyz[(k + lane) * stride + 2];
      }
    }
    Bits h = reinterpret_cast<Bits>(x) * 0x9e3779b1U ^ reinterpret_cast<Bits>(y) * 0x85ebca77U ^
             reinterpret_cast<Bits>(z) * 0xc2b2ae3dU;
    h = (h ^ (h >> 15)) * 0x2c1b3c6dU;
    h = (h ^ (h >> 12)) * 0x297a2d39U;
    const Ints hit = reinterpret_cast<Ints>(h <= limit);
    found += list(hit, k, here, drawn + found);
  }
  return found;
}

SPARSHA_INLINE std::size_t draw_of_blocks(const sparsha::pipeline::BlockKernel& k, const float* x, const float* y,
                                          std::size_t count, std::uint32_t* drawn) {
  constexpr float kMost = 1e9F;
  std::size_t found = 0;
  for (std::size_t p = 0; p < count; p += kLanes) {
    const std::size_t here = count - p < kLanes ? count - p : kLanes;
    const Places places = load_places(x + p, y + p, here);
    const Floats u = (places.x - k.x0_m) * k.per_m;
    const Floats v = (places.y - k.y0_m) * k.per_m;
    const Ints inside = (u >= 0.0F) & (v >= 0.0F) & (u < kMost) & (v < kMost);
    const auto i = reinterpret_cast<Bits>(__builtin_convertvector(masked(inside, u), Ints));
    const auto j = reinterpret_cast<Bits>(__builtin_convertvector(masked(inside, v), Ints));
    Bits h = i * 0x9e3779b1U ^ j * 0x85ebca77U;
    h = (h ^ (h >> 15)) * 0x2c1b3c6dU;
    h = (h ^ (h >> 12)) * 0x297a2d39U;
    h ^= h >> 15;
    const Ints hit = inside & reinterpret_cast<Ints>(h <= k.limit);
    found += list(hit, p, here, drawn + found);
  }
  return found;
}

SPARSHA_INLINE std::size_t draw_beyond(const sparsha::pipeline::BorderKernel& k, const float* x, const float* y,
                                       std::size_t count, std::uint32_t* drawn) {
  std::size_t found = 0;
  for (std::size_t p = 0; p < count; p += kLanes) {
    const std::size_t here = count - p < kLanes ? count - p : kLanes;
    const auto [px, py] = load_places(x + p, y + p, here);
    const Ints beyond = ~((px > k.left_m) & (px < k.right_m) & (py > k.bottom_m) & (py < k.top_m));
    found += list(beyond, p, here, drawn + found);
  }
  return found;
}

// Heights of eight nodes.
SPARSHA_INLINE Floats gather_nodes(const float* height, Ints node) {
#if defined(__AVX2__)
  return (Floats)_mm256_i32gather_ps(height, (__m256i)node, 4);
#else
  return Floats{height[node[0]], height[node[1]], height[node[2]], height[node[3]],
                height[node[4]], height[node[5]], height[node[6]], height[node[7]]};
#endif
}

SPARSHA_INLINE void classify(const sparsha::pipeline::ClassifyKernel& k, const float* x, const float* y, const float* z,
                             std::size_t count, std::uint8_t* point_class) {
  constexpr float kInfinity = __builtin_inff();
  for (std::size_t p = 0; p + kLanes <= count; p += kLanes) {
    prefetch(x + p);
    prefetch(y + p);
    prefetch(z + p);
    const Floats u = (load(x + p) - k.x0_m) * k.per_m;
    const Floats v = (load(y + p) - k.y0_m) * k.per_m;
    const Ints inner = (u >= 0.0F) & (v >= 0.0F) & (u < k.last_u) & (v < k.last_v);
    const Ints i = __builtin_convertvector(masked(inner, u), Ints);
    const Ints j = __builtin_convertvector(masked(inner, v), Ints);
    const Ints node = j * k.nx + i;
    Floats low = all(kInfinity);
    Floats high = all(-kInfinity);
    const Ints corners[4] = {node, node + 1, node + k.nx, node + k.nx + 1};
    for (int c = 0; c < 4; ++c) {
      // Unknown heights are NaN, and the second of the two is kept where they do not compare.
      const Floats height = gather_nodes(k.height, corners[c]);
      low = least(height, low);
      high = most(height, high);
    }
    const Floats here = load(z + p);
    const Ints known = inner & (low <= high);
    const Ints outlier = here > high + k.gap_m;
    const Ints occluded = here < low - k.gap_m;
    const Ints code = (known & ((outlier & k.outlier) | (occluded & k.occluded))) | (~known & k.undecided);
    const auto codes = __builtin_convertvector(code, Bytes);
    __builtin_memcpy(point_class + p, &codes, sizeof(codes));
  }
  for (std::size_t p = count / kLanes * kLanes; p < count; ++p) point_class[p] = static_cast<std::uint8_t>(k.undecided);
}

}  // namespace
