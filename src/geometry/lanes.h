/* Vectors of KDR_LANES floats: types, and the words that C cannot say.
 *
 * Only files named *_lanes.c and headers for them include this; each is compiled once per instruction set with
 * KDR_LANES and KDR_ISA_NAME defined. Arithmetic, comparison and bit operators are those of GCC vector extensions; a
 * comparison gives a kdr_lanes_i of 0 and -1. Everything is static: no vector crosses a file. */
#ifndef KDR_GEOMETRY_LANES_H
#define KDR_GEOMETRY_LANES_H

#include <math.h>
#include <stdint.h>
#include <string.h>

#ifndef KDR_LANES
#error "KDR_LANES is set by the build for files named *_lanes.c"
#endif

#define KDR_LANES_PASTE_(a, b) a##_##b
#define KDR_LANES_PASTE(a, b) KDR_LANES_PASTE_(a, b)
/* The one exported name of a lanes file: base_sse42, base_avx2 ... */
#define KDR_LANES_SYMBOL(base) KDR_LANES_PASTE(base, KDR_ISA_NAME)

#define KDR_LANES_INLINE static inline __attribute__((always_inline, unused))

typedef float kdr_lanes_f __attribute__((vector_size(4 * KDR_LANES)));
typedef int32_t kdr_lanes_i __attribute__((vector_size(4 * KDR_LANES)));
typedef uint32_t kdr_lanes_u __attribute__((vector_size(4 * KDR_LANES)));

/* One bit a lane, lane 0 lowest. */
typedef uint32_t kdr_lane_bits;
#define KDR_LANE_BITS_ALL ((kdr_lane_bits)(((uint64_t)1 << KDR_LANES) - 1))

KDR_LANES_INLINE kdr_lanes_f kdr_lanes_load(const float *from) {
    kdr_lanes_f v;
    memcpy(&v, from, sizeof v);
    return v;
}

KDR_LANES_INLINE kdr_lanes_u kdr_lanes_load_u(const uint32_t *from) {
    kdr_lanes_u v;
    memcpy(&v, from, sizeof v);
    return v;
}

KDR_LANES_INLINE void kdr_lanes_store(float *to, kdr_lanes_f v) { memcpy(to, &v, sizeof v); }

/* One lane. */
KDR_LANES_INLINE float kdr_lanes_get(kdr_lanes_f v, uint32_t lane) {
    float x[KDR_LANES];
    kdr_lanes_store(x, v);
    return x[lane];
}

KDR_LANES_INLINE kdr_lanes_f kdr_lanes_all(float x) { return x - (kdr_lanes_f){0}; }

KDR_LANES_INLINE kdr_lanes_f kdr_lanes_abs(kdr_lanes_f v) { return (kdr_lanes_f)((kdr_lanes_u)v & 0x7fffffffu); }

#if defined(__x86_64__) && KDR_LANES > 1
#include "geometry/lanes_x86.h"
#else
#include "geometry/lanes_plain.h"
#endif

/* The larger size of the two. */
KDR_LANES_INLINE kdr_lanes_f kdr_lanes_larger(kdr_lanes_f a, kdr_lanes_f b) {
#if defined(__AVX512DQ__) && KDR_LANES == 16
    return _mm512_range_ps(a, b, 0x0b);
#else
    return kdr_lanes_max(kdr_lanes_abs(a), kdr_lanes_abs(b));
#endif
}

/* a * b + c and c - a * b, where it does not matter whether the product is rounded. */
KDR_LANES_INLINE kdr_lanes_f kdr_lanes_add_product(kdr_lanes_f c, kdr_lanes_f a, kdr_lanes_f b) {
#if defined(__FMA__) && KDR_LANES == 16
    return _mm512_fmadd_ps(a, b, c);
#elif defined(__FMA__) && KDR_LANES == 8
    return _mm256_fmadd_ps(a, b, c);
#else
    return c + a * b;
#endif
}

KDR_LANES_INLINE kdr_lanes_f kdr_lanes_less_product(kdr_lanes_f c, kdr_lanes_f a, kdr_lanes_f b) {
#if defined(__FMA__) && KDR_LANES == 16
    return _mm512_fnmadd_ps(a, b, c);
#elif defined(__FMA__) && KDR_LANES == 8
    return _mm256_fnmadd_ps(a, b, c);
#else
    return c - a * b;
#endif
}

/* 1 / v within 2^-20 of it, for v and 1 / v among the normal floats. */
KDR_LANES_INLINE kdr_lanes_f kdr_lanes_reciprocal(kdr_lanes_f v) {
#if defined(__AVX512F__) && KDR_LANES == 16
    kdr_lanes_f guess = _mm512_rcp14_ps(v);
    return kdr_lanes_add_product(guess, guess, kdr_lanes_less_product(kdr_lanes_all(1), guess, v));
#else
    return 1 / v;
#endif
}

/* Has a variable lie in memory, where reading a float into all lanes costs a load; from a register it is a shuffle, and
 * these have one port on many machines. */
#define KDR_LANES_KEEP_IN_MEMORY(variable) __asm__ volatile("" : "+m"(variable))

/* Said before a function of a table returns: the upper halves of vector registers are clean again, without which the
 * old vector instructions of the caller cost hundreds of cycles. */
KDR_LANES_INLINE void kdr_lanes_leave(void) {
#if defined(__AVX__)
    _mm256_zeroupper();
#endif
}

/* The first `count` lanes; count may exceed the width. */
KDR_LANES_INLINE kdr_lane_bits kdr_lanes_first(uint32_t count) {
    return (kdr_lane_bits)((1u << (count < KDR_LANES ? count : KDR_LANES)) - 1);
}

KDR_LANES_INLINE float kdr_lanes_least(kdr_lanes_f v) {
#if defined(__AVX512F__) && KDR_LANES == 16
    return _mm512_reduce_min_ps(v);
#else
    float x[KDR_LANES];
    kdr_lanes_store(x, v);
    for (int half = KDR_LANES / 2; half > 0; half /= 2)
        for (int i = 0; i < half; i++)
            x[i] = x[i + half] < x[i] ? x[i + half] : x[i];
    return x[0];
#endif
}

KDR_LANES_INLINE float kdr_lanes_most(kdr_lanes_f v) { return -kdr_lanes_least(-v); }

#endif
