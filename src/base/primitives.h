/* The parallel vocabulary: loops, sums and orders over index ranges, used by name.
 *
 * Ranges are cut at multiples of `grain`, never by the number of workers, so results do not depend on it.
 * Scratch and results are the caller's; nothing here allocates except the sort, into a buffer that is kept. */
#ifndef KDR_BASE_PRIMITIVES_H
#define KDR_BASE_PRIMITIVES_H

#include "base/task.h"

/* fn gets a half-open range and the number of the worker that runs it. grain > 0; the last range may be shorter.
 * A count of 0 makes no call. All calls have returned on return. */
typedef void kdr_range_fn(void *context, size_t begin, size_t end, uint32_t worker);
void kdr_parallel_for(const kdr_crew *crew, size_t count, size_t grain, kdr_range_fn *fn, void *context);

#define KDR_SCAN_GRAIN 16384

/* Entries of scratch that scan, compact and partition of `count` elements take: one for each grain. */
static inline size_t kdr_scan_scratch(size_t count) { return count / KDR_SCAN_GRAIN + (count % KDR_SCAN_GRAIN != 0); }

/* Exclusive prefix sum in place; returns the total. scratch: kdr_scan_scratch(count) entries.
 * The total is exact; sums in `values` keep their low 32 bits when they do not fit. */
uint64_t kdr_parallel_scan(const kdr_crew *crew, uint32_t *values, size_t count, uint64_t *scratch);

/* Writes the numbers of the elements whose flag is not 0, ascending, and returns how many there are.
 * indices: room for that many, never NULL. count at most 2^32. scratch: kdr_scan_scratch(count) entries. */
size_t kdr_parallel_compact(const kdr_crew *crew, const uint8_t *flags, size_t count, uint32_t *indices,
                            uint64_t *scratch);

/* The same, and behind them the numbers of all other elements, ascending. indices: `count` entries. */
size_t kdr_parallel_partition(const kdr_crew *crew, const uint8_t *flags, size_t count, uint32_t *indices,
                              uint64_t *scratch);

/* Exclusive prefix sum of one number a part, on the calling thread; returns the total. */
uint64_t kdr_scan_parts(uint64_t *sums, size_t parts);

/* How ranges become one value of `size` bytes. Every grain is gathered into a part that starts as `identity`, and the
 * parts are joined from left to right, so that even sums of floats come out the same for any number of workers. */
typedef struct kdr_reduction {
    size_t size;
    const void *identity; /* the result over no elements */
    void (*gather)(void *context, size_t begin, size_t end, uint32_t worker, void *part);
    void (*join)(void *context, void *result, const void *part); /* result becomes (result, part) */
    void *context;
} kdr_reduction;

/* parts: `size` bytes for each grain of the range, aligned as the value needs. result must not be one of the parts. */
void kdr_parallel_reduce(const kdr_crew *crew, size_t count, size_t grain, const kdr_reduction *reduction, void *parts,
                         void *result);

typedef struct kdr_pair {
    uint32_t key;
    uint32_t value;
} kdr_pair;

/* Sorts pairs by ascending key; pairs with equal keys keep their order. scratch is reserved as far as needed, and may
 * be kept for the next sort. OUT_OF_MEMORY leaves the pairs as they were. */
kdr_status kdr_parallel_sort(const kdr_crew *crew, kdr_alloc *alloc, kdr_buffer *scratch, kdr_pair *pairs,
                             size_t count);

#endif
