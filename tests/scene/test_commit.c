/* What a commit changes and what it leaves alone. */
#include "support/everywhere.h"
#include "support/awkward_rays.h"
#include "support/soup.h"
#include "support/test_size.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define TRIANGLES 600
#define RAYS TEST_SIZE(2000)

typedef struct fixture {
    kdr_device *device;
    kdr_scene *scene;
    soup_scene soup;
} fixture;

static fixture fixture_create(const char *kind, uint64_t sequence) {
    fixture made = {0};
    test_random random = test_random_start(test_random_seed(), sequence);
    made.soup = soup_scene_create_kind(&random, soup_kind_find(kind), TRIANGLES);
    assert_int_equal(kdr_device_create(NULL, &made.device), KDR_OK);
    made.scene = committed_scene(made.device, made.soup.geometries, SOUP_GEOMETRIES, NULL);
    return made;
}

static void fixture_destroy(fixture *made) {
    kdr_scene_destroy(made->scene);
    kdr_device_destroy(made->device);
    soup_scene_destroy(&made->soup);
}

/* The scene answers as the oracle says of these geometries, and its tree is that of a scene made from nothing. */
static void assert_equal_to_fresh(const fixture *made, const kdr_triangles_def *geometries, uint32_t count) {
    test_random random = test_random_start(test_random_seed(), 77);
    oracle_scene scene = oracle_scene_create(geometries, count);
    oracle_tree tree = oracle_tree_create(&scene);
    kdr_ray *rays = awkward_rays_create(&random, &tree, RAYS);
    query_sheet sheet = query_sheet_create(&tree, rays, RAYS);
    assert_int_equal(query_sheet_differences(&sheet, made->scene, "scene after a commit"), 0);
    assert_int_equal(kdr_scene_verify(made->scene), KDR_OK);

    kdr_scene *fresh = committed_scene(made->device, geometries, count, NULL);
    assert_true(kdr_scene_hash(fresh) == kdr_scene_hash(made->scene));
    kdr_scene_destroy(fresh);
    query_sheet_destroy(&sheet);
    free(rays);
    oracle_tree_destroy(&tree);
    oracle_scene_destroy(&scene);
}

/* Moves every vertex of a geometry; NaN stays NaN. */
static void move(const kdr_triangles_def *def, float distance) {
    for (size_t i = 0; i < def->vertex_count; i++) {
        float *vertex = (float *)((char *)(uintptr_t)def->vertices + i * def->vertex_stride);
        vertex[i % 3] += distance * (float)(1 + i % 5);
    }
}

static void a_commit_of_an_unchanged_scene_does_nothing(void **state) {
    (void)state;
    fixture made = fixture_create("large", 1);
    uint64_t hash = kdr_scene_hash(made.scene);
    kdr_tree_stats before, after;
    assert_int_equal(kdr_scene_stats(made.scene, &before), KDR_OK);
    // Without a touch, new contents are not looked at.
    move(&made.soup.geometries[0], 0.5f);
    assert_int_equal(kdr_scene_commit(made.scene, NULL), KDR_OK);
    kdr_build_def def = kdr_default_build_def();
    assert_int_equal(kdr_scene_commit(made.scene, &def), KDR_OK);
    assert_int_equal(kdr_scene_stats(made.scene, &after), KDR_OK);
    assert_true(kdr_scene_hash(made.scene) == hash);
    assert_memory_equal(&before, &after, sizeof(before));
    fixture_destroy(&made);
}

static void a_touched_geometry_is_read_again(void **state) {
    (void)state;
    fixture made = fixture_create("large", 2);
    for (uint32_t i = 0; i < SOUP_GEOMETRIES; i++) {
        if (made.soup.geometries[i].vertex_count == 0)
            continue;
        uint64_t hash = kdr_scene_hash(made.scene);
        move(&made.soup.geometries[i], 0.03f);
        assert_int_equal(kdr_scene_touch(made.scene, i), KDR_OK);
        assert_true(kdr_scene_hash(made.scene) == hash); // not before the commit
        assert_int_equal(kdr_scene_commit(made.scene, NULL), KDR_OK);
        assert_true(kdr_scene_hash(made.scene) != hash);
        assert_equal_to_fresh(&made, made.soup.geometries, SOUP_GEOMETRIES);
    }
    fixture_destroy(&made);
}

static void queries_read_copies_and_not_the_arrays(void **state) {
    (void)state;
    fixture made = fixture_create("large", 3);
    oracle_scene scene = oracle_scene_create(made.soup.geometries, SOUP_GEOMETRIES);
    oracle_tree tree = oracle_tree_create(&scene);
    test_random random = test_random_start(test_random_seed(), 78);
    kdr_ray *rays = awkward_rays_create(&random, &tree, RAYS);
    query_sheet sheet = query_sheet_create(&tree, rays, RAYS);
    for (uint32_t i = 0; i < SOUP_GEOMETRIES; i++)
        move(&made.soup.geometries[i], 0.7f);
    assert_int_equal(query_sheet_differences(&sheet, made.scene, "scene with moved arrays"), 0);
    query_sheet_destroy(&sheet);
    free(rays);
    oracle_tree_destroy(&tree);
    oracle_scene_destroy(&scene);
    fixture_destroy(&made);
}

static void a_geometry_can_get_other_arrays_and_counts(void **state) {
    (void)state;
    fixture made = fixture_create("large", 4);
    test_random random = test_random_start(test_random_seed(), 5);
    soup_scene other = soup_scene_create_kind(&random, soup_kind_find("grid"), 90);
    kdr_triangles_def defs[SOUP_GEOMETRIES];
    memcpy(defs, made.soup.geometries, sizeof(defs));
    for (uint32_t i = 0; i < SOUP_GEOMETRIES; i++) {
        defs[i] = other.geometries[SOUP_GEOMETRIES - 1 - i];
        assert_int_equal(kdr_scene_set_triangles(made.scene, i, &defs[i]), KDR_OK);
        assert_int_equal(kdr_scene_commit(made.scene, NULL), KDR_OK);
        assert_equal_to_fresh(&made, defs, SOUP_GEOMETRIES);
    }
    fixture_destroy(&made);
    soup_scene_destroy(&other);
}

static void an_added_geometry_takes_part_from_the_next_commit_on(void **state) {
    (void)state;
    fixture made = fixture_create("small", 6);
    uint64_t hash = kdr_scene_hash(made.scene);
    kdr_triangles_def defs[SOUP_GEOMETRIES + 1];
    memcpy(defs, made.soup.geometries, sizeof(made.soup.geometries));
    defs[SOUP_GEOMETRIES] = defs[3];
    uint32_t geometry;
    assert_int_equal(kdr_scene_add_triangles(made.scene, &defs[3], &geometry), KDR_OK);
    assert_int_equal(geometry, SOUP_GEOMETRIES);
    assert_true(kdr_scene_hash(made.scene) == hash);
    assert_int_equal(kdr_scene_commit(made.scene, NULL), KDR_OK);
    assert_equal_to_fresh(&made, defs, SOUP_GEOMETRIES + 1);
    fixture_destroy(&made);
}

static void another_build_def_builds_another_tree(void **state) {
    (void)state;
    fixture made = fixture_create("large", 7);
    uint64_t hash = kdr_scene_hash(made.scene);
    kdr_build_def def = kdr_default_build_def();
    def.depth_limit = 2;
    assert_int_equal(kdr_scene_commit(made.scene, &def), KDR_OK);
    kdr_tree_stats stats;
    assert_int_equal(kdr_scene_stats(made.scene, &stats), KDR_OK);
    assert_true(stats.depth <= 2 && kdr_scene_hash(made.scene) != hash);
    assert_int_equal(kdr_scene_commit(made.scene, NULL), KDR_OK);
    assert_true(kdr_scene_hash(made.scene) == hash);
    fixture_destroy(&made);
}

static void a_vertex_number_out_of_range_fails_the_commit_and_keeps_the_old_tree(void **state) {
    (void)state;
    fixture made = fixture_create("large", 8);
    uint64_t hash = kdr_scene_hash(made.scene);
    const kdr_triangles_def *def = &made.soup.geometries[2];
    uint32_t *indices = made.soup.arrays[5], last = (uint32_t)def->triangle_count * 3 - 1;
    const uint32_t bad[] = {(uint32_t)def->vertex_count, UINT32_MAX, 0x80000000u};
    for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++) {
        uint32_t good = indices[last - i];
        indices[last - i] = bad[i];
        assert_int_equal(kdr_scene_touch(made.scene, 2), KDR_OK);
        assert_int_equal(kdr_scene_commit(made.scene, NULL), KDR_ERROR_INVALID_DATA);
        assert_true(kdr_scene_hash(made.scene) == hash);
        assert_int_equal(kdr_scene_verify(made.scene), KDR_OK);
        indices[last - i] = good;
    }
    // The failed commits have not forgotten that there is something to do.
    move(def, 0.1f);
    assert_int_equal(kdr_scene_commit(made.scene, NULL), KDR_OK);
    assert_equal_to_fresh(&made, made.soup.geometries, SOUP_GEOMETRIES);
    fixture_destroy(&made);
}

static void without_indices_three_vertices_a_triangle_are_asked_for(void **state) {
    (void)state;
    static const float vertices[24] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    kdr_device *device;
    kdr_scene *scene;
    assert_int_equal(kdr_device_create(NULL, &device), KDR_OK);
    assert_int_equal(kdr_scene_create(device, &scene), KDR_OK);
    kdr_triangles_def def = kdr_default_triangles_def();
    def.vertices = vertices;
    def.vertex_count = 8;
    def.triangle_count = 3;
    kdr_status added = kdr_scene_add_triangles(scene, &def, NULL);
    if (added == KDR_OK)
        added = kdr_scene_commit(scene, NULL);
    assert_true(added == KDR_ERROR_INVALID_DATA || added == KDR_ERROR_INVALID_ARGUMENT);
    kdr_scene_destroy(scene);
    kdr_device_destroy(device);
}

static void bounds_are_the_smallest_box_around_the_committed_triangles(void **state) {
    (void)state;
    static const char *const kinds[] = {"large", "slabs", "any bits", "not finite", "denormal", "one"};
    for (size_t k = 0; k < sizeof(kinds) / sizeof(kinds[0]); k++) {
        fixture made = fixture_create(kinds[k], 9 + k);
        oracle_scene scene = oracle_scene_create(made.soup.geometries, SOUP_GEOMETRIES);
        float expected[6] = {INFINITY, INFINITY, INFINITY, -INFINITY, -INFINITY, -INFINITY}, bounds[6];
        for (size_t i = 0; i < scene.count; i++) {
            const oracle_primitive *p = &scene.primitives[i];
            for (int axis = 0; axis < 3; axis++) {
                expected[axis] = fminf(expected[axis], fminf(p->a[axis], fminf(p->b[axis], p->c[axis])));
                expected[axis + 3] = fmaxf(expected[axis + 3], fmaxf(p->a[axis], fmaxf(p->b[axis], p->c[axis])));
            }
        }
        kdr_scene_bounds(made.scene, bounds);
        for (int i = 0; i < 6; i++)
            assert_true(bounds[i] == expected[i]);
        oracle_scene_destroy(&scene);
        fixture_destroy(&made);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_commit_of_an_unchanged_scene_does_nothing),
        cmocka_unit_test(a_touched_geometry_is_read_again),
        cmocka_unit_test(queries_read_copies_and_not_the_arrays),
        cmocka_unit_test(a_geometry_can_get_other_arrays_and_counts),
        cmocka_unit_test(an_added_geometry_takes_part_from_the_next_commit_on),
        cmocka_unit_test(another_build_def_builds_another_tree),
        cmocka_unit_test(a_vertex_number_out_of_range_fails_the_commit_and_keeps_the_old_tree),
        cmocka_unit_test(without_indices_three_vertices_a_triangle_are_asked_for),
        cmocka_unit_test(bounds_are_the_smallest_box_around_the_committed_triangles),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
