/* Boxes cut on all three axes: the 3-D partition, from one histogram.
 *
 * All workers count the centres of the boxes in the cells of a grid over the scene, each in a histogram of its own;
 * they are summed. Then a box of grid cells is cut in two where the centres in the two parts are in the proportion of
 * the regions they are to become, on its longest axis, or on another where that has no such plane; and so on. No cut
 * looks at a reference: the thesis bins its references anew for every cut, a pass over all of them for each level,
 * which is why its 3-D form takes twice the time of the 1-D form. Here both take one pass to count and two to assign.
 *
 * Source: "Parallel KD Tree Acceleration Structures for Ray Tracing on Multi-Core Processor", thesis, 2009,
 * section 5.7. Cost: one pass over the boxes, one over the histogram for each level of cuts, then regions.c. */
#include "build/opening.h"
#include "build/regions.h"
#include "build/splitter.h"

#define GRID 64
#define COUNT_GRAIN 65536

typedef struct grid {
    const kdr_references *references;
    kdr_box cell;
    float lo[3], scale[3], width[3];
    uint32_t *counters; /* worker x GRID^3; the first has the sums in the end */
} grid;

/* A box of cells, and the part of the scene that it covers. */
typedef struct part {
    uint32_t first[3], last[3];
    kdr_box cell;
} part;

static void count_range(void *context, size_t begin, size_t end, uint32_t worker) {
    const grid *g = context;
    const kdr_references *r = g->references;
    uint32_t *counters = g->counters + (size_t)worker * GRID * GRID * GRID;
    for (size_t i = begin; i < end; i++) {
        uint32_t at = 0;
        for (int k = 0; k < 3; k++) {
            int32_t cell = (int32_t)((0.5f * r->lo[k][i] + 0.5f * r->hi[k][i] - g->lo[k]) * g->scale[k]);
            at = at * GRID + ((uint32_t)cell < GRID ? (uint32_t)cell : GRID - 1);
        }
        counters[at]++;
    }
}

static void sum_range(void *context, size_t begin, size_t end, uint32_t worker) {
    (void)worker;
    const kdr_build_state *state = ((void **)context)[0];
    const grid *g = ((void **)context)[1];
    for (uint32_t w = 1; w < state->shop->worker_count; w++)
        for (size_t i = begin; i < end; i++)
            g->counters[i] += g->counters[(size_t)w * GRID * GRID * GRID + i];
}

/* Centres in each layer of a part across each axis. */
static void count_layers(const grid *g, const part *p, uint32_t layers[3][GRID]) {
    memset(layers, 0, 3 * sizeof layers[0]);
    for (uint32_t x = p->first[0]; x < p->last[0]; x++) {
        for (uint32_t y = p->first[1]; y < p->last[1]; y++) {
            const uint32_t *row = g->counters + (x * GRID + y) * GRID;
            uint32_t sum = 0;
            for (uint32_t z = p->first[2]; z < p->last[2]; z++) {
                layers[2][z] += row[z];
                sum += row[z];
            }
            layers[0][x] += sum;
            layers[1][y] += sum;
        }
    }
}

/* The boundary that cuts a part in the proportion of wanted regions, or the first: there is none that leaves both parts
 * more than half of what they should have. */
static uint32_t find_boundary(const uint32_t *layers, uint32_t first, uint32_t last, uint32_t left_wanted,
                              uint32_t right_wanted) {
    uint64_t total = 0, left = 0, least = UINT64_MAX;
    uint32_t best = first, wanted = left_wanted + right_wanted;
    for (uint32_t i = first; i < last; i++)
        total += layers[i];
    for (uint32_t i = first + 1; i < last; i++) {
        left += layers[i - 1];
        uint64_t is = left * wanted, should = total * left_wanted;
        uint64_t off = is > should ? is - should : should - is;
        bool fair = 2 * is > should && 2 * (total - left) * wanted > total * right_wanted;
        if (fair && off < least) {
            least = off;
            best = i;
        }
    }
    return best;
}

static uint32_t cut_part(const grid *g, const part *p, uint32_t wanted, kdr_regions *regions) {
    if (wanted < 2)
        return kdr_regions_add_region(regions, wanted);
    uint32_t layers[3][GRID], sets[3], right_wanted = wanted / 2;
    count_layers(g, p, layers);
    kdr_single_axes(KDR_AXIS_LONGEST, &p->cell, 0, sets);
    for (int i = 0; i < 3; i++) {
        uint32_t axis = (uint32_t)__builtin_ctz(sets[i]);
        uint32_t at = find_boundary(layers[axis], p->first[axis], p->last[axis], wanted - right_wanted, right_wanted);
        float plane = g->lo[axis] + g->width[axis] * (float)at;
        if (at == p->first[axis] || !(plane > p->cell.lo[axis] && plane < p->cell.hi[axis]))
            continue;
        uint32_t index = regions->plane_count++;
        part sides[2] = {*p, *p};
        sides[0].last[axis] = sides[1].first[axis] = at;
        sides[0].cell.hi[axis] = sides[1].cell.lo[axis] = plane;
        regions->planes[index].axis = axis;
        regions->planes[index].plane = plane;
        regions->planes[index].child[0] = cut_part(g, &sides[0], wanted - right_wanted, regions);
        regions->planes[index].child[1] = cut_part(g, &sides[1], right_wanted, regions);
        return index;
    }
    return kdr_regions_add_region(regions, wanted);
}

static void find(const void *context, uint32_t count, kdr_regions *regions) {
    const grid *g = context;
    part whole = {.last = {GRID, GRID, GRID}, .cell = g->cell};
    cut_part(g, &whole, count, regions);
}

static uint32_t divide(kdr_build_state *state, kdr_build_task *root, uint32_t count, kdr_build_task *tasks) {
    grid g = {.references = &root->references, .cell = root->cell};
    kdr_bin_grid bins = kdr_bin_grid_of(&root->box);
    for (int k = 0; k < 3; k++) {
        g.lo[k] = bins.lo[k];
        g.scale[k] = bins.scale[k] * ((float)GRID / KDR_BIN_COUNT);
        g.width[k] = bins.width[k] * ((float)KDR_BIN_COUNT / GRID);
    }
    kdr_arena *arena = &state->shop->workers[0].arena;
    kdr_arena_mark mark = kdr_arena_save(arena);
    size_t bytes = (size_t)state->shop->worker_count * GRID * GRID * GRID * sizeof *g.counters;
    g.counters = kdr_arena_get(arena, bytes);
    uint32_t made = 0;
    if (g.counters) {
        memset(g.counters, 0, bytes);
        kdr_parallel_for(state->crew, root->references.count, COUNT_GRAIN, count_range, &g);
        void *context[2] = {state, &g};
        kdr_parallel_for(state->crew, (size_t)GRID * GRID * GRID, COUNT_GRAIN, sum_range, context);
        made = kdr_regions_divide(state, root, count, tasks, find, &g);
    } else {
        kdr_bulk_put(state->shop->bulk, root->memory, root->memory_size);
        kdr_build_fail(state, KDR_ERROR_OUT_OF_MEMORY);
    }
    kdr_arena_restore(arena, mark);
    return made;
}

const kdr_share kdr_share_grid = {.divide = divide};
