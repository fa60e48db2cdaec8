#include "base/alloc.h"
#include "support/crews.h"
#include "support/failing_alloc.h"
#include "support/random.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static const size_t sizes[] = {1,
                               15,
                               64,
                               100,
                               4096,
                               KDR_ALLOC_LARGE - 1,
                               KDR_ALLOC_LARGE,
                               KDR_ALLOC_LARGE + 1,
                               (size_t)2 << 20,
                               ((size_t)5 << 20) + 12345};
#define SIZE_COUNT (sizeof(sizes) / sizeof(*sizes))

static void memory_of_every_size_and_alignment_is_aligned_and_writable(void **state) {
    (void)state;
    kdr_alloc alloc;
    kdr_alloc_init(&alloc, NULL);
    for (size_t alignment = 1; alignment <= 4096; alignment *= 2) {
        for (size_t i = 0; i < SIZE_COUNT; i++) {
            unsigned char *memory = kdr_alloc_get(&alloc, sizes[i], alignment);
            assert_non_null(memory);
            assert_int_equal((uintptr_t)memory % alignment, 0);
            memory[0] = 1;
            memory[sizes[i] / 2] = 2;
            memory[sizes[i] - 1] = 3;
            kdr_alloc_release(&alloc, memory, sizes[i]);
        }
    }
    assert_int_equal(atomic_load(&alloc.bytes), 0);
}

static void bytes_are_those_held_and_the_peak_is_the_most_ever_held(void **state) {
    (void)state;
    kdr_alloc alloc;
    kdr_alloc_init(&alloc, NULL);
    assert_int_equal(atomic_load(&alloc.bytes), 0);
    assert_int_equal(atomic_load(&alloc.peak_bytes), 0);
    void *a = kdr_alloc_get(&alloc, 1000, 8);
    void *b = kdr_alloc_get(&alloc, 3 * KDR_ALLOC_LARGE, 64);
    assert_int_equal(atomic_load(&alloc.bytes), 1000 + 3 * KDR_ALLOC_LARGE);
    kdr_alloc_release(&alloc, b, 3 * KDR_ALLOC_LARGE);
    void *c = kdr_alloc_get(&alloc, 500, 8);
    assert_int_equal(atomic_load(&alloc.bytes), 1500);
    assert_int_equal(atomic_load(&alloc.peak_bytes), 1000 + 3 * KDR_ALLOC_LARGE);
    kdr_alloc_release(&alloc, a, 1000);
    kdr_alloc_release(&alloc, c, 500);
    assert_int_equal(atomic_load(&alloc.bytes), 0);
    assert_int_equal(atomic_load(&alloc.peak_bytes), 1000 + 3 * KDR_ALLOC_LARGE);
}

static void nothing_asked_for_is_nothing_given(void **state) {
    (void)state;
    kdr_alloc alloc;
    kdr_alloc_init(&alloc, NULL);
    assert_null(kdr_alloc_get(&alloc, 0, 8));
    assert_null(kdr_alloc_array(&alloc, 0, 100, 8));
    kdr_alloc_release(&alloc, NULL, 0);
    kdr_alloc_release(&alloc, NULL, 100);
    assert_int_equal(atomic_load(&alloc.bytes), 0);
}

static void sizes_that_no_machine_has_are_refused_and_not_counted(void **state) {
    (void)state;
    kdr_alloc alloc;
    kdr_alloc_init(&alloc, NULL);
    assert_null(kdr_alloc_get(&alloc, SIZE_MAX, 64));
    assert_null(kdr_alloc_get(&alloc, SIZE_MAX - 4096, 4096));
    assert_null(kdr_alloc_get(&alloc, SIZE_MAX / 2, 64));
    assert_null(kdr_alloc_array(&alloc, SIZE_MAX / 8 + 1, 8, 8));
    assert_null(kdr_alloc_array(&alloc, (size_t)1 << 33, (size_t)1 << 33, 8));
    assert_int_equal(atomic_load(&alloc.bytes), 0);
    assert_int_equal(atomic_load(&alloc.peak_bytes), 0);
}

/* Pages of the process that are in memory. */
static long resident_pages(void) {
    FILE *file = fopen("/proc/self/statm", "r");
    assert_non_null(file);
    long total = 0, resident = 0;
    assert_int_equal(fscanf(file, "%ld %ld", &total, &resident), 2);
    fclose(file);
    return resident;
}

static void large_upper_bounds_are_zero_pages_that_cost_nothing_until_touched(void **state) {
    (void)state;
    kdr_alloc alloc;
    kdr_alloc_init(&alloc, NULL);
    const size_t size = (size_t)8 << 30;
    long before = resident_pages();
    unsigned char *memory = kdr_alloc_get(&alloc, size, 64);
    assert_non_null(memory);
    assert_true(resident_pages() - before < 1024);
    for (size_t i = 0; i < 4; i++)
        assert_int_equal(memory[i * (size / 4) + 12345], 0);
    kdr_alloc_release(&alloc, memory, size);
}

static void arrays_are_counted_by_their_bytes(void **state) {
    (void)state;
    kdr_alloc alloc;
    kdr_alloc_init(&alloc, NULL);
    uint64_t *array = kdr_alloc_array(&alloc, 100, sizeof(uint64_t), _Alignof(uint64_t));
    assert_non_null(array);
    assert_int_equal(atomic_load(&alloc.bytes), 800);
    memset(array, 0, 800);
    kdr_alloc_release(&alloc, array, 800);
    assert_int_equal(atomic_load(&alloc.bytes), 0);
}

static void a_host_allocator_gets_every_request_and_its_own_sizes_back(void **state) {
    (void)state;
    failing_alloc failing;
    failing_alloc_init(&failing);
    kdr_allocator functions = failing_alloc_functions(&failing);
    kdr_alloc alloc;
    kdr_alloc_init(&alloc, &functions);
    void *small = kdr_alloc_get(&alloc, 10, 32);
    void *large = kdr_alloc_get(&alloc, 2 * KDR_ALLOC_LARGE, 4096);
    assert_int_equal(atomic_load(&failing.calls), 2);
    assert_int_equal(atomic_load(&failing.live_bytes), atomic_load(&alloc.bytes));
    assert_null(kdr_alloc_get(&alloc, 0, 8));
    assert_int_equal(atomic_load(&failing.calls), 2);
    kdr_alloc_release(&alloc, small, 10);
    kdr_alloc_release(&alloc, large, 2 * KDR_ALLOC_LARGE);
    assert_true(failing_alloc_is_clean(&failing));
    assert_int_equal(atomic_load(&alloc.bytes), 0);
}

static void an_allocator_without_functions_means_the_default(void **state) {
    (void)state;
    kdr_allocator none = {NULL, NULL, NULL};
    kdr_alloc alloc;
    kdr_alloc_init(&alloc, &none);
    assert_non_null(alloc.functions.allocate);
    void *memory = kdr_alloc_get(&alloc, 10, 8);
    assert_non_null(memory);
    kdr_alloc_release(&alloc, memory, 10);
}

static void a_failed_request_is_not_counted(void **state) {
    (void)state;
    failing_alloc failing;
    failing_alloc_init(&failing);
    kdr_allocator functions = failing_alloc_functions(&failing);
    kdr_alloc alloc;
    kdr_alloc_init(&alloc, &functions);
    failing_alloc_fail_nth(&failing, 1);
    assert_null(kdr_alloc_get(&alloc, 1000, 8));
    assert_int_equal(atomic_load(&alloc.bytes), 0);
    assert_int_equal(atomic_load(&alloc.peak_bytes), 0);
}

static void a_buffer_grows_keeps_and_is_unchanged_when_there_is_no_more(void **state) {
    (void)state;
    failing_alloc failing;
    failing_alloc_init(&failing);
    kdr_allocator functions = failing_alloc_functions(&failing);
    kdr_alloc alloc;
    kdr_alloc_init(&alloc, &functions);
    kdr_buffer buffer = {NULL, 0};

    assert_true(kdr_buffer_reserve(&alloc, &buffer, 0));
    assert_null(buffer.memory);
    assert_true(kdr_buffer_reserve(&alloc, &buffer, 1000));
    assert_true(buffer.capacity >= 1000);
    assert_int_equal((uintptr_t)buffer.memory % 64, 0);
    memset(buffer.memory, 7, buffer.capacity);

    kdr_buffer before = buffer;
    assert_true(kdr_buffer_reserve(&alloc, &buffer, 10));
    assert_ptr_equal(buffer.memory, before.memory);
    assert_int_equal(buffer.capacity, before.capacity);

    failing_alloc_fail_nth(&failing, 1);
    assert_false(kdr_buffer_reserve(&alloc, &buffer, 100000));
    assert_ptr_equal(buffer.memory, before.memory);
    assert_int_equal(buffer.capacity, before.capacity);
    assert_int_equal(*(unsigned char *)buffer.memory, 7);

    assert_true(kdr_buffer_reserve(&alloc, &buffer, 100000));
    assert_int_equal(atomic_load(&alloc.bytes), buffer.capacity);
    kdr_buffer_release(&alloc, &buffer);
    assert_null(buffer.memory);
    assert_int_equal(buffer.capacity, 0);
    kdr_buffer_release(&alloc, &buffer);
    assert_true(failing_alloc_is_clean(&failing));
}

#define CHURN_CALLS 14
#define CHURN_BLOCKS 200

typedef struct churn {
    kdr_alloc *alloc;
    uint64_t seed;
    _Atomic uint32_t bad;
} churn;

static void churn_call(void *context, uint32_t index) {
    churn *c = context;
    test_random random = test_random_start(c->seed, index);
    for (int i = 0; i < CHURN_BLOCKS; i++) {
        size_t size = 1 + test_random_below(&random, i % 20 == 0 ? 2 * KDR_ALLOC_LARGE : 5000);
        unsigned char *memory = kdr_alloc_get(c->alloc, size, 64);
        if (!memory) {
            atomic_fetch_add(&c->bad, 1);
            continue;
        }
        memory[0] = memory[size - 1] = (unsigned char)index;
        if (memory[0] != (unsigned char)index || atomic_load(&c->alloc->bytes) < size)
            atomic_fetch_add(&c->bad, 1);
        kdr_alloc_release(c->alloc, memory, size);
    }
}

static void counts_stay_exact_when_all_workers_allocate_at_once(void **state) {
    (void)state;
    for (int number = 0; number < TEST_CREW_COUNT; number++) {
        test_crew crew;
        test_crew_open(&crew, number);
        kdr_alloc alloc;
        kdr_alloc_init(&alloc, NULL);
        churn c = {.alloc = &alloc, .seed = test_random_seed()};
        kdr_crew_run(&crew.crew, churn_call, &c, CHURN_CALLS);
        assert_int_equal(atomic_load(&c.bad), 0);
        assert_int_equal(atomic_load(&alloc.bytes), 0);
        assert_true(atomic_load(&alloc.peak_bytes) > 5000);
        assert_true(atomic_load(&alloc.peak_bytes) <= CHURN_CALLS * 2 * KDR_ALLOC_LARGE);
        test_crew_close(&crew);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(memory_of_every_size_and_alignment_is_aligned_and_writable),
        cmocka_unit_test(bytes_are_those_held_and_the_peak_is_the_most_ever_held),
        cmocka_unit_test(nothing_asked_for_is_nothing_given),
        cmocka_unit_test(sizes_that_no_machine_has_are_refused_and_not_counted),
        cmocka_unit_test(large_upper_bounds_are_zero_pages_that_cost_nothing_until_touched),
        cmocka_unit_test(arrays_are_counted_by_their_bytes),
        cmocka_unit_test(a_host_allocator_gets_every_request_and_its_own_sizes_back),
        cmocka_unit_test(an_allocator_without_functions_means_the_default),
        cmocka_unit_test(a_failed_request_is_not_counted),
        cmocka_unit_test(a_buffer_grows_keeps_and_is_unchanged_when_there_is_no_more),
        cmocka_unit_test(counts_stay_exact_when_all_workers_allocate_at_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
