/* Checks of what must hold. A failed check is a defect of kdray, never of the caller's data. */
#ifndef KDR_BASE_CHECK_H
#define KDR_BASE_CHECK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Prints the place and the condition, then aborts. */
_Noreturn void kdr_check_failed(const char *condition, const char *file, int line);

#ifdef NDEBUG
#define KDR_CHECK(condition) ((void)(0 && (condition))) /* compiled, never evaluated */
#else
#define KDR_CHECK(condition) ((condition) ? (void)0 : kdr_check_failed(#condition, __FILE__, __LINE__))
#endif

/* Size arithmetic that says when it does not fit; *out is written only if true is returned. */
static inline bool kdr_size_mul(size_t a, size_t b, size_t *out) {
    size_t product;
    if (__builtin_mul_overflow(a, b, &product))
        return false;
    *out = product;
    return true;
}

static inline bool kdr_size_add(size_t a, size_t b, size_t *out) {
    size_t sum;
    if (__builtin_add_overflow(a, b, &sum))
        return false;
    *out = sum;
    return true;
}

#endif
