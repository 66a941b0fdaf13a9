// The kernels for AVX-512: still eight lanes, but masks of one bit per lane and twice the registers; see
// kernels.cpp.
#include "pipeline/projection/simd/kernels.h"

#if defined(__AVX512F__) && defined(__AVX512VL__) && defined(__AVX512BW__) && defined(__AVX512DQ__)
#include "pipeline/projection/simd/table.h"

namespace sparsha::pipeline {
const ProjectionKernels& avx512_kernels() { return kKernels; }
}  // namespace sparsha::pipeline
#else
namespace sparsha::pipeline {
const ProjectionKernels& avx512_kernels() { return avx2_kernels(); }
}  // namespace sparsha::pipeline
#endif
