/* Every splitter with every rule for the axis makes sound trees that answer alike. */
#include "support/awkward_rays.h"
#include "support/everywhere.h"
#include "support/failing_alloc.h"
#include "support/soup.h"
#include "support/test_size.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#define RAYS TEST_SIZE(200)
#define MANY TEST_SIZE(70000) /* enough for nodes that all workers open together */

static const kdr_split_rule splits[] = {KDR_SPLIT_BINNED, KDR_SPLIT_SPACE, KDR_SPLIT_OBJECT, KDR_SPLIT_SWEEP};
static const kdr_axis_rule axes[] = {KDR_AXIS_DEFAULT, KDR_AXIS_BEST, KDR_AXIS_LONGEST, KDR_AXIS_ROBIN};
enum { SPLITS = sizeof splits / sizeof splits[0], AXES = sizeof axes / sizeof axes[0] };

static kdr_build_def plan_of(int split, int axis) {
    kdr_build_def def = kdr_default_build_def();
    def.split = splits[split];
    def.axis = axes[axis];
    return def;
}

static kdr_device *device_of(uint32_t workers) {
    kdr_device_def def = kdr_default_device_def();
    def.worker_count = workers;
    kdr_device *device;
    assert_int_equal(kdr_device_create(&def, &device), KDR_OK);
    return device;
}

static kdr_tree_stats stats_of(const kdr_scene *scene) {
    kdr_tree_stats stats;
    assert_int_equal(kdr_scene_stats(scene, &stats), KDR_OK);
    return stats;
}

static void every_plan_answers_as_the_oracle_on_every_kind_of_soup(void **state) {
    (void)state;
    kdr_device *device = device_of(1);
    for (size_t kind = 0; kind < soup_kind_count; kind++) {
        test_random random = test_random_start(test_random_seed(), kind);
        soup_scene soup = soup_scene_create_kind(&random, &soup_kinds[kind], soup_kinds[kind].count);
        oracle_scene oracle = oracle_scene_create(soup.geometries, SOUP_GEOMETRIES);
        oracle_tree tree = oracle_tree_create(&oracle);
        size_t asked = soup_kinds[kind].is_exact ? RAYS / 6 + 1 : RAYS;
        kdr_ray *rays = awkward_rays_create(&random, &tree, asked);
        query_sheet sheet = query_sheet_create(&tree, rays, asked);
        for (int plan = 0; plan < SPLITS * AXES; plan++) {
            for (uint32_t leaf_limit = 0; leaf_limit <= 1; leaf_limit++) {
                kdr_build_def def = plan_of(plan / AXES, plan % AXES);
                def.leaf_limit = leaf_limit;
                char label[200];
                snprintf(label, sizeof label, "%s, split %d, axis %d, leaf limit %u", soup_kinds[kind].name,
                         (int)def.split, (int)def.axis, leaf_limit);
                kdr_scene *scene = committed_scene(device, soup.geometries, SOUP_GEOMETRIES, &def);
                if (kdr_scene_verify(scene) != KDR_OK)
                    fail_msg("%s: the tree is not sound", label);
                assert_int_equal(query_sheet_differences(&sheet, scene, label), 0);
                kdr_scene_destroy(scene);
            }
        }
        query_sheet_destroy(&sheet);
        free(rays);
        oracle_tree_destroy(&tree);
        oracle_scene_destroy(&oracle);
        soup_scene_destroy(&soup);
    }
    kdr_device_destroy(device);
}

/* Fails the running test unless 1, 2 and 7 workers build one tree of these triangles by every plan. */
static void hold_workers_equal(const soup_scene *soup, const char *name) {
    static const uint32_t workers[] = {1, 2, 7};
    uint64_t hashes[SPLITS * AXES] = {0};
    for (int w = 0; w < 3; w++) {
        kdr_device *device = device_of(workers[w]);
        for (int plan = 0; plan < SPLITS * AXES; plan++) {
            kdr_build_def def = plan_of(plan / AXES, plan % AXES);
            kdr_scene *scene = committed_scene(device, soup->geometries, SOUP_GEOMETRIES, &def);
            uint64_t hash = kdr_scene_hash(scene);
            kdr_scene_destroy(scene);
            if (w > 0 && hash != hashes[plan])
                fail_msg("%s: split %d, axis %d: %u workers build another tree", name, (int)def.split, (int)def.axis,
                         workers[w]);
            hashes[plan] = hash;
        }
        kdr_device_destroy(device);
    }
}

static void the_tree_of_every_plan_is_the_same_for_any_number_of_workers(void **state) {
    (void)state;
    for (size_t kind = 0; kind < soup_kind_count; kind++) {
        test_random random = test_random_start(test_random_seed(), 100 + kind);
        soup_scene soup = soup_scene_create_kind(&random, &soup_kinds[kind], soup_kinds[kind].count);
        hold_workers_equal(&soup, soup_kinds[kind].name);
        soup_scene_destroy(&soup);
    }
    static const char *const large[] = {"small", "duplicates", "any bits"};
    for (size_t i = 0; i < sizeof large / sizeof large[0]; i++) {
        test_random random = test_random_start(test_random_seed(), 200 + i);
        soup_scene soup = soup_scene_create_kind(&random, soup_kind_find(large[i]), MANY);
        hold_workers_equal(&soup, large[i]);
        soup_scene_destroy(&soup);
    }
}

static void every_instruction_set_builds_the_tree_of_every_plan(void **state) {
    (void)state;
    test_random random = test_random_start(test_random_seed(), 300);
    soup_scene soup = soup_scene_create_kind(&random, soup_kind_find("mixed scales"), 2000);
    uint64_t hashes[2 * SPLITS * AXES] = {0};
    for (int isa = KDR_ISA_SCALAR; isa <= KDR_ISA_NEON; isa++) {
        kdr_device *device = device_of_isa((kdr_isa)isa, 1, NULL);
        for (int plan = 0; device && plan < 2 * SPLITS * AXES; plan++) {
            kdr_build_def def = plan_of(plan / 2 / AXES, plan / 2 % AXES);
            def.straddle = plan % 2 == 0 ? KDR_STRADDLE_GENERAL : KDR_STRADDLE_CLIP;
            kdr_scene *scene = committed_scene(device, soup.geometries, SOUP_GEOMETRIES, &def);
            if (hashes[plan] == 0)
                hashes[plan] = kdr_scene_hash(scene);
            assert_true(kdr_scene_hash(scene) == hashes[plan]);
            kdr_scene_destroy(scene);
        }
        kdr_device_destroy(device);
    }
    soup_scene_destroy(&soup);
}

/* ---- what each rule does, on triangles whose tree is known */

/* Small triangles at x = 0, 1, 3, 7 ... on a line. */
#define LINE 16
static kdr_scene *line_scene(kdr_device *device, int axis, const kdr_build_def *def) {
    float vertices[9 * LINE];
    for (int i = 0; i < LINE; i++) {
        for (int k = 0; k < 9; k++) {
            // A triangle of the size 0.25 in a box without a flat side.
            bool far = k % 3 == k / 3;
            vertices[9 * i + k] = (k % 3 == axis ? (float)((1 << i) - 1) : 0) + (far ? 0.25f : 0);
        }
    }
    kdr_triangles_def triangles = kdr_default_triangles_def();
    triangles.vertices = vertices;
    triangles.vertex_count = 3 * LINE;
    triangles.triangle_count = LINE;
    return committed_scene(device, &triangles, 1, def);
}

static void the_object_median_halves_the_primitives_and_the_spatial_median_the_cell(void **state) {
    (void)state;
    kdr_device *device = device_of(1);
    for (int axis = 0; axis < 3; axis++) {
        kdr_build_def def = kdr_default_build_def();
        def.leaf_limit = 1;
        def.split = KDR_SPLIT_OBJECT;
        kdr_scene *scene = line_scene(device, axis, &def);
        kdr_tree_stats stats = stats_of(scene);
        // 16 primitives that can be parted: four levels, whatever their distances are.
        assert_int_equal(stats.depth, 4);
        assert_int_equal(stats.leaf_count, LINE);
        assert_int_equal(stats.reference_count, LINE);
        kdr_scene_destroy(scene);

        def.split = KDR_SPLIT_SPACE;
        scene = line_scene(device, axis, &def);
        stats = stats_of(scene);
        // Each half of the cell holds one primitive, and the others together.
        assert_true(stats.depth > 10);
        kdr_scene_destroy(scene);
    }
    kdr_device_destroy(device);
}

static void one_level_of_a_median_leaves_half_of_the_primitives_on_each_side(void **state) {
    (void)state;
    kdr_device *device = device_of(1);
    for (uint32_t count = 2; count <= 600; count += 1 + count / 8) {
        // Flat triangles in planes of their own, in no order.
        float *vertices = test_allocate(9 * count, sizeof(float));
        for (uint32_t i = 0; i < count; i++)
            for (uint32_t k = 0; k < 9; k++)
                vertices[9 * i + k] = k % 3 == 0 ? (float)(i * 601 % 607) : (float)(k == 4 || k == 8);
        kdr_triangles_def triangles = kdr_default_triangles_def();
        triangles.vertices = vertices;
        triangles.vertex_count = 3 * count;
        triangles.triangle_count = count;
        kdr_build_def def = kdr_default_build_def();
        def.split = KDR_SPLIT_OBJECT;
        def.leaf_limit = 1;
        def.depth_limit = 1;
        kdr_scene *scene = committed_scene(device, &triangles, 1, &def);
        kdr_tree_stats stats = stats_of(scene);
        assert_int_equal(stats.leaf_count, 2);
        assert_int_equal(stats.reference_count, count);
        assert_int_equal(stats.largest_leaf, (count + 1) / 2);
        assert_int_equal(kdr_scene_verify(scene), KDR_OK);
        kdr_scene_destroy(scene);
        free(vertices);
    }
    kdr_device_destroy(device);
}

static void an_axis_without_a_plane_falls_back_to_another_one(void **state) {
    (void)state;
    kdr_device *device = device_of(1);
    for (int split = 0; split < SPLITS; split++) {
        for (int axis = 0; axis < 3; axis++) {
            // Round robin begins with the first axis, on which only one of the three lines can be parted.
            kdr_build_def def = plan_of(split, 3);
            def.leaf_limit = 1;
            def.depth_limit = KDR_MAX_DEPTH;
            kdr_scene *scene = line_scene(device, axis, &def);
            assert_int_equal(stats_of(scene).largest_leaf, 1);
            kdr_scene_destroy(scene);
        }
    }
    kdr_device_destroy(device);
}

static void what_no_plane_separates_becomes_a_leaf_at_once(void **state) {
    (void)state;
    enum { COPIES = 500 };
    float *vertices = test_allocate(9 * COPIES, sizeof(float));
    for (int i = 0; i < 9 * COPIES; i++)
        vertices[i] = (float)(i % 9 % 4 == 0);
    kdr_triangles_def triangles = kdr_default_triangles_def();
    triangles.vertices = vertices;
    triangles.vertex_count = 3 * COPIES;
    triangles.triangle_count = COPIES;
    kdr_device *device = device_of(1);
    for (int plan = 0; plan < SPLITS * AXES; plan++) {
        kdr_build_def def = plan_of(plan / AXES, plan % AXES);
        kdr_scene *scene = committed_scene(device, &triangles, 1, &def);
        assert_int_equal(stats_of(scene).leaf_count, 1);
        kdr_scene_destroy(scene);
    }
    kdr_device_destroy(device);
    free(vertices);
}

static void the_limits_of_leaf_depth_and_references_hold_for_every_plan(void **state) {
    (void)state;
    kdr_device *device = device_of(1);
    for (size_t kind = 0; kind < soup_kind_count; kind++) {
        test_random random = test_random_start(test_random_seed(), 400 + kind);
        soup_scene soup = soup_scene_create_kind(&random, &soup_kinds[kind], soup_kinds[kind].count);
        for (int plan = 0; plan < SPLITS * AXES; plan++) {
            kdr_build_def def = plan_of(plan / AXES, plan % AXES);
            def.depth_limit = 9;
            def.reference_limit = 1.5f;
            kdr_scene *scene = committed_scene(device, soup.geometries, SOUP_GEOMETRIES, &def);
            kdr_tree_stats stats = stats_of(scene);
            assert_true(stats.depth <= 9);
            assert_true(2 * stats.reference_count <= 3 * stats.triangle_count);
            kdr_scene_destroy(scene);
        }
        soup_scene_destroy(&soup);
    }
    kdr_device_destroy(device);
}

static void a_build_without_memory_fails_cleanly_and_the_next_one_makes_the_same_tree(void **state) {
    (void)state;
    test_random random = test_random_start(test_random_seed(), 600);
    soup_scene soup = soup_scene_create_kind(&random, soup_kind_find("small"), 20000);
    for (int split = 0; split < SPLITS; split++) {
        // The best axis asks most of a splitter.
        kdr_build_def def = plan_of(split, 1);
        uint64_t expected = 0;
        for (uint64_t n = 0;; n++) {
            failing_alloc memory;
            failing_alloc_init(&memory);
            kdr_device_def device_def = kdr_default_device_def();
            device_def.worker_count = 1 + (uint32_t)(n % 2);
            device_def.allocator = failing_alloc_functions(&memory);
            kdr_device *device;
            assert_int_equal(kdr_device_create(&device_def, &device), KDR_OK);
            kdr_scene *scene = committed_scene(device, soup.geometries, SOUP_GEOMETRIES, NULL);
            kdr_device_trim(device);
            failing_alloc_fail_nth(&memory, n);
            kdr_status status = kdr_scene_touch(scene, 0) == KDR_OK ? kdr_scene_commit(scene, &def) : KDR_ERROR_IO;
            bool failed = memory.failures > 0;
            assert_int_equal(status, failed ? KDR_ERROR_OUT_OF_MEMORY : KDR_OK);
            if (n == 0)
                expected = kdr_scene_hash(scene);
            assert_int_equal(kdr_scene_commit(scene, &def), KDR_OK);
            assert_true(kdr_scene_hash(scene) == expected);
            kdr_scene_destroy(scene);
            kdr_device_destroy(device);
            assert_true(failing_alloc_is_clean(&memory));
            if (n > 0 && !failed)
                break;
        }
    }
    soup_scene_destroy(&soup);
}

static void axis_best_is_what_the_heuristic_does_and_longest_what_the_medians_do(void **state) {
    (void)state;
    kdr_device *device = device_of(1);
    test_random random = test_random_start(test_random_seed(), 500);
    soup_scene soup = soup_scene_create_kind(&random, soup_kind_find("needles"), 3000);
    for (int split = 0; split < SPLITS; split++) {
        uint64_t hashes[AXES];
        for (int axis = 0; axis < AXES; axis++) {
            kdr_build_def def = plan_of(split, axis);
            kdr_scene *scene = committed_scene(device, soup.geometries, SOUP_GEOMETRIES, &def);
            hashes[axis] = kdr_scene_hash(scene);
            kdr_scene_destroy(scene);
        }
        bool weighs = splits[split] == KDR_SPLIT_BINNED || splits[split] == KDR_SPLIT_SWEEP;
        for (int axis = 1; axis < AXES; axis++)
            assert_int_equal(hashes[axis] == hashes[0], axes[axis] == (weighs ? KDR_AXIS_BEST : KDR_AXIS_LONGEST));
    }
    soup_scene_destroy(&soup);
    kdr_device_destroy(device);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_plan_answers_as_the_oracle_on_every_kind_of_soup),
        cmocka_unit_test(the_tree_of_every_plan_is_the_same_for_any_number_of_workers),
        cmocka_unit_test(every_instruction_set_builds_the_tree_of_every_plan),
        cmocka_unit_test(the_object_median_halves_the_primitives_and_the_spatial_median_the_cell),
        cmocka_unit_test(one_level_of_a_median_leaves_half_of_the_primitives_on_each_side),
        cmocka_unit_test(an_axis_without_a_plane_falls_back_to_another_one),
        cmocka_unit_test(what_no_plane_separates_becomes_a_leaf_at_once),
        cmocka_unit_test(the_limits_of_leaf_depth_and_references_hold_for_every_plan),
        cmocka_unit_test(a_build_without_memory_fails_cleanly_and_the_next_one_makes_the_same_tree),
        cmocka_unit_test(axis_best_is_what_the_heuristic_does_and_longest_what_the_medians_do),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
