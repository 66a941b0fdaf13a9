// The kernels compiled for AVX2; chosen at run time, see kernels.cpp.
#include "pipeline/projection/simd/kernels.h"

#if defined(__AVX2__)
#include "pipeline/projection/simd/table.h"

namespace sparsha::pipeline {
const ProjectionKernels& avx2_kernels() { return kKernels; }
}  // namespace sparsha::pipeline
#else
namespace sparsha::pipeline {
const ProjectionKernels& avx2_kernels() { return baseline_kernels(); }
}  // namespace sparsha::pipeline
#endif
