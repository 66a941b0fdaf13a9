// The inner loop of the bilateral filter on raw pointers: compiled twice, for baseline x86-64 and for AVX2, from one
// source without contraction, so that both give the same bits.
#pragma once

#include <cstddef>

namespace sparsha::pipeline::kernel {

/// Adds the weights and weighted differences of the pairs (a[i], b[i]), i < count, to both of their nodes:
/// w = 2^-(range d^2 + space), d = b[i] - a[i]; weights_a[i] += w, sums_a[i] += w d, weights_b[i] += w,
/// sums_b[i] -= w d. The relative error of w is below 1e-6; what lies below 2^-100 counts as that. All heights are
/// finite. No array overlaps another, but a may overlap b.
using BilateralPairs = void (*)(const float* a, const float* b, std::size_t count, float range, float space,
                                float* weights_a, float* sums_a, float* weights_b, float* sums_b);
void bilateral_pairs_portable(const float* a, const float* b, std::size_t count, float range, float space,
                              float* weights_a, float* sums_a, float* weights_b, float* sums_b);
void bilateral_pairs_avx2(const float* a, const float* b, std::size_t count, float range, float space, float* weights_a,
                          float* sums_a, float* weights_b, float* sums_b);
/// The fastest that this processor runs.
[[nodiscard]] BilateralPairs bilateral_pairs() noexcept;

/// exp(-t) as the continued envelope takes it, t in [0, 64], relative error below 1e-7; larger t and NaN count as 64.
[[nodiscard]] float exp_minus(float t) noexcept;

}  // namespace sparsha::pipeline::kernel
