#include "base/primitives.h"
#include "kdray/openmp.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>
#include <omp.h>

#define MOST_CALLS 1000

typedef struct tally {
    _Atomic uint32_t calls[MOST_CALLS];
    _Atomic uint32_t most_threads;
} tally;

static void tally_call(void *context, uint32_t index) {
    tally *t = context;
    atomic_fetch_add(&t->calls[index], 1);
    uint32_t threads = (uint32_t)omp_get_num_threads(), most = atomic_load(&t->most_threads);
    while (most < threads && !atomic_compare_exchange_weak(&t->most_threads, &most, threads)) {
    }
}

static uint32_t assert_each_called_once(const kdr_crew *crew, uint32_t count) {
    static tally t;
    memset(&t, 0, sizeof(t));
    kdr_crew_run(crew, tally_call, &t, count);
    for (uint32_t i = 0; i < MOST_CALLS; i++)
        assert_int_equal(atomic_load(&t.calls[i]), i < count);
    return atomic_load(&t.most_threads);
}

static void every_call_is_made_once_on_at_most_the_threads_asked_for(void **state) {
    (void)state;
    static const uint32_t workers[] = {1, 2, 7};
    static const uint32_t counts[] = {0, 1, 2, 7, 8, 100, MOST_CALLS};
    for (size_t w = 0; w < 3; w++) {
        kdr_crew crew = {kdr_openmp_backend(workers[w]), workers[w]};
        for (size_t c = 0; c < sizeof(counts) / sizeof(*counts); c++)
            assert_true(assert_each_called_once(&crew, counts[c]) <= workers[w]);
    }
}

static void no_number_means_what_openmp_would_take(void **state) {
    (void)state;
    int before = omp_get_max_threads();
    omp_set_num_threads(3);
    kdr_crew crew = {kdr_openmp_backend(0), 7};
    assert_int_equal(assert_each_called_once(&crew, 100), 3);
    omp_set_num_threads(before);
}

static void both_functions_are_there_and_nothing_is_left_to_wait_for(void **state) {
    (void)state;
    static tally t;
    memset(&t, 0, sizeof(t));
    kdr_task_backend backend = kdr_openmp_backend(2);
    assert_non_null(backend.start);
    assert_non_null(backend.wait);
    assert_null(backend.start(tally_call, &t, 10, backend.user));
    for (uint32_t i = 0; i < 10; i++)
        assert_int_equal(atomic_load(&t.calls[i]), 1);
}

static void inside_a_region_of_the_host_all_calls_are_still_made(void **state) {
    (void)state;
    static tally tallies[2];
    memset(tallies, 0, sizeof(tallies));
#pragma omp parallel num_threads(2)
    {
        kdr_crew crew = {kdr_openmp_backend(7), 7};
#pragma omp for
        for (int i = 0; i < 2; i++)
            kdr_crew_run(&crew, tally_call, &tallies[i], 100);
    }
    for (int i = 0; i < 2; i++)
        for (uint32_t j = 0; j < 100; j++)
            assert_int_equal(atomic_load(&tallies[i].calls[j]), 1);
}

/* A task is a number; it offers both halves until they are 1. */
static void halve(kdr_pool *pool, void *task, uint32_t worker, void *context) {
    uint64_t size;
    (void)worker;
    memcpy(&size, task, sizeof(size));
    while (size > 1) {
        uint64_t half[KDR_TASK_BYTES / 8] = {size / 2};
        size -= half[0];
        if (!kdr_pool_offer(pool, half))
            halve(pool, half, worker, context);
    }
    atomic_fetch_add((_Atomic uint64_t *)context, size);
}

static void the_task_pool_ends_on_openmp_also_where_regions_get_one_thread(void **state) {
    (void)state;
    kdr_alloc alloc;
    kdr_alloc_init(&alloc, NULL);
    int levels = omp_get_max_active_levels();
    for (int active = 0; active < 2; active++) {
        omp_set_max_active_levels(active);
        for (uint32_t workers = 1; workers <= 7; workers++) {
            kdr_crew crew = {kdr_openmp_backend(workers), workers};
            uint64_t task[KDR_TASK_BYTES / 8] = {5000};
            _Atomic uint64_t ones = 0;
            assert_int_equal(kdr_pool_run(&crew, &alloc, task, 1, halve, &ones), KDR_OK);
            assert_int_equal(atomic_load(&ones), 5000);
        }
    }
    omp_set_max_active_levels(levels);
}

static void primitives_give_the_same_on_openmp(void **state) {
    (void)state;
    enum { COUNT = 50000 };
    static kdr_pair pairs[COUNT];
    kdr_alloc alloc;
    kdr_alloc_init(&alloc, NULL);
    kdr_crew crew = {kdr_openmp_backend(7), 7};
    kdr_buffer scratch = {NULL, 0};
    for (uint32_t i = 0; i < COUNT; i++)
        pairs[i] = (kdr_pair){i * 2654435761u % 1000, i};
    assert_int_equal(kdr_parallel_sort(&crew, &alloc, &scratch, pairs, COUNT), KDR_OK);
    for (uint32_t i = 1; i < COUNT; i++)
        assert_true(pairs[i - 1].key < pairs[i].key ||
                    (pairs[i - 1].key == pairs[i].key && pairs[i - 1].value < pairs[i].value));
    kdr_buffer_release(&alloc, &scratch);
    assert_int_equal(atomic_load(&alloc.bytes), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_call_is_made_once_on_at_most_the_threads_asked_for),
        cmocka_unit_test(no_number_means_what_openmp_would_take),
        cmocka_unit_test(both_functions_are_there_and_nothing_is_left_to_wait_for),
        cmocka_unit_test(inside_a_region_of_the_host_all_calls_are_still_made),
        cmocka_unit_test(the_task_pool_ends_on_openmp_also_where_regions_get_one_thread),
        cmocka_unit_test(primitives_give_the_same_on_openmp),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
