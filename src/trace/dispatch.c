/* Picks a table of traversals by instruction set. */
#include "trace/trace.h"

extern const kdr_traversals kdr_traversals_scalar;
#if defined(__x86_64__)
extern const kdr_traversals kdr_traversals_sse42, kdr_traversals_avx2, kdr_traversals_avx512;
#elif defined(__aarch64__)
extern const kdr_traversals kdr_traversals_neon;
#endif

const kdr_traversals *kdr_traversals_for(kdr_isa isa) {
    switch (isa) {
#if defined(__x86_64__)
    case KDR_ISA_SSE42: return &kdr_traversals_sse42;
    case KDR_ISA_AVX2: return &kdr_traversals_avx2;
    case KDR_ISA_AVX512: return &kdr_traversals_avx512;
#elif defined(__aarch64__)
    case KDR_ISA_NEON: return &kdr_traversals_neon;
#endif
    default: return &kdr_traversals_scalar;
    }
}
