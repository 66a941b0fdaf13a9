// For kernels that are compiled once as they are and once for AVX2. Defines macros alone, so that nothing shared gets
// into an object compiled for AVX2.
#pragma once

#if defined(__GNUC__) && defined(__x86_64__)
#define SPARSHA_AVX2 __attribute__((target("avx2")))
#define SPARSHA_INLINE static inline __attribute__((always_inline))
#else
#define SPARSHA_AVX2
#define SPARSHA_INLINE static inline
#endif
