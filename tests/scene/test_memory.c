/* Every allocation made to fail in turn: a clean status, nothing lost, the old tree still answering, and a retry that
 * works. */
#include "support/everywhere.h"
#include "support/failing_alloc.h"
#include "support/soup.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

#define TRIANGLES 20000 /* enough for every phase of a parallel build */
#define RAYS 24

typedef struct fixture {
    failing_alloc memory;
    soup_scene old_soup, new_soup;
    oracle_scene old_oracle;
    oracle_tree old_tree;
    kdr_ray rays[RAYS];
    query_sheet old_sheet;
    uint64_t old_hash, new_hash;
} fixture;

static kdr_device *device_on(failing_alloc *memory, uint32_t workers) {
    kdr_device_def def = kdr_default_device_def();
    def.worker_count = workers;
    def.allocator = failing_alloc_functions(memory);
    kdr_device *device;
    assert_int_equal(kdr_device_create(&def, &device), KDR_OK);
    return device;
}

static uint64_t hash_of(const kdr_triangles_def *geometries) {
    kdr_device *device;
    assert_int_equal(kdr_device_create(NULL, &device), KDR_OK);
    kdr_scene *scene = committed_scene(device, geometries, SOUP_GEOMETRIES, NULL);
    uint64_t hash = kdr_scene_hash(scene);
    kdr_scene_destroy(scene);
    kdr_device_destroy(device);
    return hash;
}

static int setup(void **state) {
    fixture *made = test_allocate(1, sizeof(fixture));
    failing_alloc_init(&made->memory);
    test_random random = test_random_start(test_random_seed(), 1);
    made->old_soup = soup_scene_create_kind(&random, soup_kind_find("small"), 300);
    made->new_soup = soup_scene_create_kind(&random, soup_kind_find("small"), TRIANGLES);
    made->old_oracle = oracle_scene_create(made->old_soup.geometries, SOUP_GEOMETRIES);
    made->old_tree = oracle_tree_create(&made->old_oracle);
    for (int i = 0; i < RAYS; i++) {
        const oracle_primitive *aim = &made->old_oracle.primitives[i];
        float target[3];
        for (int axis = 0; axis < 3; axis++)
            target[axis] = (aim->a[axis] + aim->b[axis] + aim->c[axis]) / 3;
        made->rays[i] = (kdr_ray){.origin_z = -4,
                                  .direction_x = target[0],
                                  .direction_y = target[1],
                                  .direction_z = target[2] + 4,
                                  .tmax = INFINITY};
    }
    made->old_sheet = query_sheet_create(&made->old_tree, made->rays, RAYS);
    made->old_hash = hash_of(made->old_soup.geometries);
    made->new_hash = hash_of(made->new_soup.geometries);
    assert_true(made->old_sheet.hit_count == RAYS && made->old_hash != made->new_hash);
    *state = made;
    return 0;
}

static int teardown(void **state) {
    fixture *made = *state;
    query_sheet_destroy(&made->old_sheet);
    oracle_tree_destroy(&made->old_tree);
    oracle_scene_destroy(&made->old_oracle);
    soup_scene_destroy(&made->old_soup);
    soup_scene_destroy(&made->new_soup);
    free(made);
    return 0;
}

static void deny(failing_alloc *memory, uint64_t n, bool and_after) {
    if (and_after)
        failing_alloc_fail_from(memory, n);
    else
        failing_alloc_fail_nth(memory, n);
}

/* Runs with allocation n failing for n = 1, 2 ... until one run asks for no n-th. */
static void assert_device_survives(fixture *made, uint32_t workers, bool and_after) {
    kdr_device_def def = kdr_default_device_def();
    def.worker_count = workers;
    def.allocator = failing_alloc_functions(&made->memory);
    for (uint64_t n = 1;; n++) {
        deny(&made->memory, n, and_after);
        kdr_device *device = (kdr_device *)made;
        kdr_status status = kdr_device_create(&def, &device);
        if (status == KDR_OK) {
            kdr_device_destroy(device);
        } else {
            assert_int_equal(status, KDR_ERROR_OUT_OF_MEMORY);
            assert_null(device);
        }
        assert_true(failing_alloc_is_clean(&made->memory));
        if (made->memory.failures == 0) {
            assert_true(n > 1);
            return;
        }
    }
}

static void a_device_that_gets_no_memory_leaves_nothing_behind(void **state) {
    for (uint32_t workers = 1; workers <= 3; workers += 2) {
        assert_device_survives(*state, workers, false);
        assert_device_survives(*state, workers, true);
    }
}

static void a_scene_that_gets_no_memory_leaves_nothing_behind(void **state) {
    fixture *made = *state;
    failing_alloc_fail_nth(&made->memory, 0);
    kdr_device *device = device_on(&made->memory, 1);
    kdr_device_trim(device);
    size_t bytes = kdr_device_bytes(device);
    for (uint64_t n = 1;; n++) {
        failing_alloc_fail_nth(&made->memory, n);
        kdr_scene *scene = (kdr_scene *)made;
        kdr_status status = kdr_scene_create(device, &scene);
        bool failed = status != KDR_OK;
        if (failed) {
            assert_int_equal(status, KDR_ERROR_OUT_OF_MEMORY);
            assert_null(scene);
        }
        // More geometries than any first array holds.
        for (uint32_t i = 0; i < 100 && scene; i++) {
            uint32_t geometry = KDR_INVALID_ID;
            status = kdr_scene_add_triangles(scene, &made->old_soup.geometries[0], &geometry);
            if (status != KDR_OK) {
                assert_int_equal(status, KDR_ERROR_OUT_OF_MEMORY);
                assert_int_equal(kdr_scene_add_triangles(scene, &made->old_soup.geometries[0], &geometry), KDR_OK);
                failed = true;
            }
            assert_int_equal(geometry, i);
        }
        kdr_scene_destroy(scene);
        kdr_device_trim(device); // a device keeps what its scenes give back
        assert_int_equal(kdr_device_bytes(device), bytes);
        if (!failed)
            break;
        assert_true(n < 1000);
    }
    kdr_device_destroy(device);
    assert_true(failing_alloc_is_clean(&made->memory));
}

/* The old tree answers as it did. */
static void assert_old_tree(const fixture *made, const kdr_scene *scene) {
    assert_true(kdr_scene_hash(scene) == made->old_hash);
    assert_int_equal(kdr_scene_verify(scene), KDR_OK);
    assert_int_equal(query_sheet_differences(&made->old_sheet, scene, "the old tree"), 0);
}

static void assert_commit_survives(fixture *made, uint32_t workers, bool and_after) {
    for (uint64_t n = 1;; n++) {
        failing_alloc_fail_nth(&made->memory, 0);
        kdr_device *device = device_on(&made->memory, workers);
        kdr_scene *scene = committed_scene(device, made->old_soup.geometries, SOUP_GEOMETRIES, NULL);
        for (uint32_t i = 0; i < SOUP_GEOMETRIES; i++)
            assert_int_equal(kdr_scene_set_triangles(scene, i, &made->new_soup.geometries[i]), KDR_OK);

        deny(&made->memory, n, and_after);
        kdr_status status = kdr_scene_commit(scene, NULL);
        bool failed = made->memory.failures > 0;
        failing_alloc_fail_nth(&made->memory, 0);
        if (status != KDR_OK) {
            assert_int_equal(status, KDR_ERROR_OUT_OF_MEMORY);
            assert_true(failed);
            assert_old_tree(made, scene);
            assert_int_equal(kdr_scene_commit(scene, NULL), KDR_OK);
        }
        assert_true(kdr_scene_hash(scene) == made->new_hash);
        assert_int_equal(kdr_scene_verify(scene), KDR_OK);
        kdr_scene_destroy(scene);
        kdr_device_destroy(device);
        assert_true(failing_alloc_is_clean(&made->memory));
        if (!failed) {
            assert_true(n > 1);
            return;
        }
    }
}

static void a_commit_that_gets_no_memory_keeps_the_old_tree_and_can_be_tried_again(void **state) {
    assert_commit_survives(*state, 1, false);
    assert_commit_survives(*state, 1, true);
}

static void a_commit_of_many_workers_that_gets_no_memory_keeps_the_old_tree(void **state) {
    assert_commit_survives(*state, 3, false);
    assert_commit_survives(*state, 3, true);
}

static void bytes_are_counted_and_all_come_back(void **state) {
    fixture *made = *state;
    failing_alloc_fail_nth(&made->memory, 0);
    kdr_device *device = device_on(&made->memory, 2);
    size_t empty = kdr_device_bytes(device);
    assert_int_equal(empty, made->memory.live_bytes);
    kdr_scene *scene = committed_scene(device, made->new_soup.geometries, SOUP_GEOMETRIES, NULL);
    size_t full = kdr_device_bytes(device);
    assert_int_equal(full, made->memory.live_bytes);
    kdr_device_trim(device);
    assert_true(kdr_device_bytes(device) <= full);
    assert_int_equal(kdr_device_bytes(device), made->memory.live_bytes);
    assert_true(kdr_device_peak_bytes(device) >= full);
    assert_true(kdr_scene_hash(scene) == made->new_hash); // a trim takes nothing from the tree
    kdr_scene_destroy(scene);
    kdr_device_trim(device);
    assert_true(kdr_device_bytes(device) <= empty);
    kdr_device_destroy(device);
    assert_true(failing_alloc_is_clean(&made->memory));
}

static void many_commits_do_not_make_memory_grow(void **state) {
    fixture *made = *state;
    failing_alloc_fail_nth(&made->memory, 0);
    kdr_device *device = device_on(&made->memory, 2);
    kdr_scene *scene = committed_scene(device, made->new_soup.geometries, SOUP_GEOMETRIES, NULL);
    size_t peak = 0;
    for (int i = 0; i < 12; i++) {
        assert_int_equal(kdr_scene_touch(scene, 0), KDR_OK);
        assert_int_equal(kdr_scene_commit(scene, NULL), KDR_OK);
        if (i == 5)
            peak = kdr_device_peak_bytes(device);
    }
    // Which worker needs how much differs a little from build to build.
    assert_true((double)kdr_device_peak_bytes(device) <= 1.5 * (double)peak);
    kdr_scene_destroy(scene);
    kdr_device_destroy(device);
    assert_true(failing_alloc_is_clean(&made->memory));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_device_that_gets_no_memory_leaves_nothing_behind),
        cmocka_unit_test(a_scene_that_gets_no_memory_leaves_nothing_behind),
        cmocka_unit_test(a_commit_that_gets_no_memory_keeps_the_old_tree_and_can_be_tried_again),
        cmocka_unit_test(a_commit_of_many_workers_that_gets_no_memory_keeps_the_old_tree),
        cmocka_unit_test(bytes_are_counted_and_all_come_back),
        cmocka_unit_test(many_commits_do_not_make_memory_grow),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
