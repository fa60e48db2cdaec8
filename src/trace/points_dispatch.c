/* Picks a table of searches by instruction set. */
#include "trace/points.h"

extern const kdr_point_searches kdr_point_searches_scalar;
#if defined(__x86_64__)
extern const kdr_point_searches kdr_point_searches_sse42, kdr_point_searches_avx2, kdr_point_searches_avx512;
#elif defined(__aarch64__)
extern const kdr_point_searches kdr_point_searches_neon;
#endif

const kdr_point_searches *kdr_point_searches_for(kdr_isa isa) {
    switch (isa) {
#if defined(__x86_64__)
    case KDR_ISA_SSE42: return &kdr_point_searches_sse42;
    case KDR_ISA_AVX2: return &kdr_point_searches_avx2;
    case KDR_ISA_AVX512: return &kdr_point_searches_avx512;
#elif defined(__aarch64__)
    case KDR_ISA_NEON: return &kdr_point_searches_neon;
#endif
    default: return &kdr_point_searches_scalar;
    }
}
