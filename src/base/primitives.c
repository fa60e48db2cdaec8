#include "base/primitives.h"

#include "base/check.h"

#include <string.h>

/* Parts of at most `grain` that `count` falls into. */
static size_t part_count(size_t count, size_t grain) { return count > 0 ? (count - 1) / grain + 1 : 0; }

typedef struct loop {
    size_t count;
    size_t grain;
    size_t parts;
    kdr_range_fn *fn;
    void *context;
    _Alignas(64) _Atomic size_t cursor; /* next part that nobody took */
} loop;

static void loop_worker(void *argument, uint32_t worker) {
    loop *l = argument;
    for (;;) {
        size_t part = atomic_fetch_add_explicit(&l->cursor, 1, memory_order_relaxed);
        if (part >= l->parts)
            return;
        size_t begin = part * l->grain;
        size_t end = l->count - begin < l->grain ? l->count : begin + l->grain;
        l->fn(l->context, begin, end, worker);
    }
}

void kdr_parallel_for(const kdr_crew *crew, size_t count, size_t grain, kdr_range_fn *fn, void *context) {
    KDR_CHECK(grain > 0);
    loop l = {.count = count, .grain = grain, .parts = part_count(count, grain), .fn = fn, .context = context};
    uint32_t calls = crew->worker_count > 0 ? crew->worker_count : 1;
    kdr_crew_run(crew, loop_worker, &l, l.parts < calls ? (uint32_t)l.parts : calls);
}

/* ------------------------------------------------------------------------------------------------------ scan */

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

/* ---------------------------------------------------------------------------------------------------- reduce */

typedef struct reduce {
    const kdr_reduction *reduction;
    size_t grain;
    char *parts;
} reduce;

static void reduce_part(void *context, size_t begin, size_t end, uint32_t worker) {
    const reduce *r = context;
    const kdr_reduction *reduction = r->reduction;
    void *part = r->parts + begin / r->grain * reduction->size;
    memcpy(part, reduction->identity, reduction->size);
    reduction->gather(reduction->context, begin, end, worker, part);
}

void kdr_parallel_reduce(const kdr_crew *crew, size_t count, size_t grain, const kdr_reduction *reduction, void *parts,
                         void *result) {
    KDR_CHECK(grain > 0);
    reduce r = {reduction, grain, parts};
    kdr_parallel_for(crew, count, grain, reduce_part, &r);

    memcpy(result, reduction->identity, reduction->size);
    for (size_t i = 0; i < part_count(count, grain); i++)
        reduction->join(reduction->context, result, r.parts + i * reduction->size);
}
