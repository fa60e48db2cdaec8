/* Floating-point expansions: a number as an exact sum of doubles, least first.
 *
 * Source: J. R. Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates", 1997:
 * TWO-SUM, TWO-PRODUCT (with a fused multiply-add) and GROW-EXPANSION with elimination of zeros.
 * Invariant: parts do not overlap and increase in magnitude, so the last one has the sign of the sum.
 * No overflow or underflow can occur for sums of products of three floats, times one more float. */
#ifndef KDR_GEOMETRY_EXPANSION_H
#define KDR_GEOMETRY_EXPANSION_H

#include <math.h>

#define KDR_EXPANSION_PARTS 160

typedef struct kdr_expansion {
    int count;
    double part[KDR_EXPANSION_PARTS];
} kdr_expansion;

/* Adds one double: the carry runs through all parts, zeros are left out. */
static inline void kdr_expansion_add(kdr_expansion *e, double x) {
    double carry = x;
    int kept = 0;
    for (int i = 0; i < e->count; i++) {
        double y = e->part[i];
        double sum = carry + y;
        double virtual_y = sum - carry;
        double error = (carry - (sum - virtual_y)) + (y - virtual_y);
        carry = sum;
        if (error != 0)
            e->part[kept++] = error;
    }
    if (carry != 0)
        e->part[kept++] = carry;
    e->count = kept;
}

static inline void kdr_expansion_add_product(kdr_expansion *e, double x, double y) {
    double product = x * y;
    kdr_expansion_add(e, fma(x, y, -product));
    kdr_expansion_add(e, product);
}

/* Adds sign * det(p, q, r): six products of three floats; the product of two floats is exact in a double. */
static inline void kdr_expansion_add_det(kdr_expansion *e, double sign, const float p[3], const float q[3],
                                         const float r[3]) {
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        kdr_expansion_add_product(e, (double)q[j] * r[k], sign * p[i]);
        kdr_expansion_add_product(e, (double)q[k] * r[j], -sign * p[i]);
    }
}

static inline int kdr_expansion_sign(const kdr_expansion *e) {
    if (e->count == 0)
        return 0;
    return e->part[e->count - 1] > 0 ? 1 : -1;
}

/* The sum within a relative 2^-52. */
static inline double kdr_expansion_estimate(const kdr_expansion *e) {
    double sum = 0;
    for (int i = 0; i < e->count; i++)
        sum += e->part[i];
    return sum;
}

#endif
