#include "support/exact_expansion.h"

#include <stdio.h>
#include <stdlib.h>

void expansion_clear(expansion *sum) { sum->count = 0; }

/* sum + error == a + b exactly (Knuth; Shewchuk's TWO-SUM). */
static inline double two_sum(double a, double b, double *error) {
    double sum = a + b;
    double b_part = sum - a;
    double a_part = sum - b_part;
    *error = (a - a_part) + (b - b_part);
    return sum;
}

/* high + low == value exactly, with at most 26 bits each (Dekker; Shewchuk's SPLIT). */
static inline double split(double value, double *low) {
    double shifted = 134217729.0 * value; // 2^27 + 1
    double high = shifted - (shifted - value);
    *low = value - high;
    return high;
}

void expansion_add(expansion *sum, double value) {
    double carry = value;
    int kept = 0;
    for (int i = 0; i < sum->count; i++) {
        double error;
        carry = two_sum(carry, sum->part[i], &error);
        if (error != 0)
            sum->part[kept++] = error;
    }
    if (carry != 0) {
        if (kept == EXPANSION_CAPACITY) {
            fprintf(stderr, "exact_expansion: more than %d parts\n", EXPANSION_CAPACITY);
            abort();
        }
        sum->part[kept++] = carry;
    }
    sum->count = kept;
}

/* a b has 48 bits and is exact; each of its halves times c has at most 50 and is exact too. */
void expansion_add_product(expansion *sum, float a, float b, float c) {
    double low;
    double high = split((double)a * b, &low);
    expansion_add(sum, low * c);
    expansion_add(sum, high * c);
}

void expansion_add_scaled(expansion *sum, const expansion *value, double factor) {
    for (int i = 0; i < value->count; i++) {
        double low;
        double high = split(value->part[i], &low);
        expansion_add(sum, low * factor);
        expansion_add(sum, high * factor);
    }
}

void expansion_add_determinant(expansion *sum, const float a[3], const float b[3], const float c[3]) {
    for (int x = 0; x < 3; x++) {
        int y = (x + 1) % 3, z = (x + 2) % 3;
        expansion_add_product(sum, a[x], b[y], c[z]);
        expansion_add_product(sum, -a[x], b[z], c[y]);
    }
}

void expansion_subtract_determinant(expansion *sum, const float a[3], const float b[3], const float c[3]) {
    expansion_add_determinant(sum, b, a, c);
}

int expansion_sign(const expansion *value) {
    if (value->count == 0)
        return 0;
    return value->part[value->count - 1] > 0 ? 1 : -1;
}

double expansion_estimate(const expansion *value) {
    double sum = 0;
    for (int i = 0; i < value->count; i++)
        sum += value->part[i];
    return sum;
}
