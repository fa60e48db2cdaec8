/* Exact sums of doubles, for an oracle that must never be in doubt.
 *
 * Source: J. R. Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates", 1997.
 * An expansion is an unevaluated sum of doubles that do not overlap, in increasing magnitude and without zeros, so its
 * sign is that of its last part. Exact as long as no operation overflows or underflows: products of three floats, and
 * these times one more float's midpoint, stay within 2^-600 and 2^520, far inside the range of double.
 *
 * Round to nearest and plain doubles are assumed, with no contraction to fused operations. */
#ifndef KDR_TESTS_SUPPORT_EXACT_EXPANSION_H
#define KDR_TESTS_SUPPORT_EXACT_EXPANSION_H

/* A comparison takes the most: 24 products of three floats and 18 such products times a double, four parts each. */
#define EXPANSION_CAPACITY 192

typedef struct expansion {
    int count; /* 0: the value is zero */
    double part[EXPANSION_CAPACITY];
} expansion;

/* Sets the sum to zero. */
void expansion_clear(expansion *sum);

/* Adds one double. Cost: one exact addition for each part. */
void expansion_add(expansion *sum, double value);

/* Adds a b c. */
void expansion_add_product(expansion *sum, float a, float b, float c);

/* Adds factor * value; factor has at most 26 significant bits. */
void expansion_add_scaled(expansion *sum, const expansion *value, double factor);

/* Adds det(a, b, c), or takes it away: six products. */
void expansion_add_determinant(expansion *sum, const float a[3], const float b[3], const float c[3]);
void expansion_subtract_determinant(expansion *sum, const float a[3], const float b[3], const float c[3]);

/* -1, 0 or 1. */
int expansion_sign(const expansion *value);

/* The value within a relative error of 2^-51. */
double expansion_estimate(const expansion *value);

#endif
