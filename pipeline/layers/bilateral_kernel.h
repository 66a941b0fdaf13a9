// The inner loop of the bilateral filter on raw pointers: compiled twice, for baseline x86-64 and for AVX2, from one
// source without contraction, so that both give the same bits.
#pragma once

#include <cstddef>

namespace sparsha::pipeline::kernel {

/// A neighbour: where it lies in memory relative to the centre, and its spatial weight.
struct BilateralTap {
  std::ptrdiff_t offset;
  float weight;
};

/// out[i] = centre[i] + sum_k w_k d_k / (1 + sum_k w_k), d_k = centre[i + offset_k] - centre[i],
/// w_k = weight_k exp(-range * d_k^2), range = 1 / (2 sigma_range^2); NaN neighbours count nothing, a NaN centre gives
/// NaN. `sums` is scratch for 2 * count floats. All taps must be readable around [centre, centre + count).
using BilateralRow = void (*)(const float* centre, std::size_t count, const BilateralTap* taps, std::size_t tap_count,
                              float range, float* sums, float* out);
void bilateral_row_portable(const float* centre, std::size_t count, const BilateralTap* taps, std::size_t tap_count,
                            float range, float* sums, float* out);
void bilateral_row_avx2(const float* centre, std::size_t count, const BilateralTap* taps, std::size_t tap_count,
                        float range, float* sums, float* out);
/// The fastest that this processor runs.
[[nodiscard]] BilateralRow bilateral_row() noexcept;

/// exp(-t) as the filter computes it, t in [0, 64], relative error below 1e-7; larger t and NaN count as 64.
[[nodiscard]] float exp_minus(float t) noexcept;

}  // namespace sparsha::pipeline::kernel
