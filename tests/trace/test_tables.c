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

static kdr_ray random_ray(test_random *random) {
    float at[6];
    for (int k = 0; k < 6; k++)
        at[k] = test_random_between(random, -1.5f, 1.5f);
    return (kdr_ray){.origin_x = at[0],
                     .origin_y = at[1],
                     .origin_z = at[2],
                     .direction_x = at[3] - at[0],
                     .direction_y = at[4] - at[1],
                     .direction_z = at[5] - at[2],
                     .tmax = INFINITY};
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

    size_t tables = 0, hits = 0;
    for (int isa = KDR_ISA_SCALAR; isa <= KDR_ISA_NEON; isa++) {
        kdr_device *device = device_of_isa((kdr_isa)isa, 1, NULL);
        if (!device)
            continue;
        kdr_scene *scene = committed_scene(device, &def, 1, NULL);
        const kdr_tree *tree = &scene->tree;
        const kdr_traversals *table = kdr_traversals_for((kdr_isa)isa);
        assert_true((tree->wide != NULL) == table->wants_wide);
        kdr_entry root = kdr_entry_root(tree);
        for (size_t i = 0; i < RAYS; i++) {
            kdr_ray ray = random_ray(&random);
            kdr_found expected = {0}, stack = {0}, single = {0};
            bool hit = scalar->stack_closest(tree, &root, &ray, &expected);
            assert_true(same(table->stack_closest(tree, &root, &ray, &stack), &stack, hit, &expected));
            assert_true(same(table->single_closest(tree, &ray, &single), &single, hit, &expected));
            assert_true(table->stack_any(tree, &root, &ray) == hit);
            assert_true(table->single_any(tree, &ray) == hit);
            hits += hit;
        }
        kdr_scene_destroy(scene);
        kdr_device_destroy(device);
        tables++;
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
