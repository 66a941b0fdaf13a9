// The node kernel compiled for AVX2; chosen at run time, see project_kernel.cpp.
#if defined(__AVX2__)
#include "pipeline/grid/project_kernel_lanes.h"

namespace sparsha::pipeline {

void fit_row_avx2(const NodeKernel& kernel, std::size_t j, float* height, std::uint8_t* decided) {
  fit_row(kernel, j, height, decided);
}

}  // namespace sparsha::pipeline
#else
#include "pipeline/grid/project_kernel.h"

namespace sparsha::pipeline {

void fit_row_avx2(const NodeKernel& kernel, std::size_t j, float* height, std::uint8_t* decided) {
  fit_row_baseline(kernel, j, height, decided);
}

}  // namespace sparsha::pipeline
#endif
