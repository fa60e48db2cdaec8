/* What a triangle test in floats may be off by on one ray and triangle, worked out in doubles from the operations that
 * it says it does: each sum of products is off by at most 16 roundings of the products' sizes. Shares no code with the
 * library. */
#ifndef KDR_TESTS_SUPPORT_FLOAT_DOUBT_H
#define KDR_TESTS_SUPPORT_FLOAT_DOUBT_H

#include "support/oracle.h"

typedef struct float_doubt {
    double t, u, v;                   /* where the ray's line meets the triangle's plane */
    double doubt_t, doubt_u, doubt_v; /* at most the error of a test in floats */
    bool known; /* the line is far enough from parallel, and sizes from the ends of floats, for that to hold */
} float_doubt;

/* For a valid ray; test: one of the two in floats. */
float_doubt float_doubt_of(kdr_triangle_test test, const kdr_ray *ray, const oracle_primitive *primitive);

/* True if that test must find the triangle: it is met inside and within the ray's interval by more than the doubts. */
bool float_doubt_is_clear(const float_doubt *is, const kdr_ray *ray);

/* True if a hit told by that test lies in the triangle, and within the doubts where anything is known. */
bool float_doubt_allows(const float_doubt *is, const kdr_ray_hit *told);

#endif
