/* A camera in somebody's hands stays the camera of that model: what it goes around stays where it was. */
#include "apps/kdray/view_camera.h"
#include "apps/kdray/view_clock.h"
#include "support/random.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

static kdr_camera start(void) { return (kdr_camera){{3, 4, 12}, {1, 1, 1}, {0, 1, 0}, 40}; }

static double distance(const float a[3], const float b[3]) {
    double sum = 0;
    for (int k = 0; k < 3; k++)
        sum += ((double)a[k] - (double)b[k]) * ((double)a[k] - (double)b[k]);
    return sqrt(sum);
}

static void assert_near(const float a[3], const float b[3], double most) { assert_true(distance(a, b) <= most); }

/* Where a point of the world is in the picture. */
static void see(const kdr_camera *camera, const float point[3], double seen[3]) {
    kdr_camera_frame frame;
    assert_true(kdr_camera_frame_make(camera, &frame));
    kdr_camera_frame_project(&frame, (double[3]){(double)point[0], (double)point[1], (double)point[2]}, seen);
}

static void an_orbit_keeps_the_target_and_the_distance_to_it(void **state) {
    (void)state;
    test_random random = test_random_start(test_random_seed(), 1);
    kdr_camera camera = start();
    const double away = distance(camera.eye, camera.target);
    for (int i = 0; i < 1000; i++) {
        double right = (double)test_random_between(&random, -1, 1), up = (double)test_random_between(&random, -1, 1);
        kdr_camera_orbit(&camera, right, up);
        assert_float_equal(distance(camera.eye, camera.target), away, 1e-3 * away);
        double seen[3];
        see(&camera, camera.target, seen);
        assert_true(fabs(seen[0]) < 1e-5 && fabs(seen[1]) < 1e-5);
    }
    assert_memory_equal(camera.target, start().target, sizeof camera.target);
    assert_memory_equal(camera.up, start().up, sizeof camera.up);
}

static void an_orbit_goes_right_and_up_and_back_again(void **state) {
    (void)state;
    kdr_camera camera = {{0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 40};
    const kdr_camera before = camera;
    kdr_camera_orbit(&camera, 1.57079632679489661923, 0);
    assert_near(camera.eye, (float[3]){5, 0, 0}, 1e-5);
    kdr_camera_orbit(&camera, -1.57079632679489661923, 0.5);
    assert_true(camera.eye[1] > 2 && fabsf(camera.eye[0]) < 1e-5f);
    kdr_camera_orbit(&camera, 0, -0.5);
    assert_near(camera.eye, before.eye, 1e-5);
}

static void no_orbit_goes_over_a_pole(void **state) {
    (void)state;
    for (int side = -1; side <= 1; side += 2) {
        kdr_camera camera = start();
        for (int i = 0; i < 100; i++)
            kdr_camera_orbit(&camera, 0.3, side * 0.4);
        kdr_camera_frame frame;
        assert_true(kdr_camera_frame_make(&camera, &frame));
        assert_true(side * (camera.eye[1] - camera.target[1]) > 0);
        kdr_camera_orbit(&camera, 0, -side * 1.0);
        assert_true(kdr_camera_frame_make(&camera, &frame));
    }
}

static void turning_the_head_keeps_the_eye(void **state) {
    (void)state;
    kdr_camera camera = {{0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 40};
    kdr_camera_turn(&camera, 0.3, 0.2);
    assert_near(camera.eye, (float[3]){0, 0, 5}, 0);
    assert_float_equal(distance(camera.eye, camera.target), 5, 1e-4);
    assert_true(camera.target[0] > 0 && camera.target[1] > 0);
}

static void what_is_panned_goes_with_the_hand(void **state) {
    (void)state;
    kdr_camera camera = start();
    const float point[3] = {1, 1, 1};
    double away = distance(camera.eye, camera.target), seen[3];
    kdr_camera_pan(&camera, 0.25, -0.125);
    // The picture is 2 high, and y goes upwards.
    see(&camera, point, seen);
    assert_float_equal(seen[0], 0.5, 1e-4);
    assert_float_equal(seen[1], -0.25, 1e-4);
    assert_float_equal(distance(camera.eye, camera.target), away, 1e-4);
}

static void a_zoom_changes_the_distance_alone_and_ends_before_the_target(void **state) {
    (void)state;
    kdr_camera camera = start();
    double away = distance(camera.eye, camera.target);
    kdr_camera_zoom(&camera, 0.5);
    assert_float_equal(distance(camera.eye, camera.target), 0.5 * away, 1e-4);
    kdr_camera_zoom(&camera, 2);
    assert_near(camera.eye, start().eye, 1e-5);
    for (int i = 0; i < 1000; i++)
        kdr_camera_zoom(&camera, 0.8);
    kdr_camera_frame frame;
    assert_true(kdr_camera_frame_make(&camera, &frame));
    for (int i = 0; i < 10; i++)
        kdr_camera_zoom(&camera, 2);
    assert_true(distance(camera.eye, camera.target) > 1e-3);
}

static void flying_moves_eye_and_target_alike(void **state) {
    (void)state;
    kdr_camera camera = {{0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 40};
    kdr_camera_fly(&camera, 0.5, 0.2, 0.1);
    assert_near(camera.eye, (float[3]){1, 0.5f, 2.5f}, 1e-5);
    assert_near(camera.target, (float[3]){1, 0.5f, -2.5f}, 1e-5);
}

static void a_camera_that_looks_nowhere_is_told_and_left_alone(void **state) {
    (void)state;
    const kdr_camera bad[] = {
        {{1, 1, 1}, {1, 1, 1}, {0, 1, 0}, 40},
        {{0, 5, 0}, {0, 0, 0}, {0, 1, 0}, 40},
        {{0, 0, 5}, {0, 0, 0}, {0, 0, 0}, 40},
        {{0, 0, INFINITY}, {0, 0, 0}, {0, 1, 0}, 40},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        kdr_camera_frame frame;
        assert_false(kdr_camera_frame_make(&bad[i], &frame));
        kdr_camera camera = bad[i];
        kdr_camera_fly(&camera, 1, 1, 1);
        kdr_camera_pan(&camera, 1, 1);
        assert_memory_equal(&camera, &bad[i], sizeof camera);
    }
}

/* ---- time */

static void what_plays_begins_anew_behind_its_end(void **state) {
    (void)state;
    kdr_view_clock clock = {.duration = 3, .rate = 10, .playing = true};
    for (int i = 0; i < 100; i++) {
        kdr_view_clock_advance(&clock, 0.25);
        assert_true(clock.time >= 0 && clock.time < 3);
    }
    assert_float_equal(clock.time, fmod(25, 3), 1e-9);
    clock.playing = false;
    double before = clock.time;
    kdr_view_clock_advance(&clock, 1);
    assert_true(clock.time == before);
}

static void what_stands_still_has_one_moment(void **state) {
    (void)state;
    kdr_view_clock clock = {.rate = 25, .playing = true};
    kdr_view_clock_advance(&clock, 1);
    kdr_view_clock_step(&clock, 5);
    kdr_view_clock_skip(&clock, 5);
    kdr_view_clock_seek(&clock, 1);
    assert_true(kdr_view_clock_moment(&clock) == 0 && kdr_view_clock_part(&clock) == 0);
}

static void steps_go_from_frame_to_frame(void **state) {
    (void)state;
    kdr_view_clock clock = {.duration = 2, .rate = 10, .playing = true, .time = 0.55};
    kdr_view_clock_step(&clock, 1);
    assert_false(clock.playing);
    assert_float_equal(clock.time, 0.6, 1e-9);
    for (int i = 1; i <= 3; i++)
        kdr_view_clock_step(&clock, 1);
    assert_float_equal(clock.time, 0.9, 1e-9);
    clock.time = 0.55;
    kdr_view_clock_step(&clock, -1);
    assert_float_equal(clock.time, 0.5, 1e-9);
    kdr_view_clock_step(&clock, -100);
    assert_true(clock.time == 0);
    kdr_view_clock_step(&clock, 1000);
    assert_true(clock.time == 2);
}

static void a_sequence_changes_with_its_frames_only(void **state) {
    (void)state;
    kdr_view_clock clock = {.duration = 1, .rate = 10, .by_frames = true};
    for (int frame = 0; frame < 10; frame++)
        for (int part = 0; part < 4; part++) {
            clock.time = (frame + part / 4.0) / 10;
            assert_float_equal(kdr_view_clock_moment(&clock), frame / 10.0, 1e-9);
        }
}

static void the_bar_leads_to_the_moment_that_it_shows(void **state) {
    (void)state;
    const double durations[] = {0.5, 3, INFINITY};
    for (int i = 0; i < 3; i++) {
        kdr_view_clock clock = {.duration = durations[i], .rate = 25, .time = i == 2 ? 123.4 : 0.2};
        double page = floor(clock.time / KDR_CLOCK_PAGE);
        for (int part = 0; part < 20; part++) {
            kdr_view_clock_seek(&clock, part / 20.0);
            assert_float_equal(kdr_view_clock_part(&clock), part / 20.0, 1e-9);
            assert_true(floor(clock.time / KDR_CLOCK_PAGE) == page);
        }
        kdr_view_clock_seek(&clock, 7);
        assert_true(kdr_view_clock_part(&clock) <= 1 && kdr_view_clock_part(&clock) > 0.99);
        kdr_view_clock_seek(&clock, -7);
        assert_true(kdr_view_clock_part(&clock) == 0);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_orbit_keeps_the_target_and_the_distance_to_it),
        cmocka_unit_test(an_orbit_goes_right_and_up_and_back_again),
        cmocka_unit_test(no_orbit_goes_over_a_pole),
        cmocka_unit_test(turning_the_head_keeps_the_eye),
        cmocka_unit_test(what_is_panned_goes_with_the_hand),
        cmocka_unit_test(a_zoom_changes_the_distance_alone_and_ends_before_the_target),
        cmocka_unit_test(flying_moves_eye_and_target_alike),
        cmocka_unit_test(a_camera_that_looks_nowhere_is_told_and_left_alone),
        cmocka_unit_test(what_plays_begins_anew_behind_its_end),
        cmocka_unit_test(what_stands_still_has_one_moment),
        cmocka_unit_test(steps_go_from_frame_to_frame),
        cmocka_unit_test(a_sequence_changes_with_its_frames_only),
        cmocka_unit_test(the_bar_leads_to_the_moment_that_it_shows),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
