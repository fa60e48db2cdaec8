/* Picks tables of traversals by instruction set. */
#include "trace/trace.h"

extern const kdr_traversals kdr_traversals_scalar;
extern const kdr_named_traversals kdr_named_traversals_scalar;
#if defined(__x86_64__)
extern const kdr_traversals kdr_traversals_sse42, kdr_traversals_avx2, kdr_traversals_avx512;
extern const kdr_named_traversals kdr_named_traversals_sse42, kdr_named_traversals_avx2, kdr_named_traversals_avx512;
#elif defined(__aarch64__)
extern const kdr_traversals kdr_traversals_neon;
extern const kdr_named_traversals kdr_named_traversals_neon;
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

const kdr_named_traversals *kdr_named_traversals_for(kdr_isa isa) {
    switch (isa) {
#if defined(__x86_64__)
    case KDR_ISA_SSE42: return &kdr_named_traversals_sse42;
    case KDR_ISA_AVX2: return &kdr_named_traversals_avx2;
    case KDR_ISA_AVX512: return &kdr_named_traversals_avx512;
#elif defined(__aarch64__)
    case KDR_ISA_NEON: return &kdr_named_traversals_neon;
#endif
    default: return &kdr_named_traversals_scalar;
    }
}

kdr_lone kdr_lone_for(kdr_isa isa, kdr_trace_rule trace, kdr_nodes_rule nodes, kdr_mailbox_rule mailbox) {
    if (trace == KDR_TRACE_AUTO) {
        const kdr_traversals *table = kdr_traversals_for(isa);
        return (kdr_lone){table->single_closest, table->single_any};
    }
    return kdr_named_traversals_for(isa)->of[trace][nodes][mailbox != KDR_MAILBOX_NONE];
}
