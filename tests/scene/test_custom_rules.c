/* What a scene promises of custom primitives: what is refused, left out and counted, when a def comes into force, what
 * callbacks are given and what is believed of what they say. */
#include "support/failing_alloc.h"
#include "support/soup.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static char last_message[512];

static void keep_message(kdr_log_level level, const char *message, void *user) {
    (void)level;
    (void)user;
    snprintf(last_message, sizeof last_message, "%s", message);
}

static kdr_device *device_of(uint32_t workers, const kdr_allocator *memory) {
    kdr_device_def def = kdr_default_device_def();
    def.worker_count = workers;
    def.log = keep_message;
    if (memory)
        def.allocator = *memory;
    kdr_device *device;
    assert_int_equal(kdr_device_create(&def, &device), KDR_OK);
    return device;
}

static kdr_scene *scene_of(kdr_device *device) {
    kdr_scene *scene;
    assert_int_equal(kdr_scene_create(device, &scene), KDR_OK);
    return scene;
}

/* A triangle at z = 5 in front of rays along z. */
static kdr_triangles_def triangle_at_5(void) {
    static const float vertices[] = {-9, -9, 5, 9, -9, 5, 0, 9, 5};
    kdr_triangles_def def = kdr_default_triangles_def();
    def.vertices = vertices;
    def.vertex_count = 3;
    def.triangle_count = 1;
    return def;
}

static kdr_ray_hit ask_along_z(const kdr_scene *scene) {
    kdr_ray_hit ray = {.ray = {.direction_z = 1, .tmax = 100}};
    kdr_intersect1(scene, &ray);
    return ray;
}

/* ---- primitives that say what a test wants */

typedef struct puppets {
    float boxes[4][6];
    bool hits;
    kdr_custom_hit says;
    kdr_ray asked; /* what intersect was given last */
    uint32_t primitive;
    int calls;
} puppets;

static void puppet_bounds(uint32_t primitive, float lo[3], float hi[3], void *user) {
    const puppets *p = user;
    memcpy(lo, p->boxes[primitive], 3 * sizeof *lo);
    memcpy(hi, p->boxes[primitive] + 3, 3 * sizeof *hi);
}

static bool puppet_intersect(const kdr_ray *ray, uint32_t primitive, kdr_custom_hit *hit, void *user) {
    puppets *p = user;
    p->asked = *ray;
    p->primitive = primitive;
    p->calls++;
    assert_true(hit->t == 0 && hit->normal_x == 0 && hit->normal_y == 0 && hit->normal_z == 0);
    assert_true(hit->u == 0 && hit->v == 0);
    *hit = p->says;
    return p->hits;
}

static kdr_custom_def puppets_def(puppets *p, uint32_t count) {
    kdr_custom_def def = kdr_default_custom_def();
    def.primitive_count = count;
    def.user = p;
    def.bounds = puppet_bounds;
    def.intersect = puppet_intersect;
    return def;
}

static puppets *puppets_create(void) {
    puppets *p = test_allocate(1, sizeof *p);
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 6; k++)
            p->boxes[i][k] = (k < 3 ? -1 : 1) + (k % 3 == 2 ? 3 * (float)(i + 1) : 0);
    p->hits = true;
    p->says = (kdr_custom_hit){2, 3, 4, 5, 6, 7};
    return p;
}

/* ---- tests */

static void wrong_defs_and_numbers_are_refused_and_change_nothing(void **state) {
    (void)state;
    puppets *p = puppets_create();
    kdr_device *device = device_of(1, NULL);
    kdr_scene *scene = scene_of(device);
    kdr_custom_def good = puppets_def(p, 1), bad[4] = {good, good, good, good};
    kdr_triangles_def triangles = triangle_at_5();
    bad[0].size = 0;
    bad[1].bounds = NULL;
    bad[2].intersect = NULL;
    bad[3].size++;
    uint32_t custom = 7, other = 7;
    for (int i = 0; i < 4; i++)
        assert_int_equal(kdr_scene_add_custom(scene, &bad[i], &custom), KDR_ERROR_INVALID_ARGUMENT);
    assert_int_equal(kdr_scene_add_custom(scene, NULL, &custom), KDR_ERROR_INVALID_ARGUMENT);
    assert_int_equal(kdr_scene_add_custom(NULL, &good, &custom), KDR_ERROR_INVALID_ARGUMENT);
    assert_int_equal(custom, 7);

    // Geometries of both kinds are numbered together, and stay of their kind.
    assert_int_equal(kdr_scene_add_triangles(scene, &triangles, &other), KDR_OK);
    assert_int_equal(kdr_scene_add_custom(scene, &good, &custom), KDR_OK);
    assert_true(other == 0 && custom == 1);
    assert_int_equal(kdr_scene_add_triangles(scene, &triangles, &other), KDR_OK);
    assert_int_equal(other, 2);
    for (int i = 0; i < 4; i++)
        assert_int_equal(kdr_scene_set_custom(scene, custom, &bad[i]), KDR_ERROR_INVALID_ARGUMENT);
    assert_int_equal(kdr_scene_set_custom(scene, 0, &good), KDR_ERROR_INVALID_ARGUMENT);
    assert_int_equal(kdr_scene_set_custom(scene, 3, &good), KDR_ERROR_INVALID_ARGUMENT);
    assert_int_equal(kdr_scene_set_custom(NULL, custom, &good), KDR_ERROR_INVALID_ARGUMENT);
    assert_int_equal(kdr_scene_set_triangles(scene, custom, &triangles), KDR_ERROR_INVALID_ARGUMENT);
    assert_int_equal(kdr_scene_set_custom(scene, custom, &good), KDR_OK);
    assert_int_equal(kdr_scene_set_triangles(scene, 2, &triangles), KDR_OK);
    assert_int_equal(kdr_scene_touch(scene, custom), KDR_OK);

    assert_int_equal(kdr_scene_commit(scene, NULL), KDR_OK);
    assert_int_equal(ask_along_z(scene).hit.geometry, custom);
    kdr_scene_destroy(scene);
    kdr_device_destroy(device);
    free(p);
}

static void a_callback_gets_the_ray_as_short_as_it_is_known_to_be_and_its_hit_is_handed_on(void **state) {
    (void)state;
    puppets *p = puppets_create();
    kdr_device *device = device_of(1, NULL);
    kdr_scene *scene = scene_of(device);
    kdr_triangles_def triangles = triangle_at_5();
    kdr_custom_def def = puppets_def(p, 1);
    assert_int_equal(kdr_scene_add_triangles(scene, &triangles, NULL), KDR_OK);
    assert_int_equal(kdr_scene_add_custom(scene, &def, NULL), KDR_OK);
    assert_int_equal(kdr_scene_commit(scene, NULL), KDR_OK);
    kdr_ray_hit ray = {.ray = {.direction_z = 1, .tmin = 0.5f, .tmax = 100, .time = 3, .mask = 4, .id = 5, .flags = 6}};
    kdr_ray asked = ray.ray;
    kdr_intersect1(scene, &ray);
    asked.tmax = 5;
    assert_memory_equal(&p->asked, &asked, sizeof asked);
    assert_true(ray.ray.tmax == 2 && ray.hit.normal_x == 3 && ray.hit.normal_y == 4 && ray.hit.normal_z == 5);
    assert_true(ray.hit.u == 6 && ray.hit.v == 7 && ray.hit.geometry == 1 && ray.hit.primitive == 0);
    assert_int_equal(ray.hit.instance, KDR_INVALID_ID);
    kdr_scene_destroy(scene);
    kdr_device_destroy(device);
    free(p);
}

static void a_hit_outside_the_interval_is_not_believed(void **state) {
    (void)state;
    puppets *p = puppets_create();
    kdr_device *device = device_of(1, NULL);
    kdr_scene *scene = scene_of(device);
    kdr_custom_def def = puppets_def(p, 1);
    assert_int_equal(kdr_scene_add_custom(scene, &def, NULL), KDR_OK);
    assert_int_equal(kdr_scene_commit(scene, NULL), KDR_OK);
    static const struct {
        float t;
        bool hit;
    } cases[] = {{1.5f, false}, {1.50001f, true},  {4, true},  {4.00001f, false},
                 {NAN, false},  {INFINITY, false}, {-2, false}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        p->says.t = cases[i].t;
        kdr_ray_hit ray = {.ray = {.direction_z = 1, .tmin = 1.5f, .tmax = 4}};
        kdr_ray before = ray.ray;
        p->calls = 0;
        assert_int_equal(kdr_occluded1(scene, &before), cases[i].hit);
        kdr_intersect1(scene, &ray);
        assert_int_equal(p->calls, 2);
        assert_int_equal(ray.hit.geometry != KDR_INVALID_ID, cases[i].hit);
        if (!cases[i].hit)
            assert_memory_equal(&ray.ray, &before, sizeof before);
    }
    p->says.t = 2;
    p->hits = false;
    assert_int_equal(ask_along_z(scene).hit.geometry, KDR_INVALID_ID);
    kdr_scene_destroy(scene);
    kdr_device_destroy(device);
    free(p);
}

static void rays_that_are_not_valid_call_nobody(void **state) {
    (void)state;
    puppets *p = puppets_create();
    kdr_device *device = device_of(1, NULL);
    kdr_scene *scene = scene_of(device);
    kdr_custom_def def = puppets_def(p, 4);
    assert_int_equal(kdr_scene_add_custom(scene, &def, NULL), KDR_OK);
    assert_int_equal(kdr_scene_commit(scene, NULL), KDR_OK);
    const kdr_ray wrong[] = {
        {.direction_z = 1, .tmin = 3, .tmax = 3},
        {.direction_z = 1, .tmin = NAN, .tmax = 3},
        {.direction_z = 1, .tmax = NAN},
        {.tmax = 3},
        {.direction_z = INFINITY, .tmax = 3},
        {.direction_z = 1, .origin_x = NAN, .tmax = 3},
        {.direction_z = 1, .tmin = INFINITY, .tmax = INFINITY},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        kdr_ray_hit ray = {.ray = wrong[i]};
        kdr_intersect1(scene, &ray);
        assert_int_equal(ray.hit.geometry, KDR_INVALID_ID);
        assert_false(kdr_occluded1(scene, &wrong[i]));
    }
    assert_int_equal(p->calls, 0);
    assert_true(kdr_occluded1(scene, &(kdr_ray){.direction_z = 1, .tmax = 3}));
    kdr_scene_destroy(scene);
    kdr_device_destroy(device);
    free(p);
}

static void boxes_that_are_not_finite_are_left_out_and_counted(void **state) {
    (void)state;
    static const float odd[] = {NAN, INFINITY, -INFINITY};
    kdr_device *device = device_of(1, NULL);
    for (int field = 0; field < 6; field++) {
        for (int value = 0; value < 3; value++) {
            puppets *p = puppets_create();
            kdr_scene *scene = scene_of(device);
            kdr_custom_def def = puppets_def(p, 4);
            p->boxes[2][field] = odd[value];
            assert_int_equal(kdr_scene_add_custom(scene, &def, NULL), KDR_OK);
            assert_int_equal(kdr_scene_commit(scene, NULL), KDR_OK);
            kdr_tree_stats stats;
            assert_int_equal(kdr_scene_stats(scene, &stats), KDR_OK);
            assert_true(stats.custom_count == 3 && stats.dropped_count == 1 && stats.triangle_count == 0);
            assert_int_equal(kdr_scene_verify(scene), KDR_OK);
            p->says.t = 9;
            kdr_ray_hit ray = {.ray = {.direction_z = 1, .tmin = 8, .tmax = 9.5f}};
            kdr_intersect1(scene, &ray);
            assert_int_equal(ray.hit.geometry, KDR_INVALID_ID);
            kdr_scene_destroy(scene);
            free(p);
        }
    }
    kdr_device_destroy(device);
}

static void a_box_that_is_upside_down_is_an_error_that_names_it(void **state) {
    (void)state;
    puppets *p = puppets_create();
    kdr_device *device = device_of(1, NULL);
    kdr_scene *scene = scene_of(device);
    kdr_triangles_def triangles = triangle_at_5();
    kdr_custom_def def = puppets_def(p, 4);
    assert_int_equal(kdr_scene_add_triangles(scene, &triangles, NULL), KDR_OK);
    assert_int_equal(kdr_scene_add_custom(scene, &def, NULL), KDR_OK);
    assert_int_equal(kdr_scene_commit(scene, NULL), KDR_OK);
    uint64_t hash = kdr_scene_hash(scene);
    p->boxes[1][0] = NAN;
    p->boxes[2][1] = 8;
    p->boxes[3][2] = 50;
    assert_int_equal(kdr_scene_touch(scene, 1), KDR_OK);
    assert_int_equal(kdr_scene_commit(scene, NULL), KDR_ERROR_INVALID_DATA);
    assert_string_equal(last_message,
                        "custom primitive 2 of geometry 1 has a box from 8 to 1 on axis y (2 such boxes in all)");
    assert_true(kdr_scene_hash(scene) == hash);
    assert_int_equal(ask_along_z(scene).hit.geometry, 1);

    // Put right, it is committed.
    p->boxes[2][1] = p->boxes[3][2] = p->boxes[1][0] = 0;
    assert_int_equal(kdr_scene_commit(scene, NULL), KDR_OK);
    assert_true(kdr_scene_hash(scene) != hash);
    kdr_scene_destroy(scene);
    kdr_device_destroy(device);
    free(p);
}

static void a_new_def_or_a_touch_counts_from_the_next_commit_on(void **state) {
    (void)state;
    puppets *p = puppets_create(), *q = puppets_create();
    kdr_device *device = device_of(1, NULL);
    kdr_scene *scene = scene_of(device);
    kdr_custom_def def = puppets_def(p, 4), other = puppets_def(q, 1);
    q->says.t = 3;
    uint32_t geometry;
    assert_int_equal(kdr_scene_add_custom(scene, &def, &geometry), KDR_OK);
    assert_int_equal(ask_along_z(scene).hit.geometry, KDR_INVALID_ID);
    assert_int_equal(kdr_scene_commit(scene, NULL), KDR_OK);
    uint64_t hash = kdr_scene_hash(scene);

    // The def was copied, and the new one waits.
    def.intersect = NULL;
    assert_int_equal(kdr_scene_set_custom(scene, geometry, &other), KDR_OK);
    assert_true(ask_along_z(scene).ray.tmax == 2 && q->calls == 0);
    assert_int_equal(kdr_scene_commit(scene, NULL), KDR_OK);
    assert_true(ask_along_z(scene).ray.tmax == 3 && kdr_scene_hash(scene) != hash);

    // Boxes that move are looked at when the scene is told.
    hash = kdr_scene_hash(scene);
    q->boxes[0][0] = -2;
    assert_int_equal(kdr_scene_commit(scene, NULL), KDR_OK);
    assert_true(kdr_scene_hash(scene) == hash);
    assert_int_equal(kdr_scene_touch(scene, geometry), KDR_OK);
    assert_int_equal(kdr_scene_commit(scene, NULL), KDR_OK);
    assert_true(kdr_scene_hash(scene) != hash);

    // No primitive: the number stays taken.
    other.primitive_count = 0;
    assert_int_equal(kdr_scene_set_custom(scene, geometry, &other), KDR_OK);
    assert_int_equal(kdr_scene_commit(scene, NULL), KDR_OK);
    assert_int_equal(ask_along_z(scene).hit.geometry, KDR_INVALID_ID);
    float bounds[6];
    kdr_scene_bounds(scene, bounds);
    assert_true(bounds[0] > bounds[3]);
    assert_int_equal(kdr_scene_add_custom(scene, &other, &geometry), KDR_OK);
    assert_int_equal(geometry, 1);
    kdr_scene_destroy(scene);
    kdr_device_destroy(device);
    free(p);
    free(q);
}

static void too_many_primitives_are_refused_before_memory_is_asked_for(void **state) {
    (void)state;
    puppets *p = puppets_create();
    kdr_device *device = device_of(1, NULL);
    kdr_scene *scene = scene_of(device);
    kdr_custom_def def = puppets_def(p, UINT32_MAX);
    assert_int_equal(kdr_scene_add_custom(scene, &def, NULL), KDR_OK);
    assert_int_equal(kdr_scene_add_custom(scene, &def, NULL), KDR_OK);
    size_t bytes = kdr_device_bytes(device);
    assert_int_equal(kdr_scene_commit(scene, NULL), KDR_ERROR_LIMIT);
    kdr_device_trim(device);
    assert_true(kdr_device_bytes(device) <= bytes && kdr_device_peak_bytes(device) < bytes + (64 << 20));
    kdr_scene_destroy(scene);
    kdr_device_destroy(device);
    free(p);
}

static void a_geometry_that_gets_no_memory_is_not_added(void **state) {
    (void)state;
    puppets *p = puppets_create();
    failing_alloc memory;
    failing_alloc_init(&memory);
    kdr_allocator functions = failing_alloc_functions(&memory);
    kdr_device *device = device_of(1, &functions);
    kdr_custom_def def = puppets_def(p, 1);
    kdr_triangles_def triangles = triangle_at_5();
    for (uint64_t n = 1;; n++) {
        kdr_scene *scene = scene_of(device);
        failing_alloc_fail_nth(&memory, n);
        for (uint32_t i = 0; i < 20; i++) {
            uint32_t geometry = KDR_INVALID_ID;
            bool custom = i % 3 == 2;
            for (int attempt = 0; attempt < 2 && geometry == KDR_INVALID_ID; attempt++) {
                kdr_status status = custom ? kdr_scene_add_custom(scene, &def, &geometry)
                                           : kdr_scene_add_triangles(scene, &triangles, &geometry);
                assert_int_equal(status, geometry == i ? KDR_OK : KDR_ERROR_OUT_OF_MEMORY);
            }
            assert_int_equal(geometry, i);
        }
        bool failed = memory.failures > 0;
        failing_alloc_fail_nth(&memory, 0);
        assert_int_equal(kdr_scene_commit(scene, NULL), KDR_OK);
        assert_int_equal(ask_along_z(scene).hit.geometry, 2);
        kdr_scene_destroy(scene);
        if (!failed) {
            assert_true(n > 3);
            break;
        }
    }
    kdr_device_destroy(device);
    assert_true(failing_alloc_is_clean(&memory));
    free(p);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(wrong_defs_and_numbers_are_refused_and_change_nothing),
        cmocka_unit_test(a_callback_gets_the_ray_as_short_as_it_is_known_to_be_and_its_hit_is_handed_on),
        cmocka_unit_test(a_hit_outside_the_interval_is_not_believed),
        cmocka_unit_test(rays_that_are_not_valid_call_nobody),
        cmocka_unit_test(boxes_that_are_not_finite_are_left_out_and_counted),
        cmocka_unit_test(a_box_that_is_upside_down_is_an_error_that_names_it),
        cmocka_unit_test(a_new_def_or_a_touch_counts_from_the_next_commit_on),
        cmocka_unit_test(too_many_primitives_are_refused_before_memory_is_asked_for),
        cmocka_unit_test(a_geometry_that_gets_no_memory_is_not_added),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
