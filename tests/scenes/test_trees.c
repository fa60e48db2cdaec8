/* The built-in scenes at moderate sizes: sound trees, the same for any number of workers, that answer as the oracle
 * does. */
#include "kdray/render.h"
#include "support/awkward_rays.h"
#include "support/everywhere.h"
#include "support/test_size.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#define TRIANGLES TEST_SIZE(20000)
#define RAYS TEST_SIZE(300)

static void hold_scene(const char *name, uint64_t sequence, double time) {
    kdr_mesh *mesh;
    assert_int_equal(kdr_mesh_make(name, TRIANGLES, time, NULL, &mesh), KDR_OK);
    kdr_triangles_def def = kdr_default_triangles_def();
    def.vertices = mesh->positions;
    def.vertex_count = mesh->vertex_count;
    def.indices = mesh->indices;
    def.triangle_count = mesh->triangle_count;

    oracle_scene oracle = oracle_scene_create(&def, 1);
    oracle_tree tree = oracle_tree_create(&oracle);
    test_random random = test_random_start(test_random_seed(), sequence);
    kdr_ray *rays = awkward_rays_create(&random, &tree, RAYS);
    query_sheet sheet = query_sheet_create(&tree, rays, RAYS);
    static const uint32_t workers[] = {1, 2, 7};
    uint64_t hash = 0;
    for (int i = 0; i < 3; i++) {
        kdr_device_def device_def = kdr_default_device_def();
        device_def.worker_count = workers[i];
        kdr_device *device;
        assert_int_equal(kdr_device_create(&device_def, &device), KDR_OK);
        kdr_scene *scene = committed_scene(device, &def, 1, NULL);
        assert_int_equal(kdr_scene_verify(scene), KDR_OK);
        assert_true(i == 0 || kdr_scene_hash(scene) == hash);
        hash = kdr_scene_hash(scene);
        if (i == 0)
            assert_int_equal(query_sheet_differences(&sheet, scene, name), 0);
        kdr_scene_destroy(scene);
        kdr_device_destroy(device);
    }
    query_sheet_destroy(&sheet);
    free(rays);
    oracle_tree_destroy(&tree);
    oracle_scene_destroy(&oracle);
    kdr_mesh_destroy(mesh);
}

static void built_in_scenes_give_sound_trees_that_answer_as_the_oracle(void **state) {
    (void)state;
    uint64_t sequence = 0;
    for (const char *name; (name = kdr_mesh_builtin_name(sequence)) != NULL; sequence++)
        hold_scene(name, sequence, 0.3 * (double)sequence);
    assert_true(sequence > 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(built_in_scenes_give_sound_trees_that_answer_as_the_oracle)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
