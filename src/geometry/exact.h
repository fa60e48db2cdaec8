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
#ifndef KDR_GEOMETRY_EXACT_H
#define KDR_GEOMETRY_EXACT_H

#include <stdbool.h>

typedef struct kdr_triangle_hit {
    float t;    /* exact distance, rounded to nearest, ties to even */
    float u, v; /* weights of b and c, each within 2^-22 of the exact value and in [0, 1] */
} kdr_triangle_hit;

/* True, and *hit filled in, if the line of the ray meets the triangle. All floats finite, direction not zero.
 * Cost: about 100 flops when doubles decide, some thousand otherwise. */
bool kdr_triangle_meet(const float origin[3], const float direction[3], const float a[3], const float b[3],
                       const float c[3], kdr_triangle_hit *hit);

/* True if the exact area is zero. */
bool kdr_triangle_is_flat(const float a[3], const float b[3], const float c[3]);

#endif
