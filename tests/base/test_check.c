#include "base/check.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

/* Runs fn in a child; returns its wait status and what it wrote to stderr. */
static int run_in_child(void (*fn)(void), char *said, size_t size) {
    int ends[2];
    assert_int_equal(pipe(ends), 0);
    fflush(NULL);
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        dup2(ends[1], STDERR_FILENO);
        signal(SIGABRT, SIG_DFL);
        fn();
        _exit(0);
    }
    close(ends[1]);
    size_t length = 0;
    ssize_t got;
    while (length + 1 < size && (got = read(ends[0], said + length, size - 1 - length)) > 0)
        length += (size_t)got;
    said[length] = '\0';
    close(ends[0]);
    int status;
    assert_int_equal(waitpid(child, &status, 0), child);
    return status;
}

static void fail_by_name(void) { kdr_check_failed("1 == 2", "some/file.c", 42); }

static void a_failed_check_says_where_and_what_and_aborts(void **state) {
    (void)state;
    char said[512];
    int status = run_in_child(fail_by_name, said, sizeof(said));
    assert_true(WIFSIGNALED(status));
    assert_int_equal(WTERMSIG(status), SIGABRT);
    assert_non_null(strstr(said, "some/file.c:42"));
    assert_non_null(strstr(said, "1 == 2"));
}

static int evaluations;
static bool evaluate(bool result) {
    evaluations++;
    return result;
}

static void fail_by_condition(void) { KDR_CHECK(evaluate(false)); }

static void checks_are_made_in_debug_builds_and_cost_nothing_in_release(void **state) {
    (void)state;
    char said[512];
    evaluations = 0;
    KDR_CHECK(evaluate(true));
    int status = run_in_child(fail_by_condition, said, sizeof(said));
#ifdef NDEBUG
    assert_int_equal(evaluations, 0);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 0);
#else
    assert_int_equal(evaluations, 1);
    assert_true(WIFSIGNALED(status) && WTERMSIG(status) == SIGABRT);
    assert_non_null(strstr(said, "evaluate(false)"));
#endif
}

static void products_that_do_not_fit_are_refused_and_leave_the_result_alone(void **state) {
    (void)state;
    size_t out = 5;
    assert_true(kdr_size_mul(SIZE_MAX, 1, &out) && out == SIZE_MAX);
    assert_true(kdr_size_mul(SIZE_MAX, 0, &out) && out == 0);
    assert_true(kdr_size_mul((size_t)1 << 32, ((size_t)1 << 32) - 1, &out));
    out = 5;
    assert_false(kdr_size_mul((size_t)1 << 32, (size_t)1 << 32, &out));
    assert_int_equal(out, 5);
    assert_false(kdr_size_mul(SIZE_MAX, 2, &out));
    assert_int_equal(out, 5);
}

static void sums_that_do_not_fit_are_refused_and_leave_the_result_alone(void **state) {
    (void)state;
    size_t out = 5;
    assert_true(kdr_size_add(SIZE_MAX - 1, 1, &out) && out == SIZE_MAX);
    out = 5;
    assert_false(kdr_size_add(SIZE_MAX, 1, &out));
    assert_int_equal(out, 5);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_failed_check_says_where_and_what_and_aborts),
        cmocka_unit_test(checks_are_made_in_debug_builds_and_cost_nothing_in_release),
        cmocka_unit_test(products_that_do_not_fit_are_refused_and_leave_the_result_alone),
        cmocka_unit_test(sums_that_do_not_fit_are_refused_and_leave_the_result_alone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
