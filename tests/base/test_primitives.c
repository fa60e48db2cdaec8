#include "base/primitives.h"
#include "support/crews.h"
#include "support/random.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define MOST 100000

static const size_t counts[] = {
    0, 1, 2, 100, KDR_SCAN_GRAIN - 1, KDR_SCAN_GRAIN, KDR_SCAN_GRAIN + 1, 2 * KDR_SCAN_GRAIN, MOST};
#define COUNTS (sizeof(counts) / sizeof(*counts))

typedef struct visits {
    _Atomic uint8_t visited[MOST];
    size_t count;
    size_t grain;
    uint32_t worker_count;
    _Atomic uint32_t bad_cuts;
    _Atomic uint32_t bad_workers;
    _Atomic uint32_t busy[7];
} visits;

static void visit(void *context, size_t begin, size_t end, uint32_t worker) {
    visits *v = context;
    size_t expected_end = v->count - begin < v->grain ? v->count : begin + v->grain;
    if (begin % v->grain != 0 || end != expected_end)
        atomic_fetch_add(&v->bad_cuts, 1);
    if (worker >= v->worker_count || atomic_exchange(&v->busy[worker], 1) != 0)
        atomic_fetch_add(&v->bad_workers, 1);
    for (size_t i = begin; i < end; i++)
        atomic_fetch_add_explicit(&v->visited[i], 1, memory_order_relaxed);
    if (worker < v->worker_count)
        atomic_store(&v->busy[worker], 0);
}

static void a_loop_visits_every_index_once_in_ranges_cut_at_multiples_of_the_grain(void **state) {
    (void)state;
    static const size_t grains[] = {1, 7, 1000, KDR_SCAN_GRAIN, MOST, SIZE_MAX};
    static visits v;
    for (int number = 0; number < TEST_CREW_COUNT; number++) {
        test_crew crew;
        test_crew_open(&crew, number);
        for (size_t c = 0; c < COUNTS; c++) {
            for (size_t g = 0; g < sizeof(grains) / sizeof(*grains); g++) {
                memset(&v, 0, sizeof(v));
                v.count = counts[c];
                v.grain = grains[g];
                v.worker_count = crew.crew.worker_count;
                kdr_parallel_for(&crew.crew, v.count, v.grain, visit, &v);
                assert_int_equal(atomic_load(&v.bad_cuts), 0);
                assert_int_equal(atomic_load(&v.bad_workers), 0);
                for (size_t i = 0; i < MOST; i++)
                    assert_int_equal(atomic_load_explicit(&v.visited[i], memory_order_relaxed), i < v.count);
            }
        }
        test_crew_close(&crew);
    }
}

static void a_scan_is_the_serial_exclusive_sum_for_any_crew(void **state) {
    (void)state;
    static uint32_t values[MOST], expected[MOST];
    uint64_t scratch[MOST / KDR_SCAN_GRAIN + 2];
    for (int number = 0; number < TEST_CREW_COUNT; number++) {
        test_crew crew;
        test_crew_open(&crew, number);
        for (size_t c = 0; c < COUNTS; c++) {
            test_random random = test_random_start(test_random_seed(), c);
            uint64_t total = 0;
            for (size_t i = 0; i < counts[c]; i++) {
                values[i] = test_random_below(&random, 1000);
                expected[i] = (uint32_t)total;
                total += values[i];
            }
            memset(scratch, 0xA5, sizeof(scratch));
            size_t entries = kdr_scan_scratch(counts[c]);
            assert_int_equal(kdr_parallel_scan(&crew.crew, values, counts[c], scratch), total);
            assert_memory_equal(values, expected, counts[c] * sizeof(*values));
            assert_int_equal(scratch[entries], UINT64_C(0xA5A5A5A5A5A5A5A5));
        }
        test_crew_close(&crew);
    }
}

static void the_total_is_exact_where_the_sums_keep_their_low_bits(void **state) {
    (void)state;
    static uint32_t values[MOST];
    uint64_t scratch[MOST / KDR_SCAN_GRAIN + 1];
    for (int number = 0; number < TEST_CREW_COUNT; number++) {
        test_crew crew;
        test_crew_open(&crew, number);
        for (size_t i = 0; i < MOST; i++)
            values[i] = UINT32_MAX;
        assert_int_equal(kdr_parallel_scan(&crew.crew, values, MOST, scratch), (uint64_t)MOST * UINT32_MAX);
        for (size_t i = 0; i < MOST; i++)
            assert_int_equal(values[i], (uint32_t)(i * UINT32_MAX));
        test_crew_close(&crew);
    }
}

/* One entry a grain, and a part of a grain takes a whole one. */
static void scratch_has_an_entry_for_every_grain(void **state) {
    (void)state;
    assert_int_equal(kdr_scan_scratch(0), 0);
    assert_int_equal(kdr_scan_scratch(1), 1);
    assert_int_equal(kdr_scan_scratch(KDR_SCAN_GRAIN), 1);
    assert_int_equal(kdr_scan_scratch(KDR_SCAN_GRAIN + 1), 2);
    assert_int_equal(kdr_scan_scratch(SIZE_MAX), SIZE_MAX / KDR_SCAN_GRAIN + 1);
}

/* A sum of floats, whose rounding betrays another order, and the least and greatest of them. */
typedef struct float_range {
    float sum, least, most;
} float_range;

static const float_range no_floats = {0.0f, 1e30f, -1e30f};

static void gather_floats(void *context, size_t begin, size_t end, uint32_t worker, void *part) {
    const float *values = context;
    float_range *range = part;
    (void)worker;
    for (size_t i = begin; i < end; i++) {
        range->sum += values[i];
        range->least = values[i] < range->least ? values[i] : range->least;
        range->most = values[i] > range->most ? values[i] : range->most;
    }
}

static void join_floats(void *context, void *result, const void *part) {
    float_range *range = result;
    const float_range *other = part;
    (void)context;
    range->sum += other->sum;
    range->least = other->least < range->least ? other->least : range->least;
    range->most = other->most > range->most ? other->most : range->most;
}

static float_range reduce_serially(float *values, size_t count, size_t grain) {
    float_range result = no_floats;
    for (size_t begin = 0; begin < count; begin += grain) {
        float_range part = no_floats;
        gather_floats(values, begin, count - begin < grain ? count : begin + grain, 0, &part);
        join_floats(values, &result, &part);
    }
    return result;
}

static void a_reduction_is_the_same_to_the_last_bit_for_any_crew(void **state) {
    (void)state;
    static float values[MOST];
    static float_range parts[MOST];
    test_random random = test_random_start(test_random_seed(), 3);
    for (size_t i = 0; i < MOST; i++)
        values[i] = test_random_between(&random, -1.0f, 1.0f) * (i % 100 == 0 ? 1e6f : 1.0f);
    kdr_reduction reduction = {sizeof(float_range), &no_floats, gather_floats, join_floats, values};
    static const size_t grains[] = {1, 100, 4096, MOST};
    for (int number = 0; number < TEST_CREW_COUNT; number++) {
        test_crew crew;
        test_crew_open(&crew, number);
        for (size_t c = 0; c < COUNTS; c++) {
            for (size_t g = 0; g < sizeof(grains) / sizeof(*grains); g++) {
                float_range expected = reduce_serially(values, counts[c], grains[g]);
                float_range result;
                memset(&result, 0xA5, sizeof(result));
                memset(parts, 0xA5, sizeof(parts));
                kdr_parallel_reduce(&crew.crew, counts[c], grains[g], &reduction, parts, &result);
                assert_memory_equal(&result, &expected, sizeof(result));
            }
        }
        test_crew_close(&crew);
    }
}

static void gather_letters(void *context, size_t begin, size_t end, uint32_t worker, void *part) {
    (void)worker;
    memset(part, 0, 32);
    memcpy(part, (const char *)context + begin, end - begin);
}

static void join_letters(void *context, void *result, const void *part) {
    (void)context;
    strcat(result, part);
}

static void parts_are_joined_from_left_to_right(void **state) {
    (void)state;
    char letters[] = "abcdefghijklmnopqrstuvwxyz";
    static const char nothing[32];
    kdr_reduction reduction = {sizeof(nothing), nothing, gather_letters, join_letters, letters};
    for (int number = 0; number < TEST_CREW_COUNT; number++) {
        test_crew crew;
        test_crew_open(&crew, number);
        char parts[9][32], result[32];
        kdr_parallel_reduce(&crew.crew, 26, 3, &reduction, parts, result);
        assert_string_equal(result, letters);
        test_crew_close(&crew);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_loop_visits_every_index_once_in_ranges_cut_at_multiples_of_the_grain),
        cmocka_unit_test(a_scan_is_the_serial_exclusive_sum_for_any_crew),
        cmocka_unit_test(the_total_is_exact_where_the_sums_keep_their_low_bits),
        cmocka_unit_test(scratch_has_an_entry_for_every_grain),
        cmocka_unit_test(a_reduction_is_the_same_to_the_last_bit_for_any_crew),
        cmocka_unit_test(parts_are_joined_from_left_to_right),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
