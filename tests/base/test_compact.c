#include "base/primitives.h"
#include "support/crews.h"
#include "support/random.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#define MOST 70000
#define UNTOUCHED 0xA5A5A5A5u

static const size_t counts[] = {0, 1, 255, 256, 257, KDR_SCAN_GRAIN, KDR_SCAN_GRAIN + 1, MOST};
#define COUNTS (sizeof(counts) / sizeof(*counts))

static uint8_t flags[MOST];
static uint32_t indices[MOST + 1], expected[MOST + 1];
static uint64_t scratch[MOST / KDR_SCAN_GRAIN + 1];

/* Flags that are set in share of 8 cases, by values other than 1 too. */
static void draw_flags(test_random *random, size_t count, uint32_t share) {
    for (size_t i = 0; i < count; i++)
        flags[i] = test_random_below(random, 8) < share ? (uint8_t)(1 + test_random_below(random, 255)) : 0;
}

static size_t expect_selection(size_t count, bool with_others) {
    size_t selected = 0;
    memset(expected, 0xA5, sizeof(expected));
    for (size_t i = 0; i < count; i++)
        if (flags[i])
            expected[selected++] = (uint32_t)i;
    size_t total = selected;
    for (size_t i = 0; i < count && with_others; i++)
        if (!flags[i])
            expected[total++] = (uint32_t)i;
    return selected;
}

typedef size_t selection_fn(const kdr_crew *crew, const uint8_t *flags, size_t count, uint32_t *indices,
                            uint64_t *scratch);

static void assert_like_serial(selection_fn *fn, bool with_others) {
    for (int number = 0; number < TEST_CREW_COUNT; number++) {
        test_crew crew;
        test_crew_open(&crew, number);
        for (size_t c = 0; c < COUNTS; c++) {
            for (uint32_t share = 0; share <= 8; share += 2) {
                test_random random = test_random_start(test_random_seed(), c * 16 + share);
                draw_flags(&random, counts[c], share);
                size_t selected = expect_selection(counts[c], with_others);
                memset(indices, 0xA5, sizeof(indices));
                assert_int_equal(fn(&crew.crew, flags, counts[c], indices, scratch), selected);
                assert_memory_equal(indices, expected, sizeof(indices));
                assert_int_equal(indices[counts[c]], UNTOUCHED);
            }
        }
        test_crew_close(&crew);
    }
}

static void compact_gives_the_flagged_numbers_ascending_and_writes_no_more(void **state) {
    (void)state;
    assert_like_serial(kdr_parallel_compact, false);
}

static void partition_gives_the_flagged_numbers_and_then_the_others_both_ascending(void **state) {
    (void)state;
    assert_like_serial(kdr_parallel_partition, true);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(compact_gives_the_flagged_numbers_ascending_and_writes_no_more),
        cmocka_unit_test(partition_gives_the_flagged_numbers_and_then_the_others_both_ascending),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
