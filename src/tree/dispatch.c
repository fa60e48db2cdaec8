/* Picks a table by instruction set. */
#include "tree/unsplit.h"

extern const kdr_unsplit kdr_unsplit_scalar;
#if defined(__x86_64__)
extern const kdr_unsplit kdr_unsplit_sse42, kdr_unsplit_avx2, kdr_unsplit_avx512;
#elif defined(__aarch64__)
extern const kdr_unsplit kdr_unsplit_neon;
#endif

const kdr_unsplit *kdr_unsplit_for(kdr_isa isa) {
    switch (isa) {
#if defined(__x86_64__)
    case KDR_ISA_SSE42: return &kdr_unsplit_sse42;
    case KDR_ISA_AVX2: return &kdr_unsplit_avx2;
    case KDR_ISA_AVX512: return &kdr_unsplit_avx512;
#elif defined(__aarch64__)
    case KDR_ISA_NEON: return &kdr_unsplit_neon;
#endif
    default: return &kdr_unsplit_scalar;
    }
}
