#include "geometry/exact.h"

#include "geometry/expansion.h"

#include <float.h>
#include <stdint.h>
#include <string.h>

/* det(d, p - o, q - o) = det(d, p, q) - det(d, p, o) - det(d, o, q). */
static void edge_exact(const float d[3], const float o[3], const float p[3], const float q[3], kdr_expansion *e) {
    e->count = 0;
    kdr_expansion_add_det(e, 1, d, p, q);
    kdr_expansion_add_det(e, -1, d, p, o);
    kdr_expansion_add_det(e, -1, d, o, q);
}

static bool float_is_even(float x) {
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return (bits & 1) == 0;
}

/* num / den rounded to the nearest float, ties to even; den is not 0. */
static float quotient_exact(const kdr_expansion *num, const kdr_expansion *den) {
    double q = kdr_expansion_estimate(num) / kdr_expansion_estimate(den);
    float x = (float)(q * (1 - 0x1p-50)), y = (float)(q * (1 + 0x1p-50));
    if (x == y)
        return x;

    /* Two neighbours are left: compare num with their middle times den. */
    float lo = x < y ? x : y, hi = x < y ? y : x;
    double middle;
    if (isinf(hi))
        middle = 0x1p128 - 0x1p103;
    else if (isinf(lo))
        middle = -(0x1p128 - 0x1p103);
    else
        middle = ((double)lo + hi) / 2;
    kdr_expansion rest = *num;
    for (int i = 0; i < den->count; i++)
        kdr_expansion_add_product(&rest, den->part[i], -middle);
    int sign = kdr_expansion_sign(&rest) * kdr_expansion_sign(den);
    if (sign == 0)
        return float_is_even(lo) ? lo : hi;
    return sign > 0 ? hi : lo;
}

float kdr_triangle_distance_exact(const float o[3], const float d[3], const float a[3], const float b[3],
                                  const float c[3]) {
    kdr_expansion num, den;
    num.count = den.count = 0;
    kdr_expansion_add_det(&num, 1, a, b, c);
    kdr_expansion_add_det(&num, -1, o, b, c);
    kdr_expansion_add_det(&num, -1, a, o, c);
    kdr_expansion_add_det(&num, -1, a, b, o);
    kdr_expansion_add_det(&den, 1, d, b, c);
    kdr_expansion_add_det(&den, 1, d, c, a);
    kdr_expansion_add_det(&den, 1, d, a, b);
    return quotient_exact(&num, &den);
}

bool kdr_triangle_edges_exact(const float o[3], const float d[3], const float a[3], const float b[3], const float c[3],
                              double v[3]) {
    const float *vertex[3] = {a, b, c};
    bool positive = false, negative = false;
    for (int i = 0; i < 3; i++) {
        kdr_expansion e;
        edge_exact(d, o, vertex[(i + 1) % 3], vertex[(i + 2) % 3], &e);
        int sign = kdr_expansion_sign(&e);
        positive |= sign > 0;
        negative |= sign < 0;
        v[i] = kdr_expansion_estimate(&e);
    }
    return positive != negative;
}

bool kdr_triangle_is_flat(const float a[3], const float b[3], const float c[3]) {
    /* Each component of (b - a) x (c - a) is a 2-D cross product; it is det(e_k, b - a, c - a). */
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        double ei = (double)b[i] - a[i], ej = (double)b[j] - a[j], fi = (double)c[i] - a[i], fj = (double)c[j] - a[j];
        double cross = ei * fj - ej * fi;
        if (fabs(cross) > 0x1p-50 * (fabs(ei * fj) + fabs(ej * fi)))
            return false;
    }
    for (int k = 0; k < 3; k++) {
        float unit[3] = {0, 0, 0};
        unit[k] = 1;
        kdr_expansion e;
        edge_exact(unit, a, b, c, &e);
        if (kdr_expansion_sign(&e) != 0)
            return false;
    }
    return true;
}
