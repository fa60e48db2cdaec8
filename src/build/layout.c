/* The last pass: nodes in canonical order (depth first, left before right), blocks in the order of their leaves, both
 * in memory of exactly their size. So the bytes of a finished tree do not tell who built it, and neighbours in space
 * are neighbours in memory. Cost: one walk over the nodes by the committing thread, then the blocks are filled by all
 * workers. */
#include "build/work.h"

#include "base/primitives.h"
#include "tree/wide.h"

#define FILL_GRAIN 512

/* A leaf whose block is to be filled. */
typedef struct leaf_job {
    kdr_node leaf; /* as in the finished tree */
    uint32_t ids;  /* first of its primitives among the growing lists */
    uint32_t node; /* its number in the finished tree */
    kdr_box cell;
} leaf_job;

typedef struct filling {
    const kdr_build_state *state;
    const leaf_job *jobs;
    float *blocks;
    kdr_shown *shown; /* a node; NULL: not wanted */
    uint8_t *whole;   /* a primitive */
} filling;

static void fill_range(void *context, size_t begin, size_t end, uint32_t worker) {
    (void)worker;
    const filling *f = context;
    const kdr_input *input = f->state->input;
    for (size_t i = begin; i < end; i++) {
        const leaf_job *job = &f->jobs[i];
        input->fill(input->context, f->blocks, job->leaf, kdr_growing_ids(f->state->shop, job->ids));
        if (f->shown)
            f->state->unsplit->claim(f->blocks, job->leaf, &job->cell, f->whole, &f->shown[job->node]);
    }
}

static void sort_range(void *context, size_t begin, size_t end, uint32_t worker) {
    (void)worker;
    const filling *f = context;
    for (size_t i = begin; i < end; i++) {
        const leaf_job *job = &f->jobs[i];
        f->state->unsplit->sort(f->blocks, job->leaf, &job->cell, f->whole, &f->shown[job->node]);
    }
}

/* Numbers the nodes anew and writes them; returns the number of leaves with a block. */
static uint64_t number_nodes(const kdr_workshop *shop, kdr_tree *tree, leaf_job *jobs, kdr_shown *shown) {
    struct {
        uint32_t from, to;
        kdr_box cell;
    } stack[KDR_MAX_DEPTH + 2];
    uint32_t top = 0, pair = 1, group = 0;
    uint64_t job_count = 0;
    stack[top].from = stack[top].to = 0;
    stack[top].cell = tree->bounds;
    top++;
    tree->nodes[1] = kdr_node_leaf(0, 0);
    while (top > 0) {
        top--;
        uint32_t from = stack[top].from, to = stack[top].to;
        const kdr_box cell = stack[top].cell;
        kdr_node node = *kdr_growing_node(shop, from);
        if (kdr_node_is_leaf(node)) {
            uint32_t count = kdr_node_count(node);
            tree->nodes[to] = kdr_node_leaf(count, count > 0 ? group : 0);
            group += kdr_block_groups(count);
            if (count > 0)
                jobs[job_count++] = (leaf_job){tree->nodes[to], kdr_node_first(node), to, cell};
            else if (shown)
                shown[to] = (kdr_shown){.box = kdr_box_empty()};
            continue;
        }
        uint32_t axis = kdr_node_axis(node);
        float plane = kdr_node_plane(node);
        tree->nodes[to] = kdr_node_interior(axis, plane, pair);
        for (uint32_t side = 2; side-- > 0; top++) {
            stack[top].from = kdr_node_child(node) + side;
            stack[top].to = 2 * pair + side;
            stack[top].cell = cell;
            *(side == 0 ? &stack[top].cell.hi[axis] : &stack[top].cell.lo[axis]) = plane;
        }
        pair++;
    }
    return job_count;
}

kdr_status kdr_build_layout(kdr_build_state *state, kdr_tree *tree) {
    kdr_workshop *shop = state->shop;
    uint64_t interiors = 0, groups = 0, leaves = 0;
    for (uint32_t i = 0; i < shop->worker_count; i++) {
        interiors += shop->workers[i].interiors;
        groups += shop->workers[i].leaf_groups;
        leaves += shop->workers[i].leaves;
    }
    if (interiors >= KDR_NODE_MAX_INDEX || groups > KDR_NODE_MAX_INDEX)
        return KDR_ERROR_LIMIT;
    size_t job_bytes = leaves * sizeof(leaf_job), shown_bytes = (2 + 2 * interiors) * sizeof(kdr_shown);
    size_t wide_bytes = state->plan.wide ? shown_bytes + state->input->count : 0;
    if (!kdr_buffer_reserve(shop->alloc, &shop->layout, job_bytes + wide_bytes) ||
        !kdr_tree_reserve(tree, shop->bulk, (uint32_t)(2 + 2 * interiors), (uint32_t)groups))
        return KDR_ERROR_OUT_OF_MEMORY;

    leaf_job *jobs = shop->layout.memory;
    filling f = {.state = state, .jobs = jobs, .blocks = tree->blocks};
    if (state->plan.wide) {
        f.shown = (kdr_shown *)(jobs + leaves);
        f.whole = (uint8_t *)f.shown + shown_bytes;
        memset(f.whole, 0, state->input->count);
    }
    uint64_t job_count = number_nodes(shop, tree, jobs, f.shown);
    kdr_build_report(state, KDR_BUILD_NUMBERED);
    kdr_parallel_for(state->crew, job_count, FILL_GRAIN, fill_range, &f);
    kdr_build_report(state, KDR_BUILD_FILLED);
    if (f.shown)
        kdr_parallel_for(state->crew, job_count, FILL_GRAIN, sort_range, &f);
    if (f.shown && !kdr_build_failed(state) && !kdr_tree_add_wide(tree, shop->bulk, f.shown))
        kdr_build_fail(state, KDR_ERROR_OUT_OF_MEMORY);
    if (kdr_build_failed(state))
        kdr_tree_release(tree, shop->bulk);
    return (kdr_status)atomic_load(&state->status);
}
