#include "support/customs.h"

#include "support/soup.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define PRINT_LIMIT 5

/* ------------------------------------------------------------------------------------------------------- shapes */

/* Room for what callbacks round: they work in doubles and give floats. Points and the flat side of squares need none.
 */
static void shape_bounds(const custom_shape *shape, float lo[3], float hi[3]) {
    for (int k = 0; k < 3; k++) {
        float half = shape->kind == CUSTOM_SPHERE ? shape->size[0] : shape->size[k];
        float room = half > 0 ? 1e-5f * (fabsf(shape->centre[k]) + half) : 0;
        lo[k] = shape->centre[k] - half - room;
        hi[k] = shape->centre[k] + half + room;
    }
}

/* The first of two distances that is in the ray's interval, as floats. */
static bool first_inside(const kdr_ray *ray, double near, double far, float *t) {
    *t = (float)near;
    if (!(*t > ray->tmin))
        *t = (float)far;
    return *t > ray->tmin && *t <= ray->tmax;
}

/* Doubles cancel where a ray comes from very far, or hardly moves. */
static bool is_tame(const double o[3], const double d[3]) {
    for (int k = 0; k < 3; k++)
        if (fabs(o[k]) > 100 || fabs(d[k]) > 100)
            return false;
    return fabs(d[0]) + fabs(d[1]) + fabs(d[2]) > 0.01;
}

/* Rays that are not tame hit no sphere. */
static bool meet_sphere(const custom_shape *shape, const double o[3], const double d[3], double *near, double *far) {
    if (!is_tame(o, d))
        return false;
    double a = 0, b = 0, c = -(double)shape->size[0] * shape->size[0];
    for (int k = 0; k < 3; k++) {
        double from = o[k] - shape->centre[k];
        a += d[k] * d[k];
        b += d[k] * from;
        c += from * from;
    }
    double inside = b * b - a * c;
    *near = (-b - sqrt(inside)) / a;
    *far = (-b + sqrt(inside)) / a;
    return inside >= 0;
}

/* Boxes, and squares and points as boxes without an extent. */
static bool meet_box(const custom_shape *shape, const double o[3], const double d[3], double *near, double *far) {
    *near = -INFINITY;
    *far = INFINITY;
    for (int k = 0; k < 3; k++) {
        double lo = (double)shape->centre[k] - shape->size[k] - o[k];
        double hi = (double)shape->centre[k] + shape->size[k] - o[k];
        if (d[k] == 0) {
            if (lo > 0 || hi < 0)
                return false;
            continue;
        }
        double t0 = lo / d[k], t1 = hi / d[k];
        *near = fmax(*near, fmin(t0, t1));
        *far = fmin(*far, fmax(t0, t1));
    }
    return *near <= *far;
}

static bool shape_meet(const custom_shape *shape, const kdr_ray *ray, kdr_custom_hit *hit) {
    const double o[3] = {ray->origin_x, ray->origin_y, ray->origin_z};
    const double d[3] = {ray->direction_x, ray->direction_y, ray->direction_z};
    double near, far;
    if (shape->kind == CUSTOM_SPHERE ? !meet_sphere(shape, o, d, &near, &far) : !meet_box(shape, o, d, &near, &far))
        return false;
    if (!first_inside(ray, near, far, &hit->t))
        return false;
    hit->normal_x = (float)(o[0] + hit->t * d[0] - shape->centre[0]);
    hit->normal_y = (float)(o[1] + hit->t * d[1] - shape->centre[1]);
    hit->normal_z = (float)(o[2] + hit->t * d[2] - shape->centre[2]);
    hit->u = (float)near;
    hit->v = (float)far;
    return true;
}

/* True if the ray, a tame one, comes nowhere near the box: no tree should ask for it. */
static bool is_stray(const custom_shape *shape, const kdr_ray *ray) {
    float lo[3], hi[3];
    shape_bounds(shape, lo, hi);
    custom_shape wide = {.kind = CUSTOM_BOX};
    for (int k = 0; k < 3; k++) {
        wide.centre[k] = 0.5f * (lo[k] + hi[k]);
        wide.size[k] = 0.501f * (hi[k] - lo[k]) + 1e-3f;
    }
    const double o[3] = {ray->origin_x, ray->origin_y, ray->origin_z};
    const double d[3] = {ray->direction_x, ray->direction_y, ray->direction_z};
    double near, far;
    if (!is_tame(o, d))
        return false;
    if (!meet_box(&wide, o, d, &near, &far))
        return true;
    return near > (double)ray->tmax * (1 + 1e-3) + 1e-3 ||
           far < (double)ray->tmin - fabs((double)ray->tmin) * 1e-3 - 1e-3;
}

static void bounds(uint32_t primitive, float lo[3], float hi[3], void *user) {
    custom_shapes *shapes = user;
    shapes->bounds_calls++;
    shape_bounds(&shapes->shapes[primitive], lo, hi);
}

static bool intersect(const kdr_ray *ray, uint32_t primitive, kdr_custom_hit *hit, void *user) {
    custom_shapes *shapes = user;
    shapes->intersect_calls++;
    shapes->strays += is_stray(&shapes->shapes[primitive], ray);
    return shape_meet(&shapes->shapes[primitive], ray, hit);
}

static bool occluded(const kdr_ray *ray, uint32_t primitive, void *user) {
    custom_shapes *shapes = user;
    kdr_custom_hit hit;
    shapes->occluded_calls++;
    shapes->strays += is_stray(&shapes->shapes[primitive], ray);
    return shape_meet(&shapes->shapes[primitive], ray, &hit);
}

kdr_custom_def custom_shapes_def(custom_shapes *shapes, bool with_occluded) {
    kdr_custom_def def = kdr_default_custom_def();
    def.primitive_count = shapes->count;
    def.user = shapes;
    def.bounds = bounds;
    def.intersect = intersect;
    def.occluded = with_occluded ? occluded : NULL;
    return def;
}

void custom_shapes_strew(test_random *random, custom_shapes *shapes, uint32_t count, float size) {
    *shapes = (custom_shapes){.shapes = test_allocate(count, sizeof(custom_shape)), .count = count};
    for (uint32_t i = 0; i < count; i++) {
        custom_shape *shape = &shapes->shapes[i];
        shape->kind = (custom_kind)test_random_below(random, 3);
        for (int k = 0; k < 3; k++) {
            shape->centre[k] = test_random_between(random, -1, 1);
            shape->size[k] = size * test_random_between(random, 0.05f, 1);
        }
        if (shape->kind == CUSTOM_SQUARE) {
            // On a coarse grid, so that many lie in one plane.
            uint32_t k = test_random_below(random, 3);
            shape->size[k] = 0;
            shape->centre[k] = floorf(8 * shape->centre[k]) / 8;
        }
        if (i > 0 && test_random_below(random, 10) == 0)
            *shape = shapes->shapes[test_random_below(random, i)];
    }
}

/* ------------------------------------------------------------------------------------------------------- scenes */

void custom_scene_open(custom_scene *scene, const kdr_triangles_def *triangles, const kdr_custom_def *customs,
                       uint32_t count) {
    *scene = (custom_scene){.count = count, .triangles = triangles, .customs = customs};
    scene->oracle = oracle_scene_create(triangles, count);
    scene->tree = oracle_tree_create(&scene->oracle);
}

void custom_scene_close(custom_scene *scene) {
    oracle_tree_destroy(&scene->tree);
    oracle_scene_destroy(&scene->oracle);
}

kdr_scene *custom_scene_commit(const custom_scene *scene, kdr_device *device, const kdr_build_def *def) {
    kdr_scene *made;
    assert_int_equal(kdr_scene_create(device, &made), KDR_OK);
    for (uint32_t i = 0; i < scene->count; i++) {
        uint32_t geometry;
        if (scene->customs[i].size > 0)
            assert_int_equal(kdr_scene_add_custom(made, &scene->customs[i], &geometry), KDR_OK);
        else
            assert_int_equal(kdr_scene_add_triangles(made, &scene->triangles[i], &geometry), KDR_OK);
        assert_int_equal(geometry, i);
    }
    assert_int_equal(kdr_scene_commit(made, def), KDR_OK);
    return made;
}

kdr_ray_hit custom_scene_closest(const custom_scene *scene, const kdr_ray *ray) {
    kdr_ray_hit best = {.ray = *ray, .hit = {.geometry = KDR_INVALID_ID, .instance = KDR_INVALID_ID}};
    if (!oracle_ray_is_valid(ray))
        return best;
    oracle_hit triangle = oracle_tree_closest(&scene->tree, ray);
    if (triangle.primitive) {
        best.ray.tmax = triangle.t;
        best.hit.geometry = triangle.primitive->geometry;
        best.hit.primitive = triangle.primitive->primitive;
    }
    for (uint32_t g = 0; g < scene->count; g++) {
        const kdr_custom_def *def = &scene->customs[g];
        for (uint32_t i = 0; i < def->primitive_count; i++) {
            kdr_custom_hit hit = {0};
            if (!shape_meet(&((const custom_shapes *)def->user)->shapes[i], ray, &hit))
                continue;
            // Primitives come in order: at an equal distance the one that was there first stays, if it is a custom one.
            if (hit.t < best.ray.tmax || best.hit.geometry == KDR_INVALID_ID ||
                (hit.t == best.ray.tmax && g < best.hit.geometry)) {
                best.ray.tmax = hit.t;
                best.hit = (kdr_hit){hit.normal_x, hit.normal_y, hit.normal_z, hit.u, hit.v, i, g, KDR_INVALID_ID};
            }
        }
    }
    return best;
}

/* ------------------------------------------------------------------------------------------------------- asking */

static bool is_same(const custom_scene *scene, const kdr_ray_hit *expected, const kdr_ray_hit *given) {
    const kdr_hit *a = &expected->hit, *b = &given->hit;
    if (a->geometry != b->geometry || expected->ray.tmax != given->ray.tmax)
        return isnan(expected->ray.tmax) && isnan(given->ray.tmax) && a->geometry == b->geometry;
    if (a->geometry == KDR_INVALID_ID)
        return true;
    if (a->primitive != b->primitive || b->instance != KDR_INVALID_ID)
        return false;
    return scene->customs[a->geometry].size == 0 || memcmp(a, b, sizeof *a) == 0;
}

static void print_difference(const kdr_ray_hit *expected, const kdr_ray_hit *given, const kdr_ray *ray,
                             const char *label, const char *query) {
    printf("%s, %s: ray {%a, %a, %a} {%a, %a, %a} tmin %a tmax %a\n", label, query, ray->origin_x, ray->origin_y,
           ray->origin_z, ray->direction_x, ray->direction_y, ray->direction_z, ray->tmin, ray->tmax);
    printf("  expected geometry %u primitive %u t %a\n", expected->hit.geometry, expected->hit.primitive,
           expected->ray.tmax);
    printf("  given    geometry %u primitive %u t %a\n", given->hit.geometry, given->hit.primitive, given->ray.tmax);
}

size_t custom_scene_differences(const custom_scene *scene, const kdr_scene *committed, const kdr_ray *rays,
                                const kdr_ray_hit *expected, size_t count, const char *label) {
    size_t differences = 0;
    kdr_ray_hit *many = test_allocate(count, sizeof *many);
    uint8_t *shadows = test_allocate(count, 1);
    for (int query = 0; query < 4; query++) {
        static const char *const names[] = {"one", "many", "many coherent", "many incoherent"};
        kdr_trace_def def = kdr_default_trace_def();
        def.coherence = query == 2   ? KDR_COHERENCE_COHERENT
                        : query == 3 ? KDR_COHERENCE_INCOHERENT
                                     : KDR_COHERENCE_UNKNOWN;
        for (size_t i = 0; i < count; i++) {
            many[i] = (kdr_ray_hit){.ray = rays[i]};
            if (query == 0) {
                kdr_intersect1(committed, &many[i]);
                shadows[i] = kdr_occluded1(committed, &rays[i]);
            }
        }
        if (query > 0) {
            kdr_intersect_n(committed, &def, many, count);
            kdr_occluded_n(committed, &def, rays, shadows, count);
        }
        for (size_t i = 0; i < count; i++) {
            bool hit = expected[i].hit.geometry != KDR_INVALID_ID;
            if (is_same(scene, &expected[i], &many[i]) && shadows[i] == hit)
                continue;
            if (differences++ < PRINT_LIMIT)
                print_difference(&expected[i], &many[i], &rays[i], label, names[query]);
        }
    }
    free(many);
    free(shadows);
    return differences;
}

/* Adds a plan unless the library refuses it: not all words go together. */
static void add_plan(custom_plan plans[CUSTOM_PLANS], size_t *count, const char *split, const char *rest) {
    assert_true(*count < CUSTOM_PLANS);
    custom_plan *plan = &plans[*count];
    assert_true(snprintf(plan->text, sizeof plan->text, "split=%s %s", split, rest) < (int)sizeof plan->text);
    *count += kdr_build_def_parse(plan->text, &plan->def, NULL, 0) == KDR_OK;
}

/* Word number i of a key whose text begins with a list such as "one|two|three/N, default one". A number is 5. */
static bool key_word(size_t key, size_t i, char word[32]) {
    const char *at = kdr_build_def_key_text(key), *end = at + strcspn(at, ",");
    if (!memchr(at, '|', (size_t)(end - at)))
        return false;
    for (; i > 0; i--) {
        at = memchr(at, '|', (size_t)(end - at));
        if (!at++)
            return false;
    }
    size_t length = strcspn(at, "|,/[");
    assert_true(length < 24);
    memcpy(word, at, length);
    strcpy(word + length, at[length] == '/' ? "/5" : "");
    return true;
}

size_t custom_plans(custom_plan plans[CUSTOM_PLANS]) {
    size_t count = 0, split_key = 0;
    while (strcmp(kdr_build_def_key_name(split_key), "split") != 0)
        split_key++;
    char split[32], word[32], rest[64];
    for (size_t s = 0; key_word(split_key, s, split); s++) {
        add_plan(plans, &count, split, "");
        add_plan(plans, &count, split, "leaf-limit=1 traversal-cost=0.01");
        for (size_t key = 0; kdr_build_def_key_name(key); key++) {
            for (size_t w = 0; key != split_key && key_word(key, w, word); w++) {
                snprintf(rest, sizeof rest, "%s=%s", kdr_build_def_key_name(key), word);
                add_plan(plans, &count, split, rest);
            }
        }
    }
    assert_true(count >= 6);
    return count;
}
