/* The numbers of kdr_scene_stats fit together, and keep the limits that the build def sets. */
#include "support/everywhere.h"
#include "support/soup.h"
#include "support/test_size.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>

#include <cmocka.h>

#define MOST_TRIANGLES TEST_SIZE(4000)

static void assert_numbers_fit(const kdr_tree_stats *stats, const kdr_build_def *def) {
    // Every interior node has two children.
    assert_true(stats->leaf_count == stats->interior_count + 1);
    assert_true(stats->empty_leaf_count == stats->leaf_histogram[0]);

    uint64_t at_depths = 0, of_sizes = 0, references = 0;
    double depths = 0;
    uint32_t deepest = 0;
    for (uint32_t i = 0; i < KDR_HISTOGRAM_SIZE; i++) {
        at_depths += stats->depth_histogram[i];
        of_sizes += stats->leaf_histogram[i];
        references += i * stats->leaf_histogram[i];
        depths += (double)i * (double)stats->depth_histogram[i];
        if (stats->depth_histogram[i] > 0)
            deepest = i;
    }
    assert_true(at_depths == stats->leaf_count && of_sizes == stats->leaf_count);
    assert_true(stats->depth == deepest);
    assert_float_equal(stats->mean_leaf_depth, depths / (double)stats->leaf_count, 1e-9);
    if (stats->largest_leaf < KDR_HISTOGRAM_SIZE) {
        assert_true(references == stats->reference_count);
        assert_true(stats->largest_leaf == 0 || stats->leaf_histogram[stats->largest_leaf] > 0);
    } else {
        assert_true(references <= stats->reference_count && stats->leaf_histogram[KDR_HISTOGRAM_SIZE - 1] > 0);
    }

    double limit = def->depth_limit > 0 ? def->depth_limit : 8 + 1.3 * log2(fmax((double)stats->triangle_count, 1));
    assert_true(stats->depth <= limit);
    assert_true(stats->reference_count >= stats->triangle_count);
    double references_each = def->reference_limit > 0 ? (double)def->reference_limit : 8;
    assert_true((double)stats->reference_count <= references_each * (double)stats->triangle_count);
    assert_true(isfinite(stats->cost) && stats->cost >= 0);
    assert_true(stats->build_seconds >= 0);
}

static void statistics_fit_together_and_keep_the_limits(void **state) {
    (void)state;
    kdr_device *device;
    assert_int_equal(kdr_device_create(NULL, &device), KDR_OK);
    for (size_t kind = 0; kind < soup_kind_count; kind++) {
        for (size_t build = 0; build < BUILD_CASE_COUNT; build++) {
            test_random random = test_random_start(test_random_seed(), kind);
            size_t count = soup_kinds[kind].count < 10 ? soup_kinds[kind].count : MOST_TRIANGLES / (build % 3 + 1);
            soup_scene soup = soup_scene_create_kind(&random, &soup_kinds[kind], count);
            kdr_scene *scene = committed_scene(device, soup.geometries, SOUP_GEOMETRIES, &build_cases()[build].def);
            kdr_tree_stats stats;
            assert_int_equal(kdr_scene_stats(scene, &stats), KDR_OK);
            assert_int_equal(kdr_scene_verify(scene), KDR_OK);
            assert_true(stats.triangle_count + stats.dropped_count + stats.degenerate_count == count);
            if (stats.triangle_count > 0)
                assert_numbers_fit(&stats, &build_cases()[build].def);
            kdr_scene_destroy(scene);
            soup_scene_destroy(&soup);
        }
    }
    kdr_device_destroy(device);
}

static void triangles_left_out_are_counted_by_their_reason(void **state) {
    (void)state;
    static const float vertices[8][9] = {
        {0, 0, 0, 1, 0, 0, 0, 1, 0},                   // sound
        {0, 0, 0, 1, 0, 0, NAN, 1, 0},                 // not finite
        {0, 0, 0, 1, 0, -INFINITY, 0, 1, 0},           // not finite
        {0, 0, 0, 1, 1, 1, 3, 3, 3},                   // a segment
        {0.1f, 0.1f, 0.1f, 0.1f, 0.1f, 0.1f, 1, 2, 3}, // a segment
        {2, 2, 2, 2, 2, 2, 2, 2, 2},                   // a point
        {0, 0, 0, 0x1p-149f, 0, 0, 0, 0x1p-149f, 0},   // the smallest sound one
        {0, 0, 0, NAN, NAN, NAN, 0, 0, 0},             // not finite
    };
    kdr_device *device;
    assert_int_equal(kdr_device_create(NULL, &device), KDR_OK);
    kdr_triangles_def def = kdr_default_triangles_def();
    def.vertices = vertices[0];
    def.vertex_count = 24;
    def.triangle_count = 8;
    kdr_scene *scene = committed_scene(device, &def, 1, NULL);
    kdr_tree_stats stats;
    assert_int_equal(kdr_scene_stats(scene, &stats), KDR_OK);
    assert_int_equal(stats.triangle_count, 2);
    assert_int_equal(stats.dropped_count, 3);
    assert_int_equal(stats.degenerate_count, 3);
    kdr_scene_destroy(scene);
    kdr_device_destroy(device);
}

static void a_def_that_asks_for_small_leaves_gets_them_where_triangles_can_be_parted(void **state) {
    (void)state;
    // Small triangles far apart: every split parts them, so no leaf has to be larger than asked for.
    float vertices[9 * 512];
    for (int i = 0; i < 512; i++)
        for (int k = 0; k < 9; k++)
            vertices[9 * i + k] = 10 * (float)(i >> 3 * (k % 3) & 7) + (k == 3 || k == 7 || k == 2);
    kdr_device *device;
    assert_int_equal(kdr_device_create(NULL, &device), KDR_OK);
    kdr_triangles_def def = kdr_default_triangles_def();
    def.vertices = vertices;
    def.vertex_count = 3 * 512;
    def.triangle_count = 512;
    for (uint32_t limit = 1; limit <= 16; limit *= 2) {
        kdr_build_def build = kdr_default_build_def();
        build.cost_traversal = 1000; // the heuristic alone would never split
        build.leaf_limit = limit;
        kdr_scene *scene = committed_scene(device, &def, 1, &build);
        kdr_tree_stats stats;
        assert_int_equal(kdr_scene_stats(scene, &stats), KDR_OK);
        assert_true(stats.largest_leaf <= limit);
        kdr_scene_destroy(scene);
    }
    kdr_device_destroy(device);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(statistics_fit_together_and_keep_the_limits),
        cmocka_unit_test(triangles_left_out_are_counted_by_their_reason),
        cmocka_unit_test(a_def_that_asks_for_small_leaves_gets_them_where_triangles_can_be_parted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
