/* Min-max binning as a splitter: the cheapest bin boundary, and the exact heuristic by masks for small nodes.
 *
 * See bins.c for the method and its publication. Beyond the paper: in nodes that are not large the plane moves to the
 * cheapest begin or end of a box within one bin of it. A bin boundary passes between vertices and cuts many triangles;
 * a plane through a vertex spares those that begin or end there. Scanned models keep a quarter fewer references for it.
 * Cost: one pass over every l-th reference of a node, and one over all where the plane moves. */
#include "build/splitter.h"

#include <string.h>

#define SNAP_COUNT 4096 /* references of the largest node whose plane is moved to a begin or an end */

static void bin_range(void *context, size_t begin, size_t end, uint32_t worker) {
    kdr_opening *o = context;
    /* Every step-th of the whole node, wherever the range begins. */
    uint32_t step = kdr_bins_step(o->task->references.count);
    size_t first = (begin + step - 1) / step * step;
    kdr_bins_add(&o->scratch[worker].bins, &o->grid, &o->task->references, (uint32_t)first, (uint32_t)end, step);
}

static void begin(kdr_opening *opening) {
    opening->grid = kdr_bin_grid_of(&opening->task->box);
    for (uint32_t i = 0; i < opening->worker_count; i++)
        memset(&opening->scratch[i].bins, 0, sizeof opening->scratch[i].bins);
    kdr_opening_pass(opening, bin_range, opening);
    for (uint32_t i = 1; i < opening->worker_count; i++)
        kdr_bins_merge(&opening->scratch[0].bins, &opening->scratch[i].bins);
}

static kdr_split choose(kdr_opening *opening, uint32_t axes) {
    const kdr_build_task *task = opening->task;
    kdr_split split =
        opening->state->kernels->choose_binned(&opening->scratch[0].bins, &opening->grid, task->references.count,
                                               &task->box, &task->cell, &opening->state->plan, axes);
    if (split.cost < INFINITY && task->references.count <= SNAP_COUNT)
        split = opening->state->kernels->snap(&task->references, &split, opening->grid.width[split.axis], &task->cell,
                                              &opening->state->plan);
    return split;
}

const kdr_splitter kdr_split_binned = {
    .weighs = true, .finish_limit = KDR_MASK_LIMIT, .finish = kdr_expand_masked, .begin = begin, .choose = choose};
