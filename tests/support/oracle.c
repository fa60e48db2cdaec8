#include "support/oracle.h"

#include "support/exact_expansion.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A sum of triple products of differences has at most 8 roundings on the way from the floats to each term; the bound
 * is this times the sum of the terms' magnitudes, and twice what is needed. No term can underflow: see
 * exact_expansion.h. */
#define ERROR_FACTOR 0x1p-49

bool oracle_ray_is_valid(const kdr_ray *ray) {
    if (!isfinite(ray->origin_x) || !isfinite(ray->origin_y) || !isfinite(ray->origin_z))
        return false;
    if (!isfinite(ray->direction_x) || !isfinite(ray->direction_y) || !isfinite(ray->direction_z))
        return false;
    if (ray->direction_x == 0 && ray->direction_y == 0 && ray->direction_z == 0)
        return false;
    return ray->tmin < ray->tmax; // false for NaN too
}

/* ------------------------------------------------------------------------------------------- expansions */

/* det(d, p - o, q - o) */
static void edge_exact(expansion *sum, const float d[3], const float o[3], const float p[3], const float q[3]) {
    expansion_clear(sum);
    expansion_add_determinant(sum, d, p, q);
    expansion_subtract_determinant(sum, d, o, q);
    expansion_subtract_determinant(sum, d, p, o);
}

/* U + V + W = det(d, b - a, c - a) */
static void denominator_exact(expansion *sum, const float d[3], const float a[3], const float b[3], const float c[3]) {
    edge_exact(sum, d, a, b, c);
}

/* det(a - o, b - o, c - o) */
static void numerator_exact(expansion *sum, const float o[3], const float a[3], const float b[3], const float c[3]) {
    expansion_clear(sum);
    expansion_add_determinant(sum, a, b, c);
    expansion_subtract_determinant(sum, o, b, c);
    expansion_subtract_determinant(sum, a, o, c);
    expansion_subtract_determinant(sum, a, b, o);
}

/* Sign of |numerator| - factor |denominator|. */
static int compare_scaled(const expansion *numerator, int numerator_sign, const expansion *denominator,
                          int denominator_sign, double factor) {
    expansion difference;
    expansion_clear(&difference);
    expansion_add_scaled(&difference, numerator, numerator_sign);
    expansion_add_scaled(&difference, denominator, -factor * denominator_sign);
    return expansion_sign(&difference);
}

/* The number half way from a float >= 0 to the next one; beyond the largest stands 2^128. */
static double midpoint_above(float value) {
    float next = nextafterf(value, INFINITY);
    return ((double)value + (isinf(next) ? 0x1p128 : (double)next)) / 2;
}

static bool is_odd(float value) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof(bits));
    return bits & 1;
}

/* The quotient rounded to nearest, ties to even: starts from doubles and steps while a midpoint says so. */
static float divide_exact(const expansion *numerator, const expansion *denominator) {
    int top = expansion_sign(numerator), bottom = expansion_sign(denominator);
    if (top == 0)
        return 0;
    float value = (float)fabs(expansion_estimate(numerator) / expansion_estimate(denominator));
    for (;;) {
        if (!isinf(value)) {
            int above = compare_scaled(numerator, top, denominator, bottom, midpoint_above(value));
            if (above > 0 || (above == 0 && is_odd(value))) {
                value = nextafterf(value, INFINITY);
                continue;
            }
        }
        if (value > 0) {
            float previous = nextafterf(value, 0);
            int below = compare_scaled(numerator, top, denominator, bottom, midpoint_above(previous));
            if (below < 0 || (below == 0 && !is_odd(previous))) {
                value = previous;
                continue;
            }
        }
        return top * bottom < 0 ? -value : value;
    }
}

static void ray_vectors(const kdr_ray *ray, float o[3], float d[3]) {
    o[0] = ray->origin_x, o[1] = ray->origin_y, o[2] = ray->origin_z;
    d[0] = ray->direction_x, d[1] = ray->direction_y, d[2] = ray->direction_z;
}

static bool signs_meet(int u, int v, int w) {
    bool positive = u > 0 || v > 0 || w > 0;
    bool negative = u < 0 || v < 0 || w < 0;
    return positive != negative;
}

static float distance_exact(const float o[3], const float d[3], const float a[3], const float b[3], const float c[3]) {
    expansion numerator, denominator;
    numerator_exact(&numerator, o, a, b, c);
    denominator_exact(&denominator, d, a, b, c);
    return divide_exact(&numerator, &denominator);
}

static int edge_sign_exact(const float d[3], const float o[3], const float p[3], const float q[3]) {
    expansion edge;
    edge_exact(&edge, d, o, p, q);
    return expansion_sign(&edge);
}

bool oracle_triangle_exact(const kdr_ray *ray, const float a[3], const float b[3], const float c[3], float *t) {
    float o[3], d[3];
    ray_vectors(ray, o, d);
    if (!signs_meet(edge_sign_exact(d, o, b, c), edge_sign_exact(d, o, c, a), edge_sign_exact(d, o, a, b)))
        return false;
    *t = distance_exact(o, d, a, b, c);
    return true;
}

/* --------------------------------------------------------------------------------------------- the filter */

static inline void subtract(double out[3], const float p[3], const float o[3]) {
    for (int i = 0; i < 3; i++)
        out[i] = (double)p[i] - o[i];
}

/* det(p, q, r) and its error bound. */
static inline double determinant(const double p[3], const double q[3], const double r[3], double *error) {
    double x0 = q[1] * r[2], x1 = q[2] * r[1];
    double y0 = q[2] * r[0], y1 = q[0] * r[2];
    double z0 = q[0] * r[1], z1 = q[1] * r[0];
    *error = ERROR_FACTOR * (fabs(p[0]) * (fabs(x0) + fabs(x1)) + fabs(p[1]) * (fabs(y0) + fabs(y1)) +
                             fabs(p[2]) * (fabs(z0) + fabs(z1)));
    return p[0] * (x0 - x1) + p[1] * (y0 - y1) + p[2] * (z0 - z1);
}

/* A sign, or DOUBT. */
#define DOUBT 2
static inline int filtered_sign(double value, double error) {
    if (value > error)
        return 1;
    if (value < -error)
        return -1;
    return error == 0 ? 0 : DOUBT; // without a term that is not zero the value is exact
}

/* The distance from doubles if everything within their errors rounds to one float. */
static bool distance_filtered(const double da[3], const double db[3], const double dc[3], double denominator,
                              double denominator_error, float *t) {
    double numerator_error;
    double numerator = determinant(da, db, dc, &numerator_error);
    if (fabs(denominator) <= 2 * denominator_error || fabs(numerator) <= 2 * numerator_error)
        return false;
    double quotient = numerator / denominator;
    double slack = numerator_error / fabs(numerator) + denominator_error / fabs(denominator);
    double error = fabs(quotient) * (2 * slack + 0x1p-50); // both errors are at most a half of their numbers
    float low = (float)(quotient - error), high = (float)(quotient + error);
    *t = low;
    return low == high && low != 0;
}

bool oracle_triangle(const kdr_ray *ray, const float a[3], const float b[3], const float c[3], float *t) {
    float o[3], d[3];
    ray_vectors(ray, o, d);
    double direction[3] = {d[0], d[1], d[2]}, da[3], db[3], dc[3];
    subtract(da, a, o);
    subtract(db, b, o);
    subtract(dc, c, o);

    // Two certain and opposite signs are enough to leave.
    double u_error, v_error, w_error;
    double u = determinant(direction, db, dc, &u_error);
    double v = determinant(direction, dc, da, &v_error);
    int u_sign = filtered_sign(u, u_error), v_sign = filtered_sign(v, v_error);
    if (u_sign * v_sign == -1)
        return false;
    double w = determinant(direction, da, db, &w_error);
    int w_sign = filtered_sign(w, w_error);
    if (u_sign * w_sign == -1 || v_sign * w_sign == -1)
        return false;

    // Settle what is in doubt.
    if (u_sign == DOUBT)
        u_sign = edge_sign_exact(d, o, b, c);
    if (v_sign == DOUBT)
        v_sign = edge_sign_exact(d, o, c, a);
    if (w_sign == DOUBT)
        w_sign = edge_sign_exact(d, o, a, b);
    if (!signs_meet(u_sign, v_sign, w_sign))
        return false;

    double denominator_error = u_error + v_error + w_error;
    if (!distance_filtered(da, db, dc, u + v + w, 2 * denominator_error, t))
        *t = distance_exact(o, d, a, b, c);
    return true;
}

double oracle_barycentric(const kdr_ray *ray, const float a[3], const float b[3], const float c[3], double *u,
                          double *v) {
    float o[3], d[3];
    ray_vectors(ray, o, d);
    expansion edge, denominator;
    denominator_exact(&denominator, d, a, b, c);
    edge_exact(&edge, d, o, c, a);
    *u = expansion_estimate(&edge) / expansion_estimate(&denominator);
    edge_exact(&edge, d, o, a, b);
    *v = expansion_estimate(&edge) / expansion_estimate(&denominator);

    double direction[3] = {d[0], d[1], d[2]}, da[3], db[3], dc[3], errors[3];
    subtract(da, a, o);
    subtract(db, b, o);
    subtract(dc, c, o);
    determinant(direction, db, dc, &errors[0]);
    determinant(direction, dc, da, &errors[1]);
    determinant(direction, da, db, &errors[2]);
    return 2 * (errors[0] + errors[1] + errors[2]) / fabs(expansion_estimate(&denominator));
}

/* ------------------------------------------------------------------------------------------------ scenes */

static void *allocate(size_t count, size_t size) {
    void *memory = calloc(count ? count : 1, size);
    if (!memory) {
        fprintf(stderr, "oracle: out of memory\n");
        abort();
    }
    return memory;
}

/* False if the vertex is not finite. */
static bool read_vertex(const kdr_triangles_def *def, uint32_t index, float out[3]) {
    memcpy(out, (const char *)def->vertices + index * def->vertex_stride, 3 * sizeof(float));
    return isfinite(out[0]) && isfinite(out[1]) && isfinite(out[2]);
}

static bool read_triangle(const kdr_triangles_def *def, uint32_t number, oracle_primitive *out) {
    uint32_t index[3] = {3 * number, 3 * number + 1, 3 * number + 2};
    if (def->indices)
        memcpy(index, (const char *)def->indices + number * def->index_stride, sizeof(index));
    out->primitive = number;
    bool a = read_vertex(def, index[0], out->a);
    bool b = read_vertex(def, index[1], out->b);
    bool c = read_vertex(def, index[2], out->c);
    return a && b && c;
}

oracle_scene oracle_scene_create(const kdr_triangles_def *geometries, uint32_t geometry_count) {
    size_t total = 0;
    for (uint32_t i = 0; i < geometry_count; i++)
        total += geometries[i].triangle_count;
    oracle_scene scene = {allocate(total, sizeof(oracle_primitive)), 0, 0};
    for (uint32_t i = 0; i < geometry_count; i++) {
        for (size_t k = 0; k < geometries[i].triangle_count; k++) {
            oracle_primitive *primitive = &scene.primitives[scene.count];
            primitive->geometry = i;
            if (read_triangle(&geometries[i], (uint32_t)k, primitive))
                scene.count++;
        }
    }
    scene.dropped_count = total - scene.count;
    return scene;
}

void oracle_scene_destroy(oracle_scene *scene) {
    free(scene->primitives);
    *scene = (oracle_scene){0};
}

/* By distance, then geometry, then primitive. */
static bool comes_before(float t, const oracle_primitive *primitive, const oracle_hit *best) {
    if (!best->primitive || t != best->t)
        return !best->primitive || t < best->t;
    if (primitive->geometry != best->primitive->geometry)
        return primitive->geometry < best->primitive->geometry;
    return primitive->primitive < best->primitive->primitive;
}

void oracle_improve(const kdr_ray *ray, const oracle_primitive *primitive, oracle_hit *best) {
    float t;
    if (oracle_triangle(ray, primitive->a, primitive->b, primitive->c, &t) && t > ray->tmin && t <= ray->tmax &&
        comes_before(t, primitive, best)) {
        best->primitive = primitive;
        best->t = t;
    }
}

oracle_hit oracle_closest(const oracle_scene *scene, const kdr_ray *ray) {
    oracle_hit best = {0};
    if (!oracle_ray_is_valid(ray))
        return best;
    for (size_t i = 0; i < scene->count; i++)
        oracle_improve(ray, &scene->primitives[i], &best);
    if (best.primitive)
        best.weight_doubt =
            oracle_barycentric(ray, best.primitive->a, best.primitive->b, best.primitive->c, &best.u, &best.v);
    return best;
}

bool oracle_any(const oracle_scene *scene, const kdr_ray *ray) {
    if (!oracle_ray_is_valid(ray))
        return false;
    for (size_t i = 0; i < scene->count; i++) {
        const oracle_primitive *primitive = &scene->primitives[i];
        float t;
        if (oracle_triangle(ray, primitive->a, primitive->b, primitive->c, &t) && t > ray->tmin && t <= ray->tmax)
            return true;
    }
    return false;
}
