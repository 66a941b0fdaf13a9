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

/// 2^-t, t >= 0: 2^-n 2^f, n = round(t), f = n - t, by the polynomial of fifth degree with the least relative error on
/// |f| <= 1/2, which is 7.5e-8. As above, bits compare like the non-negative floats that they are.
SPARSHA_INLINE float exp2_minus_inline(float t) {
  constexpr int kBitsOf100 = 0x42C80000;
  constexpr float kRound = 12582912.0F;  // 1.5 * 2^23, whose lowest nine bits are zero
  const int bits = __builtin_bit_cast(int, t);
  t = __builtin_bit_cast(float, bits < kBitsOf100 ? bits : kBitsOf100);
  const float shifted = t + kRound;
  const float f = (shifted - kRound) - t;
  float q = 0.0013276472F;
  q = q * f + 0.00967554133F;
  q = q * f + 0.0555071327F;
  q = q * f + 0.240221197F;
  q = q * f + 0.693146967F;
  q = q * f + 1.00000007F;
  const unsigned exponent = __builtin_bit_cast(unsigned, shifted) << 23U;
  return __builtin_bit_cast(float, __builtin_bit_cast(unsigned, q) - exponent);
}

SPARSHA_INLINE void bilateral_pairs_inline(const float* a, const float* b, std::size_t count, float range, float space,
                                           float* __restrict weights_a, float* __restrict sums_a,
                                           float* __restrict weights_b, float* __restrict sums_b) {
  for (std::size_t i = 0; i < count; ++i) {
    const float difference = b[i] - a[i];
    const float weight = exp2_minus_inline(difference * difference * range + space);
    const float product = weight * difference;
    weights_a[i] += weight;
    sums_a[i] += product;
    weights_b[i] += weight;
    sums_b[i] -= product;
  }
}

void bilateral_pairs_portable(const float* a, const float* b, std::size_t count, float range, float space,
                              float* weights_a, float* sums_a, float* weights_b, float* sums_b) {
  bilateral_pairs_inline(a, b, count, range, space, weights_a, sums_a, weights_b, sums_b);
}

SPARSHA_AVX2 void bilateral_pairs_avx2(const float* a, const float* b, std::size_t count, float range, float space,
                                       float* weights_a, float* sums_a, float* weights_b, float* sums_b) {
  bilateral_pairs_inline(a, b, count, range, space, weights_a, sums_a, weights_b, sums_b);
}

BilateralPairs bilateral_pairs() noexcept {
#if defined(__GNUC__) && defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) return bilateral_pairs_avx2;
#endif
  return bilateral_pairs_portable;
}

float exp_minus(float t) noexcept { return exp_minus_inline(t); }

}  // namespace sparsha::pipeline::kernel
