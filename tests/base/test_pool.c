#include "base/task.h"
#include "support/crews.h"
#include "support/failing_alloc.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <sched.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#define MOST_WORKERS 7

/* A number to halve until it is 1; the rest of the task's bytes are known, so that a torn copy shows. */
typedef struct halving {
    uint64_t size;
    uint64_t filling[KDR_TASK_BYTES / 8 - 1];
} halving;

_Static_assert(sizeof(halving) == KDR_TASK_BYTES, "a task is exactly as large as the pool's entries");

static halving make_halving(uint64_t size) {
    halving h = {.size = size};
    for (size_t i = 0; i < sizeof(h.filling) / sizeof(*h.filling); i++)
        h.filling[i] = size * 31 + i;
    return h;
}

static bool is_intact(const halving *h) {
    halving expected = make_halving(h->size);
    return memcmp(h, &expected, sizeof(expected)) == 0;
}

typedef struct halvings {
    _Atomic uint64_t ones; /* leaves reached */
    _Atomic uint64_t torn;
    _Atomic uint64_t offered; /* offers that were taken */
    _Atomic uint64_t refused;
    _Atomic uint32_t busy[MOST_WORKERS]; /* a worker's number must belong to one call at a time */
    _Atomic uint32_t shared;
    uint32_t worker_count;
    bool only_when_hungry;
} halvings;

static void halve(kdr_pool *pool, halvings *all, uint64_t size) {
    while (size > 1) {
        halving right = make_halving(size / 2);
        size -= size / 2;
        bool offer = !all->only_when_hungry || kdr_pool_hungry(pool);
        if (offer && kdr_pool_offer(pool, &right)) {
            atomic_fetch_add(&all->offered, 1);
        } else {
            atomic_fetch_add(&all->refused, 1);
            halve(pool, all, right.size);
        }
    }
    atomic_fetch_add(&all->ones, size);
}

static void run_halving(kdr_pool *pool, void *task, uint32_t worker, void *context) {
    halvings *all = context;
    halving h = *(halving *)task;
    if (!is_intact(&h))
        atomic_fetch_add(&all->torn, 1);
    if (worker >= all->worker_count || atomic_exchange(&all->busy[worker], 1) != 0)
        atomic_fetch_add(&all->shared, 1);
    memset(task, 0xEE, KDR_TASK_BYTES); // the copy is the worker's own
    halve(pool, all, h.size);
    if (worker < all->worker_count)
        atomic_store(&all->busy[worker], 0);
}

static void assert_halved(test_crew *crew, kdr_alloc *alloc, size_t count, uint64_t size, bool only_when_hungry) {
    halving tasks[600];
    assert_true(count <= 600);
    uint64_t total = 0;
    for (size_t i = 0; i < count; i++) {
        tasks[i] = make_halving(size + i);
        total += size + i;
    }
    halvings all = {.worker_count = crew->crew.worker_count, .only_when_hungry = only_when_hungry};
    assert_int_equal(kdr_pool_run(&crew->crew, alloc, tasks, count, run_halving, &all), KDR_OK);
    assert_int_equal(atomic_load(&all.ones), total);
    assert_int_equal(atomic_load(&all.torn), 0);
    assert_int_equal(atomic_load(&all.shared), 0);
    assert_int_equal(atomic_load(&all.offered) + atomic_load(&all.refused), total - count);
    for (size_t i = 0; i < count; i++)
        assert_true(is_intact(&tasks[i]));
    assert_int_equal(atomic_load(&alloc->bytes), 0);
}

static void all_tasks_and_all_that_they_offer_are_done(void **state) {
    (void)state;
    kdr_alloc alloc;
    kdr_alloc_init(&alloc, NULL);
    for (int number = 0; number < TEST_CREW_COUNT; number++) {
        test_crew crew;
        test_crew_open(&crew, number);
        for (int hungry = 0; hungry < 2; hungry++) {
            assert_halved(&crew, &alloc, 1, 1, hungry);
            assert_halved(&crew, &alloc, 1, 10000, hungry);
            assert_halved(&crew, &alloc, 3, 1000, hungry);
            assert_halved(&crew, &alloc, 600, 20, hungry);
        }
        test_crew_close(&crew);
    }
}

static void small_runs_in_a_row_end_every_time(void **state) {
    (void)state;
    kdr_alloc alloc;
    kdr_alloc_init(&alloc, NULL);
    for (int number = 0; number < 3; number++) {
        test_crew crew;
        test_crew_open(&crew, number);
        for (int i = 0; i < 300; i++)
            assert_halved(&crew, &alloc, 1 + (size_t)i % 3, 1 + (uint64_t)i % 50, i % 2);
        test_crew_close(&crew);
    }
}

static void no_task_at_all_is_done_at_once(void **state) {
    (void)state;
    failing_alloc failing;
    failing_alloc_init(&failing);
    failing_alloc_fail_from(&failing, 1);
    kdr_allocator functions = failing_alloc_functions(&failing);
    kdr_alloc alloc;
    kdr_alloc_init(&alloc, &functions);
    test_crew crew;
    test_crew_open(&crew, 2);
    assert_int_equal(kdr_pool_run(&crew.crew, &alloc, NULL, 0, run_halving, NULL), KDR_OK);
    test_crew_close(&crew);
}

static void without_memory_nothing_is_run_and_the_status_says_so(void **state) {
    (void)state;
    failing_alloc failing;
    failing_alloc_init(&failing);
    kdr_allocator functions = failing_alloc_functions(&failing);
    kdr_alloc alloc;
    kdr_alloc_init(&alloc, &functions);
    test_crew crew;
    test_crew_open(&crew, 2);
    halving task = make_halving(100);
    uint64_t needed = 0;
    for (uint64_t n = 1;; n++) {
        halvings all = {.worker_count = crew.crew.worker_count};
        failing_alloc_fail_nth(&failing, n);
        kdr_status status = kdr_pool_run(&crew.crew, &alloc, &task, 1, run_halving, &all);
        assert_true(failing_alloc_is_clean(&failing));
        if (atomic_load(&failing.failures) == 0) {
            assert_int_equal(status, KDR_OK);
            assert_int_equal(atomic_load(&all.ones), 100);
            break;
        }
        assert_int_equal(status, KDR_ERROR_OUT_OF_MEMORY);
        assert_int_equal(atomic_load(&all.ones), 0);
        needed = n;
    }
    assert_int_equal(needed, 1);
    test_crew_close(&crew);
}

typedef struct filling {
    uint32_t taken;
    bool root_done;
    _Atomic uint32_t others;
} filling;

static void fill_pool(kdr_pool *pool, void *task, uint32_t worker, void *context) {
    filling *f = context;
    (void)worker;
    if (((halving *)task)->size == 1) {
        atomic_fetch_add(&f->others, 1);
        return;
    }
    halving offer = make_halving(1);
    while (kdr_pool_offer(pool, &offer))
        f->taken++;
    f->root_done = !kdr_pool_offer(pool, &offer);
}

static void the_pool_takes_256_offers_and_then_refuses(void **state) {
    (void)state;
    kdr_alloc alloc;
    kdr_alloc_init(&alloc, NULL);
    kdr_crew alone = {.worker_count = 1};
    halving root = make_halving(2);
    filling f = {.taken = 0};
    assert_int_equal(kdr_pool_run(&alone, &alloc, &root, 1, fill_pool, &f), KDR_OK);
    assert_int_equal(f.taken, KDR_POOL_CAPACITY);
    assert_true(f.root_done);
    assert_int_equal(atomic_load(&f.others), KDR_POOL_CAPACITY);
}

typedef struct order {
    uint64_t seen[16];
    size_t count;
    bool hungry;
} order;

static void note_order(kdr_pool *pool, void *task, uint32_t worker, void *context) {
    order *o = context;
    assert_int_equal(worker, 0);
    uint64_t size = ((halving *)task)->size;
    o->seen[o->count++] = size;
    o->hungry = o->hungry || kdr_pool_hungry(pool);
    if (size < 100) {
        halving first = make_halving(size + 100), second = make_halving(size + 200);
        assert_true(kdr_pool_offer(pool, &first));
        assert_true(kdr_pool_offer(pool, &second));
    }
}

static void alone_a_worker_takes_given_tasks_in_order_then_the_newest_offer_and_is_never_hungry(void **state) {
    (void)state;
    kdr_alloc alloc;
    kdr_alloc_init(&alloc, NULL);
    kdr_crew alone = {.worker_count = 1};
    halving tasks[2] = {make_halving(1), make_halving(2)};
    order o = {.count = 0};
    assert_int_equal(kdr_pool_run(&alone, &alloc, tasks, 2, note_order, &o), KDR_OK);
    static const uint64_t expected[] = {1, 2, 202, 102, 201, 101};
    assert_int_equal(o.count, 6);
    assert_memory_equal(o.seen, expected, sizeof(expected));
    assert_false(o.hungry);
}

/* The root waits until others are idle, then offers: the offer must reach a sleeper. */
typedef struct waking {
    uint32_t sleep_microseconds;
    uint32_t root_worker;
    _Atomic uint32_t other_worker;
} waking;

static void wake_other(kdr_pool *pool, void *task, uint32_t worker, void *context) {
    waking *w = context;
    if (((halving *)task)->size == 1) {
        atomic_store(&w->other_worker, worker);
        return;
    }
    w->root_worker = worker;
    while (!kdr_pool_hungry(pool))
        sched_yield();
    usleep(w->sleep_microseconds);
    halving offer = make_halving(1);
    if (kdr_pool_offer(pool, &offer))
        while (atomic_load(&w->other_worker) == UINT32_MAX)
            sched_yield();
}

static void a_hungry_pool_has_a_worker_that_takes_the_offer_spinning_or_asleep(void **state) {
    (void)state;
    kdr_alloc alloc;
    kdr_alloc_init(&alloc, NULL);
    for (int number = 1; number < 3; number++) {
        test_crew crew;
        test_crew_open(&crew, number);
        for (uint32_t sleep = 0; sleep <= 3000; sleep += 1000) {
            waking w = {.sleep_microseconds = sleep, .other_worker = UINT32_MAX};
            halving root = make_halving(2);
            assert_int_equal(kdr_pool_run(&crew.crew, &alloc, &root, 1, wake_other, &w), KDR_OK);
            assert_int_not_equal(atomic_load(&w.other_worker), w.root_worker);
            assert_true(atomic_load(&w.other_worker) < crew.crew.worker_count);
        }
        test_crew_close(&crew);
    }
}

typedef struct aligned_check {
    _Atomic uint32_t misaligned;
} aligned_check;

static void check_alignment(kdr_pool *pool, void *task, uint32_t worker, void *context) {
    (void)pool, (void)worker;
    if ((uintptr_t)task % 64 != 0)
        atomic_fetch_add(&((aligned_check *)context)->misaligned, 1);
}

static void tasks_reach_their_worker_aligned_whatever_they_were_given_as(void **state) {
    (void)state;
    kdr_alloc alloc;
    kdr_alloc_init(&alloc, NULL);
    test_crew crew;
    test_crew_open(&crew, 2);
    char bytes[8 + 4 * KDR_TASK_BYTES] = {0};
    aligned_check c = {.misaligned = 0};
    assert_int_equal(kdr_pool_run(&crew.crew, &alloc, bytes + 1, 4, check_alignment, &c), KDR_OK);
    assert_int_equal(atomic_load(&c.misaligned), 0);
    test_crew_close(&crew);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_tasks_and_all_that_they_offer_are_done),
        cmocka_unit_test(small_runs_in_a_row_end_every_time),
        cmocka_unit_test(no_task_at_all_is_done_at_once),
        cmocka_unit_test(without_memory_nothing_is_run_and_the_status_says_so),
        cmocka_unit_test(the_pool_takes_256_offers_and_then_refuses),
        cmocka_unit_test(alone_a_worker_takes_given_tasks_in_order_then_the_newest_offer_and_is_never_hungry),
        cmocka_unit_test(a_hungry_pool_has_a_worker_that_takes_the_offer_spinning_or_asleep),
        cmocka_unit_test(tasks_reach_their_worker_aligned_whatever_they_were_given_as),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
