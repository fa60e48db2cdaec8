/* The triangle tests in floats find what doubles say is clearly hit, and nothing that is clearly missed, whatever the
 * traversal; their bits do not depend on the instruction set. */
#include "scene/scene.h"
#include "support/everywhere.h"
#include "support/random.h"
#include "support/soup.h"
#include "support/test_size.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define TRIANGLES 2000
#define RAYS TEST_SIZE(4000)
#define CLEAR 1e-3     /* weights further from 0 leave no doubt */
#define GRAZING 0.05   /* cosine below which distances are not held to anything */
#define DISTANCE 1e-4f /* in a scene of size 1, that floats may be off by */

static const char *const tests[] = {"test=moller-trumbore", "test=projection", "test=watertight"};
static const char *const traces[] = {"trace=stack",       "trace=stack nodes=arrays mailbox=16",
                                     "trace=restart",     "trace=push-down mailbox=8",
                                     "trace=short-stack", "trace=backtrack"};
enum { TESTS = 3, TRACES = sizeof traces / sizeof traces[0] };

/* Triangles of much the same size and shape, all over a cube of size 1. */
static float *well_shaped(test_random *random) {
    float *vertices = test_allocate(9 * (size_t)TRIANGLES, sizeof *vertices);
    for (size_t i = 0; i < TRIANGLES; i++) {
        for (int k = 0; k < 3; k++) {
            float centre = test_random_float(random), size = 0.05f;
            for (int corner = 0; corner < 3; corner++)
                vertices[9 * i + 3 * corner + k] = centre + size * (test_random_float(random) - 0.5f);
        }
        /* One corner further out on each axis, so that no triangle is a sliver. */
        for (int k = 0; k < 3; k++)
            vertices[9 * i + 3 * ((k + i) % 3) + k] += 0.1f;
    }
    return vertices;
}

/* What doubles say of a ray and a triangle. */
typedef enum verdict { MISSES, HITS, DOUBTFUL } verdict;

static verdict judge(const float *triangle, const kdr_ray *ray, double *t, double *u, double *v) {
    const double o[3] = {ray->origin_x, ray->origin_y, ray->origin_z};
    const double d[3] = {ray->direction_x, ray->direction_y, ray->direction_z};
    double e[3], f[3], s[3], n[3], r[3], den = 0, num = 0, nn = 0, dd = 0;
    for (int k = 0; k < 3; k++) {
        e[k] = (double)triangle[3 + k] - triangle[k];
        f[k] = (double)triangle[6 + k] - triangle[k];
        s[k] = o[k] - triangle[k];
    }
    for (int k = 0; k < 3; k++) {
        int l = (k + 1) % 3, m = (k + 2) % 3;
        n[k] = e[l] * f[m] - e[m] * f[l];
        r[k] = s[l] * d[m] - s[m] * d[l];
    }
    *u = *v = 0;
    for (int k = 0; k < 3; k++) {
        den += n[k] * d[k];
        num -= n[k] * s[k];
        nn += n[k] * n[k];
        dd += d[k] * d[k];
        *u -= r[k] * f[k];
        *v += r[k] * e[k];
    }
    *t = num / den;
    *u /= den;
    *v /= den;
    double least = fmin(fmin(*u, *v), 1 - *u - *v);
    if (den * den < GRAZING * GRAZING * nn * dd)
        return least < -CLEAR * 1e4 ? MISSES : DOUBTFUL;
    if (least < -CLEAR || *t < -(double)DISTANCE)
        return MISSES;
    return least > CLEAR && *t > (double)DISTANCE ? HITS : DOUBTFUL;
}

/* What a ray must be told. */
typedef struct expectation {
    bool decided, hits;
    double t, u, v;
    uint32_t primitive;
} expectation;

static expectation expect(const float *vertices, const kdr_ray *ray) {
    expectation e = {.t = INFINITY};
    double doubtful = INFINITY, second = INFINITY;
    for (size_t i = 0; i < TRIANGLES; i++) {
        double t, u, v;
        verdict said = judge(vertices + 9 * i, ray, &t, &u, &v);
        if (said == DOUBTFUL) {
            doubtful = fmin(doubtful, t > -(double)DISTANCE ? t - 10 * (double)DISTANCE : doubtful);
        } else if (said == HITS && t < e.t) {
            second = e.t;
            e = (expectation){.hits = true, .t = t, .u = u, .v = v, .primitive = (uint32_t)i};
        } else if (said == HITS) {
            second = fmin(second, t);
        }
    }
    e.decided = e.hits ? doubtful > e.t && second > e.t + 10 * (double)DISTANCE : doubtful == INFINITY;
    return e;
}

static kdr_ray any_ray(test_random *random) {
    float v[6];
    for (int k = 0; k < 6; k++)
        v[k] = test_random_float(random);
    kdr_ray ray = {.origin_x = 2 * v[0] - 0.5f,
                   .origin_y = 2 * v[1] - 0.5f,
                   .origin_z = 2 * v[2] - 0.5f,
                   .direction_x = v[3] - v[0],
                   .direction_y = v[4] - v[1],
                   .direction_z = v[5] - v[2],
                   .tmax = INFINITY};
    float length = sqrtf(ray.direction_x * ray.direction_x + ray.direction_y * ray.direction_y +
                         ray.direction_z * ray.direction_z);
    ray.direction_x /= length;
    ray.direction_y /= length;
    ray.direction_z /= length;
    return ray;
}

static void hold(const kdr_scene *scene, const kdr_ray *ray, const expectation *e, const char *plan) {
    kdr_ray_hit said = {.ray = *ray};
    kdr_intersect1(scene, &said);
    bool hits = said.hit.geometry != KDR_INVALID_ID, right = hits == e->hits;
    if (right && hits) {
        right = said.hit.primitive == e->primitive && fabs(said.ray.tmax - e->t) < (double)DISTANCE &&
                fabs(said.hit.u - e->u) < CLEAR && fabs(said.hit.v - e->v) < CLEAR;
        float normal[3] = {said.hit.normal_x, said.hit.normal_y, said.hit.normal_z};
        const float *t = (const float *)scene->geometries[0].vertices + 9 * (size_t)e->primitive;
        for (int k = 0; k < 3; k++) {
            int l = (k + 1) % 3, m = (k + 2) % 3;
            double n = ((double)t[3 + l] - t[l]) * ((double)t[6 + m] - t[m]) -
                       ((double)t[3 + m] - t[m]) * ((double)t[6 + l] - t[l]);
            right = right && fabs(n - normal[k]) < 1e-6;
        }
    }
    kdr_ray shorter = *ray;
    shorter.tmax = e->hits ? (float)e->t - 2 * DISTANCE : 10;
    right = right && kdr_occluded1(scene, ray) == e->hits && !kdr_occluded1(scene, &shorter);
    shorter.tmax = (float)e->t + 2 * DISTANCE;
    right = right && kdr_occluded1(scene, &shorter) == e->hits;
    if (!right)
        fail_msg("%s: primitive %u at %g (%g, %g) instead of %u at %g (%g, %g)", plan, said.hit.primitive,
                 (double)said.ray.tmax, (double)said.hit.u, (double)said.hit.v, e->primitive, e->t, e->u, e->v);
}

static kdr_scene *scene_by(kdr_device *device, const float *vertices, const char *trace, const char *test, char *plan) {
    kdr_triangles_def triangles = kdr_default_triangles_def();
    triangles.vertices = vertices;
    triangles.vertex_count = 3 * (size_t)TRIANGLES;
    triangles.triangle_count = TRIANGLES;
    kdr_build_def def;
    snprintf(plan, 100, "%s %s", trace, test);
    assert_int_equal(kdr_build_def_parse(plan, &def, NULL, 0), KDR_OK);
    return committed_scene(device, &triangles, 1, &def);
}

static void what_is_clearly_hit_is_found_where_it_is_by_every_test_and_traversal(void **state) {
    (void)state;
    test_random random = test_random_start(test_random_seed(), 400);
    float *vertices = well_shaped(&random);
    kdr_ray *rays = test_allocate(RAYS, sizeof *rays);
    expectation *expected = test_allocate(RAYS, sizeof *expected);
    size_t decided = 0, hits = 0;
    for (size_t i = 0; i < RAYS; i++) {
        rays[i] = any_ray(&random);
        expected[i] = expect(vertices, &rays[i]);
        decided += expected[i].decided;
        hits += expected[i].decided && expected[i].hits;
    }
    assert_true(decided > RAYS / 2 && hits > RAYS / 4 && decided - hits > RAYS / 50);
    for (int isa = KDR_ISA_SCALAR; isa <= KDR_ISA_NEON; isa++) {
        kdr_device *device = device_of_isa((kdr_isa)isa, 1, NULL);
        for (int i = 0; device && i < TESTS * TRACES; i++) {
            char plan[100];
            kdr_scene *scene = scene_by(device, vertices, traces[i / TESTS], tests[i % TESTS], plan);
            for (size_t r = 0; r < RAYS; r++)
                if (expected[r].decided)
                    hold(scene, &rays[r], &expected[r], plan);
            kdr_scene_destroy(scene);
        }
        kdr_device_destroy(device);
    }
    free(expected);
    free(rays);
    free(vertices);
}

static void every_instruction_set_gives_the_bits_of_scalar_code(void **state) {
    (void)state;
    test_random random = test_random_start(test_random_seed(), 401);
    float *vertices = well_shaped(&random);
    kdr_ray_hit *first = test_allocate(TESTS * (size_t)RAYS, sizeof *first);
    kdr_ray *rays = test_allocate(RAYS, sizeof *rays);
    for (size_t i = 0; i < RAYS; i++)
        rays[i] = any_ray(&random);
    for (int isa = KDR_ISA_SCALAR; isa <= KDR_ISA_NEON; isa++) {
        kdr_device *device = device_of_isa((kdr_isa)isa, 1, NULL);
        for (int test = 0; device && test < TESTS; test++) {
            char plan[100];
            kdr_scene *scene = scene_by(device, vertices, "trace=stack", tests[test], plan);
            for (size_t i = 0; i < RAYS; i++) {
                kdr_ray_hit said = {.ray = rays[i]}, *kept = &first[test * (size_t)RAYS + i];
                kdr_intersect1(scene, &said);
                if (isa == KDR_ISA_SCALAR)
                    *kept = said;
                assert_memory_equal(kept, &said, sizeof said);
            }
            kdr_scene_destroy(scene);
        }
        kdr_device_destroy(device);
    }
    free(rays);
    free(first);
    free(vertices);
}

int main(void) {
    const struct CMUnitTest all[] = {
        cmocka_unit_test(what_is_clearly_hit_is_found_where_it_is_by_every_test_and_traversal),
        cmocka_unit_test(every_instruction_set_gives_the_bits_of_scalar_code),
    };
    return cmocka_run_group_tests(all, NULL, NULL);
}
