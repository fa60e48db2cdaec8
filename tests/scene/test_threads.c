/* The tree is the same whoever builds it, and any number of threads may ask it at once. */
#include "support/awkward_rays.h"
#include "support/everywhere.h"
#include "support/soup.h"
#include "support/test_size.h"

#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#define TRIANGLES TEST_SIZE(60000)
#define QUERY_THREADS 8

/* A host that makes all calls itself, the last one first. */
static void *backwards_start(kdr_task_fn *task, void *context, uint32_t count, void *user) {
    ++*(int *)user;
    while (count > 0)
        task(context, --count);
    return NULL;
}

static void no_wait(void *handle, void *user) { (void)handle, (void)user; }

/* A host that starts a thread for each call. */
typedef struct host_call {
    kdr_task_fn *task;
    void *context;
    uint32_t index;
    pthread_t thread;
} host_call;

typedef struct host_start {
    uint32_t count;
    host_call calls[];
} host_start;

static void *host_thread(void *argument) {
    host_call *call = argument;
    call->task(call->context, call->index);
    return NULL;
}

static void *threads_start(kdr_task_fn *task, void *context, uint32_t count, void *user) {
    ++*(int *)user;
    host_start *start = malloc(sizeof(host_start) + count * sizeof(host_call));
    assert_non_null(start);
    start->count = count;
    for (uint32_t i = 0; i < count; i++) {
        start->calls[i] = (host_call){.task = task, .context = context, .index = i};
        assert_int_equal(pthread_create(&start->calls[i].thread, NULL, host_thread, &start->calls[i]), 0);
    }
    return start;
}

static void threads_wait(void *handle, void *user) {
    (void)user;
    host_start *start = handle;
    for (uint32_t i = 0; i < start->count; i++)
        pthread_join(start->calls[i].thread, NULL);
    free(start);
}

static uint64_t hash_with(const kdr_device_def *def, const soup_scene *soup, const kdr_build_def *build) {
    kdr_device *device;
    assert_int_equal(kdr_device_create(def, &device), KDR_OK);
    kdr_scene *scene = committed_scene(device, soup->geometries, SOUP_GEOMETRIES, build);
    assert_int_equal(kdr_scene_verify(scene), KDR_OK);
    uint64_t hash = kdr_scene_hash(scene);
    // A second build, on memory that the first one left, is no different.
    assert_int_equal(kdr_scene_touch(scene, 0), KDR_OK);
    assert_int_equal(kdr_scene_commit(scene, build), KDR_OK);
    assert_true(kdr_scene_hash(scene) == hash);
    kdr_scene_destroy(scene);
    kdr_device_destroy(device);
    return hash;
}

static void the_tree_does_not_depend_on_workers_or_backend(void **state) {
    (void)state;
    static const char *const kinds[] = {"small", "large",   "slabs",        "boxes",
                                        "plane", "needles", "mixed scales", "any bits"};
    for (size_t kind = 0; kind < sizeof(kinds) / sizeof(kinds[0]); kind++) {
        test_random random = test_random_start(test_random_seed(), kind);
        soup_scene soup = soup_scene_create_kind(&random, soup_kind_find(kinds[kind]), TRIANGLES / (kind + 1));
        kdr_build_def build = kdr_default_build_def();
        build.reference_limit = 2; // large triangles would fill the test's time
        kdr_device_def def = kdr_default_device_def();
        def.worker_count = 1;
        uint64_t hash = hash_with(&def, &soup, &build);
        static const uint32_t workers[] = {2, 3, 7};
        for (size_t i = 0; i < sizeof(workers) / sizeof(workers[0]); i++) {
            def.worker_count = workers[i];
            assert_true(hash_with(&def, &soup, &build) == hash);
        }
        int starts = 0;
        def.tasks = (kdr_task_backend){backwards_start, no_wait, &starts};
        assert_true(hash_with(&def, &soup, &build) == hash);
        def.tasks = (kdr_task_backend){threads_start, threads_wait, &starts};
        assert_true(hash_with(&def, &soup, &build) == hash);
        assert_true(starts > 0);
        soup_scene_destroy(&soup);
    }
}

typedef struct asker {
    const query_sheet *sheet;
    const kdr_scene *scene;
    size_t differences;
    pthread_t thread;
} asker;

static void *ask(void *argument) {
    asker *one = argument;
    one->differences = query_sheet_differences(one->sheet, one->scene, "one of many threads");
    kdr_tree_stats stats;
    if (kdr_scene_stats(one->scene, &stats) != KDR_OK || kdr_scene_verify(one->scene) != KDR_OK)
        one->differences++;
    return NULL;
}

static void many_threads_ask_one_scene_at_once(void **state) {
    (void)state;
    enum { RAYS = TEST_SIZE(2500) };
    test_random random = test_random_start(test_random_seed(), 50);
    soup_scene soup = soup_scene_create_kind(&random, soup_kind_find("small"), TRIANGLES / 10);
    oracle_scene oracle = oracle_scene_create(soup.geometries, SOUP_GEOMETRIES);
    oracle_tree tree = oracle_tree_create(&oracle);
    kdr_ray *rays = awkward_rays_create(&random, &tree, RAYS);
    query_sheet sheet = query_sheet_create(&tree, rays, RAYS);
    kdr_device *device;
    assert_int_equal(kdr_device_create(NULL, &device), KDR_OK);
    kdr_scene *scene = committed_scene(device, soup.geometries, SOUP_GEOMETRIES, NULL);
    asker askers[QUERY_THREADS];
    for (int i = 0; i < QUERY_THREADS; i++) {
        askers[i] = (asker){.sheet = &sheet, .scene = scene};
        assert_int_equal(pthread_create(&askers[i].thread, NULL, ask, &askers[i]), 0);
    }
    for (int i = 0; i < QUERY_THREADS; i++) {
        pthread_join(askers[i].thread, NULL);
        assert_int_equal(askers[i].differences, 0);
    }
    kdr_scene_destroy(scene);
    kdr_device_destroy(device);
    query_sheet_destroy(&sheet);
    free(rays);
    oracle_tree_destroy(&tree);
    oracle_scene_destroy(&oracle);
    soup_scene_destroy(&soup);
}

static void count_call(void *context, uint32_t index) { atomic_fetch_add(&((_Atomic uint32_t *)context)[index], 1); }

static void a_device_lends_its_threads_and_makes_every_call_once(void **state) {
    (void)state;
    for (uint32_t workers = 1; workers <= 5; workers++) {
        kdr_device_def def = kdr_default_device_def();
        def.worker_count = workers;
        kdr_device *device;
        assert_int_equal(kdr_device_create(&def, &device), KDR_OK);
        assert_int_equal(kdr_device_worker_count(device), workers);
        static const uint32_t counts[] = {0, 1, 2, 17, 1000};
        for (size_t i = 0; i < sizeof(counts) / sizeof(counts[0]); i++) {
            _Atomic uint32_t calls[1001] = {0};
            kdr_device_run(device, count_call, (void *)calls, counts[i]);
            for (uint32_t k = 0; k <= 1000; k++)
                assert_int_equal(calls[k], k < counts[i]);
        }
        kdr_device_destroy(device);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_tree_does_not_depend_on_workers_or_backend),
        cmocka_unit_test(many_threads_ask_one_scene_at_once),
        cmocka_unit_test(a_device_lends_its_threads_and_makes_every_call_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
