/* The root's references: boxes of all primitives that belong into the tree, in order of their numbers.
 *
 * Each range of primitives writes to its own place; only if some are left out are the ranges moved together. */
#include "build/work.h"

#include "base/primitives.h"

#include <string.h>

#define GATHER_GRAIN 16384

typedef struct gathering {
    const kdr_input *input;
    kdr_references to;
    uint32_t *kept;           /* a range */
    kdr_box *boxes;           /* a worker */
    kdr_input_counts *counts; /* a worker */
} gathering;

static void gather_range(void *context, size_t begin, size_t end, uint32_t worker) {
    gathering *g = context;
    g->kept[begin / GATHER_GRAIN] = g->input->boxes(g->input->context, (uint32_t)begin, (uint32_t)end, &g->to,
                                                    (uint32_t)begin, &g->boxes[worker], &g->counts[worker]);
}

static uint32_t close_gaps(const gathering *g, uint32_t count) {
    uint32_t to = 0;
    for (uint32_t begin = 0, range = 0; begin < count; begin += GATHER_GRAIN, range++) {
        uint32_t kept = g->kept[range];
        if (to != begin) {
            for (int k = 0; k < 3; k++) {
                memmove(g->to.lo[k] + to, g->to.lo[k] + begin, kept * sizeof(float));
                memmove(g->to.hi[k] + to, g->to.hi[k] + begin, kept * sizeof(float));
            }
            memmove(g->to.primitive + to, g->to.primitive + begin, kept * sizeof(uint32_t));
        }
        to += kept;
    }
    return to;
}

kdr_status kdr_build_gather(kdr_build_state *state, kdr_build_task *root, kdr_input_counts *counts) {
    kdr_workshop *shop = state->shop;
    uint32_t count = state->input->count, workers = shop->worker_count;
    uint32_t ranges = count / GATHER_GRAIN + 1;
    kdr_arena *arena = &shop->workers[0].arena;
    kdr_arena_mark mark = kdr_arena_save(arena);
    gathering g = {.input = state->input};
    g.kept = kdr_arena_get(arena, ranges * sizeof *g.kept);
    g.boxes = kdr_arena_get(arena, workers * sizeof *g.boxes);
    g.counts = kdr_arena_get(arena, workers * sizeof *g.counts);
    size_t size = kdr_references_bytes(count);
    void *memory = kdr_bulk_get(shop->bulk, &size);
    if (!g.kept || !g.boxes || !g.counts || !memory) {
        kdr_bulk_put(shop->bulk, memory, size);
        kdr_arena_restore(arena, mark);
        return KDR_ERROR_OUT_OF_MEMORY;
    }

    /* Let every range write its boxes. */
    g.to = kdr_references_in(memory, count);
    for (uint32_t i = 0; i < workers; i++) {
        g.boxes[i] = kdr_box_empty();
        g.counts[i] = (kdr_input_counts){0};
    }
    kdr_parallel_for(state->crew, count, GATHER_GRAIN, gather_range, &g);

    /* Sum up. */
    *counts = (kdr_input_counts){0};
    kdr_box box = kdr_box_empty();
    for (uint32_t i = 0; i < workers; i++) {
        kdr_box_add(&box, &g.boxes[i]);
        counts->dropped += g.counts[i].dropped;
        counts->degenerate += g.counts[i].degenerate;
        counts->invalid += g.counts[i].invalid;
    }
    g.to.count = close_gaps(&g, count);
    kdr_arena_restore(arena, mark);
    if (counts->invalid > 0) {
        kdr_bulk_put(shop->bulk, memory, size);
        return KDR_ERROR_INVALID_DATA;
    }
    *root = (kdr_build_task){.references = g.to, .memory = memory, .memory_size = size, .cell = box, .box = box};
    return KDR_OK;
}
