/* A doubly buffered scene: whoever asks while it is committed sees the old trees or the new ones, whole. */
#include "support/everywhere.h"
#include "support/soup.h"

#include <math.h>
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { RAYS = 192, ASKERS = 4, FRAMES = 300, STATES = 3 };

/* Frame i shows state i % STATES, in which all triangles stand elsewhere; geometry 0 is static in every other frame. */
typedef struct stage {
    kdr_device *device;
    kdr_scene *scene;
    soup_scene soups[STATES];
    kdr_ray rays[RAYS];
    kdr_ray_hit hits[STATES][RAYS]; /* what they meet in each state */
    uint8_t occluded[STATES][RAYS];
    uint64_t hashes[STATES][2];
    _Atomic bool done;
    _Atomic uint64_t asked;
} stage;

static void show(kdr_scene *scene, const soup_scene *soup, bool with_static) {
    for (uint32_t g = 0; g < SOUP_GEOMETRIES; g++) {
        kdr_triangles_def def = soup->geometries[g];
        def.is_static = with_static && g == 0;
        assert_int_equal(kdr_scene_set_triangles(scene, g, &def), KDR_OK);
    }
}

static kdr_scene *make_scene(kdr_device *device, const soup_scene *soup, bool double_buffered) {
    kdr_scene_def def = kdr_default_scene_def();
    def.double_buffered = double_buffered;
    kdr_scene *scene;
    assert_int_equal(kdr_scene_create_with(device, &def, &scene), KDR_OK);
    for (uint32_t g = 0; g < SOUP_GEOMETRIES; g++)
        assert_int_equal(kdr_scene_add_triangles(scene, &soup->geometries[g], NULL), KDR_OK);
    return scene;
}

static void answer(const kdr_scene *scene, const kdr_ray *rays, kdr_ray_hit *hits, uint8_t *occluded) {
    memset(hits, 0, RAYS * sizeof *hits);
    for (int i = 0; i < RAYS; i++)
        hits[i].ray = rays[i];
    kdr_intersect_n(scene, NULL, hits, RAYS);
    kdr_occluded_n(scene, NULL, rays, occluded, RAYS);
}

static stage *open_stage(uint64_t sequence, size_t triangles) {
    stage *s = test_allocate(1, sizeof *s);
    test_random random = test_random_start(test_random_seed(), sequence);
    assert_int_equal(kdr_device_create(NULL, &s->device), KDR_OK);
    for (int i = 0; i < RAYS; i++) {
        float *ray = &s->rays[i].origin_x;
        for (int k = 0; k < 3; k++) {
            ray[k] = k == 2 ? -4 : 0;
            ray[4 + k] = k == 2 ? 4 : test_random_between(&random, -1, 1);
        }
        s->rays[i].tmax = INFINITY;
    }
    for (int i = 0; i < STATES; i++)
        s->soups[i] = soup_scene_create_kind(&random, soup_kind_find("small"), triangles);
    kdr_scene *plain = make_scene(s->device, &s->soups[0], false);
    for (int i = 0; i < 2 * STATES; i++) {
        show(plain, &s->soups[i / 2], i % 2);
        assert_int_equal(kdr_scene_commit(plain, NULL), KDR_OK);
        answer(plain, s->rays, s->hits[i / 2], s->occluded[i / 2]);
        s->hashes[i / 2][i % 2] = kdr_scene_hash(plain);
    }
    kdr_scene_destroy(plain);
    for (int i = 1; i < STATES; i++)
        assert_memory_not_equal(s->hits[0], s->hits[i], sizeof s->hits[0]);
    s->scene = make_scene(s->device, &s->soups[0], true);
    return s;
}

static void close_stage(stage *s) {
    kdr_scene_destroy(s->scene);
    kdr_device_destroy(s->device);
    for (int i = 0; i < STATES; i++)
        soup_scene_destroy(&s->soups[i]);
    free(s);
}

/* The state that all answers are of; STATES if there is none. */
static int state_of(const stage *s, const kdr_ray_hit *hits) {
    int state = 0;
    while (state < STATES && memcmp(hits, s->hits[state], sizeof s->hits[state]) != 0)
        state++;
    return state;
}

static bool is_of_a_state(const stage *s, const uint8_t *occluded) {
    for (int state = 0; state < STATES; state++)
        if (memcmp(occluded, s->occluded[state], sizeof s->occluded[state]) == 0)
            return true;
    return false;
}

static bool is_known(const stage *s, uint64_t hash) {
    for (int i = 0; i < 2 * STATES; i++)
        if (s->hashes[i / 2][i % 2] == hash)
            return true;
    return false;
}

/* One of the threads that ask; returns how many answers were of no state, or of a mix. */
static void *ask_on(void *argument) {
    stage *s = argument;
    kdr_ray_hit *hits = test_allocate(RAYS, sizeof *hits);
    uint8_t occluded[RAYS];
    uintptr_t wrong = 0;
    while (!atomic_load(&s->done)) {
        answer(s->scene, s->rays, hits, occluded);
        wrong += state_of(s, hits) == STATES;
        wrong += !is_of_a_state(s, occluded);
        wrong += !is_known(s, kdr_scene_hash(s->scene));

        /* A lone ray's answer is that of some state. */
        kdr_ray_hit one = {.ray = s->rays[atomic_load(&s->asked) % RAYS]};
        size_t number = 0;
        while (memcmp(&s->rays[number], &one.ray, sizeof one.ray) != 0)
            number++;
        kdr_intersect1(s->scene, &one);
        bool found = false;
        for (int i = 0; i < STATES; i++)
            found |= memcmp(&one, &s->hits[i][number], sizeof one) == 0;
        wrong += !found;
        kdr_ray_hit4 four;
        for (uint32_t i = 0; i < 4; i++) {
            four.ray.origin_x[i] = one.ray.origin_x;
            four.ray.origin_y[i] = one.ray.origin_y;
            four.ray.origin_z[i] = one.ray.origin_z;
            four.ray.direction_x[i] = one.ray.direction_x;
            four.ray.direction_y[i] = one.ray.direction_y;
            four.ray.direction_z[i] = one.ray.direction_z;
            four.ray.tmin[i] = 0;
            four.ray.tmax[i] = INFINITY;
        }
        kdr_intersect4(s->scene, NULL, &four);
        for (uint32_t i = 1; i < 4; i++)
            wrong += four.hit.primitive[i] != four.hit.primitive[0] && four.hit.geometry[0] != KDR_INVALID_ID;
        atomic_fetch_add(&s->asked, 1);
    }
    free(hits);
    return (void *)wrong;
}

static void queries_during_commits_see_the_old_trees_or_the_new_never_a_mix(void **state) {
    (void)state;
    stage *s = open_stage(91, 400);
    show(s->scene, &s->soups[0], false);
    assert_int_equal(kdr_scene_commit(s->scene, NULL), KDR_OK);
    pthread_t askers[ASKERS];
    for (int i = 0; i < ASKERS; i++)
        assert_int_equal(pthread_create(&askers[i], NULL, ask_on, s), 0);
    for (int frame = 1; frame < FRAMES || atomic_load(&s->asked) < 20; frame++) {
        show(s->scene, &s->soups[frame % STATES], frame / STATES % 2);
        assert_int_equal(kdr_scene_commit(s->scene, NULL), KDR_OK);
    }
    atomic_store(&s->done, true);
    for (int i = 0; i < ASKERS; i++) {
        void *wrong;
        pthread_join(askers[i], &wrong);
        assert_int_equal((uintptr_t)wrong, 0);
    }
    close_stage(s);
}

/* A query that takes its time: it stands in a visit until it is let go. */
typedef struct slow {
    stage *s;
    _Atomic bool entered, may_go;
    pthread_t thread;
} slow;

static bool linger(const kdr_point_hit *hit, void *user) {
    (void)hit;
    slow *one = user;
    atomic_store(&one->entered, true);
    while (!atomic_load(&one->may_go))
        sched_yield();
    return false;
}

static void *ask_slowly(void *argument) {
    slow *one = argument;
    kdr_point_query query = {.radius = INFINITY};
    kdr_primitives_within(one->s->scene, &query, linger, one);
    return NULL;
}

static void *commit_once_more(void *argument) {
    stage *s = argument;
    show(s->scene, &s->soups[2], false);
    kdr_status status = kdr_scene_commit(s->scene, NULL);
    atomic_store(&s->done, true);
    return (void *)(uintptr_t)status;
}

static void a_commit_does_not_wait_for_slow_queries_but_the_next_one_does(void **state) {
    (void)state;
    stage *s = open_stage(92, 60);
    show(s->scene, &s->soups[0], false);
    assert_int_equal(kdr_scene_commit(s->scene, NULL), KDR_OK);
    slow one = {.s = s};
    assert_int_equal(pthread_create(&one.thread, NULL, ask_slowly, &one), 0);
    while (!atomic_load(&one.entered))
        sched_yield();

    /* The first commit is done while the query stands, and new queries see it. */
    show(s->scene, &s->soups[1], false);
    assert_int_equal(kdr_scene_commit(s->scene, NULL), KDR_OK);
    assert_true(kdr_scene_hash(s->scene) == s->hashes[1][0]);

    /* The second one needs the memory that the query reads. */
    pthread_t committing;
    assert_int_equal(pthread_create(&committing, NULL, commit_once_more, s), 0);
    for (int i = 0; i < 1000; i++) {
        assert_true(kdr_scene_hash(s->scene) == s->hashes[1][0]);
        sched_yield();
    }
    assert_false(atomic_load(&s->done));
    atomic_store(&one.may_go, true);
    void *status;
    pthread_join(committing, &status);
    pthread_join(one.thread, NULL);
    assert_int_equal((uintptr_t)status, KDR_OK);
    assert_true(kdr_scene_hash(s->scene) == s->hashes[2][0]);
    close_stage(s);
}

static bool cancel(uint64_t finished, uint64_t total, void *user) {
    (void)finished, (void)total, (void)user;
    return false;
}

static void commits_that_fail_or_are_cancelled_leave_what_is_shown(void **state) {
    (void)state;
    stage *s = open_stage(93, 100);
    show(s->scene, &s->soups[0], true);
    assert_int_equal(kdr_scene_commit(s->scene, NULL), KDR_OK);
    for (int i = 0; i < 4; i++) {
        show(s->scene, &s->soups[1], true);
        kdr_scene_set_progress(s->scene, cancel, NULL);
        assert_int_equal(kdr_scene_commit(s->scene, NULL), KDR_ERROR_CANCELLED);
        kdr_scene_set_progress(s->scene, NULL, NULL);
        kdr_triangles_def wrong = s->soups[1].geometries[0];
        wrong.vertex_count = 2;
        assert_int_equal(kdr_scene_set_triangles(s->scene, 0, &wrong), KDR_OK);
        assert_int_equal(kdr_scene_commit(s->scene, NULL), KDR_ERROR_INVALID_DATA);
        assert_true(kdr_scene_hash(s->scene) == s->hashes[0][1]);
        assert_int_equal(kdr_scene_verify(s->scene), KDR_OK);
    }
    show(s->scene, &s->soups[1], true);
    assert_int_equal(kdr_scene_commit(s->scene, NULL), KDR_OK);
    assert_true(kdr_scene_hash(s->scene) == s->hashes[1][1]);
    close_stage(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(queries_during_commits_see_the_old_trees_or_the_new_never_a_mix),
        cmocka_unit_test(a_commit_does_not_wait_for_slow_queries_but_the_next_one_does),
        cmocka_unit_test(commits_that_fail_or_are_cancelled_leave_what_is_shown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
