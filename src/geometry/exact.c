#include "geometry/exact.h"

#include "geometry/expansion.h"

#include <float.h>
#include <stdint.h>
#include <string.h>

/* A triple product of differences of floats, computed in double, is off by at most 8 roundings of its six terms, each
 * at most the product of the largest magnitudes: 6 x 8 x 2^-53 < 2^-47. One more bit of slack. */
static const double ERROR_PER_PRODUCT = 0x1p-46;

/* Finite numbers only, so a comparison will do where fmax would be a call. */
static inline double larger(double x, double y) { return x > y ? x : y; }

static inline double largest3(double x, double y, double z) { return larger(fabs(x), larger(fabs(y), fabs(z))); }

/* ------------------------------------------------------------------------------------------- the exact path */

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

static float distance_exact(const float o[3], const float d[3], const float a[3], const float b[3], const float c[3]) {
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

/* Signs of the three edge functions and estimates within a relative 2^-52. */
static __attribute__((noinline)) bool edges_exact(const float o[3], const float d[3], const float a[3],
                                                  const float b[3], const float c[3], double v[3]) {
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

static __attribute__((noinline)) float distance_in_doubt(const float o[3], const float d[3], const float a[3],
                                                         const float b[3], const float c[3]) {
    return distance_exact(o, d, a, b, c);
}

/* -------------------------------------------------------------------------------------------- the fast path */

bool kdr_triangle_meet(const float o[3], const float d[3], const float av[3], const float bv[3], const float cv[3],
                       kdr_triangle_hit *hit) {
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
    double size_d = largest3(dx, dy, dz);
    double size_a = largest3(ax, ay, az), size_b = largest3(bx, by, bz), size_c = largest3(cx, cy, cz);
    double size = larger(size_a, larger(size_b, size_c));
    double bound = ERROR_PER_PRODUCT * size_d * size * size;
    bool positive = v[0] > bound || v[1] > bound || v[2] > bound;
    bool negative = v[0] < -bound || v[1] < -bound || v[2] < -bound;
    if (positive && negative)
        return false;
    bool sure = fabs(v[0]) > bound && fabs(v[1]) > bound && fabs(v[2]) > bound;
    if (!sure && !edges_exact(o, d, av, bv, cv, v))
        return false;

    /* Distance, from the triangle's own edges: their products are small where the triangle is. */
    double ex = (double)bv[0] - av[0], ey = (double)bv[1] - av[1], ez = (double)bv[2] - av[2];
    double fx = (double)cv[0] - av[0], fy = (double)cv[1] - av[1], fz = (double)cv[2] - av[2];
    double nx = ey * fz - ez * fy, ny = ez * fx - ex * fz, nz = ex * fy - ey * fx;
    double num = nx * ax + ny * ay + nz * az;
    double den = nx * dx + ny * dy + nz * dz;
    double size_n = ERROR_PER_PRODUCT * largest3(ex, ey, ez) * largest3(fx, fy, fz);
    double q = num / den;
    double error = fabs(q) * 0x1p-50 + (size_n * size_a + fabs(q) * size_n * size_d) / (fabs(den) - size_n * size_d);
    float lo = (float)(q - error), hi = (float)(q + error);
    bool rounded = fabs(den) > size_n * size_d && lo == hi;
    hit->t = (rounded ? lo : distance_in_doubt(o, d, av, bv, cv)) + 0.0f; /* no negative zero */

    /* Weights: all three have one sign, so their sum is as good as they are. */
    double scale = 1 / (v[0] + v[1] + v[2]);
    hit->u = (float)(v[1] * scale);
    hit->v = (float)(v[2] * scale);
    return true;
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
