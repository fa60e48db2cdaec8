#include "kdray/render.h"
#include "mesh/mesh_memory.h"
#include "scenes/scenes.h"
#include "support/failing_alloc.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

typedef struct heard {
    int count;
    kdr_log_level level;
    char message[1024];
} heard;

static void hear(kdr_log_level level, const char *message, void *user) {
    heard *log = user;
    log->count++;
    log->level = level;
    snprintf(log->message, sizeof log->message, "%s", message);
}

static heard refuse(const char *name, size_t triangle_count, double time) {
    heard log = {0};
    kdr_logger logger = {hear, &log};
    kdr_mesh *mesh = (kdr_mesh *)&log;
    assert_int_equal(kdr_mesh_make(name, triangle_count, time, &logger, &mesh), KDR_ERROR_INVALID_ARGUMENT);
    assert_null(mesh);
    assert_int_equal(log.count, 1);
    assert_int_equal(log.level, KDR_LOG_ERROR);
    return log;
}

static void names_and_descriptions_end_together(void **state) {
    (void)state;
    size_t count = 0;
    for (; kdr_mesh_builtin_name(count); count++) {
        assert_non_null(kdr_mesh_builtin_text(count));
        assert_true(strlen(kdr_mesh_builtin_text(count)) >= 10);
        assert_null(strchr(kdr_mesh_builtin_text(count), '\n'));
        for (size_t i = 0; i < count; i++)
            assert_string_not_equal(kdr_mesh_builtin_name(i), kdr_mesh_builtin_name(count));
    }
    assert_true(count >= 19);
    assert_null(kdr_mesh_builtin_text(count));
    assert_null(kdr_mesh_builtin_name(SIZE_MAX));
}

static void an_unknown_name_is_answered_with_all_that_there_are(void **state) {
    (void)state;
    heard log = refuse("teapot", 0, 0);
    assert_non_null(strstr(log.message, "teapot"));
    for (size_t i = 0; kdr_mesh_builtin_name(i); i++)
        assert_non_null(strstr(log.message, kdr_mesh_builtin_name(i)));
    refuse("", 0, 0);
    refuse("Flake", 0, 0);
    refuse("flake ", 0, 0);
}

static void a_very_long_name_does_not_hide_the_list(void **state) {
    (void)state;
    char name[5000];
    memset(name, 'x', sizeof name - 1);
    name[sizeof name - 1] = '\0';
    heard log = refuse(name, 0, 0);
    assert_non_null(strstr(log.message, "crowd"));
}

static void a_size_out_of_range_is_answered_with_the_range(void **state) {
    (void)state;
    static const size_t sizes[] = {1, 99, 10000001, SIZE_MAX};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        heard log = refuse("city", sizes[i], 0);
        assert_non_null(strstr(log.message, "city"));
        assert_non_null(strstr(log.message, "100"));
        assert_non_null(strstr(log.message, "10000000"));
    }
}

static void a_time_that_is_no_number_is_refused(void **state) {
    (void)state;
    refuse("wave", 1000, NAN);
    refuse("wave", 1000, INFINITY);
    refuse("city", 1000, -INFINITY);
}

static void a_missing_name_or_place_is_refused(void **state) {
    (void)state;
    refuse(NULL, 1000, 0);
    assert_int_equal(kdr_mesh_make("city", 1000, 0, NULL, NULL), KDR_ERROR_INVALID_ARGUMENT);
}

/* Every allocation fails in turn: a clean status, one sentence, and not a byte left. */
static void running_out_of_memory_leaves_nothing_behind(void **state) {
    (void)state;
    failing_alloc failing;
    failing_alloc_init(&failing);
    kdr_allocator functions = failing_alloc_functions(&failing);
    kdr_mesh_memory_replace(&functions);
    for (size_t i = 0; kdr_mesh_builtin_name(i); i++) {
        kdr_status status = KDR_ERROR_OUT_OF_MEMORY;
        uint64_t nth = 1;
        for (; status != KDR_OK; nth++) {
            heard log = {0};
            kdr_logger logger = {hear, &log};
            kdr_mesh *mesh = NULL;
            failing_alloc_fail_nth(&failing, nth);
            status = kdr_mesh_make(kdr_mesh_builtin_name(i), 1000, 0.5, &logger, &mesh);
            if (status == KDR_OK) {
                assert_non_null(mesh);
                assert_int_equal(log.count, 0);
                kdr_mesh_destroy(mesh);
            } else {
                assert_int_equal(status, KDR_ERROR_OUT_OF_MEMORY);
                assert_null(mesh);
                assert_int_equal(log.count, 1);
                assert_non_null(strstr(log.message, "memory"));
            }
            assert_int_equal(kdr_render_bytes(), 0);
        }
        // A mesh is at least five blocks, so at least five were made to fail.
        assert_true(nth > 5);
    }
    assert_true(failing_alloc_is_clean(&failing));
    kdr_mesh_memory_replace(NULL);
}

static void the_bytes_of_a_mesh_are_counted_and_given_back(void **state) {
    (void)state;
    size_t before = kdr_render_bytes();
    kdr_mesh *mesh = NULL;
    assert_int_equal(kdr_mesh_make("soup", 100000, 0, NULL, &mesh), KDR_OK);
    // 36 bytes of positions, 12 of indices and 4 of materials a triangle.
    assert_in_range(kdr_render_bytes() - before, 5200000, 5300000);
    kdr_mesh_destroy(mesh);
    assert_int_equal(kdr_render_bytes(), before);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_and_descriptions_end_together),
        cmocka_unit_test(an_unknown_name_is_answered_with_all_that_there_are),
        cmocka_unit_test(a_very_long_name_does_not_hide_the_list),
        cmocka_unit_test(a_size_out_of_range_is_answered_with_the_range),
        cmocka_unit_test(a_time_that_is_no_number_is_refused),
        cmocka_unit_test(a_missing_name_or_place_is_refused),
        cmocka_unit_test(running_out_of_memory_leaves_nothing_behind),
        cmocka_unit_test(the_bytes_of_a_mesh_are_counted_and_given_back),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
