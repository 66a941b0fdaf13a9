// The kernels for every x86-64 (and other machines), and the choice between them and the AVX ones.
#include "pipeline/projection/simd/kernels.h"

#include "pipeline/projection/simd/table.h"

namespace sparsha::pipeline {

const ProjectionKernels& baseline_kernels() { return kKernels; }

bool has_avx512() {
#if defined(__x86_64__) && defined(__GNUC__)
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
         __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq");
#else
  return false;
#endif
}

const ProjectionKernels& fastest_kernels() {
#if defined(__x86_64__) && defined(__GNUC__)
  if (has_avx512()) return avx512_kernels();
  if (__builtin_cpu_supports("avx2")) return avx2_kernels();
#endif
  return baseline_kernels();
}

}  // namespace sparsha::pipeline
