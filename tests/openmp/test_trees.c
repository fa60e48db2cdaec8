/* A tree built on OpenMP's threads is the one that the built-in threads build. */
#include "kdray/openmp.h"
#include "support/everywhere.h"
#include "support/soup.h"
#include "support/test_size.h"

#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>

static uint64_t hash_with(const kdr_device_def *def, const soup_scene *soup) {
    kdr_device *device;
    assert_int_equal(kdr_device_create(def, &device), KDR_OK);
    kdr_scene *scene = committed_scene(device, soup->geometries, SOUP_GEOMETRIES, NULL);
    assert_int_equal(kdr_scene_verify(scene), KDR_OK);
    uint64_t hash = kdr_scene_hash(scene);
    kdr_scene_destroy(scene);
    kdr_device_destroy(device);
    return hash;
}

static void openmp_and_built_in_threads_build_the_same_tree(void **state) {
    (void)state;
    for (size_t kind = 0; kind < soup_kind_count; kind++) {
        test_random random = test_random_start(test_random_seed(), kind);
        size_t count = kind % 4 == 3 ? TEST_SIZE(30000) : soup_kinds[kind].count;
        soup_scene soup = soup_scene_create_kind(&random, &soup_kinds[kind], count);
        kdr_device_def def = kdr_default_device_def();
        def.worker_count = 2;
        uint64_t hash = hash_with(&def, &soup);
        static const uint32_t workers[] = {1, 2, 7};
        for (int i = 0; i < 3; i++) {
            def.worker_count = workers[i];
            def.tasks = kdr_openmp_backend(workers[i]);
            assert_true(hash_with(&def, &soup) == hash);
        }
        soup_scene_destroy(&soup);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(openmp_and_built_in_threads_build_the_same_tree)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
