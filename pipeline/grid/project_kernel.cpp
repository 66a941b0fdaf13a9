// The kernels for every x86-64 (and other machines), and the choice between them and the AVX2 ones.
#include "pipeline/grid/project_kernel.h"

#include "pipeline/grid/project_lanes_table.h"

namespace sparsha::pipeline {

const ProjectionKernels& baseline_kernels() { return kKernels; }

const ProjectionKernels& fastest_kernels() {
#if defined(__x86_64__) && defined(__GNUC__)
  if (__builtin_cpu_supports("avx2")) return avx2_kernels();
#endif
  return baseline_kernels();
}

}  // namespace sparsha::pipeline
