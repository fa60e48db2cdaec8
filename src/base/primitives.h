/* The parallel vocabulary: loops, sums and orders over index ranges, used by name.
 *
 * Ranges are cut at multiples of `grain`, never by the number of workers, so results do not depend on it. */
#ifndef KDR_BASE_PRIMITIVES_H
#define KDR_BASE_PRIMITIVES_H

#include "base/task.h"

/* fn gets a half-open range and the number of the worker that runs it. */
typedef void kdr_range_fn(void *context, size_t begin, size_t end, uint32_t worker);
void kdr_parallel_for(const kdr_crew *crew, size_t count, size_t grain, kdr_range_fn *fn, void *context);

/* Exclusive prefix sum in place; returns the total. scratch: one uint64_t for each grain of 16,384. */
uint64_t kdr_parallel_scan(const kdr_crew *crew, uint32_t *values, size_t count, uint64_t *scratch);

#endif
