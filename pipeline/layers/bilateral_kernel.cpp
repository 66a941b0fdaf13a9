// Written for the vectoriser: branch-free, one array per operand, no library call. Includes nothing that could put a
// shared inline function into an object compiled for AVX2.
#include "pipeline/layers/bilateral_kernel.h"

#include "pipeline/layers/vector_target.h"

namespace sparsha::pipeline::kernel {

/// exp(-t) = 2^-n exp(r), n = round(t / ln 2), |r| <= ln 2 / 2; ln 2 in two parts (Cody & Waite 1980), Taylor to r^7,
/// whose remainder is 5e-9.
SPARSHA_INLINE float exp_minus_inline(float t) {
  constexpr int kBitsOf64 = 0x42800000;
  constexpr float kRound = 12582912.0F;  // 1.5 * 2^23: adding it rounds to an integer
  // e^-64 weighs nothing, and what follows stays clear of slow denormal numbers. Bits compare like the non-negative
  // floats that they are, and leave the vectoriser no floating-point trap to preserve.
  const int bits = __builtin_bit_cast(int, t);
  t = __builtin_bit_cast(float, bits < kBitsOf64 ? bits : kBitsOf64);
  const float shifted = t * 1.44269504F + kRound;
  const float n = shifted - kRound;
  const float r = (n * 0.693359375F - t) + n * -2.12194440e-4F;
  float q = 1.0F / 5040.0F;
  q = q * r + 1.0F / 720.0F;
  q = q * r + 1.0F / 120.0F;
  q = q * r + 1.0F / 24.0F;
  q = q * r + 1.0F / 6.0F;
  q = q * r + 0.5F;
  const float value = 1.0F + (r + (r * r) * q);
  const int exponent = 127 - (__builtin_bit_cast(int, shifted) - 0x4B400000);
  return value * __builtin_bit_cast(float, exponent << 23);
}

SPARSHA_INLINE void bilateral_row_inline(const float* __restrict centre, std::size_t count, const BilateralTap* taps,
                                         std::size_t tap_count, float range, float* __restrict sums,
                                         float* __restrict out) {
  constexpr int kBitsOfInfinity = 0x7F800000;
  float* __restrict weighted = sums;
  float* __restrict weights = sums + count;
  for (std::size_t i = 0; i < count; ++i) {
    weighted[i] = 0.0F;
    weights[i] = 1.0F;
  }
  for (std::size_t k = 0; k < tap_count; ++k) {
    const float* __restrict neighbour = centre + taps[k].offset;
    const float spatial = taps[k].weight;
    for (std::size_t i = 0; i < count; ++i) {
      const float difference = neighbour[i] - centre[i];
      const float weight = spatial * exp_minus_inline(difference * difference * range);
      const float product = weight * difference;
      // All ones where the difference is known: a NaN's magnitude has larger bits than infinity.
      const int known = ((__builtin_bit_cast(int, difference) & 0x7FFFFFFF) - (kBitsOfInfinity + 1)) >> 31;
      weights[i] += __builtin_bit_cast(float, __builtin_bit_cast(int, weight) & known);
      weighted[i] += __builtin_bit_cast(float, __builtin_bit_cast(int, product) & known);
    }
  }
  for (std::size_t i = 0; i < count; ++i) out[i] = centre[i] + weighted[i] / weights[i];
}

void bilateral_row_portable(const float* centre, std::size_t count, const BilateralTap* taps, std::size_t tap_count,
                            float range, float* sums, float* out) {
  bilateral_row_inline(centre, count, taps, tap_count, range, sums, out);
}

SPARSHA_AVX2 void bilateral_row_avx2(const float* centre, std::size_t count, const BilateralTap* taps,
                                     std::size_t tap_count, float range, float* sums, float* out) {
  bilateral_row_inline(centre, count, taps, tap_count, range, sums, out);
}

BilateralRow bilateral_row() noexcept {
#if defined(__GNUC__) && defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) return bilateral_row_avx2;
#endif
  return bilateral_row_portable;
}

float exp_minus(float t) noexcept { return exp_minus_inline(t); }

}  // namespace sparsha::pipeline::kernel
