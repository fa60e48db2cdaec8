#include "support/failing_alloc.h"
#include "support/random.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static void the_nth_allocation_fails_and_no_other(void **state) {
    (void)state;
    failing_alloc failing;
    failing_alloc_init(&failing);
    kdr_allocator functions = failing_alloc_functions(&failing);
    for (uint64_t n = 0; n <= 5; n++) {
        failing_alloc_fail_nth(&failing, n);
        for (uint64_t call = 1; call <= 5; call++) {
            void *memory = functions.allocate(10, 8, functions.user);
            assert_int_equal(memory == NULL, call == n);
            functions.release(memory, 10, functions.user);
        }
        assert_int_equal(atomic_load(&failing.calls), 5);
        assert_int_equal(atomic_load(&failing.failures), n > 0);
    }
    assert_true(failing_alloc_is_clean(&failing));
}

static void from_the_nth_on_every_allocation_fails(void **state) {
    (void)state;
    failing_alloc failing;
    failing_alloc_init(&failing);
    kdr_allocator functions = failing_alloc_functions(&failing);
    failing_alloc_fail_from(&failing, 3);
    for (uint64_t call = 1; call <= 5; call++) {
        void *memory = functions.allocate(10, 8, functions.user);
        assert_int_equal(memory == NULL, call >= 3);
        functions.release(memory, 10, functions.user);
    }
    assert_int_equal(atomic_load(&failing.failures), 3);
    failing_alloc_fail_nth(&failing, 0);
    void *memory = functions.allocate(10, 8, functions.user);
    assert_non_null(memory);
    functions.release(memory, 10, functions.user);
}

static void leaks_and_wrong_sizes_are_seen(void **state) {
    (void)state;
    failing_alloc failing;
    failing_alloc_init(&failing);
    kdr_allocator functions = failing_alloc_functions(&failing);
    void *memory = functions.allocate(100, 64, functions.user);
    assert_int_equal(atomic_load(&failing.live_blocks), 1);
    assert_int_equal(atomic_load(&failing.live_bytes), 100);
    assert_false(failing_alloc_is_clean(&failing));
    functions.release(memory, 99, functions.user);
    assert_int_equal(atomic_load(&failing.live_blocks), 0);
    assert_int_equal(atomic_load(&failing.bad_releases), 1);
    assert_false(failing_alloc_is_clean(&failing));
}

static void blocks_are_aligned_and_never_zero(void **state) {
    (void)state;
    failing_alloc failing;
    failing_alloc_init(&failing);
    kdr_allocator functions = failing_alloc_functions(&failing);
    for (size_t alignment = 1; alignment <= 4096; alignment *= 2) {
        unsigned char *memory = functions.allocate(1000, alignment, functions.user);
        assert_non_null(memory);
        assert_int_equal((uintptr_t)memory % alignment, 0);
        for (int i = 0; i < 1000; i++)
            assert_int_not_equal(memory[i], 0);
        functions.release(memory, 1000, functions.user);
    }
    assert_null(functions.allocate(SIZE_MAX, 64, functions.user));
    assert_true(failing_alloc_is_clean(&failing));
}

static void a_seed_gives_the_same_numbers_again_and_sequences_differ(void **state) {
    (void)state;
    test_random a = test_random_start(1, 2), b = test_random_start(1, 2), c = test_random_start(1, 3);
    int equal = 0;
    for (int i = 0; i < 1000; i++) {
        uint32_t number = test_random_u32(&a);
        assert_int_equal(number, test_random_u32(&b));
        equal += number == test_random_u32(&c);
    }
    assert_true(equal < 10);
}

/* The published output of the generator for state 42 and sequence 54. */
static void the_generator_is_the_published_one(void **state) {
    (void)state;
    static const uint32_t published[] = {0xa15c02b7, 0x7b47f409, 0xba1d3330, 0x83d2f293, 0xbfa4784b, 0xcbed606e};
    test_random random = test_random_start(42, 54);
    for (size_t i = 0; i < sizeof(published) / sizeof(*published); i++)
        assert_int_equal(test_random_u32(&random), published[i]);
}

static void numbers_stay_in_their_ranges_and_fill_them(void **state) {
    (void)state;
    test_random random = test_random_start(test_random_seed(), 0);
    uint32_t seen[10] = {0};
    double sum = 0;
    for (int i = 0; i < 100000; i++) {
        float number = test_random_float(&random);
        assert_true(number >= 0.0f && number < 1.0f);
        sum += number;
        seen[test_random_below(&random, 10)]++;
        float between = test_random_between(&random, -3.0f, 5.0f);
        assert_true(between >= -3.0f && between <= 5.0f);
    }
    assert_true(sum > 49000 && sum < 51000);
    for (int i = 0; i < 10; i++)
        assert_true(seen[i] > 9000 && seen[i] < 11000);
}

static void the_environment_sets_the_seed(void **state) {
    (void)state;
    const char *before = getenv("KDR_TEST_SEED");
    char *kept = before ? strdup(before) : NULL;
    setenv("KDR_TEST_SEED", "12345", 1);
    assert_int_equal(test_random_seed(), 12345);
    setenv("KDR_TEST_SEED", "0x10", 1);
    assert_int_equal(test_random_seed(), 16);
    if (kept)
        setenv("KDR_TEST_SEED", kept, 1);
    else
        unsetenv("KDR_TEST_SEED");
    free(kept);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_nth_allocation_fails_and_no_other),
        cmocka_unit_test(from_the_nth_on_every_allocation_fails),
        cmocka_unit_test(leaks_and_wrong_sizes_are_seen),
        cmocka_unit_test(blocks_are_aligned_and_never_zero),
        cmocka_unit_test(a_seed_gives_the_same_numbers_again_and_sequences_differ),
        cmocka_unit_test(the_generator_is_the_published_one),
        cmocka_unit_test(numbers_stay_in_their_ranges_and_fill_them),
        cmocka_unit_test(the_environment_sets_the_seed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
