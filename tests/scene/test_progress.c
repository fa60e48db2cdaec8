/* Commits that tell how far they are, and that are cancelled. */
#include "support/everywhere.h"
#include "support/failing_alloc.h"
#include "support/soup.h"
#include "support/test_size.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdlib.h>

#include <cmocka.h>

#define TRIANGLES TEST_SIZE(15000)

/* Counts calls, and cancels at one of them. */
typedef struct listening {
    _Atomic uint32_t at_once;  /* calls that run */
    uint32_t calls, cancel_at; /* 0: never */
    uint64_t last, total;
    bool fell, overlapped;
} listening;

static bool listen(uint64_t finished, uint64_t total, void *user) {
    listening *l = user;
    l->overlapped |= atomic_fetch_add(&l->at_once, 1) > 0;
    l->fell |= finished < l->last || finished > total || (l->calls > 0 && total != l->total);
    l->last = finished;
    l->total = total;
    bool goes_on = ++l->calls != l->cancel_at;
    atomic_fetch_sub(&l->at_once, 1);
    return goes_on;
}

/* Boxes in a row, as custom primitives. */
static void row_bounds(uint32_t i, float lo[3], float hi[3], void *user) {
    (void)user;
    for (int k = 0; k < 3; k++) {
        lo[k] = (float)(i % 100);
        hi[k] = lo[k] + 1;
    }
}

static bool row_intersect(const kdr_ray *ray, uint32_t i, kdr_custom_hit *hit, void *user) {
    (void)ray, (void)i, (void)hit, (void)user;
    return false;
}

/* Dynamic and static triangles and custom primitives. */
static kdr_scene *scene_of_all_kinds(kdr_device *device, const soup_scene *soup) {
    kdr_scene *scene;
    assert_int_equal(kdr_scene_create(device, &scene), KDR_OK);
    for (uint32_t g = 0; g < SOUP_GEOMETRIES; g++) {
        kdr_triangles_def def = soup->geometries[g];
        def.is_static = g == 2;
        assert_int_equal(kdr_scene_add_triangles(scene, &def, NULL), KDR_OK);
    }
    kdr_custom_def custom = kdr_default_custom_def();
    custom.primitive_count = TRIANGLES / 4;
    custom.bounds = row_bounds;
    custom.intersect = row_intersect;
    assert_int_equal(kdr_scene_add_custom(scene, &custom, NULL), KDR_OK);
    return scene;
}

static void touch_all(kdr_scene *scene) {
    for (uint32_t g = 0; g <= SOUP_GEOMETRIES; g++)
        assert_int_equal(kdr_scene_touch(scene, g), KDR_OK);
}

static const char *const plans[] = {"",
                                    "order=bfs",
                                    "split=sweep straddle=clip retract=yes",
                                    "split=space order=bfs share=grid/8",
                                    "split=object share=line/5",
                                    "quality=best"};

static void a_commit_tells_how_far_it_is_never_less_than_before_and_all_at_the_end(void **state) {
    (void)state;
    test_random random = test_random_start(test_random_seed(), 81);
    soup_scene soup = soup_scene_create_kind(&random, soup_kind_find("small"), TRIANGLES);
    for (uint32_t workers = 1; workers <= 3; workers++) {
        kdr_device_def device_def = kdr_default_device_def();
        device_def.worker_count = workers;
        kdr_device *device;
        assert_int_equal(kdr_device_create(&device_def, &device), KDR_OK);
        for (size_t i = 0; i < sizeof plans / sizeof *plans; i++) {
            kdr_build_def plan;
            listening l = {0};
            kdr_scene *scene = scene_of_all_kinds(device, &soup);
            assert_int_equal(kdr_build_def_parse(plans[i], &plan, NULL, 0), KDR_OK);
            assert_int_equal(kdr_scene_set_progress(scene, listen, &l), KDR_OK);
            assert_int_equal(kdr_scene_commit(scene, &plan), KDR_OK);
            assert_false(l.fell || l.overlapped);
            assert_true(l.calls > 50 && l.last == l.total && l.total > 0);

            /* A commit with nothing to do tells nobody; nor does one that nobody listens to. */
            uint32_t calls = l.calls;
            assert_int_equal(kdr_scene_commit(scene, &plan), KDR_OK);
            touch_all(scene);
            assert_int_equal(kdr_scene_set_progress(scene, NULL, NULL), KDR_OK);
            assert_int_equal(kdr_scene_commit(scene, &plan), KDR_OK);
            assert_int_equal(l.calls, calls);
            kdr_scene_destroy(scene);
        }
        kdr_device_destroy(device);
    }
    assert_int_equal(kdr_scene_set_progress(NULL, listen, NULL), KDR_ERROR_INVALID_ARGUMENT);
    soup_scene_destroy(&soup);
}

static void who_listens_changes_no_tree(void **state) {
    (void)state;
    test_random random = test_random_start(test_random_seed(), 82);
    soup_scene soup = soup_scene_create_kind(&random, soup_kind_find("mixed scales"), TRIANGLES);
    kdr_device *device;
    assert_int_equal(kdr_device_create(NULL, &device), KDR_OK);
    uint64_t hashes[2];
    for (int i = 0; i < 2; i++) {
        listening l = {0};
        kdr_scene *scene = scene_of_all_kinds(device, &soup);
        kdr_scene_set_progress(scene, i == 1 ? listen : NULL, &l);
        assert_int_equal(kdr_scene_commit(scene, NULL), KDR_OK);
        hashes[i] = kdr_scene_hash(scene);
        kdr_scene_destroy(scene);
    }
    assert_true(hashes[0] == hashes[1]);
    kdr_device_destroy(device);
    soup_scene_destroy(&soup);
}

static void a_cancelled_commit_leaves_the_old_trees_and_loses_nothing(void **state) {
    (void)state;
    failing_alloc memory;
    failing_alloc_init(&memory);
    kdr_allocator functions = failing_alloc_functions(&memory);
    test_random random = test_random_start(test_random_seed(), 83);
    soup_scene few = soup_scene_create_kind(&random, soup_kind_find("small"), 100);
    soup_scene many = soup_scene_create_kind(&random, soup_kind_find("small"), TRIANGLES);
    for (uint32_t workers = 1; workers <= 2; workers++) {
        for (size_t i = 0; i < sizeof plans / sizeof *plans; i++) {
            kdr_build_def plan;
            assert_int_equal(kdr_build_def_parse(plans[i], &plan, NULL, 0), KDR_OK);
            kdr_device *device = device_of_isa(KDR_ISA_SCALAR, workers, &functions);
            kdr_scene *scene = scene_of_all_kinds(device, &few);
            assert_int_equal(kdr_scene_commit(scene, &plan), KDR_OK);
            const uint64_t hash = kdr_scene_hash(scene);
            for (uint32_t g = 0; g < SOUP_GEOMETRIES; g++) {
                kdr_triangles_def def = many.geometries[g];
                def.is_static = g == 2;
                assert_int_equal(kdr_scene_set_triangles(scene, g, &def), KDR_OK);
            }
            kdr_scene_touch(scene, SOUP_GEOMETRIES);

            /* Cancel at the first call, the second, the fourth ... until the commit is done sooner. */
            kdr_status status = KDR_ERROR_CANCELLED;
            uint32_t cancelled = 0;
            for (uint32_t at = 1; status == KDR_ERROR_CANCELLED; at += 1 + at / 2) {
                listening l = {.cancel_at = at};
                kdr_scene_set_progress(scene, listen, &l);
                status = kdr_scene_commit(scene, &plan);
                assert_true(status == KDR_OK || status == KDR_ERROR_CANCELLED);
                assert_int_equal(status == KDR_OK, l.calls < at);
                if (status == KDR_OK)
                    break;
                assert_int_equal(l.calls, at);
                assert_true(kdr_scene_hash(scene) == hash);
                assert_int_equal(kdr_scene_verify(scene), KDR_OK);
                cancelled++;
            }
            assert_true(cancelled > 5);
            assert_true(kdr_scene_hash(scene) != hash);
            assert_int_equal(kdr_scene_verify(scene), KDR_OK);
            kdr_scene_destroy(scene);
            kdr_device_destroy(device);
        }
    }
    assert_true(failing_alloc_is_clean(&memory));
    soup_scene_destroy(&few);
    soup_scene_destroy(&many);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_commit_tells_how_far_it_is_never_less_than_before_and_all_at_the_end),
        cmocka_unit_test(who_listens_changes_no_tree),
        cmocka_unit_test(a_cancelled_commit_leaves_the_old_trees_and_loses_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
