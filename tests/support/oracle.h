/* The oracle: what the rays of a scene hit, by the rule of kdr_intersect1 in exact arithmetic.
 *
 * With the triangle a, b, c as seen from the origin o along the direction d, the three edge functions are
 *     U = det(d, b - o, c - o)    V = det(d, c - o, a - o)    W = det(d, a - o, b - o)
 * and the distance is det(a - o, b - o, c - o) / (U + V + W). Signs come from doubles where a bound on the error leaves
 * no doubt, else from expansions (exact_expansion.h); so does the rounding of the distance to float. Nothing overflows
 * or underflows, whatever the finite floats are. It shares no code with the library.
 *
 * Cost: 20 to 50 ns a ray and triangle, some microseconds where doubles are in doubt. */
#ifndef KDR_TESTS_SUPPORT_ORACLE_H
#define KDR_TESTS_SUPPORT_ORACLE_H

#include "kdray/kdray.h"

/* False for a ray that misses everything: a NaN, an infinite origin or direction, zero direction, tmin >= tmax. */
bool oracle_ray_is_valid(const kdr_ray *ray);

/* Whether the line through the ray (a valid one) meets the triangle, and at which distance, rounded to nearest, ties to
 * even: infinite above the floats. The interval of the ray is not looked at. */
bool oracle_triangle(const kdr_ray *ray, const float a[3], const float b[3], const float c[3], float *t);

/* The same by expansions alone: the slow path that checks the filter. */
bool oracle_triangle_exact(const kdr_ray *ray, const float a[3], const float b[3], const float c[3], float *t);

/* Barycentric coordinates of the point where that line meets the triangle's plane, correct to a few units of double.
 * Returns how far from them plain doubles may end, since the edge functions they come from cancel. */
double oracle_barycentric(const kdr_ray *ray, const float a[3], const float b[3], const float c[3], double *u,
                          double *v);

typedef struct oracle_primitive {
    float a[3], b[3], c[3];
    uint32_t geometry;
    uint32_t primitive;
} oracle_primitive;

/* The triangles of a scene, copied, in the order of geometry and primitive, without those that are not finite. */
typedef struct oracle_scene {
    oracle_primitive *primitives;
    size_t count;
    size_t dropped_count;
} oracle_scene;

/* Geometry i is geometries[i], laid out as the library reads it. Aborts without memory. */
oracle_scene oracle_scene_create(const kdr_triangles_def *geometries, uint32_t geometry_count);
void oracle_scene_destroy(oracle_scene *scene);

typedef struct oracle_hit {
    const oracle_primitive *primitive; /* NULL: a miss */
    float t;
    double u, v;
    double weight_doubt; /* of u and v in plain doubles */
} oracle_hit;

/* Brute force over all triangles. */
oracle_hit oracle_closest(const oracle_scene *scene, const kdr_ray *ray);
bool oracle_any(const oracle_scene *scene, const kdr_ray *ray);

/* Tests one triangle and keeps it in *best if it is hit within the ray's interval and comes before what is there. */
void oracle_improve(const kdr_ray *ray, const oracle_primitive *primitive, oracle_hit *best);

#endif
