/* Prefix sums by parts: sum up every part, sum over the parts on one thread, then go through every part again from
 * what stands before it. Cost: two passes over the values; one where a single worker does it all. */
#include "base/primitives.h"

typedef struct scan {
    uint32_t *values;
    uint64_t *sums; /* of each part; then what stands before it */
} scan;

static void scan_sum(void *context, size_t begin, size_t end, uint32_t worker) {
    const scan *s = context;
    (void)worker;
    uint64_t sum = 0;
    for (size_t i = begin; i < end; i++)
        sum += s->values[i];
    s->sums[begin / KDR_SCAN_GRAIN] = sum;
}

static uint64_t scan_range(uint32_t *values, size_t begin, size_t end, uint64_t sum) {
    for (size_t i = begin; i < end; i++) {
        uint32_t value = values[i];
        values[i] = (uint32_t)sum;
        sum += value;
    }
    return sum;
}

static void scan_write(void *context, size_t begin, size_t end, uint32_t worker) {
    const scan *s = context;
    (void)worker;
    scan_range(s->values, begin, end, s->sums[begin / KDR_SCAN_GRAIN]);
}

uint64_t kdr_scan_parts(uint64_t *sums, size_t parts) {
    uint64_t total = 0;
    for (size_t i = 0; i < parts; i++) {
        uint64_t sum = sums[i];
        sums[i] = total;
        total += sum;
    }
    return total;
}

uint64_t kdr_parallel_scan(const kdr_crew *crew, uint32_t *values, size_t count, uint64_t *scratch) {
    // Integers: one pass gives what two give.
    if (crew->worker_count <= 1 || count <= KDR_SCAN_GRAIN)
        return scan_range(values, 0, count, 0);

    scan s = {values, scratch};
    kdr_parallel_for(crew, count, KDR_SCAN_GRAIN, scan_sum, &s);
    uint64_t total = kdr_scan_parts(scratch, kdr_scan_scratch(count));
    kdr_parallel_for(crew, count, KDR_SCAN_GRAIN, scan_write, &s);
    return total;
}
