/* What queries cost: exactly, on trees that are known; and as walks that visit the same leaves must agree. A library
 * that does not count says so. */
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

#ifndef KDR_COUNTING

static void a_library_that_does_not_count_says_so(void **state) {
    (void)state;
    kdr_trace_counts counts = {.nodes = 7, .width = 3};
    assert_int_equal(kdr_trace_counts_take(&counts), KDR_ERROR_UNSUPPORTED);
    assert_true(counts.nodes == 0 && counts.width == 0);
    assert_int_equal(kdr_trace_counts_take(NULL), KDR_ERROR_INVALID_ARGUMENT);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_library_that_does_not_count_says_so)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

#else

#define RAYS TEST_SIZE(2000)

static kdr_trace_counts taken(void) {
    kdr_trace_counts counts;
    assert_int_equal(kdr_trace_counts_take(&counts), KDR_OK);
    return counts;
}

/* Small triangles across the axis at x = 0, 1, 2 ... */
#define ROW 9
static kdr_scene *row_scene(kdr_device *device, const char *plan) {
    float vertices[9 * ROW] = {0};
    for (int i = 0; i < ROW; i++) {
        float triangle[9] = {(float)i, 0, 0, (float)i, 1, 0, (float)i, 0, 1};
        memcpy(vertices + 9 * (size_t)i, triangle, sizeof triangle);
    }
    kdr_triangles_def triangles = kdr_default_triangles_def();
    triangles.vertices = vertices;
    triangles.vertex_count = 3 * ROW;
    triangles.triangle_count = ROW;
    kdr_build_def def;
    assert_int_equal(kdr_build_def_parse(plan, &def, NULL, 0), KDR_OK);
    return committed_scene(device, &triangles, 1, &def);
}

static void one_leaf_costs_one_node_and_the_steps_that_its_triangles_take(void **state) {
    (void)state;
    for (int isa = KDR_ISA_SCALAR; isa <= KDR_ISA_NEON; isa++) {
        kdr_device *device = device_of_isa((kdr_isa)isa, 1, NULL);
        if (!device)
            continue;
        kdr_scene *scene = row_scene(device, "trace=stack depth-limit=0 split=space leaf-limit=100");
        kdr_ray_hit along = {
            .ray = {.origin_x = -1, .origin_y = 0.25f, .origin_z = 0.25f, .direction_x = 1, .tmax = 99}};
        taken();
        kdr_intersect1(scene, &along);
        kdr_trace_counts counts = taken();
        uint32_t padded = (ROW + 3) / 4 * 4;
        assert_true(counts.nodes == 1 && counts.node_rays == 1 && counts.blocks == 1);
        assert_true(counts.width > 0 && counts.steps == (padded + counts.width - 1) / counts.width);
        assert_true(counts.tests == padded);

        /* Each thread starts from nothing once it has asked, and a ray beside the box costs nothing. */
        kdr_ray beside = {.origin_x = -1, .origin_y = 7, .direction_x = 1, .tmax = 99};
        assert_false(kdr_occluded1(scene, &beside));
        counts = taken();
        assert_true(counts.nodes == 0 && counts.blocks == 0 && counts.steps == 0 && counts.width == 0);
        kdr_scene_destroy(scene);
        kdr_device_destroy(device);
    }
}

static void a_ray_through_both_halves_visits_three_nodes_and_one_that_ends_before_visits_two(void **state) {
    (void)state;
    kdr_device *device = device_of_isa(KDR_ISA_SCALAR, 1, NULL);
    kdr_scene *scene = row_scene(device, "trace=stack split=space depth-limit=1 leaf-limit=1");
    kdr_ray through = {.origin_x = -1, .origin_y = 0.75f, .origin_z = 0.75f, .direction_x = 1, .tmax = 99};
    kdr_ray half = through;
    half.tmax = 3;
    taken();
    assert_false(kdr_occluded1(scene, &through));
    kdr_trace_counts counts = taken();
    assert_true(counts.nodes == 3 && counts.blocks == 2);
    assert_false(kdr_occluded1(scene, &half));
    counts = taken();
    assert_true(counts.nodes == 2 && counts.blocks == 1);
    kdr_scene_destroy(scene);
    kdr_device_destroy(device);
}

static kdr_ray any_ray(test_random *random) {
    float v[6];
    for (int k = 0; k < 6; k++)
        v[k] = 4 * test_random_float(random) - 2;
    return (kdr_ray){.origin_x = v[0],
                     .origin_y = v[1],
                     .origin_z = v[2],
                     .direction_x = v[3],
                     .direction_y = v[4],
                     .direction_z = v[5],
                     .tmax = INFINITY};
}

static kdr_trace_counts cost_of(kdr_device *device, const soup_scene *soup, const kdr_ray *rays, const char *plan,
                                bool any, bool together) {
    kdr_build_def def;
    assert_int_equal(kdr_build_def_parse(plan, &def, NULL, 0), KDR_OK);
    kdr_scene *scene = committed_scene(device, soup->geometries, SOUP_GEOMETRIES, &def);
    kdr_trace_def coherent = kdr_default_trace_def();
    coherent.coherence = KDR_COHERENCE_COHERENT;
    kdr_ray_hit *found = test_allocate(RAYS, sizeof *found);
    uint8_t *occluded = test_allocate(RAYS, 1);
    for (size_t i = 0; i < RAYS; i++)
        found[i].ray = rays[i];
    taken();
    if (together && any)
        kdr_occluded_n(scene, &coherent, rays, occluded, RAYS);
    else if (together)
        kdr_intersect_n(scene, &coherent, found, RAYS);
    for (size_t i = 0; !together && i < RAYS; i++) {
        if (any)
            kdr_occluded1(scene, &rays[i]);
        else
            kdr_intersect1(scene, &found[i]);
    }
    kdr_trace_counts counts = taken();
    free(occluded);
    free(found);
    kdr_scene_destroy(scene);
    return counts;
}

static void walks_without_a_stack_visit_the_leaves_of_the_stack_and_no_fewer_nodes(void **state) {
    (void)state;
    static const char *const others[] = {"trace=restart", "trace=push-down", "trace=short-stack", "trace=backtrack",
                                         "trace=restart nodes=arrays"};
    test_random random = test_random_start(test_random_seed(), 500);
    soup_scene soup = soup_scene_create_kind(&random, soup_kind_find("small"), 2000);
    kdr_ray *rays = test_allocate(RAYS, sizeof *rays);
    for (size_t i = 0; i < RAYS; i++)
        rays[i] = any_ray(&random);
    for (int isa = KDR_ISA_SCALAR; isa <= KDR_ISA_NEON; isa++) {
        kdr_device *device = device_of_isa((kdr_isa)isa, 1, NULL);
        for (int any = 0; device && any < 2; any++) {
            kdr_trace_counts stack = cost_of(device, &soup, rays, "trace=stack", any, false);
            assert_true(stack.nodes > RAYS && stack.blocks > 0 && stack.nodes > stack.blocks);
            assert_true(stack.tests <= stack.steps * stack.width && stack.steps >= stack.blocks);
            for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
                kdr_trace_counts other = cost_of(device, &soup, rays, others[i], any, false);
                assert_true(other.blocks == stack.blocks && other.steps == stack.steps && other.tests == stack.tests);
                assert_true(other.nodes >= stack.nodes && other.exact == stack.exact);
            }
            kdr_trace_counts mailed = cost_of(device, &soup, rays, "trace=stack mailbox=64", any, false);
            assert_true(mailed.nodes == stack.nodes && mailed.blocks == stack.blocks && mailed.tests < stack.tests);

            /* Together, a node is visited once for several rays. */
            kdr_trace_counts lone = cost_of(device, &soup, rays, "", any, false);
            kdr_trace_counts packets = cost_of(device, &soup, rays, "", any, true);
            assert_true(lone.nodes == lone.node_rays && lone.nodes <= stack.nodes);
            assert_true(packets.nodes <= packets.node_rays && packets.nodes <= lone.nodes);
            assert_true(packets.tests <= packets.steps * packets.width);
        }
        kdr_device_destroy(device);
    }
    free(rays);
    soup_scene_destroy(&soup);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_leaf_costs_one_node_and_the_steps_that_its_triangles_take),
        cmocka_unit_test(a_ray_through_both_halves_visits_three_nodes_and_one_that_ends_before_visits_two),
        cmocka_unit_test(walks_without_a_stack_visit_the_leaves_of_the_stack_and_no_fewer_nodes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

#endif
