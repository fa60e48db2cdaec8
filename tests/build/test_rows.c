/* Every splitter with every rule for the axis, every share and every order: sound trees that answer alike, and the same
 * ones for any order and any number of workers. */
#include "support/awkward_rays.h"
#include "support/everywhere.h"
#include "support/failing_alloc.h"
#include "support/plan_rows.h"
#include "support/soup.h"
#include "support/test_size.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define RAYS TEST_SIZE(40)

/* Each kind of soup takes one plan of so many, another one each time: together they take all, or half where every step
 * is slow. Of the rows that run out of memory every FAILING_STEP-th does. */
#ifdef TEST_SLOW
#define TURNS 46
#define FAILING_STEP 3
#else
#define TURNS 16
#define FAILING_STEP 1
#endif

static const uint32_t crew_sizes[] = {1, 2, 7};
enum { CREWS = sizeof crew_sizes / sizeof crew_sizes[0] };

typedef struct devices {
    kdr_device *of[CREWS];
} devices;

static devices open_devices(void) {
    devices made;
    for (int i = 0; i < CREWS; i++) {
        kdr_device_def def = kdr_default_device_def();
        def.worker_count = crew_sizes[i];
        assert_int_equal(kdr_device_create(&def, &made.of[i]), KDR_OK);
    }
    return made;
}

static void close_devices(devices *made) {
    for (int i = 0; i < CREWS; i++)
        kdr_device_destroy(made->of[i]);
}

static kdr_tree_stats stats_of(const kdr_scene *scene) {
    kdr_tree_stats stats;
    assert_int_equal(kdr_scene_stats(scene, &stats), KDR_OK);
    return stats;
}

static uint64_t hash_of(kdr_device *device, const soup_scene *soup, const kdr_build_def *def) {
    kdr_scene *scene = committed_scene(device, soup->geometries, SOUP_GEOMETRIES, def);
    uint64_t hash = kdr_scene_hash(scene);
    kdr_scene_destroy(scene);
    return hash;
}

/* Any other order and number of workers makes the tree of this hash. */
static void hold_orders_and_workers_equal(const devices *on, const soup_scene *soup, const char *split,
                                          const char *axis, const char *share, uint64_t hash, const char *name) {
    for (size_t order = 0; order < order_row_count; order++) {
        for (int crew = order == 0 ? 1 : 0; crew < CREWS; crew++) {
            char text[PLAN_ROW_TEXT];
            kdr_build_def def = plan_of_words(text, split, axis, share, order_rows[order]);
            if (hash_of(on->of[crew], soup, &def) != hash)
                fail_msg("%s, %s: another tree by %u workers", name, text, crew_sizes[crew]);
        }
    }
}

/* Holds one soup by every plan. */
static void hold_soup(const devices *on, size_t kind) {
    const soup_kind *drawn = &soup_kinds[kind];
    test_random random = test_random_start(test_random_seed(), kind);
    soup_scene soup = soup_scene_create_kind(&random, drawn, drawn->count);
    oracle_scene oracle = oracle_scene_create(soup.geometries, SOUP_GEOMETRIES);
    oracle_tree tree = oracle_tree_create(&oracle);
    size_t asked = drawn->is_exact ? RAYS / 8 + 1 : RAYS;
    kdr_ray *rays = awkward_rays_create(&random, &tree, asked);
    query_sheet sheet = query_sheet_create(&tree, rays, asked);
    size_t plans = split_row_count * axis_row_count * share_row_count;
    for (size_t plan = kind % TURNS; plan < plans; plan += TURNS) {
        const char *share = share_rows[plan % share_row_count];
        const char *axis = axis_rows[plan / share_row_count % axis_row_count];
        const char *split = split_rows[plan / share_row_count / axis_row_count];
        char text[PLAN_ROW_TEXT];
        kdr_build_def def = plan_of_words(text, split, axis, share, order_rows[0]);
        kdr_scene *scene = committed_scene(on->of[0], soup.geometries, SOUP_GEOMETRIES, &def);
        if (kdr_scene_verify(scene) != KDR_OK)
            fail_msg("%s, %s: the tree is not sound", drawn->name, text);
        if (query_sheet_differences(&sheet, scene, drawn->name) != 0)
            fail_msg("%s, %s: answers differ", drawn->name, text);
        uint64_t hash = kdr_scene_hash(scene);
        kdr_scene_destroy(scene);
        // Every plan meets every order and crew, on one kind of soup or another.
        if ((plan / TURNS + kind) % 4 == 0)
            hold_orders_and_workers_equal(on, &soup, split, axis, share, hash, drawn->name);
    }
    query_sheet_destroy(&sheet);
    free(rays);
    oracle_tree_destroy(&tree);
    oracle_scene_destroy(&oracle);
    soup_scene_destroy(&soup);
}

static void every_plan_makes_sound_trees_that_answer_as_the_oracle_whatever_the_order_and_the_workers(void **state) {
    (void)state;
    devices on = open_devices();
    for (size_t kind = 0; kind < soup_kind_count; kind++)
        hold_soup(&on, kind);
    close_devices(&on);
}

/* Large enough for nodes that all workers open together, and for nodes that one worker's arena does not take. */
static void large_scenes_have_one_tree_whatever_the_order_and_the_workers(void **state) {
    (void)state;
    static const char *const kinds[] = {"small", "stadium"};
    devices on = open_devices();
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        test_random random = test_random_start(test_random_seed(), 100 + i);
        soup_scene soup = soup_scene_create_kind(&random, soup_kind_find(kinds[i]), TEST_SIZE(70000));
        for (size_t share = 5 * i; share < share_row_count; share += 10) {
            char text[PLAN_ROW_TEXT];
            const char *split = split_rows[(share / 10 + 4 * i) % split_row_count];
            kdr_build_def def = plan_of_words(text, split, "", share_rows[share], order_rows[0]);
            uint64_t hash = hash_of(on.of[0], &soup, &def);
            hold_orders_and_workers_equal(&on, &soup, split, "", share_rows[share], hash, kinds[i]);
        }
        soup_scene_destroy(&soup);
    }
    close_devices(&on);
}

static void one_region_is_the_tree_without_regions_and_sixty_four_are_another(void **state) {
    (void)state;
    devices on = open_devices();
    test_random random = test_random_start(test_random_seed(), 200);
    soup_scene soup = soup_scene_create_kind(&random, soup_kind_find("small"), TEST_SIZE(10000));
    for (size_t split = 0; split < split_row_count; split++) {
        char text[PLAN_ROW_TEXT];
        kdr_build_def def = plan_of_words(text, split_rows[split], "", "", "");
        uint64_t none = hash_of(on.of[1], &soup, &def);
        for (size_t share = 1; share < share_row_count; share++) {
            def = plan_of_words(text, split_rows[split], "", share_rows[share], "");
            if (def.share_count != 1 && def.share_count != 64)
                continue;
            if ((hash_of(on.of[1], &soup, &def) == none) != (def.share_count == 1))
                fail_msg("%s: %s", text, def.share_count == 1 ? "one region is another tree" : "regions do nothing");
        }
    }
    soup_scene_destroy(&soup);
    close_devices(&on);
}

/* Points in the unit cube, as triangles so small that hardly any is cut. */
static soup_scene create_dust(uint64_t sequence, size_t count) {
    test_random random = test_random_start(test_random_seed(), sequence);
    float *triangles = test_allocate(9 * count, sizeof(float));
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 9; k++)
            triangles[9 * i + k] =
                k < 3 ? test_random_float(&random) : triangles[9 * i + k % 3] + (k % 3 == k / 3 ? 0x1p-20f : 0);
    soup_scene soup = soup_scene_create(&random, triangles, count);
    free(triangles);
    return soup;
}

static void there_are_as_many_regions_as_asked_for_of_about_one_size(void **state) {
    (void)state;
    enum { COUNT = 40000 };
    soup_scene soup = create_dust(300, COUNT);
    devices on = open_devices();
    for (size_t share = 1; share < share_row_count; share++) {
        char text[PLAN_ROW_TEXT];
        kdr_build_def def = plan_of_words(text, "split=space", "", share_rows[share], "");
        if (def.share_count > 64)
            continue;
        // A region is a leaf, unless it is half as large again as it should be.
        def.leaf_limit = COUNT / def.share_count * 3 / 2;
        kdr_scene *scene = committed_scene(on.of[1], soup.geometries, SOUP_GEOMETRIES, &def);
        kdr_tree_stats stats = stats_of(scene);
        if (stats.leaf_count != def.share_count || stats.largest_leaf > def.leaf_limit)
            fail_msg("%s: %u regions, the largest of %u", text, (unsigned)stats.leaf_count, stats.largest_leaf);
        assert_true(stats.reference_count < COUNT + COUNT / 50);
        kdr_scene_destroy(scene);
    }
    close_devices(&on);
    soup_scene_destroy(&soup);
}

/* Where nothing is split below them regions are leaves. */
static void regions_leave_half_of_the_references_that_may_be_added_to_what_is_below_them(void **state) {
    (void)state;
    devices on = open_devices();
    test_random random = test_random_start(test_random_seed(), 350);
    soup_scene soup = soup_scene_create_kind(&random, soup_kind_find("small"), 20000);
    static const char *const shares[] = {"share=line/1024", "share=cluster/1024", "share=grid/1024"};
    for (size_t i = 0; i < sizeof shares / sizeof shares[0]; i++) {
        char text[PLAN_ROW_TEXT];
        kdr_build_def def = plan_of_words(text, "split=space leaf-limit=4294967295", "", shares[i], "");
        for (int limit = 2; limit <= 16; limit *= 2) {
            def.reference_limit = (float)limit;
            kdr_scene *scene = committed_scene(on.of[1], soup.geometries, SOUP_GEOMETRIES, &def);
            kdr_tree_stats stats = stats_of(scene);
            assert_true(stats.leaf_count > 1);
            if (2 * stats.reference_count > ((uint64_t)limit + 1) * stats.triangle_count)
                fail_msg("%s: %u references in %u regions", text, (unsigned)stats.reference_count,
                         (unsigned)stats.leaf_count);
            kdr_scene_destroy(scene);
        }
    }
    soup_scene_destroy(&soup);
    close_devices(&on);
}

/* Sixty-four regions, six levels deep, and triangles as large as the scene: each belongs to a dozen of regions. */
static void a_triangle_is_in_the_subtree_of_every_region_it_reaches_into(void **state) {
    (void)state;
    devices on = open_devices();
    test_random random = test_random_start(test_random_seed(), 400);
    soup_scene soup = soup_scene_create_kind(&random, soup_kind_find("large"), 600);
    oracle_scene oracle = oracle_scene_create(soup.geometries, SOUP_GEOMETRIES);
    oracle_tree tree = oracle_tree_create(&oracle);
    kdr_ray *rays = awkward_rays_create(&random, &tree, 5 * RAYS);
    query_sheet sheet = query_sheet_create(&tree, rays, 5 * RAYS);
    for (size_t share = 1; share < share_row_count; share++) {
        char text[PLAN_ROW_TEXT];
        kdr_build_def def = plan_of_words(text, "split=space leaf-limit=1 reference-limit=1000 depth-limit=6", "",
                                          share_rows[share], "");
        if (def.share_count != 64)
            continue;
        kdr_scene *scene = committed_scene(on.of[2], soup.geometries, SOUP_GEOMETRIES, &def);
        kdr_tree_stats stats = stats_of(scene);
        if (stats.leaf_count != 64 || stats.reference_count < 10 * stats.triangle_count)
            fail_msg("%s: %u regions, %u references", text, (unsigned)stats.leaf_count,
                     (unsigned)stats.reference_count);
        assert_int_equal(kdr_scene_verify(scene), KDR_OK);
        assert_int_equal(query_sheet_differences(&sheet, scene, text), 0);
        kdr_scene_destroy(scene);
    }
    query_sheet_destroy(&sheet);
    free(rays);
    oracle_tree_destroy(&tree);
    oracle_scene_destroy(&oracle);
    soup_scene_destroy(&soup);
    close_devices(&on);
}

static void the_limits_of_depth_and_references_hold_for_every_share_and_order(void **state) {
    (void)state;
    devices on = open_devices();
    for (size_t kind = 0; kind < soup_kind_count; kind++) {
        test_random random = test_random_start(test_random_seed(), 500 + kind);
        soup_scene soup = soup_scene_create_kind(&random, &soup_kinds[kind], soup_kinds[kind].count);
        size_t plans = share_row_count * split_row_count;
        for (size_t plan = kind % TURNS; plan < plans; plan += TURNS) {
            char text[PLAN_ROW_TEXT];
            kdr_build_def def = plan_of_words(text, split_rows[plan / share_row_count], "",
                                              share_rows[plan % share_row_count], order_rows[kind % order_row_count]);
            def.depth_limit = 5;
            def.leaf_limit = 1;
            def.reference_limit = 1.5f;
            kdr_scene *scene = committed_scene(on.of[0], soup.geometries, SOUP_GEOMETRIES, &def);
            kdr_tree_stats stats = stats_of(scene);
            if (stats.depth > 5 || 2 * stats.reference_count > 3 * stats.triangle_count)
                fail_msg("%s, %s: depth %u, %u references of %u triangles", soup_kinds[kind].name, text, stats.depth,
                         (unsigned)stats.reference_count, (unsigned)stats.triangle_count);
            kdr_scene_destroy(scene);
        }
        soup_scene_destroy(&soup);
    }
    close_devices(&on);
}

/* Fails the n-th allocation of a commit by this plan, for every n there is: the old tree stays in force and answers,
 * not a byte more is held, and the next commit makes the tree of the plan. */
static void fail_everywhere(const soup_scene *soup, const char *split, const char *share, const char *order) {
    char text[PLAN_ROW_TEXT];
    kdr_build_def def = plan_of_words(text, split, "", share, order);
    bool failed = true;
    for (uint64_t n = 1; failed; n++) {
        failing_alloc memory;
        failing_alloc_init(&memory);
        kdr_device_def device_def = kdr_default_device_def();
        device_def.worker_count = 1 + (uint32_t)(n % 2);
        device_def.allocator = failing_alloc_functions(&memory);
        kdr_device *device;
        assert_int_equal(kdr_device_create(&device_def, &device), KDR_OK);
        kdr_scene *scene = committed_scene(device, soup->geometries, SOUP_GEOMETRIES, NULL);
        uint64_t before = kdr_scene_hash(scene);
        kdr_device_trim(device);
        size_t bytes = memory.live_bytes;
        failing_alloc_fail_nth(&memory, n);
        assert_int_equal(kdr_scene_touch(scene, 0), KDR_OK);
        kdr_status status = kdr_scene_commit(scene, &def);
        failed = memory.failures > 0;
        if (status != (failed ? KDR_ERROR_OUT_OF_MEMORY : KDR_OK))
            fail_msg("%s: allocation %u: status %d", text, (unsigned)n, (int)status);
        failing_alloc_fail_nth(&memory, 0);
        if (failed) {
            kdr_device_trim(device);
            if (kdr_scene_hash(scene) != before || memory.live_bytes != bytes)
                fail_msg("%s: allocation %u: %zu bytes instead of %zu", text, (unsigned)n, (size_t)memory.live_bytes,
                         bytes);
            assert_int_equal(kdr_scene_verify(scene), KDR_OK);
            if (n % 8 == 1)
                assert_int_equal(kdr_scene_commit(scene, &def), KDR_OK);
        }
        kdr_scene_destroy(scene);
        kdr_device_destroy(device);
        assert_true(failing_alloc_is_clean(&memory));
    }
}

static void a_build_without_memory_leaves_the_old_tree_and_no_bytes_wherever_it_fails(void **state) {
    (void)state;
    static const char *const shares[] = {"share=none", "share=serial/5", "share=line/5", "share=grid/5",
                                         "share=cluster/5"};
    test_random random = test_random_start(test_random_seed(), 600);
    soup_scene soup = soup_scene_create_kind(&random, soup_kind_find("small"), 10000);
    for (size_t i = 0; i < split_row_count; i += FAILING_STEP)
        fail_everywhere(&soup, split_rows[i], shares[i % (sizeof shares / sizeof shares[0])],
                        order_rows[i / 2 % order_row_count]);
    soup_scene_destroy(&soup);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_plan_makes_sound_trees_that_answer_as_the_oracle_whatever_the_order_and_the_workers),
        cmocka_unit_test(large_scenes_have_one_tree_whatever_the_order_and_the_workers),
        cmocka_unit_test(one_region_is_the_tree_without_regions_and_sixty_four_are_another),
        cmocka_unit_test(there_are_as_many_regions_as_asked_for_of_about_one_size),
        cmocka_unit_test(regions_leave_half_of_the_references_that_may_be_added_to_what_is_below_them),
        cmocka_unit_test(a_triangle_is_in_the_subtree_of_every_region_it_reaches_into),
        cmocka_unit_test(the_limits_of_depth_and_references_hold_for_every_share_and_order),
        cmocka_unit_test(a_build_without_memory_leaves_the_old_tree_and_no_bytes_wherever_it_fails),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
