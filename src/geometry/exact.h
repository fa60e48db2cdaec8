/* The exact half of the ray-triangle test: what doubles leave in doubt, decided by floating-point expansions.
 *
 * Source: J. R. Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates", 1997.
 * Names as in triangle.h. Cost: some thousand operations; rarely asked. */
#ifndef KDR_GEOMETRY_EXACT_H
#define KDR_GEOMETRY_EXACT_H

#include <stdbool.h>

/* V0, V1, V2 within a relative 2^-52 each; true if no two have opposite signs and not all are zero. */
bool kdr_triangle_edges_exact(const float origin[3], const float direction[3], const float a[3], const float b[3],
                              const float c[3], double v[3]);

/* num / den, rounded to nearest, ties to even; den must not be zero. */
float kdr_triangle_distance_exact(const float origin[3], const float direction[3], const float a[3], const float b[3],
                                  const float c[3]);

/* True if the exact area is zero. */
bool kdr_triangle_is_flat(const float a[3], const float b[3], const float c[3]);

#endif
