/* Four floats in a register, the same on every machine: a point or a direction, the fourth number along for the ride.
 */
#ifndef KDR_GEOMETRY_QUAD_H
#define KDR_GEOMETRY_QUAD_H

#include <stdint.h>
#include <string.h>

typedef float kdr_quad __attribute__((vector_size(16)));
typedef int32_t kdr_quad_i __attribute__((vector_size(16)));

#define KDR_QUAD_INLINE static inline __attribute__((always_inline, unused))

KDR_QUAD_INLINE kdr_quad kdr_quad_load(const void *from) {
    kdr_quad q;
    memcpy(&q, from, sizeof q);
    return q;
}

KDR_QUAD_INLINE void kdr_quad_store(float to[4], kdr_quad q) { memcpy(to, &q, sizeof q); }

KDR_QUAD_INLINE kdr_quad kdr_quad_all(float x) { return x - (kdr_quad){0}; }

KDR_QUAD_INLINE kdr_quad kdr_quad_abs(kdr_quad q) { return (kdr_quad)((kdr_quad_i)q & 0x7fffffff); }

/* The second where either is NaN. */
KDR_QUAD_INLINE kdr_quad kdr_quad_max(kdr_quad a, kdr_quad b) {
#if defined(__SSE__)
    return __builtin_ia32_maxps(a, b);
#else
    kdr_quad_i more = a > b;
    return (kdr_quad)(((kdr_quad_i)a & more) | ((kdr_quad_i)b & ~more));
#endif
}

KDR_QUAD_INLINE kdr_quad kdr_quad_min(kdr_quad a, kdr_quad b) {
#if defined(__SSE__)
    return __builtin_ia32_minps(a, b);
#else
    kdr_quad_i less = a < b;
    return (kdr_quad)(((kdr_quad_i)a & less) | ((kdr_quad_i)b & ~less));
#endif
}

/* The largest of the first three. */
KDR_QUAD_INLINE float kdr_quad_most(kdr_quad q) {
    float most = q[0] > q[1] ? q[0] : q[1];
    return q[2] > most ? q[2] : most;
}

/* Bit k: the sign of number k; of a comparison: it holds. */
KDR_QUAD_INLINE uint32_t kdr_quad_bits(kdr_quad_i q) {
#if defined(__SSE__)
    return (uint32_t)__builtin_ia32_movmskps((kdr_quad)q);
#else
    return (uint32_t)q[0] >> 31 | (uint32_t)q[1] >> 31 << 1 | (uint32_t)q[2] >> 31 << 2 | (uint32_t)q[3] >> 31 << 3;
#endif
}

#endif
