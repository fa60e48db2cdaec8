/* The rules written at kdr_intersect1, one by one, on scenes small enough to see the answer. */
#include "support/everywhere.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

static const float square[18] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 0, 0, 1, 0};

static kdr_triangles_def triangles_of(const float *vertices, size_t count) {
    kdr_triangles_def def = kdr_default_triangles_def();
    def.vertices = vertices;
    def.vertex_count = 3 * count;
    def.triangle_count = count;
    return def;
}

typedef struct fixture {
    kdr_device *device;
    kdr_scene *scene;
} fixture;

static fixture fixture_of(const kdr_triangles_def *defs, uint32_t count) {
    fixture made = {NULL, NULL};
    assert_int_equal(kdr_device_create(NULL, &made.device), KDR_OK);
    made.scene = committed_scene(made.device, defs, count, NULL);
    return made;
}

static fixture square_fixture(void) {
    kdr_triangles_def def = triangles_of(square, 2);
    return fixture_of(&def, 1);
}

static void fixture_destroy(fixture *made) {
    kdr_scene_destroy(made->scene);
    kdr_device_destroy(made->device);
}

static kdr_ray downwards(float x, float y) {
    return (kdr_ray){.origin_x = x, .origin_y = y, .origin_z = 2, .direction_z = -1, .tmax = INFINITY};
}

/* The hit of every query, which must agree on whether there is one. */
static kdr_ray_hit ask(const kdr_scene *scene, const kdr_ray *ray) {
    kdr_ray_hit one = {.ray = *ray}, many = {.ray = *ray};
    uint8_t occluded = 7;
    kdr_intersect1(scene, &one);
    kdr_intersect_n(scene, NULL, &many, 1);
    kdr_occluded_n(scene, NULL, ray, &occluded, 1);
    bool hit = one.hit.geometry != KDR_INVALID_ID;
    assert_int_equal(kdr_occluded1(scene, ray), hit);
    assert_int_equal(occluded, hit);
    assert_int_equal(many.hit.geometry, one.hit.geometry);
    assert_memory_equal(&many.ray, &one.ray, sizeof(kdr_ray));
    if (!hit)
        assert_memory_equal(&one.ray, ray, sizeof(kdr_ray));
    return one;
}

static bool hits(const kdr_scene *scene, const kdr_ray *ray) { return ask(scene, ray).hit.geometry != KDR_INVALID_ID; }

static void tmin_is_exclusive_and_tmax_inclusive(void **state) {
    (void)state;
    fixture made = square_fixture();
    kdr_ray ray = downwards(0.75f, 0.25f);
    assert_true(ask(made.scene, &ray).ray.tmax == 2);
    ray.tmax = 2;
    assert_true(hits(made.scene, &ray));
    ray.tmax = nextafterf(2, 0);
    assert_false(hits(made.scene, &ray));
    ray.tmax = 3;
    ray.tmin = nextafterf(2, 0);
    assert_true(hits(made.scene, &ray));
    ray.tmin = 2;
    assert_false(hits(made.scene, &ray));
    fixture_destroy(&made);
}

static void an_interval_that_is_empty_or_backwards_has_no_hit(void **state) {
    (void)state;
    fixture made = square_fixture();
    const float intervals[][2] = {{2, 2}, {3, 1}, {INFINITY, INFINITY}, {INFINITY, 0}, {0, -INFINITY}, {2.5f, 1.5f}};
    for (size_t i = 0; i < sizeof(intervals) / sizeof(intervals[0]); i++) {
        kdr_ray ray = downwards(0.75f, 0.25f);
        ray.tmin = intervals[i][0];
        ray.tmax = intervals[i][1];
        assert_false(hits(made.scene, &ray));
    }
    fixture_destroy(&made);
}

static void a_negative_tmin_looks_behind_the_origin(void **state) {
    (void)state;
    fixture made = square_fixture();
    kdr_ray ray = downwards(0.75f, 0.25f);
    ray.direction_z = 1;
    assert_false(hits(made.scene, &ray));
    ray.tmin = -2.5f;
    assert_true(ask(made.scene, &ray).ray.tmax == -2);
    ray.tmin = -2;
    assert_false(hits(made.scene, &ray));
    ray.tmin = -INFINITY;
    assert_true(ask(made.scene, &ray).ray.tmax == -2);
    ray.tmax = -1;
    assert_true(ask(made.scene, &ray).ray.tmax == -2);
    fixture_destroy(&made);
}

static void an_origin_on_the_triangle_hits_only_below_a_negative_tmin(void **state) {
    (void)state;
    fixture made = square_fixture();
    kdr_ray ray = downwards(0.75f, 0.25f);
    ray.origin_z = 0;
    assert_false(hits(made.scene, &ray));
    ray.tmin = -0x1p-149f;
    assert_true(ask(made.scene, &ray).ray.tmax == 0);
    fixture_destroy(&made);
}

static void a_ray_with_nan_or_infinite_parts_or_without_direction_misses(void **state) {
    (void)state;
    fixture made = square_fixture();
    const float bad[] = {NAN, -NAN, INFINITY, -INFINITY};
    for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++) {
        for (size_t part = 0; part < 8; part++) {
            kdr_ray ray = downwards(0.75f, 0.25f);
            float *parts[8] = {&ray.origin_x,    &ray.origin_y,    &ray.origin_z, &ray.direction_x,
                               &ray.direction_y, &ray.direction_z, &ray.tmin,     &ray.tmax};
            *parts[part] = bad[i];
            bool allowed = (part == 6 && bad[i] == -INFINITY) || (part == 7 && bad[i] == INFINITY);
            assert_int_equal(hits(made.scene, &ray), allowed);
        }
    }
    kdr_ray ray = downwards(0.75f, 0.25f);
    ray.direction_z = -0.0f;
    assert_false(hits(made.scene, &ray));
    fixture_destroy(&made);
}

static void time_mask_id_and_flags_are_not_read(void **state) {
    (void)state;
    fixture made = square_fixture();
    kdr_ray ray = downwards(0.75f, 0.25f);
    ray.time = NAN;
    ray.mask = 0;
    ray.id = 77;
    ray.flags = UINT32_MAX;
    kdr_ray_hit given = ask(made.scene, &ray);
    assert_int_equal(given.hit.primitive, 0);
    ray.tmax = 2;
    assert_memory_equal(&given.ray, &ray, sizeof(ray));
    fixture_destroy(&made);
}

static void a_hit_carries_weights_normal_and_identity(void **state) {
    (void)state;
    fixture made = square_fixture();
    kdr_ray ray = downwards(0.75f, 0.25f);
    kdr_ray_hit given = ask(made.scene, &ray);
    // a + u (b - a) + v (c - a) with b - a = x and c - a = x + y.
    assert_float_equal(given.hit.u, 0.5, 1e-6);
    assert_float_equal(given.hit.v, 0.25, 1e-6);
    assert_true(given.hit.normal_x == 0 && given.hit.normal_y == 0 && given.hit.normal_z == 1);
    assert_int_equal(given.hit.primitive, 0);
    assert_int_equal(given.hit.geometry, 0);
    assert_int_equal(given.hit.instance, KDR_INVALID_ID);
    fixture_destroy(&made);
}

static void the_shared_edge_of_two_triangles_belongs_to_the_lower_one(void **state) {
    (void)state;
    fixture made = square_fixture();
    for (int i = 0; i <= 64; i++) {
        kdr_ray ray = downwards((float)i / 64, (float)i / 64);
        assert_int_equal(ask(made.scene, &ray).hit.primitive, 0);
    }
    fixture_destroy(&made);
}

static void of_equal_distances_the_lowest_geometry_then_the_lowest_primitive_wins(void **state) {
    (void)state;
    enum { COPIES = 40 };
    float vertices[9 * COPIES], mirrored[9 * COPIES];
    for (int i = 0; i < COPIES; i++) {
        memcpy(vertices + 9 * i, square, 9 * sizeof(float));
        memcpy(mirrored + 9 * i, square + 9, 9 * sizeof(float));
    }
    // Geometry 0 covers the upper half only, 1 the lower, 2 both.
    kdr_triangles_def defs[3] = {triangles_of(mirrored, COPIES), triangles_of(vertices, COPIES),
                                 triangles_of(square, 2)};
    fixture made = fixture_of(defs, 3);
    kdr_ray ray = downwards(0.25f, 0.75f);
    kdr_ray_hit given = ask(made.scene, &ray);
    assert_true(given.hit.geometry == 0 && given.hit.primitive == 0);
    ray = downwards(0.75f, 0.25f);
    given = ask(made.scene, &ray);
    assert_true(given.hit.geometry == 1 && given.hit.primitive == 0);
    ray = downwards(0.5f, 0.5f);
    given = ask(made.scene, &ray);
    assert_true(given.hit.geometry == 0 && given.hit.primitive == 0);
    fixture_destroy(&made);
}

static void distances_that_round_to_one_float_are_a_tie(void **state) {
    (void)state;
    // The second triangle is nearer by less than a float of the distance can say.
    float vertices[18];
    memcpy(vertices, square, 9 * sizeof(float));
    memcpy(vertices + 9, square, 9 * sizeof(float));
    vertices[11] = vertices[14] = vertices[17] = 0x1p-30f;
    kdr_triangles_def def = triangles_of(vertices, 2);
    fixture made = fixture_of(&def, 1);
    kdr_ray ray = downwards(0.75f, 0.25f);
    kdr_ray_hit given = ask(made.scene, &ray);
    assert_true(given.hit.primitive == 0 && given.ray.tmax == 2);
    ray.origin_z = 0x1p-7f;
    given = ask(made.scene, &ray);
    assert_true(given.hit.primitive == 1 && given.ray.tmax == 0x1p-7f - 0x1p-30f);
    fixture_destroy(&made);
}

static void a_triangle_seen_edge_on_or_without_area_is_never_hit(void **state) {
    (void)state;
    const float vertices[18] = {0, 0, 0, 2, 0, 0, 0, 2, 0, 0.5f, 0.5f, 1, 0.5f, 0.5f, 1, 1, 1, 1};
    kdr_triangles_def def = triangles_of(vertices, 2);
    fixture made = fixture_of(&def, 1);
    kdr_ray ray = {.origin_x = -1, .origin_y = 0.5f, .direction_x = 1, .tmax = INFINITY};
    assert_false(hits(made.scene, &ray));
    ray.origin_x = 0.25f; // from within
    assert_false(hits(made.scene, &ray));
    ray = downwards(0.5f, 0.5f);
    assert_int_equal(ask(made.scene, &ray).hit.primitive, 0);
    kdr_tree_stats stats;
    assert_int_equal(kdr_scene_stats(made.scene, &stats), KDR_OK);
    assert_int_equal(stats.degenerate_count, 1);
    assert_int_equal(stats.triangle_count, 1);
    fixture_destroy(&made);
}

static void a_scene_without_triangles_or_not_yet_committed_answers_miss(void **state) {
    (void)state;
    kdr_device *device;
    kdr_scene *scene;
    assert_int_equal(kdr_device_create(NULL, &device), KDR_OK);
    assert_int_equal(kdr_scene_create(device, &scene), KDR_OK);
    kdr_ray ray = downwards(0.75f, 0.25f);
    assert_false(hits(scene, &ray));
    kdr_triangles_def def = triangles_of(square, 2);
    assert_int_equal(kdr_scene_add_triangles(scene, &def, NULL), KDR_OK);
    assert_false(hits(scene, &ray));
    def.triangle_count = 0;
    assert_int_equal(kdr_scene_set_triangles(scene, 0, &def), KDR_OK);
    assert_int_equal(kdr_scene_commit(scene, NULL), KDR_OK);
    assert_false(hits(scene, &ray));
    float bounds[6];
    kdr_scene_bounds(scene, bounds);
    for (int axis = 0; axis < 3; axis++)
        assert_true(bounds[axis] > bounds[axis + 3]);
    kdr_scene_destroy(scene);
    kdr_device_destroy(device);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tmin_is_exclusive_and_tmax_inclusive),
        cmocka_unit_test(an_interval_that_is_empty_or_backwards_has_no_hit),
        cmocka_unit_test(a_negative_tmin_looks_behind_the_origin),
        cmocka_unit_test(an_origin_on_the_triangle_hits_only_below_a_negative_tmin),
        cmocka_unit_test(a_ray_with_nan_or_infinite_parts_or_without_direction_misses),
        cmocka_unit_test(time_mask_id_and_flags_are_not_read),
        cmocka_unit_test(a_hit_carries_weights_normal_and_identity),
        cmocka_unit_test(the_shared_edge_of_two_triangles_belongs_to_the_lower_one),
        cmocka_unit_test(of_equal_distances_the_lowest_geometry_then_the_lowest_primitive_wins),
        cmocka_unit_test(distances_that_round_to_one_float_are_a_tie),
        cmocka_unit_test(a_triangle_seen_edge_on_or_without_area_is_never_hit),
        cmocka_unit_test(a_scene_without_triangles_or_not_yet_committed_answers_miss),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
