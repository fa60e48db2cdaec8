/* Custom primitives answer as brute force does: by every plan, mixed with triangles, in ties, and on any thread. */
#include "support/awkward_rays.h"
#include "support/customs.h"
#include "support/everywhere.h"
#include "support/soup.h"
#include "support/test_size.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define RAYS TEST_SIZE(300)
#define SHAPES TEST_SIZE(400)
#define MANY TEST_SIZE(5000)
#define MANY_RAYS TEST_SIZE(60)
#define LARGEST (TEST_SIZE(70000) < 20000 ? 20000 : TEST_SIZE(70000)) /* several workers ask for boxes at once */

static kdr_device *device_of(uint32_t workers) {
    kdr_device_def def = kdr_default_device_def();
    def.worker_count = workers;
    kdr_device *device;
    assert_int_equal(kdr_device_create(&def, &device), KDR_OK);
    return device;
}

/* True of the one plan a split that has no other word. */
static bool is_bare(const custom_plan *plan) { return strchr(plan->text, '=') == strrchr(plan->text, '='); }

/* A ray at the middle of things, of any length; some with an interval that ends among them. */
static kdr_ray strewn_ray(test_random *random) {
    float o[3], d[3], scale = test_random_between(random, 0.01f, 4);
    for (int k = 0; k < 3; k++) {
        o[k] = test_random_between(random, -2, 2);
        d[k] = scale * (test_random_between(random, -1, 1) - o[k]);
    }
    kdr_ray ray = {o[0], o[1], o[2], 0, d[0], d[1], d[2], 0, INFINITY, 0, 0, 0};
    uint32_t kind = test_random_below(random, 8);
    if (kind < 3)
        (&ray.direction_x)[kind] = 0;
    if (kind == 3)
        ray.tmax = test_random_between(random, 0, 2) / scale;
    if (kind == 4)
        ray.tmin = test_random_between(random, -2, 1) / scale;
    return ray;
}

/* Expected answers to rays, of which those behind the first `strewn` look for trouble among the triangles. */
static void ask_brute_force(const custom_scene *scene, test_random *random, kdr_ray *rays, kdr_ray_hit *expected,
                            size_t strewn, size_t count) {
    for (size_t i = 0; i < count; i++) {
        rays[i] = i < strewn ? strewn_ray(random) : awkward_ray(random, &scene->tree);
        expected[i] = custom_scene_closest(scene, &rays[i]);
    }
}

enum { GEOMETRIES = SOUP_GEOMETRIES + 3 };

/* Three geometries of shapes before, among and after those of a soup. */
typedef struct mixed {
    soup_scene soup;
    custom_shapes shapes[3];
    kdr_triangles_def triangles[GEOMETRIES];
    kdr_custom_def customs[GEOMETRIES];
    custom_scene scene;
} mixed;

static void mixed_open(mixed *m, test_random *random, size_t triangles, uint32_t shapes, float size) {
    m->soup = soup_scene_create_kind(random, soup_kind_find("small"), triangles);
    for (int i = 0; i < 3; i++)
        custom_shapes_strew(random, &m->shapes[i], i == 1 ? 1 : shapes, size);
    for (int i = 0, soup = 0; i < GEOMETRIES; i++) {
        m->triangles[i] = kdr_default_triangles_def();
        m->customs[i] = (kdr_custom_def){0};
        if (i % 3 == 0)
            m->customs[i] = custom_shapes_def(&m->shapes[i / 3], i == 3);
        else
            m->triangles[i] = m->soup.geometries[soup++];
    }
    custom_scene_open(&m->scene, m->triangles, m->customs, GEOMETRIES);
}

static uint64_t strays(const mixed *m) { return m->shapes[0].strays + m->shapes[1].strays + m->shapes[2].strays; }

static void mixed_close(mixed *m) {
    custom_scene_close(&m->scene);
    for (int i = 0; i < 3; i++)
        free(m->shapes[i].shapes);
    soup_scene_destroy(&m->soup);
}

static void every_plan_answers_as_brute_force_with_and_without_triangles(void **state) {
    (void)state;
    custom_plan plans[CUSTOM_PLANS];
    size_t plan_count = custom_plans(plans);
    kdr_device *device = device_of(1);
    static const float sizes[] = {0.01f, 0.1f, 2};
    size_t hits = 0, custom_hits = 0;
    for (int i = 0; i < 6; i++) {
        test_random random = test_random_start(test_random_seed(), (uint64_t)i);
        mixed m;
        mixed_open(&m, &random, i % 2 ? SHAPES : 0, SHAPES, sizes[i / 2]);
        kdr_ray *rays = test_allocate(RAYS, sizeof *rays);
        kdr_ray_hit *expected = test_allocate(RAYS, sizeof *expected);
        ask_brute_force(&m.scene, &random, rays, expected, RAYS / 2, RAYS);
        for (size_t j = 0; j < RAYS; j++) {
            hits += expected[j].hit.geometry != KDR_INVALID_ID;
            custom_hits += expected[j].hit.geometry != KDR_INVALID_ID && expected[j].hit.geometry % 3 == 0;
        }
        for (size_t plan = 0; plan < plan_count; plan++) {
            if (!is_bare(&plans[plan]) && plan % 3 != (size_t)i / 2)
                continue; // one size of shapes for each of the many
            char label[120];
            snprintf(label, sizeof label, "scene %d, %s", i, plans[plan].text);
            kdr_scene *scene = custom_scene_commit(&m.scene, device, &plans[plan].def);
            if (kdr_scene_verify(scene) != KDR_OK)
                fail_msg("%s: the tree is not sound", label);
            assert_int_equal(custom_scene_differences(&m.scene, scene, rays, expected, RAYS, label), 0);
            kdr_scene_destroy(scene);
        }
        free(rays);
        free(expected);
        mixed_close(&m);
    }
    assert_true(hits > 2 * RAYS && custom_hits > RAYS && custom_hits < hits);
    kdr_device_destroy(device);
}

static void every_instruction_set_gives_the_same_tree_and_the_same_answers(void **state) {
    (void)state;
    test_random random = test_random_start(test_random_seed(), 20);
    mixed m;
    mixed_open(&m, &random, SHAPES, SHAPES, 0.1f);
    kdr_ray *rays = test_allocate(RAYS, sizeof *rays);
    kdr_ray_hit *expected = test_allocate(RAYS, sizeof *expected);
    ask_brute_force(&m.scene, &random, rays, expected, RAYS / 2, RAYS);
    uint64_t hash = 0;
    for (int isa = KDR_ISA_SCALAR; isa <= KDR_ISA_NEON; isa++) {
        kdr_device *device = device_of_isa((kdr_isa)isa, 1, NULL);
        if (!device)
            continue;
        kdr_scene *scene = custom_scene_commit(&m.scene, device, NULL);
        assert_true(hash == 0 || kdr_scene_hash(scene) == hash);
        hash = kdr_scene_hash(scene);
        assert_int_equal(custom_scene_differences(&m.scene, scene, rays, expected, RAYS, kdr_isa_name((kdr_isa)isa)),
                         0);
        kdr_scene_destroy(scene);
        kdr_device_destroy(device);
    }
    assert_true(hash != 0);
    free(rays);
    free(expected);
    mixed_close(&m);
}

static void many_primitives_are_asked_through_the_tree_and_their_boxes_once(void **state) {
    (void)state;
    test_random random = test_random_start(test_random_seed(), 30);
    mixed m;
    mixed_open(&m, &random, 1000, MANY, 0.03f);
    kdr_ray *rays = test_allocate(MANY_RAYS, sizeof *rays);
    kdr_ray_hit *expected = test_allocate(MANY_RAYS, sizeof *expected);
    ask_brute_force(&m.scene, &random, rays, expected, MANY_RAYS, MANY_RAYS);
    custom_plan plans[CUSTOM_PLANS];
    size_t plan_count = custom_plans(plans);
    for (size_t plan = 0; plan < plan_count; plan++) {
        uint64_t hash = 0;
        for (uint32_t workers = 1; workers <= 2; workers++) {
            kdr_device *device = device_of(workers);
            uint64_t boxes = m.shapes[0].bounds_calls, asked = m.shapes[0].intersect_calls;
            kdr_scene *scene = custom_scene_commit(&m.scene, device, &plans[plan].def);
            assert_int_equal(m.shapes[0].bounds_calls - boxes, MANY);
            assert_true(workers == 1 || kdr_scene_hash(scene) == hash);
            hash = kdr_scene_hash(scene);
            assert_int_equal(custom_scene_differences(&m.scene, scene, rays, expected, MANY_RAYS, plans[plan].text), 0);
            // Eight answers a ray, of which each asks few of the primitives.
            assert_true(m.shapes[0].intersect_calls - asked < (uint64_t)8 * MANY_RAYS * MANY / 50);
            kdr_scene_destroy(scene);
            kdr_device_destroy(device);
        }
    }
    assert_int_equal(strays(&m), 0);
    free(rays);
    free(expected);
    mixed_close(&m);
}

static void tens_of_thousands_make_the_same_tree_for_any_number_of_workers(void **state) {
    (void)state;
    static const uint32_t workers[] = {1, 2, 7};
    test_random random = test_random_start(test_random_seed(), 60);
    custom_shapes shapes;
    custom_shapes_strew(&random, &shapes, LARGEST, 0.03f);
    kdr_custom_def def = custom_shapes_def(&shapes, false);
    custom_scene brute = {.count = 1, .customs = &def}; // never asked
    custom_plan plans[CUSTOM_PLANS];
    size_t plan_count = custom_plans(plans);
    for (size_t plan = 0; plan < plan_count; plan++) {
        if (!is_bare(&plans[plan]))
            continue;
        uint64_t hash = 0;
        for (int w = 0; w < 3; w++) {
            kdr_device *device = device_of(workers[w]);
            kdr_scene *scene = custom_scene_commit(&brute, device, &plans[plan].def);
            if (w > 0 && kdr_scene_hash(scene) != hash)
                fail_msg("%s: %u workers build another tree", plans[plan].text, workers[w]);
            hash = kdr_scene_hash(scene);
            kdr_scene_destroy(scene);
            kdr_device_destroy(device);
        }
    }
    free(shapes.shapes);
}

/* ---- ties: squares of a lattice, each there twice as a custom primitive and twice as a pair of triangles */

#define SIDE 4

/* Two triangles for each square of the plane z = 0, 1 ... SIDE - 1. */
static float *lattice_triangles(void) {
    float *at, *vertices = test_allocate(SIDE * SIDE * SIDE * 18, sizeof *vertices);
    at = vertices;
    for (int i = 0; i < SIDE * SIDE * SIDE; i++) {
        static const int corners[6][2] = {{0, 0}, {2, 0}, {2, 2}, {0, 0}, {2, 2}, {0, 2}};
        for (int j = 0; j < 6; j++) {
            *at++ = (float)(i % SIDE * 2 + corners[j][0]);
            *at++ = (float)(i / SIDE % SIDE * 2 + corners[j][1]);
            *at++ = (float)(i / SIDE / SIDE);
        }
    }
    return vertices;
}

static void lattice_shapes(custom_shapes *shapes) {
    uint32_t squares = SIDE * SIDE * SIDE, points = (2 * SIDE + 1) * (2 * SIDE + 1);
    *shapes = (custom_shapes){.shapes = test_allocate(2 * squares + points, sizeof(custom_shape))};
    for (uint32_t i = 0; i < 2 * squares; i++) {
        uint32_t j = i % squares;
        shapes->shapes[shapes->count++] =
            (custom_shape){CUSTOM_SQUARE,
                           {(float)(j % SIDE * 2 + 1), (float)(j / SIDE % SIDE * 2 + 1), (float)(j / SIDE / SIDE)},
                           {1, 1, 0}};
    }
    for (uint32_t i = 0; i < points; i++)
        shapes->shapes[shapes->count++] =
            (custom_shape){CUSTOM_POINT, {(float)(i % (2 * SIDE + 1)), (float)(i / (2 * SIDE + 1)), 2}, {0, 0, 0}};
}

/* A ray between points of the lattice. Its direction is a power of two on each axis, so that all divisions are exact.
 */
static kdr_ray lattice_ray(test_random *random) {
    float o[3], d[3];
    do {
        for (int k = 0; k < 3; k++) {
            o[k] = (float)test_random_below(random, 2 * SIDE + 1);
            d[k] = (float)((int)test_random_below(random, 3) - 1) * (float)(1 << test_random_below(random, 2));
        }
    } while (d[0] == 0 && d[1] == 0 && d[2] == 0);
    kdr_ray ray = {o[0] - 8 * d[0], o[1] - 8 * d[1], o[2] - 8 * d[2], 0, d[0], d[1], d[2], 0, INFINITY, 0, 0, 0};
    if (test_random_below(random, 2) == 0)
        ray.tmax = (float)test_random_below(random, 17);
    return ray;
}

static void of_equal_distances_the_lowest_geometry_wins_then_the_lowest_primitive_of_either_kind(void **state) {
    (void)state;
    float *vertices = lattice_triangles();
    custom_shapes shapes;
    lattice_shapes(&shapes);
    kdr_triangles_def squares = kdr_default_triangles_def();
    squares.vertices = vertices;
    squares.vertex_count = SIDE * SIDE * SIDE * 6;
    squares.triangle_count = SIDE * SIDE * SIDE * 2;
    kdr_device *device = device_of(1);
    custom_plan plans[CUSTOM_PLANS];
    size_t plan_count = custom_plans(plans), by_kind[2] = {0};
    test_random random = test_random_start(test_random_seed(), 40);
    for (int order = 0; order < 8; order++) {
        kdr_triangles_def triangles[3];
        kdr_custom_def customs[3];
        for (int g = 0; g < 3; g++) {
            bool custom = order >> g & 1;
            triangles[g] = custom ? kdr_default_triangles_def() : squares;
            customs[g] = custom ? custom_shapes_def(&shapes, g == 1) : (kdr_custom_def){0};
        }
        custom_scene brute;
        custom_scene_open(&brute, triangles, customs, 3);
        kdr_ray *rays = test_allocate(RAYS, sizeof *rays);
        kdr_ray_hit *expected = test_allocate(RAYS, sizeof *expected);
        for (size_t i = 0; i < RAYS; i++) {
            rays[i] = lattice_ray(&random);
            expected[i] = custom_scene_closest(&brute, &rays[i]);
            if (expected[i].hit.geometry != KDR_INVALID_ID)
                by_kind[customs[expected[i].hit.geometry].size > 0]++;
        }
        for (size_t plan = 0; plan < plan_count; plan++) {
            if (!is_bare(&plans[plan]) && (int)plan % 8 != order)
                continue;
            char label[120];
            snprintf(label, sizeof label, "order %d, %s", order, plans[plan].text);
            kdr_scene *scene = custom_scene_commit(&brute, device, &plans[plan].def);
            assert_int_equal(kdr_scene_verify(scene), KDR_OK);
            assert_int_equal(custom_scene_differences(&brute, scene, rays, expected, RAYS, label), 0);
            kdr_scene_destroy(scene);
        }
        free(rays);
        free(expected);
        custom_scene_close(&brute);
    }
    assert_true(by_kind[0] > RAYS && by_kind[1] > RAYS);
    kdr_device_destroy(device);
    free(shapes.shapes);
    free(vertices);
}

/* ---- threads */

typedef struct questions {
    const custom_scene *brute;
    const kdr_scene *scene;
    const kdr_ray *rays;
    const kdr_ray_hit *expected;
    _Atomic size_t differences;
} questions;

static void ask_all(void *context, uint32_t index) {
    (void)index;
    questions *q = context;
    q->differences += custom_scene_differences(q->brute, q->scene, q->rays, q->expected, RAYS, "a worker");
}

static void any_number_of_threads_may_ask_at_once(void **state) {
    (void)state;
    test_random random = test_random_start(test_random_seed(), 50);
    mixed m;
    mixed_open(&m, &random, SHAPES, SHAPES, 0.1f);
    kdr_ray *rays = test_allocate(RAYS, sizeof *rays);
    kdr_ray_hit *expected = test_allocate(RAYS, sizeof *expected);
    ask_brute_force(&m.scene, &random, rays, expected, RAYS / 2, RAYS);
    kdr_device *device = device_of(4);
    kdr_scene *scene = custom_scene_commit(&m.scene, device, NULL);
    questions q = {.brute = &m.scene, .scene = scene, .rays = rays, .expected = expected};
    kdr_device_run(device, ask_all, &q, 8);
    assert_int_equal(q.differences, 0);
    kdr_scene_destroy(scene);
    kdr_device_destroy(device);
    free(rays);
    free(expected);
    mixed_close(&m);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_plan_answers_as_brute_force_with_and_without_triangles),
        cmocka_unit_test(every_instruction_set_gives_the_same_tree_and_the_same_answers),
        cmocka_unit_test(many_primitives_are_asked_through_the_tree_and_their_boxes_once),
        cmocka_unit_test(tens_of_thousands_make_the_same_tree_for_any_number_of_workers),
        cmocka_unit_test(of_equal_distances_the_lowest_geometry_wins_then_the_lowest_primitive_of_either_kind),
        cmocka_unit_test(any_number_of_threads_may_ask_at_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
