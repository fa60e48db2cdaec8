/* Picks a table of build kernels by instruction set. */
#include "build/kernels.h"

extern const kdr_build_kernels kdr_build_kernels_scalar;
#if defined(__x86_64__)
extern const kdr_build_kernels kdr_build_kernels_sse42, kdr_build_kernels_avx2, kdr_build_kernels_avx512;
#elif defined(__aarch64__)
extern const kdr_build_kernels kdr_build_kernels_neon;
#endif

const kdr_build_kernels *kdr_build_kernels_for(kdr_isa isa) {
    switch (isa) {
#if defined(__x86_64__)
    case KDR_ISA_SSE42: return &kdr_build_kernels_sse42;
    case KDR_ISA_AVX2: return &kdr_build_kernels_avx2;
    case KDR_ISA_AVX512: return &kdr_build_kernels_avx512;
#elif defined(__aarch64__)
    case KDR_ISA_NEON: return &kdr_build_kernels_neon;
#endif
    default: return &kdr_build_kernels_scalar;
    }
}
