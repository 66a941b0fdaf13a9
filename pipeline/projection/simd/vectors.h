// Vectors of eight floats in the compiler's own notation, included once for each instruction set. No inline function or
// template leaves the file that includes it: a weak symbol compiled with AVX could be linked into code that runs
// without.
#pragma once

#include <cstddef>
#include <cstdint>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace {

typedef float Floats __attribute__((vector_size(32)));
typedef std::int32_t Ints __attribute__((vector_size(32)));
typedef std::uint32_t Bits __attribute__((vector_size(32)));
typedef double Doubles __attribute__((vector_size(32)));
typedef float Quad __attribute__((vector_size(16)));
typedef std::int32_t QuadInts __attribute__((vector_size(16)));
typedef std::int64_t Longs __attribute__((vector_size(32)));
typedef std::uint8_t Bytes __attribute__((vector_size(8)));

#define SPARSHA_INLINE static inline __attribute__((always_inline))
#define SPARSHA_APART static __attribute__((noinline))

constexpr std::size_t kLanes = 8;

SPARSHA_INLINE Floats load(const float* p) {
  Floats value;
  __builtin_memcpy(&value, p, sizeof(value));
  return value;
}
SPARSHA_INLINE Quad load_four(const float* p) {
  Quad value;
  __builtin_memcpy(&value, p, sizeof(value));
  return value;
}

// Asks for what a loop over a cloud reads 2 KB on: the processor prefetches within a page only, and pages are as
// small. Harmless beyond the end.
SPARSHA_INLINE void prefetch(const float* p) { __builtin_prefetch(p + 512); }

// Eight points' x and y, or the last `here` of a cloud and zeros.
struct Places {
  Floats x, y;
};
SPARSHA_INLINE Places load_places(const float* x, const float* y, std::size_t here) {
  Places places{};
  if (here == kLanes) {
    prefetch(x);
    prefetch(y);
    places = {load(x), load(y)};
  } else {
    __builtin_memcpy(&places.x, x, here * sizeof(float));
    __builtin_memcpy(&places.y, y, here * sizeof(float));
  }
  return places;
}

SPARSHA_INLINE void store(float* p, Floats value) { __builtin_memcpy(p, &value, sizeof(value)); }
SPARSHA_INLINE Floats all(float value) { return Floats{} + value; }
SPARSHA_INLINE Floats masked(Ints mask, Floats value) {
  return reinterpret_cast<Floats>(mask & reinterpret_cast<Ints>(value));
}
SPARSHA_INLINE Floats absolute(Floats value) {
  return reinterpret_cast<Floats>(reinterpret_cast<Ints>(value) & 0x7fffffff);
}

// Square roots of the lanes; the smaller and the larger of a and b, b when they do not compare.
#if defined(__AVX2__)
SPARSHA_INLINE Floats root(Floats a) { return (Floats)_mm256_sqrt_ps((__m256)a); }
SPARSHA_INLINE Floats least(Floats a, Floats b) { return (Floats)_mm256_min_ps((__m256)a, (__m256)b); }
SPARSHA_INLINE Floats most(Floats a, Floats b) { return (Floats)_mm256_max_ps((__m256)a, (__m256)b); }
#elif defined(__SSE2__)
struct Halves {
  __m128 low, high;
};
SPARSHA_INLINE Floats root(Floats a) {
  const auto x = __builtin_bit_cast(Halves, a);
  return __builtin_bit_cast(Floats, Halves{_mm_sqrt_ps(x.low), _mm_sqrt_ps(x.high)});
}
SPARSHA_INLINE Floats least(Floats a, Floats b) {
  const auto x = __builtin_bit_cast(Halves, a);
  const auto y = __builtin_bit_cast(Halves, b);
  return __builtin_bit_cast(Floats, Halves{_mm_min_ps(x.low, y.low), _mm_min_ps(x.high, y.high)});
}
SPARSHA_INLINE Floats most(Floats a, Floats b) {
  const auto x = __builtin_bit_cast(Halves, a);
  const auto y = __builtin_bit_cast(Halves, b);
  return __builtin_bit_cast(Floats, Halves{_mm_max_ps(x.low, y.low), _mm_max_ps(x.high, y.high)});
}
#else
SPARSHA_INLINE Floats root(Floats a) {
  Floats r{};
  for (std::size_t lane = 0; lane < kLanes; ++lane) r[lane] = __builtin_sqrtf(a[lane]);
  return r;
}
SPARSHA_INLINE Floats least(Floats a, Floats b) { return a < b ? a : b; }
SPARSHA_INLINE Floats most(Floats a, Floats b) { return a > b ? a : b; }
#endif
SPARSHA_INLINE Floats choose(Ints mask, Floats yes, Floats no) {
#if defined(__AVX2__)
  return (Floats)_mm256_blendv_ps((__m256)no, (__m256)yes, (__m256)mask);
#else
  return reinterpret_cast<Floats>((mask & reinterpret_cast<Ints>(yes)) | (~mask & reinterpret_cast<Ints>(no)));
#endif
}

// Sum of the lanes in a fixed order.
SPARSHA_INLINE float total(Floats a) {
  const Floats half = a + __builtin_shufflevector(a, a, 4, 5, 6, 7, 0, 1, 2, 3);
  const Floats quarter = half + __builtin_shufflevector(half, half, 2, 3, 0, 1, 6, 7, 4, 5);
  return quarter[0] + quarter[1];
}
SPARSHA_INLINE std::int32_t total(Ints a) {
  const Ints half = a + __builtin_shufflevector(a, a, 4, 5, 6, 7, 0, 1, 2, 3);
  return (half[0] + half[1]) + (half[2] + half[3]);
}
SPARSHA_INLINE float largest(Floats a) {
  const Floats half = most(a, __builtin_shufflevector(a, a, 4, 5, 6, 7, 0, 1, 2, 3));
  const Floats quarter = most(half, __builtin_shufflevector(half, half, 2, 3, 0, 1, 6, 7, 4, 5));
  return quarter[0] > quarter[1] ? quarter[0] : quarter[1];
}

struct Eight {
  float at[8];
};

// The sums of eight vectors, as total() would not order them but always in the same order.
SPARSHA_INLINE Floats by_pairs(Floats a, Floats b) {
  return __builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13) +
         __builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15);
}
SPARSHA_INLINE Floats by_quarters(Floats a, Floats b) {
  return __builtin_shufflevector(a, b, 0, 1, 8, 9, 4, 5, 12, 13) +
         __builtin_shufflevector(a, b, 2, 3, 10, 11, 6, 7, 14, 15);
}
SPARSHA_INLINE Floats by_halves(Floats a, Floats b) {
  return __builtin_shufflevector(a, b, 0, 1, 2, 3, 8, 9, 10, 11) +
         __builtin_shufflevector(a, b, 4, 5, 6, 7, 12, 13, 14, 15);
}
SPARSHA_INLINE Eight totals(Floats a, Floats b, Floats c, Floats d, Floats e, Floats f, Floats g, Floats h) {
  const Floats abcd = by_quarters(by_pairs(a, b), by_pairs(c, d));
  const Floats efgh = by_quarters(by_pairs(e, f), by_pairs(g, h));
  Eight sums;
  store(sums.at, by_halves(abcd, efgh));
  return sums;
}

// Eight vectors as rows become columns.
SPARSHA_INLINE void transpose(Floats* rows) {
  Floats pairs[8];
  for (int r = 0; r < 4; ++r) {
    const Floats a = rows[2 * r];
    const Floats b = rows[2 * r + 1];
    pairs[2 * r] = __builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13);
    pairs[2 * r + 1] = __builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15);
  }
  for (int h = 0; h < 2; ++h) {
    const Floats a = __builtin_shufflevector(pairs[h], pairs[h + 2], 0, 1, 8, 9, 4, 5, 12, 13);
    const Floats b = __builtin_shufflevector(pairs[h], pairs[h + 2], 2, 3, 10, 11, 6, 7, 14, 15);
    const Floats c = __builtin_shufflevector(pairs[h + 4], pairs[h + 6], 0, 1, 8, 9, 4, 5, 12, 13);
    const Floats d = __builtin_shufflevector(pairs[h + 4], pairs[h + 6], 2, 3, 10, 11, 6, 7, 14, 15);
    rows[2 * h] = __builtin_shufflevector(a, c, 0, 1, 2, 3, 8, 9, 10, 11);
    rows[2 * h + 1] = __builtin_shufflevector(b, d, 0, 1, 2, 3, 8, 9, 10, 11);
    rows[2 * h + 4] = __builtin_shufflevector(a, c, 4, 5, 6, 7, 12, 13, 14, 15);
    rows[2 * h + 5] = __builtin_shufflevector(b, d, 4, 5, 6, 7, 12, 13, 14, 15);
  }
}

// Bit by bit which lanes of a mask are set.
SPARSHA_INLINE std::uint32_t lanes_of(Ints mask) {
#if defined(__AVX2__)
  return static_cast<std::uint32_t>(_mm256_movemask_ps((__m256)mask));
#elif defined(__SSE2__)
  const auto half = __builtin_bit_cast(Halves, mask);
  return static_cast<std::uint32_t>(_mm_movemask_ps(half.low)) | static_cast<std::uint32_t>(_mm_movemask_ps(half.high))
                                                                     << 4U;
#else
  std::uint32_t bits = 0;
  for (std::uint32_t lane = 0; lane < kLanes; ++lane) bits |= (mask[lane] != 0 ? 1U : 0U) << lane;
  return bits;
#endif
}
// Writes first + lane for each set lane and returns how many; up to eight values are written.
SPARSHA_INLINE std::size_t write_lanes(std::uint32_t lanes, std::uint32_t first, std::uint32_t* to) {
#if defined(__AVX512VL__)
  const __m256i numbers =
      _mm256_add_epi32(_mm256_set1_epi32(static_cast<int>(first)), _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7));
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(to),
                      _mm256_maskz_compress_epi32(static_cast<__mmask8>(lanes), numbers));
#else
  std::size_t count = 0;
  for (std::uint32_t left = lanes; left != 0; left &= left - 1) {
    to[count++] = first + static_cast<std::uint32_t>(__builtin_ctz(left));
  }
#endif
  return static_cast<std::size_t>(__builtin_popcount(lanes));
}

SPARSHA_INLINE bool any(Ints mask) { return lanes_of(mask) != 0; }

}  // namespace
