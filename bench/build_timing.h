/* Builds of one mesh by several plans, taking turns, as rows of figures. */
#ifndef KDR_BENCH_BUILD_TIMING_H
#define KDR_BENCH_BUILD_TIMING_H

#include "kdray/render.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#define VARIANT_LIMIT 64
#define ROUND_LIMIT 99

/* One way to build. */
typedef struct build_variant {
    char plan[96]; /* as text */
    bool per_node; /* memory node by node instead of from pools */
    uint32_t threads;
} build_variant;

/* Variants that are to be compared with each other. */
typedef struct build_group {
    const char *experiment;
    build_variant variants[VARIANT_LIMIT];
    uint32_t count;
} build_group;

/* How long to measure. */
typedef struct build_effort {
    uint32_t rounds;      /* at most; at least 1 */
    uint32_t least;       /* fewer only if rounds says so */
    double group_seconds; /* rounds stop after the least when a group would take longer */
} build_effort;

/* The line of names of the columns. */
void build_timing_head(FILE *out);

/* Builds the mesh by every variant in turn and writes a row for each. False, with a sentence on stderr, when a build
 * fails, or when two variants that differ only in order, memory or threads make different trees. */
bool build_timing_group(FILE *out, const build_group *group, const build_effort *effort, const char *scene,
                        const kdr_mesh *mesh);

#endif
