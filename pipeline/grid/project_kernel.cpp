// The node kernel for every x86-64 (and other machines), and the choice between it and the AVX2 one.
#include "pipeline/grid/project_kernel_lanes.h"

namespace sparsha::pipeline {

void fit_row_baseline(const NodeKernel& kernel, std::size_t j, float* height, std::uint8_t* decided) {
  fit_row(kernel, j, height, decided);
}

NodeKernelRow fastest_node_kernel() {
#if defined(__x86_64__) && defined(__GNUC__)
  if (__builtin_cpu_supports("avx2")) return fit_row_avx2;
#endif
  return fit_row_baseline;
}

}  // namespace sparsha::pipeline
