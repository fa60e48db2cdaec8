#include "base/task.h"
#include "support/crews.h"
#include "support/failing_alloc.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <errno.h>
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#define MOST_CALLS 1000
#define STARTS 2000

/* Threads that pthread_create still gives; negative: no limit. The linker leads calls here. */
static int threads_left = -1;

int __real_pthread_create(pthread_t *thread, const pthread_attr_t *attributes, void *(*start)(void *), void *argument);
int __wrap_pthread_create(pthread_t *thread, const pthread_attr_t *attributes, void *(*start)(void *), void *argument);

int __wrap_pthread_create(pthread_t *thread, const pthread_attr_t *attributes, void *(*start)(void *), void *argument) {
    if (threads_left == 0)
        return EAGAIN;
    if (threads_left > 0)
        threads_left--;
    return __real_pthread_create(thread, attributes, start, argument);
}

typedef struct tally {
    _Atomic uint32_t calls[MOST_CALLS];
    _Atomic uint32_t outside; /* calls with an index that was not asked for */
    uint32_t count;
} tally;

static void tally_call(void *context, uint32_t index) {
    tally *t = context;
    atomic_fetch_add(index < t->count ? &t->calls[index] : &t->outside, 1);
}

static void assert_each_called_once(const kdr_crew *crew, uint32_t count) {
    static tally t;
    memset(&t, 0, sizeof(t));
    t.count = count;
    kdr_crew_run(crew, tally_call, &t, count);
    assert_int_equal(atomic_load(&t.outside), 0);
    for (uint32_t i = 0; i < count; i++)
        assert_int_equal(atomic_load(&t.calls[i]), 1);
}

static void every_call_is_made_exactly_once(void **state) {
    (void)state;
    static const uint32_t counts[] = {0, 1, 2, 3, 7, 8, 100, MOST_CALLS};
    for (int number = 0; number < TEST_CREW_COUNT; number++) {
        test_crew crew;
        test_crew_open(&crew, number);
        for (size_t i = 0; i < sizeof(counts) / sizeof(*counts); i++)
            assert_each_called_once(&crew.crew, counts[i]);
        test_crew_close(&crew);
    }
}

/* What the calls of one start write must be seen by the starter, and what the starter writes by the next calls. */
typedef struct relay {
    uint64_t numbers[16];
    uint64_t round;
} relay;

static void relay_call(void *context, uint32_t index) {
    relay *r = context;
    r->numbers[index] += r->round;
}

static void starts_in_a_row_see_what_was_written_before(void **state) {
    (void)state;
    for (int number = 0; number < TEST_CREW_COUNT; number++) {
        test_crew crew;
        test_crew_open(&crew, number);
        relay r = {.round = 0};
        uint64_t expected = 0;
        for (int i = 0; i < STARTS; i++) {
            r.round++;
            expected += r.round;
            uint32_t count = 2 + (uint32_t)i % 15;
            memset(r.numbers, 0, sizeof(r.numbers));
            kdr_crew_run(&crew.crew, relay_call, &r, count);
            for (uint32_t j = 0; j < count; j++)
                assert_int_equal(r.numbers[j], r.round);
        }
        assert_int_equal(expected, (uint64_t)STARTS * (STARTS + 1) / 2);
        test_crew_close(&crew);
    }
}

static void threads_that_fell_asleep_wake_for_the_next_start(void **state) {
    (void)state;
    test_crew crew;
    test_crew_open(&crew, 2);
    for (int i = 0; i < 10; i++) {
        usleep(3000);
        assert_each_called_once(&crew.crew, 50);
    }
    test_crew_close(&crew);
}

/* Every call waits until all have begun: passes only if the calls run at once. */
typedef struct meeting {
    _Atomic uint32_t present;
    uint32_t expected;
} meeting;

static void meeting_call(void *context, uint32_t index) {
    meeting *m = context;
    (void)index;
    atomic_fetch_add(&m->present, 1);
    while (atomic_load(&m->present) < m->expected)
        sched_yield();
}

static void as_many_calls_as_workers_run_at_once(void **state) {
    (void)state;
    for (int number = 0; number < 3; number++) {
        test_crew crew;
        test_crew_open(&crew, number);
        for (int i = 0; i < 5; i++) {
            meeting m = {.expected = crew.crew.worker_count};
            kdr_crew_run(&crew.crew, meeting_call, &m, m.expected);
            assert_int_equal(atomic_load(&m.present), m.expected);
        }
        test_crew_close(&crew);
    }
}

static void slow_call(void *context, uint32_t index) {
    if (index != 0)
        usleep(5000);
    atomic_fetch_add((_Atomic uint32_t *)context, 1);
}

static void the_start_ends_after_its_slowest_call(void **state) {
    (void)state;
    test_crew crew;
    test_crew_open(&crew, 2);
    for (int i = 0; i < 5; i++) {
        _Atomic uint32_t done = 0;
        kdr_crew_run(&crew.crew, slow_call, &done, 7);
        assert_int_equal(atomic_load(&done), 7);
    }
    test_crew_close(&crew);
}

static void *refuse_start(kdr_task_fn *task, void *context, uint32_t count, void *user) {
    (void)task, (void)context, (void)count;
    atomic_fetch_add((_Atomic uint32_t *)user, 1);
    return NULL;
}

static void note_thread(void *context, uint32_t index) {
    (void)index;
    *(pthread_t *)context = pthread_self();
}

static void one_worker_or_one_call_needs_no_backend(void **state) {
    (void)state;
    _Atomic uint32_t starts = 0;
    kdr_crew one_worker = {{refuse_start, NULL, &starts}, 1};
    assert_each_called_once(&one_worker, 20);
    kdr_crew many_workers = {{refuse_start, NULL, &starts}, 7};
    pthread_t caller = pthread_self(), runner;
    memset(&runner, 0, sizeof(runner));
    kdr_crew_run(&many_workers, note_thread, &runner, 1);
    assert_true(pthread_equal(caller, runner));
    kdr_crew_run(&many_workers, note_thread, &runner, 0);
    kdr_crew no_backend = {{NULL, NULL, NULL}, 7};
    assert_each_called_once(&no_backend, 20);
    assert_int_equal(atomic_load(&starts), 0);
}

static void the_backend_answers_a_start_of_nothing(void **state) {
    (void)state;
    test_crew crew;
    test_crew_open(&crew, 2);
    static tally t;
    memset(&t, 0, sizeof(t));
    kdr_task_backend backend = crew.crew.backend;
    void *handle = backend.start(tally_call, &t, 0, backend.user);
    if (handle)
        backend.wait(handle, backend.user);
    assert_int_equal(atomic_load(&t.outside), 0);
    test_crew_close(&crew);
}

static void two_pools_work_side_by_side(void **state) {
    (void)state;
    test_crew first, second;
    test_crew_open(&first, 1);
    test_crew_open(&second, 2);
    static tally a, b;
    for (int i = 0; i < 50; i++) {
        memset(&a, 0, sizeof(a));
        memset(&b, 0, sizeof(b));
        a.count = b.count = 40;
        void *first_handle = first.crew.backend.start(tally_call, &a, 40, first.crew.backend.user);
        void *second_handle = second.crew.backend.start(tally_call, &b, 40, second.crew.backend.user);
        first.crew.backend.wait(first_handle, first.crew.backend.user);
        second.crew.backend.wait(second_handle, second.crew.backend.user);
        for (uint32_t j = 0; j < 40; j++)
            assert_true(atomic_load(&a.calls[j]) == 1 && atomic_load(&b.calls[j]) == 1);
    }
    test_crew_close(&first);
    test_crew_close(&second);
}

static void a_pool_without_memory_is_not_made(void **state) {
    (void)state;
    failing_alloc failing;
    failing_alloc_init(&failing);
    kdr_allocator functions = failing_alloc_functions(&failing);
    kdr_alloc alloc;
    kdr_alloc_init(&alloc, &functions);
    failing_alloc_fail_nth(&failing, 1);
    assert_null(kdr_thread_pool_create(&alloc, 7));
    assert_int_equal(atomic_load(&failing.failures), 1);
    kdr_thread_pool *pool = kdr_thread_pool_create(&alloc, 7);
    assert_non_null(pool);
    assert_int_equal(atomic_load(&failing.calls), 2);
    kdr_thread_pool_destroy(pool);
    kdr_thread_pool_destroy(NULL);
    assert_true(failing_alloc_is_clean(&failing));
}

static void with_some_of_its_threads_a_pool_still_makes_every_call(void **state) {
    (void)state;
    kdr_alloc alloc;
    kdr_alloc_init(&alloc, NULL);
    for (int given = 1; given <= 6; given++) {
        threads_left = given;
        kdr_thread_pool *pool = kdr_thread_pool_create(&alloc, 7);
        threads_left = -1;
        assert_non_null(pool);
        kdr_crew crew = {kdr_thread_pool_backend(pool), 7};
        assert_each_called_once(&crew, 100);
        meeting m = {.expected = (uint32_t)given + 1};
        kdr_crew_run(&crew, meeting_call, &m, 7);
        assert_int_equal(atomic_load(&m.present), 7);
        kdr_thread_pool_destroy(pool);
    }
    assert_int_equal(atomic_load(&alloc.bytes), 0);
}

static void without_any_thread_a_pool_of_several_workers_is_not_made(void **state) {
    (void)state;
    kdr_alloc alloc;
    kdr_alloc_init(&alloc, NULL);
    threads_left = 0;
    assert_null(kdr_thread_pool_create(&alloc, 2));
    kdr_thread_pool *pool = kdr_thread_pool_create(&alloc, 1);
    threads_left = -1;
    assert_non_null(pool);
    kdr_thread_pool_destroy(pool);
    assert_int_equal(atomic_load(&alloc.bytes), 0);
}

/* Workers sleep in the crew while a signal comes: only threads of the host may see it. */
static volatile sig_atomic_t signals;
static pthread_t signalled;

static void on_signal(int number) {
    (void)number;
    signalled = pthread_self();
    signals++;
}

static void signals_stay_with_the_threads_of_the_host(void **state) {
    (void)state;
    sigset_t before, after;
    pthread_sigmask(SIG_SETMASK, NULL, &before);
    test_crew crew;
    test_crew_open(&crew, 2);
    pthread_sigmask(SIG_SETMASK, NULL, &after);
    for (int number = 1; number < 32; number++)
        assert_int_equal(sigismember(&before, number), sigismember(&after, number));

    // A signal to the process that this thread does not take now would go to any worker that does.
    struct sigaction action = {.sa_handler = on_signal}, old;
    sigaction(SIGUSR1, &action, &old);
    sigset_t blocked, pending;
    sigemptyset(&blocked);
    sigaddset(&blocked, SIGUSR1);
    pthread_sigmask(SIG_BLOCK, &blocked, NULL);
    kill(getpid(), SIGUSR1);
    usleep(5000);
    assert_int_equal(signals, 0);
    assert_int_equal(sigpending(&pending), 0);
    assert_int_equal(sigismember(&pending, SIGUSR1), 1);

    pthread_sigmask(SIG_SETMASK, &before, NULL);
    for (int i = 0; i < 1000 && signals == 0; i++)
        usleep(1000);
    assert_int_equal(signals, 1);
    assert_true(pthread_equal(signalled, pthread_self()));
    sigaction(SIGUSR1, &old, NULL);
    test_crew_close(&crew);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_call_is_made_exactly_once),
        cmocka_unit_test(starts_in_a_row_see_what_was_written_before),
        cmocka_unit_test(threads_that_fell_asleep_wake_for_the_next_start),
        cmocka_unit_test(as_many_calls_as_workers_run_at_once),
        cmocka_unit_test(the_start_ends_after_its_slowest_call),
        cmocka_unit_test(one_worker_or_one_call_needs_no_backend),
        cmocka_unit_test(the_backend_answers_a_start_of_nothing),
        cmocka_unit_test(two_pools_work_side_by_side),
        cmocka_unit_test(a_pool_without_memory_is_not_made),
        cmocka_unit_test(with_some_of_its_threads_a_pool_still_makes_every_call),
        cmocka_unit_test(without_any_thread_a_pool_of_several_workers_is_not_made),
        cmocka_unit_test(signals_stay_with_the_threads_of_the_host),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
