/* What rays cost in each traversal: the benchmark's rays asked by a library that counts (kdray info --trace). */
#ifndef KDR_APPS_KDRAY_TRACE_COUNTS_H
#define KDR_APPS_KDRAY_TRACE_COUNTS_H

#include "bench.h"
#include "json.h"

#define KDR_TRACE_SIDE 256u /* pixels of the picture whose rays are asked */
#define KDR_TRACE_WAYS 7u

typedef struct kdr_trace_row {
    const char *way; /* "packets", "lone rays", "stack" ... */
    const char *kind;
    uint64_t rays, hits;
    kdr_trace_counts counts;
} kdr_trace_row;

typedef struct kdr_trace_sheet {
    kdr_trace_row rows[KDR_TRACE_WAYS * KDR_BENCH_KINDS];
    uint32_t count;
} kdr_trace_sheet;

/* Asks the rays of a scene on the calling thread in every way, or, where the plan names a traversal, in that one. False
 * after a sentence to the logger. */
bool kdr_trace_sheet_make(const kdr_bench_scene *scene, const kdr_build_def *build, const kdr_logger *logger,
                          kdr_trace_sheet *out);

/* False in a library that does not count. */
bool kdr_trace_can_count(void);

void kdr_trace_sheet_print(const kdr_trace_sheet *sheet, FILE *file);
void kdr_trace_sheet_json(const kdr_trace_sheet *sheet, kdr_json *json);

#endif
