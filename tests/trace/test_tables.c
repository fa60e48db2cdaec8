/* Every traversal of every instruction set gives the same answer to the bit: the stack traversal of the kd-tree and the
 * lone-ray traversal of the wide tree, held against the scalar stack. */
#include "scene/scene.h"
#include "support/everywhere.h"
#include "support/random.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define TRIANGLES 600
#define RAYS 4000

static kdr_ray plain_ray(const float at[6]) {
    return (kdr_ray){.origin_x = at[0],
                     .origin_y = at[1],
                     .origin_z = at[2],
                     .direction_x = at[3] - at[0],
                     .direction_y = at[4] - at[1],
                     .direction_z = at[5] - at[2],
                     .tmax = INFINITY};
}

/* Every other ray is of a kind that traversals treat apart: along an axis or nearly so, from far away, with an
 * interval, behind the origin, short, long. */
static kdr_ray random_ray(test_random *random, uint32_t kind) {
    float at[6];
    for (int k = 0; k < 6; k++)
        at[k] = test_random_between(random, -1.5f, 1.5f);
    kdr_ray ray = plain_ray(at);
    float *direction = &ray.direction_x;
    switch (kind % 16) {
    case 1: direction[kind / 16 % 3] = 0; break;
    case 3: direction[kind / 16 % 3] = direction[(kind / 16 + 1) % 3] = -0.0f; break;
    case 5: direction[kind / 16 % 3] *= 0x1p-70f; break;
    case 7:
        at[kind / 16 % 3] *= 0x1p30f;
        ray = plain_ray(at);
        break;
    case 9:
        ray.tmin = 0.4f;
        ray.tmax = 0.8f;
        break;
    case 11: ray.tmin = -1; break;
    case 13:
    case 15:
        for (int k = 0; k < 3; k++)
            direction[k] *= kind % 16 == 13 ? 0x1p-50f : 0x1p70f;
        break;
    default: break;
    }
    return ray;
}

static bool same(bool hit, const kdr_found *found, bool expected_hit, const kdr_found *expected) {
    return hit == expected_hit && (!hit || memcmp(found, expected, sizeof *found) == 0);
}

static void every_traversal_of_every_instruction_set_gives_the_same_bits(void **state) {
    (void)state;
    test_random random = test_random_start(test_random_seed(), 77);
    float *triangles = malloc(TRIANGLES * 9 * sizeof *triangles);
    assert_non_null(triangles);
    for (size_t i = 0; i < TRIANGLES; i++) {
        float centre[3];
        for (int k = 0; k < 3; k++)
            centre[k] = test_random_between(&random, -1, 1);
        for (int k = 0; k < 9; k++)
            triangles[9 * i + k] = centre[k % 3] + test_random_between(&random, -0.2f, 0.2f);
    }
    kdr_triangles_def def = kdr_default_triangles_def();
    def.vertices = triangles;
    def.vertex_count = 3 * TRIANGLES;
    def.triangle_count = TRIANGLES;
    const kdr_traversals *scalar = kdr_traversals_for(KDR_ISA_SCALAR);

    /* Leaves as the default has them, single triangles, and leaves too long for the word of a wide node's child. */
    kdr_build_def builds[3] = {kdr_default_build_def(), kdr_default_build_def(), kdr_default_build_def()};
    builds[1].cost_traversal = 0.1f;
    builds[2].cost_traversal = 60;
    builds[2].leaf_limit = 200;
    size_t tables = 0, hits = 0;
    for (int isa = KDR_ISA_SCALAR; isa <= KDR_ISA_NEON; isa++) {
        kdr_device *device = device_of_isa((kdr_isa)isa, 1, NULL);
        if (!device)
            continue;
        for (size_t build = 0; build < 3; build++, tables++) {
            kdr_scene *scene = committed_scene(device, &def, 1, &builds[build]);
            const kdr_tree *tree = &scene->tree;
            const kdr_traversals *table = kdr_traversals_for((kdr_isa)isa);
            assert_true((tree->wide != NULL) == table->wants_wide);
            kdr_entry root = kdr_entry_root(tree);
            for (uint32_t i = 0; i < RAYS; i++) {
                kdr_ray ray = random_ray(&random, i);
                kdr_found expected = {0}, stack = {0}, single = {0};
                bool hit = scalar->stack_closest(tree, &root, &ray, &expected);
                assert_true(same(table->stack_closest(tree, &root, &ray, &stack), &stack, hit, &expected));
                assert_true(same(table->single_closest(tree, &ray, &single), &single, hit, &expected));
                assert_true(table->stack_any(tree, &root, &ray) == hit);
                assert_true(table->single_any(tree, &ray) == hit);
                hits += hit;
            }
            kdr_scene_destroy(scene);
        }
        kdr_device_destroy(device);
    }
    assert_true(tables > 0 && hits > tables * RAYS / 10);
    free(triangles);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_traversal_of_every_instruction_set_gives_the_same_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
