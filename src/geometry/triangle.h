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

#include <math.h>

typedef struct kdr_triangle_hit {
    float t;    /* exact distance, rounded to nearest, ties to even */
    float u, v; /* weights of b and c, as doubles give them, in [0, 1] */
} kdr_triangle_hit;

/* A triple product of differences of floats, computed in double, is off by at most 8 roundings of its six terms, each
 * at most the product of the largest magnitudes: 6 x 8 x 2^-53 < 2^-47. One more bit of slack. */
#define KDR_TRIANGLE_ERROR 0x1p-46

/* Finite numbers only, so a comparison will do where fmax would be a call. */
static inline double kdr_larger(double x, double y) { return x > y ? x : y; }

static inline double kdr_largest3(double x, double y, double z) {
    return kdr_larger(fabs(x), kdr_larger(fabs(y), fabs(z)));
}

/* True, and *hit filled in, if the line of the ray meets the triangle. All floats finite, direction not zero.
 * Inline, so that each instruction set compiles it for itself: old and new vector instructions do not mix well.
 * Cost: about 100 flops when doubles decide. */
static inline bool kdr_triangle_meet(const float o[3], const float d[3], const float av[3], const float bv[3],
                                     const float cv[3], kdr_triangle_hit *hit) {
    /* Vertices as seen from the origin. */
    double ox = o[0], oy = o[1], oz = o[2], dx = d[0], dy = d[1], dz = d[2];
    double ax = av[0] - ox, ay = av[1] - oy, az = av[2] - oz;
    double bx = bv[0] - ox, by = bv[1] - oy, bz = bv[2] - oz;
    double cx = cv[0] - ox, cy = cv[1] - oy, cz = cv[2] - oz;

    /* Edge functions. */
    double v[3];
    v[0] = dx * (by * cz - bz * cy) + dy * (bz * cx - bx * cz) + dz * (bx * cy - by * cx);
    v[1] = dx * (cy * az - cz * ay) + dy * (cz * ax - cx * az) + dz * (cx * ay - cy * ax);
    v[2] = dx * (ay * bz - az * by) + dy * (az * bx - ax * bz) + dz * (ax * by - ay * bx);

    /* Decide their signs, exactly where the bound leaves them in doubt. */
    double size_d = kdr_largest3(dx, dy, dz);
    double size_a = kdr_largest3(ax, ay, az), size_b = kdr_largest3(bx, by, bz), size_c = kdr_largest3(cx, cy, cz);
    double size = kdr_larger(size_a, kdr_larger(size_b, size_c));
    double bound = KDR_TRIANGLE_ERROR * size_d * size * size;
    bool positive = v[0] > bound || v[1] > bound || v[2] > bound;
    bool negative = v[0] < -bound || v[1] < -bound || v[2] < -bound;
    if (positive && negative)
        return false;
    bool sure = fabs(v[0]) > bound && fabs(v[1]) > bound && fabs(v[2]) > bound;
    if (!sure && !kdr_triangle_edges_exact(o, d, av, bv, cv, v))
        return false;

    /* Distance, from the triangle's own edges: their products are small where the triangle is. */
    double ex = (double)bv[0] - av[0], ey = (double)bv[1] - av[1], ez = (double)bv[2] - av[2];
    double fx = (double)cv[0] - av[0], fy = (double)cv[1] - av[1], fz = (double)cv[2] - av[2];
    double nx = ey * fz - ez * fy, ny = ez * fx - ex * fz, nz = ex * fy - ey * fx;
    double num = nx * ax + ny * ay + nz * az;
    double den = nx * dx + ny * dy + nz * dz;
    double size_n = KDR_TRIANGLE_ERROR * kdr_largest3(ex, ey, ez) * kdr_largest3(fx, fy, fz);
    double inverse = 1 / den, q = num * inverse;
    double doubt_n = size_n * size_d;
    double error = fabs(q) * 0x1p-49 + 2 * fabs(inverse) * (size_n * size_a + fabs(q) * doubt_n);
    float lo = (float)(q - error), hi = (float)(q + error);
    bool rounded = fabs(den) > 2 * doubt_n && lo == hi;
    hit->t = (rounded ? lo : kdr_triangle_distance_exact(o, d, av, bv, cv)) + 0.0f; /* no negative zero */

    /* Weights: all three have one sign, so their sum is as good as they are. */
    double scale = 1 / (v[0] + v[1] + v[2]);
    hit->u = (float)(v[1] * scale);
    hit->v = (float)(v[2] * scale);
    return true;
}

#endif
