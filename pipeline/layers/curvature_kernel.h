// Separable derivative filters on raw pointers, compiled for baseline x86-64 and for AVX2 with the same bits.
#pragma once

#include <cstddef>

namespace sparsha::pipeline::kernel {

/// 1-D weights at offsets 0..radius of the fit's value (even), slope (odd) and second derivative (even).
struct CurvatureFilter {
  int radius;
  const float* value;
  const float* slope;
  const float* bend;
};

/// Along the row: value, slope and second derivative of `source`, readable from -radius to count + radius.
using CurvatureAlong = void (*)(const CurvatureFilter& filter, const float* source, std::size_t count, float* value,
                                float* slope, float* bend);
/// Across rows of `stride` floats: from the row results to h_x, h_y, h_xx, h_xy, h_yy, unit: height per spacing
/// (squared).
using CurvatureAcross = void (*)(const CurvatureFilter& filter, const float* value, const float* slope,
                                 const float* bend, std::ptrdiff_t stride, std::size_t count, float* const* out);

struct CurvatureKernels {
  CurvatureAlong along;
  CurvatureAcross across;
};
[[nodiscard]] CurvatureKernels curvature_kernels_portable() noexcept;
[[nodiscard]] CurvatureKernels curvature_kernels_avx2() noexcept;
/// The fastest that this processor runs.
[[nodiscard]] CurvatureKernels curvature_kernels() noexcept;

}  // namespace sparsha::pipeline::kernel
