/* Loops and reductions. A loop's workers take the parts of the range from one counter, so that a slow part holds up
 * nobody else; a reduction is a loop with a place of its own for the value of every part. */
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
