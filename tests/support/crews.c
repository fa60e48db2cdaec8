#include "support/crews.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#define HOST_WORKERS 7

static void *start_at_once(kdr_task_fn *task, void *context, uint32_t count, void *user) {
    (void)user;
    for (uint32_t i = 0; i < count; i++)
        task(context, i);
    return NULL;
}

static void never_wait(void *handle, void *user) {
    (void)handle;
    (void)user;
    fail_msg("nothing was left to wait for");
}

static void *start_later(kdr_task_fn *task, void *context, uint32_t count, void *user) {
    test_crew *crew = user;
    crew->task = task;
    crew->context = context;
    crew->count = count;
    return crew;
}

static void wait_backwards(void *handle, void *user) {
    test_crew *crew = user;
    assert_ptr_equal(handle, crew);
    for (uint32_t i = crew->count; i-- > 0;)
        crew->task(crew->context, i);
}

void test_crew_open(test_crew *crew, int number) {
    static const uint32_t workers[] = {1, 2, 7};
    static const char *const names[TEST_CREW_COUNT] = {"1 thread", "2 threads", "7 threads", "host, at once",
                                                       "host, backwards"};
    *crew = (test_crew){.name = names[number]};
    kdr_alloc_init(&crew->alloc, NULL);
    if (number < 3) {
        crew->threads = kdr_thread_pool_create(&crew->alloc, workers[number]);
        assert_non_null(crew->threads);
        crew->crew = (kdr_crew){kdr_thread_pool_backend(crew->threads), workers[number]};
    } else if (number == 3) {
        crew->crew = (kdr_crew){{start_at_once, never_wait, crew}, HOST_WORKERS};
    } else {
        crew->crew = (kdr_crew){{start_later, wait_backwards, crew}, HOST_WORKERS};
    }
}

void test_crew_close(test_crew *crew) {
    kdr_thread_pool_destroy(crew->threads);
    assert_int_equal(atomic_load(&crew->alloc.bytes), 0);
}
