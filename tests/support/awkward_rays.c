#include "support/awkward_rays.h"

#include "support/soup.h"

#include <float.h>
#include <math.h>
#include <string.h>

static float to_finite(double value) { return (float)fmax(fmin(value, FLT_MAX), -FLT_MAX); }

static bool one_in(test_random *random, uint32_t count) { return test_random_below(random, count) == 0; }

static const float *any_vertex(test_random *random, const oracle_scene *scene) {
    const oracle_primitive *primitive = &scene->primitives[test_random_below(random, (uint32_t)scene->count)];
    return (const float *[]){primitive->a, primitive->b, primitive->c}[test_random_below(random, 3)];
}

/* A vertex, the middle of an edge, a point of an edge, or a point of the inside, as near as floats come. */
static void point_of_triangle(test_random *random, const oracle_scene *scene, float out[3]) {
    const oracle_primitive *primitive = &scene->primitives[test_random_below(random, (uint32_t)scene->count)];
    double u = 0, v = 0;
    switch (test_random_below(random, 4)) {
    case 0: break;
    case 1: u = 0.5; break;
    case 2: u = test_random_float(random); break;
    default: u = test_random_float(random), v = (1 - u) * test_random_float(random);
    }
    const float *corners[3] = {primitive->a, primitive->b, primitive->c};
    uint32_t turn = test_random_below(random, 3);
    for (int axis = 0; axis < 3; axis++) {
        double a = corners[turn][axis], b = corners[(turn + 1) % 3][axis], c = corners[(turn + 2) % 3][axis];
        out[axis] = to_finite(a * (1 - u - v) + b * u + c * v);
    }
}

static void choose_origin(test_random *random, const oracle_scene *scene, float o[3]) {
    uint32_t recipe = test_random_below(random, 8);
    if (recipe == 0) {
        point_of_triangle(random, scene, o);
        return;
    }
    for (int axis = 0; axis < 3; axis++) {
        // Somewhere between and around two vertices, or in the planes of three.
        double p = any_vertex(random, scene)[axis], q = any_vertex(random, scene)[axis];
        double s = test_random_float(random) * 3 - 1;
        if (recipe == 1)
            o[axis] = (float)p;
        else if (recipe == 2)
            o[axis] = to_finite(p + (p - q) * 1000);
        else if (recipe == 3)
            o[axis] = soup_any_float(random);
        else
            o[axis] = to_finite(p + (q - p) * s);
    }
}

static void choose_direction(test_random *random, const oracle_scene *scene, const float o[3], float d[3]) {
    float target[3];
    point_of_triangle(random, scene, target);
    for (int axis = 0; axis < 3; axis++)
        d[axis] = to_finite((double)target[axis] - o[axis]);

    uint32_t axis = test_random_below(random, 3);
    switch (test_random_below(random, 12)) {
    case 0: // along an axis, zeros of either sign
        for (uint32_t i = 0; i < 3; i++)
            d[i] = one_in(random, 2) ? 0.0f : -0.0f;
        d[axis] = one_in(random, 2) ? 1 : -2;
        break;
    case 1: // in an axis-aligned plane
        d[axis] = one_in(random, 2) ? 0.0f : -0.0f;
        break;
    case 2: { // in the plane of a triangle, or along its edge
        const oracle_primitive *primitive = &scene->primitives[test_random_below(random, (uint32_t)scene->count)];
        for (int i = 0; i < 3; i++)
            d[i] = to_finite((double)primitive->b[i] - primitive->a[i]);
        break;
    }
    case 3: // one component all but zero
        d[axis] = (float)((int)test_random_below(random, 7) - 3) * 0x1p-149f;
        break;
    case 4: // huge, tiny, denormal
    case 5: {
        static const double scales[] = {1e30, 1e-30, 1e-42, 1e-20};
        double length = fmax(fmax(fabsf(d[0]), fabsf(d[1])), fabsf(d[2]));
        double factor = scales[test_random_below(random, 4)] / (length > 0 ? length : 1);
        for (int i = 0; i < 3; i++)
            d[i] = to_finite(d[i] * factor);
        break;
    }
    case 6: // anything
        for (int i = 0; i < 3; i++)
            d[i] = soup_any_float(random);
        break;
    case 7:
        for (int i = 0; i < 3; i++)
            d[i] = test_random_between(random, -1, 1);
        break;
    default: break;
    }
}

/* Cuts the interval at the hit, at the float before it or at the one behind it. */
static void cut_at_hit(test_random *random, const oracle_tree *tree, kdr_ray *ray) {
    oracle_hit hit = oracle_tree_closest(tree, ray);
    if (!hit.primitive)
        return;
    float before = nextafterf(hit.t, -INFINITY), behind = nextafterf(hit.t, INFINITY);
    switch (test_random_below(random, 6)) {
    case 0: ray->tmax = hit.t; break;
    case 1: ray->tmax = before; break;
    case 2: ray->tmin = hit.t; break;
    case 3: ray->tmin = before, ray->tmax = hit.t; break;
    case 4: ray->tmin = before, ray->tmax = behind; break;
    default: ray->tmin = hit.t, ray->tmax = behind; break;
    }
}

static void choose_interval(test_random *random, const oracle_tree *tree, kdr_ray *ray) {
    ray->tmin = 0;
    ray->tmax = INFINITY;
    switch (test_random_below(random, 10)) {
    case 0: ray->tmin = -INFINITY; break;
    case 1: ray->tmin = -test_random_between(random, 0, 4); break;
    case 2: ray->tmax = test_random_between(random, 0, 2); break;
    case 3: ray->tmin = test_random_between(random, 0, 1), ray->tmax = test_random_between(random, 0.8f, 2); break;
    case 4: ray->tmin = soup_any_float(random), ray->tmax = soup_any_float(random); break;
    case 5:
    case 6:
        ray->tmin = one_in(random, 3) ? -INFINITY : 0;
        cut_at_hit(random, tree, ray);
        break;
    default: break;
    }
}

static void spoil(test_random *random, kdr_ray *ray) {
    static const float bad[] = {NAN, INFINITY, -INFINITY};
    float value = bad[test_random_below(random, 3)];
    switch (test_random_below(random, 5)) {
    case 0: ray->origin_y = value; break;
    case 1: ray->direction_z = value; break;
    case 2: ray->tmin = NAN; break;
    case 3: ray->tmax = NAN; break;
    default: ray->direction_x = ray->direction_y = ray->direction_z = -0.0f;
    }
}

kdr_ray awkward_ray(test_random *random, const oracle_tree *tree) {
    static const oracle_primitive unit = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0, 0};
    const oracle_scene one = {(oracle_primitive *)&unit, 1, 0};
    const oracle_scene *scene = tree->scene->count > 0 ? tree->scene : &one;
    float o[3], d[3];
    choose_origin(random, scene, o);
    choose_direction(random, scene, o, d);
    kdr_ray ray = {.origin_x = o[0],
                   .origin_y = o[1],
                   .origin_z = o[2],
                   .direction_x = d[0],
                   .direction_y = d[1],
                   .direction_z = d[2],
                   .time = NAN,
                   .mask = test_random_u32(random),
                   .id = test_random_u32(random),
                   .flags = test_random_u32(random)};
    choose_interval(random, tree, &ray);
    if (one_in(random, 30))
        spoil(random, &ray);
    return ray;
}

kdr_ray *awkward_rays_create(test_random *random, const oracle_tree *tree, size_t count) {
    kdr_ray *rays = test_allocate(count, sizeof(kdr_ray));
    for (size_t i = 0; i < count; i++)
        rays[i] = awkward_ray(random, tree);
    return rays;
}
