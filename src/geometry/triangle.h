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
#include <stddef.h>

/* Where the corners of a triangle lie: nine floats, a.x a.y a.z b.x ... c.z, one every `stride`. */
typedef struct kdr_corners {
    const float *at;
    size_t stride;
} kdr_corners;

static inline __attribute__((always_inline)) float kdr_corner(kdr_corners t, size_t corner, size_t axis) {
    return t.at[(3 * corner + axis) * t.stride];
}

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

static inline void kdr_corners_copy(kdr_corners t, float corner[3][3]) {
    for (size_t i = 0; i < 9; i++)
        corner[i / 3][i % 3] = t.at[i * t.stride];
}

/* The exact forms, kept out of the way. */
static __attribute__((noinline, unused)) bool kdr_corners_edges_exact(const float o[3], const float d[3], kdr_corners t,
                                                                      double v[3]) {
    float corner[3][3];
    kdr_corners_copy(t, corner);
    return kdr_triangle_edges_exact(o, d, corner[0], corner[1], corner[2], v);
}

static __attribute__((noinline, unused)) float kdr_corners_distance_exact(const float o[3], const float d[3],
                                                                          kdr_corners t) {
    float corner[3][3];
    kdr_corners_copy(t, corner);
    return kdr_triangle_distance_exact(o, d, corner[0], corner[1], corner[2]);
}

typedef double kdr_two __attribute__((vector_size(16)));
typedef int64_t kdr_two_i __attribute__((vector_size(16)));

static inline __attribute__((always_inline)) kdr_two kdr_two_abs(kdr_two q) {
    return (kdr_two)((kdr_two_i)q & INT64_MAX);
}

static inline __attribute__((always_inline)) kdr_two kdr_two_swap(kdr_two q) {
    return __builtin_shufflevector(q, q, 1, 0);
}

/* True if x is in the range of normal floats, and all doubles within 2^-34 of it, relatively, round to the same float.
 */
static inline __attribute__((always_inline)) bool kdr_rounds_surely(double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    uint64_t rest = bits & 0x1fffffff, middle = 0x10000000, doubt = 0x80000; /* of 2^-53 */
    double size = fabs(x);
    return rest - (middle - doubt) > 2 * doubt && size > 0x1p-125 && size < 0x1p127;
}

/* The distance num / den, rounded as the exact one is, with a bound of its own for the errors; sizes are the largest
 * coordinates of s and d, and size_n is the error of a coordinate of n. For the few whose rounding is in doubt. */
static __attribute__((noinline, unused)) float kdr_corners_distance(const float o[3], const float d[3], kdr_corners t,
                                                                    double num, double den, double size_n,
                                                                    double size_s, double size_d) {
    double inverse = 1 / den, quotient = num * inverse, doubt_den = size_n * size_d;
    double error = fabs(quotient) * 0x1p-49 + 2 * fabs(inverse) * (size_n * size_s + fabs(quotient) * doubt_den);
    float lo = (float)(quotient - error), hi = (float)(quotient + error);
    bool rounded = fabs(den) > 2 * doubt_den && lo == hi;
    return (rounded ? lo : kdr_corners_distance_exact(o, d, t)) + 0.0f; /* no negative zero */
}

/* Fills *hit for a ray whose line meets the triangle; den must not be zero.
 * With e and f the edges at a and s the origin as seen from a: n = e x f, r = s x d, t = -n . s / n . d,
 * u = -r . f / n . d, v = r . e / n . d, two at a time.
 * Source of this form: T. Moller, B. Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", 1997.
 * Edges are as small as the triangle, and so are the errors of what is made of them. Cost: about 70 operations. */
static inline __attribute__((always_inline)) void kdr_triangle_measure(const float o[3], const float d[3],
                                                                       kdr_corners t, kdr_triangle_hit *hit) {
    kdr_two es[3], fd[3], nr[3];
    for (size_t k = 0; k < 3; k++) {
        double a = kdr_corner(t, 0, k), b = kdr_corner(t, 1, k), c = kdr_corner(t, 2, k);
        es[k] = (kdr_two){b - a, o[k] - a};
        fd[k] = (kdr_two){c - a, d[k]};
    }
    for (int k = 0; k < 3; k++) {
        int l = (k + 1) % 3, m = (k + 2) % 3;
        nr[k] = es[l] * fd[m] - es[m] * fd[l];
    }
    kdr_two den_u = nr[0] * kdr_two_swap(fd[0]) + nr[1] * kdr_two_swap(fd[1]) + nr[2] * kdr_two_swap(fd[2]);
    kdr_two num_v = nr[0] * kdr_two_swap(es[0]) + nr[1] * kdr_two_swap(es[1]) + nr[2] * kdr_two_swap(es[2]);

    /* Distance. Where num and den are good to 36 bits, so is nearly their quotient, and it rounds as the exact one does
     * unless it lies near the middle of two floats. */
    kdr_two size_es = kdr_two_abs(es[0]) + kdr_two_abs(es[1]) + kdr_two_abs(es[2]);
    kdr_two size_fd = kdr_two_abs(fd[0]) + kdr_two_abs(fd[1]) + kdr_two_abs(fd[2]);
    double num = -num_v[0], den = den_u[0], inverse = 1 / den, quotient = num * inverse;
    double size_n = KDR_TRIANGLE_ERROR * size_es[0] * size_fd[0];
    bool good = (0x1p36 * size_n * size_es[1] < fabs(num)) & (0x1p36 * size_n * size_fd[1] < fabs(den));
    if (__builtin_expect(good && kdr_rounds_surely(quotient), 1))
        hit->t = (float)quotient;
    else
        hit->t = kdr_corners_distance(o, d, t, num, den, size_n, size_es[1], size_fd[1]);

    double u = -den_u[1] * inverse, v = num_v[1] * inverse;
    hit->u = (float)(u > 0 ? (u < 1 ? u : 1) : 0);
    hit->v = (float)(v > 0 ? (v < 1 ? v : 1) : 0);
    for (int k = 0; k < 3; k++)
        hit->normal[k] = (float)nr[k][0];
}

/* True if the ray meets the triangle's plane before tmin for sure, so that nothing else need be asked: as for the
 * surface that a shadow ray starts from. Errors as in kdr_corners_distance. */
static inline bool kdr_triangle_is_behind(const float o[3], const float d[3], kdr_corners t, float tmin) {
    double e[3], f[3], s[3];
    for (size_t k = 0; k < 3; k++) {
        double a = kdr_corner(t, 0, k);
        e[k] = kdr_corner(t, 1, k) - a;
        f[k] = kdr_corner(t, 2, k) - a;
        s[k] = o[k] - a;
    }
    double num = 0, den = 0, size_s = 0, size_d = 0, size_e = 0, size_f = 0;
    for (int k = 0; k < 3; k++) {
        int l = (k + 1) % 3, m = (k + 2) % 3;
        double n = e[l] * f[m] - e[m] * f[l];
        num -= n * s[k];
        den += n * d[k];
        size_e += fabs(e[k]);
        size_f += fabs(f[k]);
        size_s += fabs(s[k]);
        size_d += fabs(d[k]);
    }
    double size_n = KDR_TRIANGLE_ERROR * size_e * size_f, doubt_den = size_n * size_d;
    double before = tmin * den - num, doubt = 2 * (size_n * size_s + fabs(tmin) * doubt_den);
    return fabs(den) > 2 * doubt_den && (den > 0 ? before : -before) > doubt;
}

/* True, and *hit filled in, if the line of the ray meets the triangle. All floats finite, direction not zero.
 * Inline, so that each instruction set compiles it for itself: old and new vector instructions do not mix well.
 * The three edge functions are lanes of one vector. Cost: about 50 vector operations when doubles decide. */
static inline __attribute__((always_inline)) bool kdr_triangle_meet(const float o[3], const float d[3], kdr_corners t,
                                                                    kdr_triangle_hit *hit) {
    /* Lane by lane, P x Q . d is V0, V1, V2: P is b, c, a as seen from the origin, and Q is c, a, b. */
    kdr_four p[3], q[3];
    for (size_t k = 0; k < 3; k++) {
        kdr_quad corner = {kdr_corner(t, 0, k), kdr_corner(t, 1, k), kdr_corner(t, 2, k)};
        kdr_four corners = __builtin_convertvector(corner, kdr_four) - (double)o[k];
        p[k] = __builtin_shufflevector(corners, corners, 1, 2, 0, 3);
        q[k] = __builtin_shufflevector(corners, corners, 2, 0, 1, 3);
    }
    kdr_four v = (double)d[0] * (p[1] * q[2] - p[2] * q[1]) + (double)d[1] * (p[2] * q[0] - p[0] * q[2]) +
                 (double)d[2] * (p[0] * q[1] - p[1] * q[0]);

    /* Decide their signs, exactly where the bound leaves them in doubt. */
    kdr_four sizes = kdr_four_max(kdr_four_max(kdr_four_abs(p[0]), kdr_four_abs(p[1])), kdr_four_abs(p[2]));
    double size = kdr_larger(sizes[0], kdr_larger(sizes[1], sizes[2]));
    double size_d = kdr_larger(fabsf(d[0]), kdr_larger(fabsf(d[1]), fabsf(d[2])));
    double bound = KDR_TRIANGLE_ERROR * size_d * size * size;
    uint32_t positive = kdr_four_bits(v > bound) & 7, negative = kdr_four_bits(v < -bound) & 7;
    if (positive && negative)
        return false;
    if (__builtin_expect((positive | negative) == 7, 1)) {
        kdr_triangle_measure(o, d, t, hit);
        return true;
    }

    /* Weights from the exact edge functions: all three have one sign, so their sum is as good as they are. */
    double edge[3];
    if (!kdr_corners_edges_exact(o, d, t, edge))
        return false;
    kdr_triangle_measure(o, d, t, hit);
    double scale = 1 / (edge[0] + edge[1] + edge[2]);
    hit->u = (float)(edge[1] * scale);
    hit->v = (float)(edge[2] * scale);
    return true;
}

#endif
