/* Lazy commits: nodes that the first ray opens. Whatever is open, answers are those of the whole tree, by any number of
 * threads and where memory runs out; once all is open the tree is the same as the eager one. */
#include "support/awkward_rays.h"
#include "support/everywhere.h"
#include "support/failing_alloc.h"
#include "support/query_sheet.h"
#include "support/soup.h"
#include "support/test_size.h"

#include <math.h>
#include <pthread.h>
#include <sched.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { RAYS = 300, ASKERS = 8 };

static const char *const plans[] = {"",
                                    "quality=fast",
                                    "split=space",
                                    "split=object axis=robin",
                                    "straddle=clip",
                                    "straddle=general traversal-cost=1",
                                    "share=grid/16",
                                    "share=cluster/8 traversal-cost=4",
                                    "share=serial/5 reference-limit=1.5",
                                    "depth-limit=9"};
enum { PLANS = sizeof plans / sizeof *plans };

static kdr_build_def plan_of(const char *text, const char *more) {
    char whole[160];
    kdr_build_def def;
    snprintf(whole, sizeof whole, "%s%s%s", text, *text ? " " : "", more);
    assert_int_equal(kdr_build_def_parse(whole, &def, NULL, 0), KDR_OK);
    return def;
}

static kdr_device *device_with(uint32_t workers, const kdr_allocator *functions) {
    kdr_device_def def = kdr_default_device_def();
    def.worker_count = workers;
    if (functions)
        def.allocator = *functions;
    kdr_device *device;
    assert_int_equal(kdr_device_create(&def, &device), KDR_OK);
    return device;
}

static uint64_t closed_nodes(const kdr_scene *scene, uint64_t *opened) {
    kdr_tree_stats stats;
    assert_int_equal(kdr_scene_stats(scene, &stats), KDR_OK);
    *opened = stats.opened_count;
    return stats.closed_count;
}

static void the_tree_is_the_eager_one_once_all_is_open(void **state) {
    (void)state;
    static const char *const limits[] = {"lazy-limit=64", "lazy-limit=500"};
    uint64_t closed_in_all = 0;
    for (size_t kind = 0; kind < soup_kind_count; kind++) {
        test_random random = test_random_start(test_random_seed(), kind);
        soup_scene soup = soup_scene_create_kind(&random, &soup_kinds[kind], TEST_SIZE(3000));
        for (uint32_t workers = 1; workers <= 3; workers += 2) {
            kdr_device *device = device_with(workers, NULL);
            for (size_t i = 0; i < PLANS; i++) {
                kdr_build_def eager = plan_of(plans[i], ""), lazy = plan_of(plans[i], limits[(i + kind) % 2]);
                kdr_scene *whole = committed_scene(device, soup.geometries, SOUP_GEOMETRIES, &eager);
                kdr_scene *scene = committed_scene(device, soup.geometries, SOUP_GEOMETRIES, &lazy);
                uint64_t opened, closed = closed_nodes(scene, &opened);
                assert_int_equal(opened, 0);
                closed_in_all += closed;
                if (kdr_scene_hash(scene) != kdr_scene_hash(whole))
                    fail_msg("%s, %s, %s: another tree", soup_kinds[kind].name, plans[i], limits[(i + kind) % 2]);
                assert_int_equal(kdr_scene_verify(scene), KDR_OK);
                assert_int_equal(closed_nodes(scene, &opened), closed);
                assert_int_equal(opened, closed);
                kdr_scene_destroy(scene);
                kdr_scene_destroy(whole);
            }
            kdr_device_destroy(device);
        }
        soup_scene_destroy(&soup);
    }
    assert_true(closed_in_all > TEST_SIZE(1000));
}

static void answers_are_the_oracle_s_whatever_opens_first(void **state) {
    (void)state;
    static const char *const traces[] = {
        "", "trace=stack", "trace=stack mailbox=8", "trace=restart", "trace=push-down", "trace=short-stack",
    };
    enum { TRACES = sizeof traces / sizeof *traces };
    for (size_t kind = 0; kind < soup_kind_count; kind++) {
        test_random random = test_random_start(test_random_seed(), 100 + kind);
        soup_scene soup = soup_scene_create_kind(&random, &soup_kinds[kind], TEST_SIZE(2000));
        oracle_scene oracle = oracle_scene_create(soup.geometries, SOUP_GEOMETRIES);
        oracle_tree tree = oracle_tree_create(&oracle);
        size_t count = TEST_SIZE(soup_kinds[kind].is_exact ? RAYS / 40 : RAYS / 8);
        kdr_ray *rays = awkward_rays_create(&random, &tree, count);
        query_sheet sheet = query_sheet_create(&tree, rays, count);
        for (int isa = 0; isa <= KDR_ISA_AVX512; isa++) {
            kdr_device *device = device_of_isa((kdr_isa)isa, 1, NULL);
            for (size_t i = 0; device && i < 2; i++) {
                const char *trace = i == 0 ? "" : traces[1 + (kind + (size_t)isa) % (TRACES - 1)];
                kdr_build_def lazy = plan_of("lazy-limit=64", trace);
                kdr_scene *scene = committed_scene(device, soup.geometries, SOUP_GEOMETRIES, &lazy);
                assert_int_equal(query_sheet_differences(&sheet, scene, trace), 0);
                kdr_scene_destroy(scene);
            }
            kdr_device_destroy(device);
        }
        query_sheet_destroy(&sheet);
        free(rays);
        oracle_tree_destroy(&tree);
        oracle_scene_destroy(&oracle);
        soup_scene_destroy(&soup);
    }
}

/* Many threads ask a tree of which nothing is open. */
typedef struct stage {
    const kdr_scene *scene;
    const kdr_ray *rays;
    const kdr_ray_hit *hits;
    _Atomic uint32_t ready, wrong;
} stage;

static void *ask(void *argument) {
    stage *s = argument;
    uint32_t turn = atomic_fetch_add(&s->ready, 1);
    while (atomic_load(&s->ready) < ASKERS)
        sched_yield();
    kdr_ray_hit hits[RAYS];
    memset(hits, 0, sizeof hits);
    for (int i = 0; i < RAYS; i++)
        hits[i].ray = s->rays[i];
    if (turn % 2 == 0)
        kdr_intersect_n(s->scene, NULL, hits, RAYS);
    for (int i = 0; i < RAYS && turn % 2; i++)
        kdr_intersect1(s->scene, &hits[i]);
    if (memcmp(hits, s->hits, sizeof hits) != 0)
        atomic_fetch_add(&s->wrong, 1);
    return NULL;
}

static void any_number_of_threads_open_it_together(void **state) {
    (void)state;
    static const char *const kinds[] = {"small", "large", "boxes", "slabs"};
    const int rounds = (int)TEST_SIZE(test_is_long() ? 1000 : 100);
    for (size_t kind = 0; kind < sizeof kinds / sizeof *kinds; kind++) {
        test_random random = test_random_start(test_random_seed(), 200 + kind);
        soup_scene soup = soup_scene_create_kind(&random, soup_kind_find(kinds[kind]), TEST_SIZE(4000));
        kdr_ray rays[RAYS];
        for (int i = 0; i < RAYS; i++) {
            for (int k = 0; k < 3; k++) {
                (&rays[i].origin_x)[k] = test_random_between(&random, -1, 1);
                (&rays[i].direction_x)[k] = test_random_between(&random, -1, 1);
            }
            rays[i].tmin = 0;
            rays[i].tmax = INFINITY;
        }
        kdr_device *device = device_with(2, NULL);
        kdr_build_def eager = plan_of("quality=fast", ""), lazy = plan_of("quality=fast", "lazy-limit=100");
        kdr_scene *whole = committed_scene(device, soup.geometries, SOUP_GEOMETRIES, &eager);
        kdr_ray_hit hits[RAYS];
        memset(hits, 0, sizeof hits);
        for (int i = 0; i < RAYS; i++) {
            hits[i].ray = rays[i];
            kdr_intersect1(whole, &hits[i]);
        }
        kdr_scene *scene = committed_scene(device, soup.geometries, SOUP_GEOMETRIES, &lazy);
        for (int round = 0; round < rounds; round++) {
            assert_int_equal(kdr_scene_touch(scene, 0), KDR_OK);
            assert_int_equal(kdr_scene_commit(scene, &lazy), KDR_OK);
            stage s = {.scene = scene, .rays = rays, .hits = hits};
            pthread_t threads[ASKERS];
            for (int i = 0; i < ASKERS; i++)
                assert_int_equal(pthread_create(&threads[i], NULL, ask, &s), 0);
            for (int i = 0; i < ASKERS; i++)
                pthread_join(threads[i], NULL);
            if (s.wrong)
                fail_msg("%s: %u threads of round %d have other answers", kinds[kind], s.wrong, round);
            if (round % 8 == 0)
                assert_true(kdr_scene_hash(scene) == kdr_scene_hash(whole));
        }
        kdr_scene_destroy(scene);
        kdr_scene_destroy(whole);
        kdr_device_destroy(device);
        soup_scene_destroy(&soup);
    }
}

static void a_node_stays_closed_and_answers_where_memory_runs_out(void **state) {
    (void)state;
    test_random random = test_random_start(test_random_seed(), 300);
    soup_scene soup = soup_scene_create_kind(&random, soup_kind_find("small"), TEST_SIZE(6000));
    oracle_scene oracle = oracle_scene_create(soup.geometries, SOUP_GEOMETRIES);
    oracle_tree tree = oracle_tree_create(&oracle);
    kdr_ray *rays = awkward_rays_create(&random, &tree, RAYS);
    query_sheet sheet = query_sheet_create(&tree, rays, RAYS);
    kdr_build_def lazy = plan_of("lazy-limit=200", "");
    failing_alloc memory;
    failing_alloc_init(&memory);
    kdr_allocator functions = failing_alloc_functions(&memory);
    uint64_t stayed = 0;
    for (uint64_t first = 1; first <= 8; first++) {
        kdr_device *device = device_with(2, &functions);
        kdr_scene *scene = committed_scene(device, soup.geometries, SOUP_GEOMETRIES, &lazy);
        failing_alloc_fail_from(&memory, first);
        assert_int_equal(query_sheet_differences(&sheet, scene, "without memory"), 0);
        failing_alloc_fail_nth(&memory, 0);

        /* Statistics open what rays have not reached. */
        uint64_t opened;
        closed_nodes(scene, &opened);
        stayed += closed_nodes(scene, &opened) - opened;
        assert_true(kdr_scene_hash(scene) != 0);

        /* The next commit finds memory again. */
        assert_int_equal(kdr_scene_touch(scene, 0), KDR_OK);
        assert_int_equal(kdr_scene_commit(scene, &lazy), KDR_OK);
        assert_int_equal(query_sheet_differences(&sheet, scene, "with memory"), 0);
        kdr_scene_destroy(scene);
        kdr_device_destroy(device);
        assert_true(failing_alloc_is_clean(&memory));
    }
    assert_true(stayed > 0);
    query_sheet_destroy(&sheet);
    free(rays);
    oracle_tree_destroy(&tree);
    oracle_scene_destroy(&oracle);
    soup_scene_destroy(&soup);
}

static void the_caller_s_arrays_are_free_after_the_commit(void **state) {
    (void)state;
    test_random random = test_random_start(test_random_seed(), 301);
    soup_scene soup = soup_scene_create_kind(&random, soup_kind_find("small"), 3000);
    kdr_device *device = device_with(1, NULL);
    kdr_build_def eager = plan_of("", ""), lazy = plan_of("lazy-limit=100", "");
    kdr_scene *whole = committed_scene(device, soup.geometries, SOUP_GEOMETRIES, &eager);
    kdr_scene *scene = committed_scene(device, soup.geometries, SOUP_GEOMETRIES, &lazy);
    soup_scene_destroy(&soup);
    assert_true(kdr_scene_hash(scene) == kdr_scene_hash(whole));
    kdr_scene_destroy(scene);
    kdr_scene_destroy(whole);
    kdr_device_destroy(device);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_tree_is_the_eager_one_once_all_is_open),
        cmocka_unit_test(answers_are_the_oracle_s_whatever_opens_first),
        cmocka_unit_test(any_number_of_threads_open_it_together),
        cmocka_unit_test(a_node_stays_closed_and_answers_where_memory_runs_out),
        cmocka_unit_test(the_caller_s_arrays_are_free_after_the_commit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
