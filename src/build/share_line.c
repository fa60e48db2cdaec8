/* Slices of the longest axis, cut at bins: the 1-D partition and the initial clustering.
 *
 * All workers count on one axis where boxes begin and where they end, each in counters of its own, which are summed.
 * Then the slice [a, b) is cut in two where the references that reach into the two parts are in the proportion of the
 * regions they are to become: those that reach into bins [a, c) are the begins below c less the ends below a. The same
 * counters serve all cuts.
 *
 * The 1-D partition has a fixed number of bins, and each slice is built by one worker. Initial clustering has 512 bins
 * a region, and workers hand nodes over to each other. Sources: "Parallel KD Tree Acceleration Structures for Ray
 * Tracing on Multi-Core Processor", thesis, 2009, section 5.6; M. Shevtsov, A. Soupikov, A. Kapustin, "Highly Parallel
 * Fast KD-tree Construction for Interactive Ray Tracing of Dynamic Scenes", 2007, sections 4.1 and 5. Cost: one pass
 * over begins and ends on one axis, then regions.c. */
#include "build/opening.h"
#include "build/regions.h"
#include "build/splitter.h"

#define LINE_BINS 16384
#define CLUSTER_BINS 512 /* a region */
#define BIN_GRAIN 65536

typedef struct line {
    const kdr_references *references;
    uint32_t axis, bins;
    float lo, scale, width;
    kdr_box cell;
    uint32_t *counters; /* worker x (begins, ends) x bins + 1; those of the first become sums over all bins below */
} line;

static uint32_t *counters_of(const line *l, uint32_t worker, uint32_t ends) {
    return l->counters + (2 * (size_t)worker + ends) * (l->bins + 1);
}

static uint32_t bin_of(const line *l, float x) {
    int32_t bin = (int32_t)((x - l->lo) * l->scale);
    return (uint32_t)bin < l->bins ? (uint32_t)bin : l->bins - 1;
}

static void bin_range(void *context, size_t begin, size_t end, uint32_t worker) {
    const line *l = context;
    const float *lo = l->references->lo[l->axis], *hi = l->references->hi[l->axis];
    uint32_t *begins = counters_of(l, worker, 0), *ends = counters_of(l, worker, 1);
    for (size_t i = begin; i < end; i++) {
        begins[bin_of(l, lo[i])]++;
        ends[bin_of(l, hi[i])]++;
    }
}

/* Makes counters sums of all bins below each boundary. */
static void sum_up(const line *l, uint32_t workers) {
    for (uint32_t ends = 0; ends < 2; ends++) {
        uint32_t sum = 0, *to = counters_of(l, 0, ends);
        for (uint32_t i = 0; i <= l->bins; i++) {
            uint32_t count = 0;
            for (uint32_t w = 0; w < workers; w++)
                count += counters_of(l, w, ends)[i];
            to[i] = sum;
            sum += count;
        }
    }
}

/* The boundary inside (first, last) that cuts the slice in the proportion of wanted regions, or first: there is none.
 */
static uint32_t find_boundary(const line *l, uint32_t first, uint32_t last, uint32_t left_wanted,
                              uint32_t right_wanted) {
    const uint32_t *begins = counters_of(l, 0, 0), *ends = counters_of(l, 0, 1);
    uint32_t best = first;
    uint64_t least = UINT64_MAX;
    for (uint32_t lo = first + 1, hi = last; lo < hi;) {
        uint32_t middle = lo + (hi - lo) / 2;
        uint64_t left = (uint64_t)(begins[middle] - ends[first]) * right_wanted;
        uint64_t right = (uint64_t)(begins[last] - ends[middle]) * left_wanted;
        uint64_t off = left > right ? left - right : right - left;
        if (off < least || (off == least && middle < best)) {
            least = off;
            best = middle;
        }
        if (left < right)
            lo = middle + 1;
        else
            hi = middle;
    }
    return best;
}

/* Cuts the slice of bins [first, last) into regions; recursion is bounded by their number. */
static uint32_t cut_slice(const line *l, uint32_t first, uint32_t last, float lo, float hi, uint32_t wanted,
                          kdr_regions *regions) {
    uint32_t right_wanted = wanted / 2, left_wanted = wanted - right_wanted, at = first;
    if (wanted > 1)
        at = find_boundary(l, first, last, left_wanted, right_wanted);
    float plane = l->lo + l->width * (float)at;
    if (at == first || !(plane > lo && plane < hi))
        return kdr_regions_add_region(regions, wanted);
    uint32_t index = regions->plane_count++;
    kdr_region_plane *p = &regions->planes[index];
    p->axis = l->axis;
    p->plane = plane;
    p->child[0] = cut_slice(l, first, at, lo, plane, left_wanted, regions);
    p->child[1] = cut_slice(l, at, last, plane, hi, right_wanted, regions);
    return index;
}

static void find(const void *context, uint32_t count, kdr_regions *regions) {
    const line *l = context;
    cut_slice(l, 0, l->bins, l->cell.lo[l->axis], l->cell.hi[l->axis], count, regions);
}

static uint32_t divide(kdr_build_state *state, kdr_build_task *root, uint32_t count, kdr_build_task *tasks,
                       uint32_t bins) {
    uint32_t sets[3], workers = state->shop->worker_count;
    kdr_single_axes(KDR_AXIS_LONGEST, &root->cell, 0, sets);
    line l = {
        .references = &root->references, .axis = (uint32_t)__builtin_ctz(sets[0]), .bins = bins, .cell = root->cell};
    float extent = root->box.hi[l.axis] - root->box.lo[l.axis];
    bool usable = extent >= 0x1p-100f && extent <= 0x1p100f && fabsf(root->box.lo[l.axis]) <= 0x1p100f;
    l.lo = usable ? root->box.lo[l.axis] : 0;
    l.scale = usable ? (float)bins / extent : 0;
    l.width = usable ? extent / (float)bins : 0;

    kdr_arena *arena = &state->shop->workers[0].arena;
    kdr_arena_mark mark = kdr_arena_save(arena);
    size_t bytes = (size_t)workers * 2 * (bins + 1) * sizeof *l.counters;
    l.counters = kdr_arena_get(arena, bytes);
    uint32_t made = 0;
    if (l.counters) {
        memset(l.counters, 0, bytes);
        kdr_parallel_for(state->crew, root->references.count, BIN_GRAIN, bin_range, &l);
        sum_up(&l, workers);
        made = kdr_regions_divide(state, root, count, tasks, find, &l);
    } else {
        kdr_bulk_put(state->shop->bulk, root->memory, root->memory_size);
        kdr_build_fail(state, KDR_ERROR_OUT_OF_MEMORY);
    }
    kdr_arena_restore(arena, mark);
    return made;
}

static uint32_t divide_line(kdr_build_state *state, kdr_build_task *root, uint32_t count, kdr_build_task *tasks) {
    return divide(state, root, count, tasks, LINE_BINS);
}

static uint32_t divide_cluster(kdr_build_state *state, kdr_build_task *root, uint32_t count, kdr_build_task *tasks) {
    return divide(state, root, count, tasks, CLUSTER_BINS * count);
}

const kdr_share kdr_share_line = {.divide = divide_line};
const kdr_share kdr_share_cluster = {.divide = divide_cluster, .hands_over = true};
