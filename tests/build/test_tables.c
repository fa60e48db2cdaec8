/* Every row of the three tables with every other: sound trees that answer as the oracle does, and the same tree
 * whatever the order and the number of workers. */
#include "support/awkward_rays.h"
#include "support/everywhere.h"
#include "support/failing_alloc.h"
#include "support/soup.h"
#include "support/test_size.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define RAYS TEST_SIZE(60)
#define MANY TEST_SIZE(70000) /* enough for nodes that all workers open together */

static const char *const splits[] = {"split=binned",
                                     "retract=yes empty-bonus=0.7",
                                     "split=space",
                                     "split=object retract=yes",
                                     "split=sweep",
                                     "split=sweep events=3",
                                     "split=sweep straddle=clip",
                                     "split=sweep straddle=clip events=3 leaf-limit=1 traversal-cost=1",
                                     "quality=best"};
static const char *const orders[] = {"order=dfs", "order=bfs"};
static const char *const shares[] = {"share=none", "share=serial/7", "share=line/64", "share=grid/5", "share=cluster"};
enum { SPLITS = sizeof splits / sizeof splits[0], SHARES = sizeof shares / sizeof shares[0] };

static kdr_build_def plan_of(const char *split, const char *order, const char *share) {
    char text[200], problem[200];
    snprintf(text, sizeof text, "%s %s %s", split, order, share);
    kdr_build_def def;
    if (kdr_build_def_parse(text, &def, problem, sizeof problem) != KDR_OK)
        fail_msg("%s: %s", text, problem);
    return def;
}

static kdr_device *device_of(uint32_t workers) {
    kdr_device_def def = kdr_default_device_def();
    def.worker_count = workers;
    kdr_device *device;
    assert_int_equal(kdr_device_create(&def, &device), KDR_OK);
    return device;
}

static uint64_t hash_of(kdr_device *device, const soup_scene *soup, const kdr_build_def *def) {
    kdr_scene *scene = committed_scene(device, soup->geometries, SOUP_GEOMETRIES, def);
    uint64_t hash = kdr_scene_hash(scene);
    kdr_scene_destroy(scene);
    return hash;
}

static void every_row_with_every_other_answers_as_the_oracle(void **state) {
    (void)state;
    kdr_device *device = device_of(2);
    for (size_t kind = 0; kind < soup_kind_count; kind++) {
        test_random random = test_random_start(test_random_seed(), kind);
        soup_scene soup = soup_scene_create_kind(&random, &soup_kinds[kind], soup_kinds[kind].count);
        oracle_scene oracle = oracle_scene_create(soup.geometries, SOUP_GEOMETRIES);
        oracle_tree tree = oracle_tree_create(&oracle);
        kdr_ray *rays = awkward_rays_create(&random, &tree, RAYS);
        query_sheet sheet = query_sheet_create(&tree, rays, RAYS);
        for (int i = 0; i < SPLITS * SHARES; i++) {
            const char *split = splits[i / SHARES], *share = shares[i % SHARES], *order = orders[(i + i / SHARES) % 2];
            kdr_build_def def = plan_of(split, order, share);
            char label[200];
            snprintf(label, sizeof label, "%s, %s %s %s", soup_kinds[kind].name, split, order, share);
            kdr_scene *scene = committed_scene(device, soup.geometries, SOUP_GEOMETRIES, &def);
            if (kdr_scene_verify(scene) != KDR_OK)
                fail_msg("%s: the tree is not sound", label);
            assert_int_equal(query_sheet_differences(&sheet, scene, label), 0);
            kdr_scene_destroy(scene);
        }
        query_sheet_destroy(&sheet);
        free(rays);
        oracle_tree_destroy(&tree);
        oracle_scene_destroy(&oracle);
        soup_scene_destroy(&soup);
    }
    kdr_device_destroy(device);
}

/* Fails the running test unless both orders and 1, 2 and 7 workers build one tree by every pair of the other rows, or
 * of every `step`-th splitter. */
static void hold_orders_and_workers_equal(const soup_scene *soup, const char *name, int step) {
    static const uint32_t workers[] = {1, 2, 7};
    uint64_t hashes[SPLITS * SHARES] = {0};
    for (int w = 0; w < 3; w++) {
        kdr_device *device = device_of(workers[w]);
        for (int i = 0; i < SPLITS * SHARES * 2; i++) {
            // One worker has the say of both orders; of the others each gets half of the pairs.
            int pair = i / 2;
            if ((w > 0 && (pair + i + w) % 2 > 0) || pair / SHARES % step > 0)
                continue;
            kdr_build_def def = plan_of(splits[pair / SHARES], orders[i % 2], shares[pair % SHARES]);
            uint64_t hash = hash_of(device, soup, &def);
            if (hashes[pair] != 0 && hash != hashes[pair])
                fail_msg("%s: %s %s %s: %u workers build another tree", name, splits[pair / SHARES], orders[i % 2],
                         shares[pair % SHARES], workers[w]);
            hashes[pair] = hash;
        }
        kdr_device_destroy(device);
    }
}

static void neither_the_order_nor_the_workers_change_a_tree(void **state) {
    (void)state;
    static const char *const kinds[] = {"none", "one", "two", "large", "duplicates", "needles", "mixed scales", "huge"};
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        test_random random = test_random_start(test_random_seed(), 100 + i);
        const soup_kind *kind = soup_kind_find(kinds[i]);
        soup_scene soup = soup_scene_create_kind(&random, kind, kind->count);
        hold_orders_and_workers_equal(&soup, kinds[i], 1);
        soup_scene_destroy(&soup);
    }
    test_random random = test_random_start(test_random_seed(), 200);
    soup_scene soup = soup_scene_create_kind(&random, soup_kind_find("small"), MANY);
    hold_orders_and_workers_equal(&soup, "many small ones", 3);
    soup_scene_destroy(&soup);
}

/* Scenes that leave little to divide: nothing, one place, one bin of the line, and triangles that span every region. */
static void any_number_of_regions_is_a_sound_tree_of_any_scene(void **state) {
    (void)state;
    static const uint32_t counts[] = {1, 2, 3, 7, 64, 1024};
    static const char *const kinds[] = {"none",  "one",        "two",     "small", "large",
                                        "plane", "duplicates", "largest", "tiny"};
    kdr_device *device = device_of(2);
    for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++) {
        test_random random = test_random_start(test_random_seed(), 300 + k);
        const soup_kind *kind = soup_kind_find(kinds[k]);
        soup_scene soup = soup_scene_create_kind(&random, kind, kind->count);
        for (int share = KDR_SHARE_SERIAL; share <= KDR_SHARE_CLUSTER; share++) {
            for (size_t c = 0; c < sizeof counts / sizeof counts[0]; c++) {
                kdr_build_def def = kdr_default_build_def();
                def.share = (kdr_share_rule)share;
                def.share_count = counts[c];
                kdr_scene *scene = committed_scene(device, soup.geometries, SOUP_GEOMETRIES, &def);
                kdr_tree_stats stats;
                assert_int_equal(kdr_scene_stats(scene, &stats), KDR_OK);
                if (kdr_scene_verify(scene) != KDR_OK)
                    fail_msg("%s: share %d, %u regions: the tree is not sound", kinds[k], share, counts[c]);
                assert_true((double)stats.reference_count <= 4.0 * (double)stats.triangle_count);
                kdr_scene_destroy(scene);
            }
        }
        soup_scene_destroy(&soup);
    }
    kdr_device_destroy(device);
}

static void regions_stop_at_the_depth_limit(void **state) {
    (void)state;
    kdr_device *device = device_of(2);
    test_random random = test_random_start(test_random_seed(), 700);
    soup_scene soup = soup_scene_create_kind(&random, soup_kind_find("small"), 1500);
    for (int share = KDR_SHARE_SERIAL; share <= KDR_SHARE_CLUSTER; share++) {
        for (uint32_t limit = 1; limit <= 5; limit++) {
            kdr_build_def def = kdr_default_build_def();
            def.share = (kdr_share_rule)share;
            def.share_count = 1000;
            def.depth_limit = limit;
            kdr_scene *scene = committed_scene(device, soup.geometries, SOUP_GEOMETRIES, &def);
            kdr_tree_stats stats;
            assert_int_equal(kdr_scene_stats(scene, &stats), KDR_OK);
            assert_true(stats.depth <= limit);
            assert_int_equal(kdr_scene_verify(scene), KDR_OK);
            kdr_scene_destroy(scene);
        }
    }
    soup_scene_destroy(&soup);
    kdr_device_destroy(device);
}

static void one_region_is_the_tree_without_regions(void **state) {
    (void)state;
    kdr_device *device = device_of(2);
    test_random random = test_random_start(test_random_seed(), 400);
    soup_scene soup = soup_scene_create_kind(&random, soup_kind_find("small"), 20000);
    for (int split = 0; split < SPLITS; split++) {
        kdr_build_def def = plan_of(splits[split], "", "");
        uint64_t expected = hash_of(device, &soup, &def);
        for (int share = KDR_SHARE_SERIAL; share <= KDR_SHARE_CLUSTER; share++) {
            def.share = (kdr_share_rule)share;
            def.share_count = 1;
            assert_true(hash_of(device, &soup, &def) == expected);
            def.share_count = 16;
            assert_true(hash_of(device, &soup, &def) != expected);
        }
    }
    soup_scene_destroy(&soup);
    kdr_device_destroy(device);
}

/* Where nothing is split below them regions are leaves. */
static void regions_have_about_equal_loads(void **state) {
    (void)state;
    kdr_device *device = device_of(2);
    test_random random = test_random_start(test_random_seed(), 500);
    soup_scene soup = soup_scene_create_kind(&random, soup_kind_find("small"), 30000);
    static const uint32_t counts[] = {2, 3, 5, 8, 12};
    for (int share = KDR_SHARE_SERIAL; share <= KDR_SHARE_CLUSTER; share++) {
        for (size_t c = 0; c < sizeof counts / sizeof counts[0]; c++) {
            kdr_build_def def = kdr_default_build_def();
            def.share = (kdr_share_rule)share;
            def.share_count = counts[c];
            def.cost_traversal = 1e6f; /* no plane pays */
            def.leaf_limit = 29000;
            kdr_scene *scene = committed_scene(device, soup.geometries, SOUP_GEOMETRIES, &def);
            kdr_tree_stats stats;
            assert_int_equal(kdr_scene_stats(scene, &stats), KDR_OK);
            assert_int_equal(stats.leaf_count, counts[c]);
            assert_true(2 * (uint64_t)stats.largest_leaf * counts[c] <= 3 * stats.reference_count);
            kdr_scene_destroy(scene);
        }
    }
    soup_scene_destroy(&soup);
    kdr_device_destroy(device);
}

static void a_build_of_any_row_without_memory_fails_cleanly(void **state) {
    (void)state;
    static const char *const plans[] = {"order=bfs",
                                        "share=serial/5",
                                        "share=line/9",
                                        "share=grid/9 order=bfs",
                                        "share=cluster",
                                        "split=sweep straddle=clip order=bfs",
                                        "quality=best share=line/3"};
    test_random random = test_random_start(test_random_seed(), 600);
    soup_scene soup = soup_scene_create_kind(&random, soup_kind_find("small"), 12000);
    for (size_t i = 0; i < sizeof plans / sizeof plans[0]; i++) {
        kdr_build_def def = plan_of(plans[i], "", "");
        kdr_device *plain = device_of(1);
        uint64_t expected = hash_of(plain, &soup, &def);
        kdr_device_destroy(plain);
        for (uint64_t n = 1;; n++) {
            failing_alloc memory;
            failing_alloc_init(&memory);
            kdr_device_def device_def = kdr_default_device_def();
            device_def.worker_count = 1 + (uint32_t)(n % 2);
            device_def.allocator = failing_alloc_functions(&memory);
            kdr_device *device;
            assert_int_equal(kdr_device_create(&device_def, &device), KDR_OK);
            kdr_scene *scene = committed_scene(device, soup.geometries, SOUP_GEOMETRIES, NULL);
            uint64_t before = kdr_scene_hash(scene);
            kdr_device_trim(device);
            failing_alloc_fail_nth(&memory, n);
            kdr_status status = kdr_scene_commit(scene, &def);
            bool failed = memory.failures > 0;
            assert_int_equal(status, failed ? KDR_ERROR_OUT_OF_MEMORY : KDR_OK);
            assert_true(kdr_scene_hash(scene) == (failed ? before : expected));
            assert_int_equal(kdr_scene_commit(scene, &def), KDR_OK);
            assert_true(kdr_scene_hash(scene) == expected);
            kdr_scene_destroy(scene);
            kdr_device_destroy(device);
            assert_true(failing_alloc_is_clean(&memory));
            if (!failed)
                break;
        }
    }
    soup_scene_destroy(&soup);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_row_with_every_other_answers_as_the_oracle),
        cmocka_unit_test(neither_the_order_nor_the_workers_change_a_tree),
        cmocka_unit_test(any_number_of_regions_is_a_sound_tree_of_any_scene),
        cmocka_unit_test(regions_stop_at_the_depth_limit),
        cmocka_unit_test(one_region_is_the_tree_without_regions),
        cmocka_unit_test(regions_have_about_equal_loads),
        cmocka_unit_test(a_build_of_any_row_without_memory_fails_cleanly),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
