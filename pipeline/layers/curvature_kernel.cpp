// Even filters are folded about their centre, odd ones too; one pass over the neighbours serves all three results.
#include "pipeline/layers/curvature_kernel.h"

#include "pipeline/layers/vector_target.h"

namespace sparsha::pipeline::kernel {

SPARSHA_INLINE void along_inline(const CurvatureFilter& filter, const float* __restrict source, std::size_t count,
                                 float* __restrict value, float* __restrict slope, float* __restrict bend) {
  for (std::size_t i = 0; i < count; ++i) {
    value[i] = filter.value[0] * source[i];
    slope[i] = 0.0F;
    bend[i] = filter.bend[0] * source[i];
  }
  for (int k = 1; k <= filter.radius; ++k) {
    const float* __restrict left = source - k;
    const float* __restrict right = source + k;
    const float v = filter.value[k], s = filter.slope[k], b = filter.bend[k];
    for (std::size_t i = 0; i < count; ++i) {
      const float sum = right[i] + left[i];
      value[i] += v * sum;
      bend[i] += b * sum;
      slope[i] += s * (right[i] - left[i]);
    }
  }
}

SPARSHA_INLINE void across_inline(const CurvatureFilter& filter, const float* __restrict value,
                                  const float* __restrict slope, const float* __restrict bend, std::ptrdiff_t stride,
                                  std::size_t count, float* const* out) {
  float* __restrict h_x = out[0];
  float* __restrict h_y = out[1];
  float* __restrict h_xx = out[2];
  float* __restrict h_xy = out[3];
  float* __restrict h_yy = out[4];
  for (std::size_t i = 0; i < count; ++i) {
    h_x[i] = filter.value[0] * slope[i];
    h_y[i] = 0.0F;
    h_xx[i] = filter.value[0] * bend[i];
    h_xy[i] = 0.0F;
    h_yy[i] = filter.bend[0] * value[i];
  }
  for (int k = 1; k <= filter.radius; ++k) {
    const std::ptrdiff_t step = k * stride;
    const float v = filter.value[k], s = filter.slope[k], b = filter.bend[k];
    const float* __restrict value_up = value + step;
    const float* __restrict value_down = value - step;
    const float* __restrict slope_up = slope + step;
    const float* __restrict slope_down = slope - step;
    const float* __restrict bend_up = bend + step;
    const float* __restrict bend_down = bend - step;
    for (std::size_t i = 0; i < count; ++i) {
      h_x[i] += v * (slope_up[i] + slope_down[i]);
      h_xx[i] += v * (bend_up[i] + bend_down[i]);
      h_xy[i] += s * (slope_up[i] - slope_down[i]);
      h_y[i] += s * (value_up[i] - value_down[i]);
      h_yy[i] += b * (value_up[i] + value_down[i]);
    }
  }
}

static void along_portable(const CurvatureFilter& filter, const float* source, std::size_t count, float* value,
                           float* slope, float* bend) {
  along_inline(filter, source, count, value, slope, bend);
}
static void across_portable(const CurvatureFilter& filter, const float* value, const float* slope, const float* bend,
                            std::ptrdiff_t stride, std::size_t count, float* const* out) {
  across_inline(filter, value, slope, bend, stride, count, out);
}
SPARSHA_AVX2 static void along_avx2(const CurvatureFilter& filter, const float* source, std::size_t count, float* value,
                                    float* slope, float* bend) {
  along_inline(filter, source, count, value, slope, bend);
}
SPARSHA_AVX2 static void across_avx2(const CurvatureFilter& filter, const float* value, const float* slope,
                                     const float* bend, std::ptrdiff_t stride, std::size_t count, float* const* out) {
  across_inline(filter, value, slope, bend, stride, count, out);
}

CurvatureKernels curvature_kernels_portable() noexcept { return {along_portable, across_portable}; }
CurvatureKernels curvature_kernels_avx2() noexcept { return {along_avx2, across_avx2}; }

CurvatureKernels curvature_kernels() noexcept {
#if defined(__GNUC__) && defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) return curvature_kernels_avx2();
#endif
  return curvature_kernels_portable();
}

}  // namespace sparsha::pipeline::kernel
