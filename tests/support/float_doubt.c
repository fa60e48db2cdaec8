#include "support/float_doubt.h"

#include <math.h>

#define ROUNDINGS 0x1p-20 /* sixteen of 2^-24 */
#define SMALLEST 0x1p-20  /* of what floats multiply without loss, and the largest */
#define LARGEST 0x1p20
#define LOST 0x1p-100 /* below the smallest floats, times what it is multiplied with */

/* A sum of products, and the sum of their sizes. */
typedef struct sum {
    double value, size;
} sum;

static sum product(sum a, sum b) { return (sum){a.value * b.value, a.size * b.size}; }

static sum dot(const sum a[3], const sum b[3]) {
    sum total = {0, 0};
    for (int k = 0; k < 3; k++) {
        sum one = product(a[k], b[k]);
        total.value += one.value;
        total.size += one.size;
    }
    return total;
}

static void cross(const sum a[3], const sum b[3], sum out[3]) {
    for (int k = 0; k < 3; k++) {
        sum p = product(a[(k + 1) % 3], b[(k + 2) % 3]), q = product(a[(k + 2) % 3], b[(k + 1) % 3]);
        out[k] = (sum){p.value - q.value, p.size + q.size};
    }
}

static sum plain(double value) { return (sum){value, fabs(value)}; }

static double doubt(sum s) { return ROUNDINGS * s.size + LOST; }

/* numerator / denominator, and its doubt. */
static double quotient(sum numerator, sum denominator, double *error) {
    double value = numerator.value / denominator.value;
    *error = (doubt(numerator) + fabs(value) * doubt(denominator)) / (fabs(denominator.value) - doubt(denominator)) +
             fabs(value) * ROUNDINGS;
    return value;
}

static double largest(const sum a[3]) { return fmax(a[0].size, fmax(a[1].size, a[2].size)); }

static bool in_range(const sum a[3]) { return largest(a) >= SMALLEST && largest(a) <= LARGEST; }

static float_doubt by_edges(const sum e[3], const sum f[3], const sum s[3], const sum d[3]) {
    sum p[3], q[3];
    cross(d, f, p);
    cross(s, e, q);
    sum det = dot(e, p);
    float_doubt out = {.known = fabs(det.value) > 2 * doubt(det)};
    out.u = quotient(dot(s, p), det, &out.doubt_u);
    out.v = quotient(dot(d, q), det, &out.doubt_v);
    out.t = quotient(dot(f, q), det, &out.doubt_t);
    return out;
}

/* The weight that is linear over the plane: line . (x - a). */
static double weight(const double line[3], const sum a[3], const sum o[3], const sum d[3], const float_doubt *at,
                     double *error) {
    double value = 0, size = 0, along = 0;
    for (int k = 0; k < 3; k++) {
        value += line[k] * (o[k].value + at->t * d[k].value - a[k].value);
        size += fabs(line[k]) * (o[k].size + (fabs(at->t) + at->doubt_t) * d[k].size + a[k].size);
        along += line[k] * d[k].value;
    }
    *error = ROUNDINGS * size + (fabs(along) + ROUNDINGS * size) * at->doubt_t + LOST;
    return value;
}

static float_doubt by_projection(const sum e[3], const sum f[3], const sum a[3], const sum o[3], const sum d[3]) {
    sum normal[3], n[3], to = {0, 0};
    cross(e, f, normal);
    int k = 0;
    for (int i = 0; i < 3; i++)
        k = fabs(normal[i].value) > fabs(normal[k].value) ? i : k;
    for (int i = 0; i < 3; i++) {
        n[i] = plain(normal[i].value / normal[k].value);
        to.value += n[i].value * (a[i].value - o[i].value);
        to.size += n[i].size * (a[i].size + o[i].size);
    }
    sum den = dot(n, d);
    int l = (k + 1) % 3, m = (k + 2) % 3;
    double b[3] = {0}, c[3] = {0};
    b[l] = f[m].value / normal[k].value;
    b[m] = -f[l].value / normal[k].value;
    c[l] = -e[m].value / normal[k].value;
    c[m] = e[l].value / normal[k].value;
    float_doubt out = {.known = fabs(den.value) > 2 * doubt(den) && fabs(normal[k].value) > 0x1p-36 * normal[k].size};
    out.t = quotient(to, den, &out.doubt_t);
    out.u = weight(b, a, o, d, &out, &out.doubt_u);
    out.v = weight(c, a, o, d, &out, &out.doubt_v);
    return out;
}

float_doubt float_doubt_of(kdr_triangle_test test, const kdr_ray *ray, const oracle_primitive *primitive) {
    const float origin[3] = {ray->origin_x, ray->origin_y, ray->origin_z};
    const float direction[3] = {ray->direction_x, ray->direction_y, ray->direction_z};
    sum a[3], e[3], f[3], s[3], o[3], d[3];
    for (int k = 0; k < 3; k++) {
        a[k] = plain(primitive->a[k]);
        e[k] = plain((double)primitive->b[k] - primitive->a[k]);
        f[k] = plain((double)primitive->c[k] - primitive->a[k]);
        s[k] = plain((double)origin[k] - primitive->a[k]);
        o[k] = plain(origin[k]);
        d[k] = plain(direction[k]);
    }
    float_doubt out = test == KDR_TEST_PROJECTION ? by_projection(e, f, a, o, d) : by_edges(e, f, s, d);
    bool common = in_range(e) && in_range(f) && in_range(d) && largest(o) <= LARGEST && largest(a) <= LARGEST;
    out.known = out.known && common;
    return out;
}

bool float_doubt_is_clear(const float_doubt *is, const kdr_ray *ray) {
    double doubt_w = is->doubt_u + is->doubt_v + ROUNDINGS;
    return is->known && is->u > is->doubt_u && is->v > is->doubt_v && is->u + is->v < 1 - doubt_w &&
           is->t - is->doubt_t > (double)ray->tmin && is->t + is->doubt_t < (double)ray->tmax;
}

bool float_doubt_allows(const float_doubt *is, const kdr_ray_hit *told) {
    double t = told->ray.tmax, u = told->hit.u, v = told->hit.v;
    bool inside = u >= 0 && v >= 0 && u + v <= 1 + ROUNDINGS;
    bool near = fabs(t - is->t) <= is->doubt_t && fabs(u - is->u) <= is->doubt_u && fabs(v - is->v) <= is->doubt_v;
    return inside && (!is->known || near);
}
