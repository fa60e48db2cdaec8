/* Frames after the first few: neither a commit nor a ray takes no memory from anybody, and touches no page that was not
 * there. */
#include "support/everywhere.h"
#include "support/failing_alloc.h"
#include "support/soup.h"
#include "support/test_size.h"

#include <setjmp.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <sys/resource.h>

#include <cmocka.h>

#define TRIANGLES TEST_SIZE(12000)
#define RAYS 100

static void ball_bounds(uint32_t i, float lo[3], float hi[3], void *user) {
    const float *moved = user;
    for (int k = 0; k < 3; k++) {
        lo[k] = (float)(i * (7u + (uint32_t)k) % 101) + *moved;
        hi[k] = lo[k] + 1;
    }
}

static bool ball_intersect(const kdr_ray *ray, uint32_t i, kdr_custom_hit *hit, void *user) {
    (void)ray, (void)i, (void)hit, (void)user;
    return false;
}

/* All that a scene may have: dynamic and static triangles, custom primitives, instances. */
typedef struct frames {
    failing_alloc memory;
    kdr_device *device;
    kdr_scene *shown, *scene;
    soup_scene soup;
    float moved, transforms[50][12];
} frames;

static void open_frames(frames *f, uint32_t workers, bool own_memory, bool double_buffered) {
    failing_alloc_init(&f->memory);
    test_random random = test_random_start(test_random_seed(), 60);
    f->soup = soup_scene_create_kind(&random, soup_kind_find("small"), TRIANGLES);
    kdr_device_def def = kdr_default_device_def();
    def.worker_count = workers;
    if (!own_memory)
        def.allocator = failing_alloc_functions(&f->memory);
    assert_int_equal(kdr_device_create(&def, &f->device), KDR_OK);
    f->shown = committed_scene(f->device, f->soup.geometries, 1, NULL);
    kdr_scene_def scene_def = kdr_default_scene_def();
    scene_def.double_buffered = double_buffered;
    assert_int_equal(kdr_scene_create_with(f->device, &scene_def, &f->scene), KDR_OK);
    for (uint32_t g = 0; g < SOUP_GEOMETRIES; g++) {
        kdr_triangles_def triangles = f->soup.geometries[g];
        triangles.is_static = g == 3;
        assert_int_equal(kdr_scene_add_triangles(f->scene, &triangles, NULL), KDR_OK);
    }
    f->moved = 0;
    kdr_custom_def custom = kdr_default_custom_def();
    custom.primitive_count = 3000;
    custom.user = &f->moved;
    custom.bounds = ball_bounds;
    custom.intersect = ball_intersect;
    assert_int_equal(kdr_scene_add_custom(f->scene, &custom, NULL), KDR_OK);
    kdr_instance_def instance = kdr_default_instance_def();
    instance.scene = f->shown;
    instance.transforms = &f->transforms[0][0];
    instance.count = 50;
    for (uint32_t i = 0; i < 50; i++)
        for (uint32_t k = 0; k < 12; k++)
            f->transforms[i][k] = k % 5 == 0 ? 1 : k % 4 == 3 ? (float)i : 0;
    assert_int_equal(kdr_scene_add_instance(f->scene, &instance, NULL), KDR_OK);
}

static void close_frames(frames *f) {
    kdr_scene_destroy(f->scene);
    kdr_scene_destroy(f->shown);
    kdr_device_destroy(f->device);
    soup_scene_destroy(&f->soup);
    assert_true(failing_alloc_is_clean(&f->memory));
}

/* One frame: everything that is not static is built anew. */
static void commit_frame(frames *f, const kdr_build_def *plan) {
    for (uint32_t g = 0; g < SOUP_GEOMETRIES + 2; g++)
        if (g != 3)
            assert_int_equal(kdr_scene_touch(f->scene, g), KDR_OK);
    assert_int_equal(kdr_scene_commit(f->scene, plan), KDR_OK);

    /* A lazy tree is opened by rays. */
    test_random random = test_random_start(1, 61);
    for (int i = 0; i < RAYS; i++) {
        kdr_ray_hit hit = {.ray = {.tmax = INFINITY}};
        for (int k = 0; k < 3; k++) {
            (&hit.ray.origin_x)[k] = test_random_between(&random, -1, 1);
            (&hit.ray.direction_x)[k] = test_random_between(&random, -1, 1);
        }
        kdr_intersect1(f->scene, &hit);
    }
}

static const char *const plans[] = {"",
                                    "quality=fast",
                                    "quality=best",
                                    "quality=lazy lazy-limit=64",
                                    "quality=lazy straddle=clip",
                                    "order=bfs",
                                    "split=sweep events=3",
                                    "split=space share=grid/8",
                                    "split=object share=cluster/4 order=bfs",
                                    "trace=backtrack nodes=structures",
                                    "trace=stack nodes=arrays test=projection"};

static void a_commit_of_a_frame_like_the_last_ones_calls_no_allocator(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof plans / sizeof *plans; i++) {
        for (int double_buffered = 0; double_buffered < 2; double_buffered++) {
            frames f;
            kdr_build_def plan;
            assert_int_equal(kdr_build_def_parse(plans[i], &plan, NULL, 0), KDR_OK);
            open_frames(&f, 1, false, double_buffered);
            for (int frame = 0; frame < 3; frame++)
                commit_frame(&f, &plan);
            uint64_t calls = f.memory.calls;
            size_t bytes = kdr_device_bytes(f.device);
            for (int frame = 0; frame < 5; frame++)
                commit_frame(&f, &plan);
            assert_int_equal(f.memory.calls, calls);
            assert_int_equal(kdr_device_bytes(f.device), bytes);
            close_frames(&f);
        }
    }
}

/* With several workers it is a matter of chance how many blocks are in use at once; the most there ever are is soon
 * reached. */
static void with_several_workers_frames_soon_call_no_allocator(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof plans / sizeof *plans; i++) {
        frames f;
        kdr_build_def plan;
        assert_int_equal(kdr_build_def_parse(plans[i], &plan, NULL, 0), KDR_OK);
        open_frames(&f, 3, false, false);
        int quiet = 0;
        for (int frame = 0; frame < 400 && quiet < 10; frame++) {
            uint64_t calls = f.memory.calls;
            commit_frame(&f, &plan);
            quiet = f.memory.calls == calls ? quiet + 1 : 0;
        }
        assert_int_equal(quiet, 10);
        close_frames(&f);
    }
}

#ifndef TEST_SLOW /* sanitizers have pages of their own */
static long page_faults(void) {
    struct rusage usage;
    assert_int_equal(getrusage(RUSAGE_SELF, &usage), 0);
    return usage.ru_minflt + usage.ru_majflt;
}

static void a_commit_of_a_frame_like_the_last_ones_faults_no_page(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof plans / sizeof *plans; i++) {
        frames f;
        kdr_build_def plan;
        assert_int_equal(kdr_build_def_parse(plans[i], &plan, NULL, 0), KDR_OK);
        open_frames(&f, 1, true, false);
        commit_frame(&f, &plan);
        long first = page_faults(), quiet = 0;
        for (int frame = 0; frame < 100 && quiet < 5; frame++) {
            long faults = page_faults();
            commit_frame(&f, &plan);
            quiet = page_faults() == faults ? quiet + 1 : 0;
        }
        assert_true(first > 0);
        assert_int_equal(quiet, 5);
        close_frames(&f);
    }
}
#endif

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_commit_of_a_frame_like_the_last_ones_calls_no_allocator),
        cmocka_unit_test(with_several_workers_frames_soon_call_no_allocator),
#ifndef TEST_SLOW
        cmocka_unit_test(a_commit_of_a_frame_like_the_last_ones_faults_no_page),
#endif
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
