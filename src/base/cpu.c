#include "base/cpu.h"

#include "base/system.h"
#include "base/task.h"

#include <stdlib.h>
#include <string.h>

#if defined(__x86_64__)

#include <cpuid.h>

#define EXTENDED_FEATURES 0x80000001u
#define LZCNT_BIT (1u << 5) /* of ecx; not every compiler knows the feature by name */

static bool has_lzcnt(void) {
    unsigned eax, ebx, ecx, edx;
    return __get_cpuid(EXTENDED_FEATURES, &eax, &ebx, &ecx, &edx) && (ecx & LZCNT_BIT) != 0;
}

/* Each set asks for what its files are compiled with; the builtin also asks whether the system keeps the registers. */
static bool has_sse42(void) { return __builtin_cpu_supports("sse4.2") && __builtin_cpu_supports("popcnt"); }

static bool has_avx2(void) {
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi") &&
           __builtin_cpu_supports("bmi2") && has_lzcnt();
}

static bool has_avx512(void) {
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
           __builtin_cpu_supports("avx512vl");
}

kdr_isa kdr_cpu_isa(void) {
    __builtin_cpu_init();
    if (!has_sse42())
        return KDR_ISA_SCALAR;
    if (!has_avx2())
        return KDR_ISA_SSE42;
    return has_avx512() ? KDR_ISA_AVX512 : KDR_ISA_AVX2;
}

#elif defined(__aarch64__)

kdr_isa kdr_cpu_isa(void) { return KDR_ISA_NEON; }

#else

kdr_isa kdr_cpu_isa(void) { return KDR_ISA_SCALAR; }

#endif

bool kdr_cpu_has_isa(kdr_isa isa) {
    kdr_isa widest = kdr_cpu_isa();
    return isa == KDR_ISA_SCALAR || isa == widest || (widest != KDR_ISA_NEON && isa >= KDR_ISA_SCALAR && isa < widest);
}

bool kdr_cpu_choose_isa(kdr_isa limit, kdr_isa *out) {
    kdr_isa chosen = kdr_cpu_isa();
    if (kdr_cpu_has_isa(limit))
        chosen = limit;

    const char *wanted = getenv("KDR_ISA");
    if (wanted && *wanted) {
        kdr_isa named = KDR_ISA_SCALAR;
        while (named <= KDR_ISA_NEON && strcmp(wanted, kdr_isa_name(named)) != 0)
            named++;
        if (named > KDR_ISA_NEON || !kdr_cpu_has_isa(named))
            return false;
        if (named < chosen)
            chosen = named;
    }
    *out = chosen;
    return true;
}

double kdr_cpu_seconds(void) { return (double)kdr_system_nanoseconds() * 1e-9; }

uint32_t kdr_cpu_count(void) {
    uint32_t count = kdr_system_cpu_count();
    return count < KDR_MAX_WORKERS ? count : KDR_MAX_WORKERS;
}
