/* Stable selection by flags: count the true ones of every part, sum up what stands before each part, then let every
 * part write to its own place. Cost: two passes over the flags. */
#include "base/primitives.h"

#include <string.h>

#define BLOCK 256 /* elements written to the stack first, so that the inner loop needs no branch */

typedef struct selection {
    const uint8_t *flags;
    uint32_t *indices;
    uint32_t *others; /* where numbers of elements with flag 0 go; NULL: nowhere */
    uint64_t *before; /* true flags of each part; then those of all parts before it */
} selection;

static void count_flags(void *context, size_t begin, size_t end, uint32_t worker) {
    const selection *s = context;
    (void)worker;
    uint32_t sum = 0;
    for (size_t i = begin; i < end; i++)
        sum += s->flags[i] != 0;
    s->before[begin / KDR_SCAN_GRAIN] = sum;
}

/* Both kinds of one block, through the stack: every element is written to both, and one of the two moves on. */
static void write_block(const selection *s, size_t begin, size_t end, size_t *selected) {
    uint32_t yes[BLOCK], no[BLOCK];
    uint32_t yes_count = 0, no_count = 0;
    for (size_t i = begin; i < end; i++) {
        bool flag = s->flags[i] != 0;
        yes[yes_count] = no[no_count] = (uint32_t)i;
        yes_count += flag;
        no_count += !flag;
    }
    memcpy(s->indices + *selected, yes, yes_count * sizeof(*yes));
    if (s->others)
        memcpy(s->others + (begin - *selected), no, no_count * sizeof(*no));
    *selected += yes_count;
}

static void write_indices(void *context, size_t begin, size_t end, uint32_t worker) {
    const selection *s = context;
    (void)worker;
    size_t selected = (size_t)s->before[begin / KDR_SCAN_GRAIN];
    for (size_t i = begin; i < end; i += BLOCK)
        write_block(s, i, end - i < BLOCK ? end : i + BLOCK, &selected);
}

static size_t select_flags(const kdr_crew *crew, const uint8_t *flags, size_t count, uint32_t *indices,
                           uint64_t *scratch, bool keep_others) {
    selection s = {.flags = flags, .indices = indices, .before = scratch};
    kdr_parallel_for(crew, count, KDR_SCAN_GRAIN, count_flags, &s);
    size_t total = (size_t)kdr_scan_parts(scratch, kdr_scan_scratch(count));
    if (keep_others)
        s.others = indices + total;
    kdr_parallel_for(crew, count, KDR_SCAN_GRAIN, write_indices, &s);
    return total;
}

size_t kdr_parallel_compact(const kdr_crew *crew, const uint8_t *flags, size_t count, uint32_t *indices,
                            uint64_t *scratch) {
    return select_flags(crew, flags, count, indices, scratch, false);
}

size_t kdr_parallel_partition(const kdr_crew *crew, const uint8_t *flags, size_t count, uint32_t *indices,
                              uint64_t *scratch) {
    return select_flags(crew, flags, count, indices, scratch, true);
}
