/* Ray against triangle as exact arithmetic decides it.
 *
 * Edge functions, distance and order of a hit are those of real arithmetic on the given floats. Doubles with an error
 * bound decide nearly always; what they leave in doubt is decided by floating-point expansions.
 *
 * Source: J. R. Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates", 1997;
 * the edge functions are those of S. Woop, C. Benthin, I. Wald, "Watertight Ray/Triangle Intersection", 2013.
 *
 * With a, b, c the vertices as seen from the ray's origin and d its direction:
 *     V0 = det(d, b, c), V1 = det(d, c, a), V2 = det(d, a, b)   weights of the vertices, unnormalised
 *     den = V0 + V1 + V2 = d . n, num = a . n                   with n = (b - a) x (c - a)
 * The ray's line meets the triangle iff no two of V0, V1, V2 have opposite signs and den is not 0; t = num / den. */
#ifndef KDR_GEOMETRY_TRIANGLE_H
#define KDR_GEOMETRY_TRIANGLE_H

#include "geometry/exact.h"
#include "geometry/quad.h"

#include <math.h>

/* Corners of a triangle by axis: a, b, c, and a fourth number that has no meaning. */
typedef struct kdr_corners {
    kdr_quad axis[3];
} kdr_corners;

typedef struct kdr_triangle_hit {
    float t;         /* exact distance, rounded to nearest, ties to even */
    float u, v;      /* weights of b and c, as doubles give them, in [0, 1] */
    float normal[3]; /* (b - a) x (c - a) */
} kdr_triangle_hit;

/* A triple product of differences of floats, computed in double, is off by at most 8 roundings of its six terms, each
 * at most the product of the largest magnitudes: 6 x 8 x 2^-53 < 2^-47. One more bit of slack. */
#define KDR_TRIANGLE_ERROR 0x1p-46

/* Finite numbers only, so a comparison will do where fmax would be a call. */
static inline double kdr_larger(double x, double y) { return x > y ? x : y; }

typedef double kdr_four __attribute__((vector_size(32)));
typedef int64_t kdr_four_i __attribute__((vector_size(32)));

static inline __attribute__((always_inline)) kdr_four kdr_four_all(double x) { return x - (kdr_four){0}; }

static inline __attribute__((always_inline)) kdr_four kdr_four_abs(kdr_four q) {
    return (kdr_four)((kdr_four_i)q & INT64_MAX);
}

static inline __attribute__((always_inline)) kdr_four kdr_four_max(kdr_four a, kdr_four b) {
    kdr_four_i more = a > b;
    return (kdr_four)(((kdr_four_i)a & more) | ((kdr_four_i)b & ~more));
}

/* Bit k: comparison k holds. */
static inline __attribute__((always_inline)) uint32_t kdr_four_bits(kdr_four_i comparison) {
#if defined(__AVX__)
    return (uint32_t)__builtin_ia32_movmskpd256((kdr_four)comparison);
#else
    return (uint32_t)(comparison[0] & 1) | (uint32_t)(comparison[1] & 2) | (uint32_t)(comparison[2] & 4) |
           (uint32_t)(comparison[3] & 8);
#endif
}

static inline void kdr_corners_split(const kdr_corners *t, float a[3], float b[3], float c[3]) {
    for (int k = 0; k < 3; k++) {
        a[k] = t->axis[k][0];
        b[k] = t->axis[k][1];
        c[k] = t->axis[k][2];
    }
}

/* The exact forms, kept out of the way. */
static __attribute__((noinline, unused)) bool kdr_corners_edges_exact(const float o[3], const float d[3],
                                                                      const kdr_corners *t, double v[3]) {
    float a[3], b[3], c[3];
    kdr_corners_split(t, a, b, c);
    return kdr_triangle_edges_exact(o, d, a, b, c, v);
}

static __attribute__((noinline, unused)) float kdr_corners_distance_exact(const float o[3], const float d[3],
                                                                          const kdr_corners *t) {
    float a[3], b[3], c[3];
    kdr_corners_split(t, a, b, c);
    return kdr_triangle_distance_exact(o, d, a, b, c);
}

/* True, and *hit filled in, if the line of the ray meets the triangle. All floats finite, direction not zero.
 * Inline, so that each instruction set compiles it for itself: old and new vector instructions do not mix well.
 * The three edge functions and den are lanes of one vector. Cost: about 70 vector operations when doubles decide. */
static inline __attribute__((always_inline)) bool kdr_triangle_meet(const float o[3], const float d[3],
                                                                    const kdr_corners *t, kdr_triangle_hit *hit) {
    /* Lane by lane, P x Q . d is V0, V1, V2, den: P is b, c, a as seen from the origin, and the edge b - a; Q is
     * c, a, b and c - a. */
    kdr_four p[3], q[3], from[3];
    for (int k = 0; k < 3; k++) {
        kdr_four corners = __builtin_convertvector(t->axis[k], kdr_four);
        from[k] = (kdr_four){o[k], o[k], o[k], corners[0]};
        p[k] = __builtin_shufflevector(corners, corners, 1, 2, 0, 1) - from[k];
        q[k] = __builtin_shufflevector(corners, corners, 2, 0, 1, 2) - from[k];
    }
    kdr_four normal[3] = {p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]};
    kdr_four v = d[0] * normal[0] + d[1] * normal[1] + d[2] * normal[2];

    /* Decide the signs of the edge functions, exactly where the bound leaves them in doubt. */
    kdr_four size_p = kdr_four_max(kdr_four_max(kdr_four_abs(p[0]), kdr_four_abs(p[1])), kdr_four_abs(p[2]));
    kdr_four size_q = kdr_four_max(kdr_four_max(kdr_four_abs(q[0]), kdr_four_abs(q[1])), kdr_four_abs(q[2]));
    double size_d = kdr_larger(fabsf(d[0]), kdr_larger(fabsf(d[1]), fabsf(d[2])));
    double size_a = size_p[2], size = kdr_larger(size_a, kdr_larger(size_p[0], size_p[1]));
    double bound = KDR_TRIANGLE_ERROR * size_d * size * size;
    double edge[3] = {v[0], v[1], v[2]};
    uint32_t positive = kdr_four_bits(v > kdr_four_all(bound)) & 7,
             negative = kdr_four_bits(v < kdr_four_all(-bound)) & 7;
    if (positive && negative)
        return false;
    if (__builtin_expect((positive | negative) != 7, 0) && !kdr_corners_edges_exact(o, d, t, edge))
        return false;

    /* Distance, from the triangle's own edges: their products are small where the triangle is. */
    double num = normal[0][3] * p[0][2] + normal[1][3] * p[1][2] + normal[2][3] * p[2][2], den = v[3];
    double size_n = KDR_TRIANGLE_ERROR * size_p[3] * size_q[3], doubt_den = size_n * size_d;
    double inverse = 1 / den, quotient = num * inverse;
    double error = fabs(quotient) * 0x1p-49 + 2 * fabs(inverse) * (size_n * size_a + fabs(quotient) * doubt_den);
    float lo = (float)(quotient - error), hi = (float)(quotient + error);
    bool rounded = fabs(den) > 2 * doubt_den && lo == hi;
    hit->t = (__builtin_expect(rounded, 1) ? lo : kdr_corners_distance_exact(o, d, t)) + 0.0f; /* no negative zero */

    /* Weights: all three have one sign, so their sum is as good as they are. */
    double scale = 1 / (edge[0] + edge[1] + edge[2]);
    hit->u = (float)(edge[1] * scale);
    hit->v = (float)(edge[2] * scale);
    for (int k = 0; k < 3; k++)
        hit->normal[k] = (float)normal[k][3];
    return true;
}

#endif
