/* The words of the library: what a status means, what an instruction set is called, which version this is. */
#include "kdray/kdray.h"

#define TEXT_OF(value) #value
#define VERSION_TEXT(major, minor, patch) TEXT_OF(major) "." TEXT_OF(minor) "." TEXT_OF(patch)

const char *kdr_status_text(kdr_status status) {
    switch (status) {
#define STATUS_CASE(name, text)                                                                                        \
    case name: return text;
        KDR_STATUS_LIST(STATUS_CASE)
#undef STATUS_CASE
    }
    return "unknown status";
}

const char *kdr_version(void) { return VERSION_TEXT(KDR_VERSION_MAJOR, KDR_VERSION_MINOR, KDR_VERSION_PATCH); }

const char *kdr_isa_name(kdr_isa isa) {
    switch (isa) {
    case KDR_ISA_SCALAR: return "scalar";
    case KDR_ISA_SSE42: return "sse42";
    case KDR_ISA_AVX2: return "avx2";
    case KDR_ISA_AVX512: return "avx512";
    case KDR_ISA_NEON: return "neon";
    }
    return "unknown";
}
