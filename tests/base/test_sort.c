#include "base/primitives.h"
#include "support/crews.h"
#include "support/failing_alloc.h"
#include "support/random.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define MOST 100000

static kdr_pair drawn[MOST], pairs[MOST], expected[MOST];

/* By key, then by value: values are drawn as positions, so this is what a stable sort gives. */
static int compare_pairs(const void *a, const void *b) {
    const kdr_pair *x = a, *y = b;
    if (x->key != y->key)
        return x->key < y->key ? -1 : 1;
    return (x->value > y->value) - (x->value < y->value);
}

/* Keys that differ in the bits of the mask alone. */
static void draw_pairs(size_t count, uint32_t mask, uint32_t rest) {
    test_random random = test_random_start(test_random_seed(), mask);
    for (size_t i = 0; i < count; i++)
        drawn[i] = (kdr_pair){(test_random_u32(&random) & mask) | rest, (uint32_t)i};
    memcpy(expected, drawn, count * sizeof(*drawn));
    qsort(expected, count, sizeof(*expected), compare_pairs);
}

static void a_sort_is_stable_and_ascending_for_any_crew_and_any_bits(void **state) {
    (void)state;
    static const size_t counts[] = {0, 1, 2, 3, 100, 16384, 16385, MOST};
    static const uint32_t masks[] = {0, 1, 0xFF, 0xFF00, 0x80000000, 0x00FF00FF, 0xFF0000FF, 0x0FFFFF00, UINT32_MAX};
    for (size_t m = 0; m < sizeof(masks) / sizeof(*masks); m++) {
        for (size_t c = 0; c < sizeof(counts) / sizeof(*counts); c++) {
            draw_pairs(counts[c], masks[m], 0x12345678 & ~masks[m]);
            for (int number = 0; number < TEST_CREW_COUNT; number++) {
                test_crew crew;
                test_crew_open(&crew, number);
                kdr_buffer scratch = {NULL, 0};
                memcpy(pairs, drawn, counts[c] * sizeof(*pairs));
                assert_int_equal(kdr_parallel_sort(&crew.crew, &crew.alloc, &scratch, pairs, counts[c]), KDR_OK);
                assert_memory_equal(pairs, expected, counts[c] * sizeof(*pairs));
                kdr_buffer_release(&crew.alloc, &scratch);
                test_crew_close(&crew);
            }
        }
    }
}

static void kept_scratch_serves_the_next_sort_without_an_allocation(void **state) {
    (void)state;
    failing_alloc failing;
    failing_alloc_init(&failing);
    kdr_allocator functions = failing_alloc_functions(&failing);
    kdr_alloc alloc;
    kdr_alloc_init(&alloc, &functions);
    kdr_crew alone = {.worker_count = 1};
    kdr_buffer scratch = {NULL, 0};
    draw_pairs(1000, UINT32_MAX, 0);
    for (int i = 0; i < 3; i++) {
        memcpy(pairs, drawn, 1000 * sizeof(*pairs));
        assert_int_equal(kdr_parallel_sort(&alone, &alloc, &scratch, pairs, 1000), KDR_OK);
        assert_memory_equal(pairs, expected, 1000 * sizeof(*pairs));
        failing_alloc_fail_from(&failing, 1);
    }
    assert_int_equal(atomic_load(&failing.calls), 0);
    kdr_buffer_release(&alloc, &scratch);
    assert_true(failing_alloc_is_clean(&failing));
}

static void without_memory_the_pairs_stay_as_they_were(void **state) {
    (void)state;
    failing_alloc failing;
    failing_alloc_init(&failing);
    kdr_allocator functions = failing_alloc_functions(&failing);
    kdr_alloc alloc;
    kdr_alloc_init(&alloc, &functions);
    kdr_crew alone = {.worker_count = 1};
    kdr_buffer scratch = {NULL, 0};
    draw_pairs(1000, UINT32_MAX, 0);
    memcpy(pairs, drawn, 1000 * sizeof(*pairs));
    failing_alloc_fail_nth(&failing, 1);
    assert_int_equal(kdr_parallel_sort(&alone, &alloc, &scratch, pairs, 1000), KDR_ERROR_OUT_OF_MEMORY);
    assert_memory_equal(pairs, drawn, 1000 * sizeof(*pairs));
    assert_int_equal(kdr_parallel_sort(&alone, &alloc, &scratch, pairs, SIZE_MAX / 8), KDR_ERROR_OUT_OF_MEMORY);
    assert_int_equal(kdr_parallel_sort(&alone, &alloc, &scratch, pairs, SIZE_MAX), KDR_ERROR_OUT_OF_MEMORY);
    assert_memory_equal(pairs, drawn, 1000 * sizeof(*pairs));
    assert_true(failing_alloc_is_clean(&failing));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sort_is_stable_and_ascending_for_any_crew_and_any_bits),
        cmocka_unit_test(kept_scratch_serves_the_next_sort_without_an_allocation),
        cmocka_unit_test(without_memory_the_pairs_stay_as_they_were),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
