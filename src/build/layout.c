/* The last pass: nodes in canonical order (depth first, left before right), blocks in the order of their leaves, both
 * in memory of exactly their size. So the bytes of a finished tree do not tell who built it, and neighbours in space
 * are neighbours in memory. Cost: one walk over the nodes by the committing thread, then the blocks are filled by all
 * workers. */
#include "build/layout.h"

#include "base/primitives.h"
#include "tree/wide.h"

#define FILL_GRAIN 512

typedef struct filling {
    const kdr_build_state *state;
    const kdr_leaf_job *jobs;
    float *blocks;
    kdr_shown *shown; /* a node; NULL: not wanted */
    uint8_t *whole;   /* a primitive */
} filling;

static void fill_range(void *context, size_t begin, size_t end, uint32_t worker) {
    (void)worker;
    const filling *f = context;
    const kdr_input *input = f->state->input;
    for (size_t i = begin; i < end; i++) {
        const kdr_leaf_job *job = &f->jobs[i];
        input->fill(input->context, f->blocks, job->leaf, job->ids);
        if (f->shown && !kdr_node_is_closed(job->leaf))
            f->state->unsplit->claim(f->blocks, job->leaf, &job->cell, f->whole, &f->shown[job->node]);
    }
}

static void sort_range(void *context, size_t begin, size_t end, uint32_t worker) {
    (void)worker;
    const filling *f = context;
    for (size_t i = begin; i < end; i++) {
        const kdr_leaf_job *job = &f->jobs[i];
        if (!kdr_node_is_closed(job->leaf))
            f->state->unsplit->sort(f->blocks, job->leaf, &job->cell, f->whole, &f->shown[job->node]);
    }
}

/* A leaf gets its block's place and its job. */
static kdr_node number_leaf(const kdr_workshop *shop, kdr_node node, uint32_t to, const kdr_box *cell, uint32_t *group,
                            kdr_numbering *n) {
    uint32_t count = kdr_node_count(node);
    if (count == 0) {
        if (n->shown)
            n->shown[to] = (kdr_shown){.box = kdr_box_empty()};
        return kdr_node_leaf(0, 0);
    }
    kdr_node leaf = kdr_node_leaf(count, *group);
    const uint32_t *ids;
    *group += kdr_block_groups(count);
    if (kdr_node_is_closed(node)) {
        const kdr_closing *closing = n->by_number[kdr_node_first(node)];
        leaf |= KDR_NODE_CLOSED;
        ids = closing->task.references.primitive;
        n->closings[n->closed_count] = closing;
        n->places[n->closed_count++] = to;
        if (n->shown)
            n->shown[to] = (kdr_shown){.box = closing->task.box, .groups = kdr_block_groups(count)};
    } else {
        ids = kdr_growing_ids(shop, kdr_node_first(node));
    }
    n->jobs[n->job_count++] = (kdr_leaf_job){leaf, ids, to, *cell};
    return leaf;
}

void kdr_number_nodes(const kdr_workshop *shop, uint32_t root, kdr_tree *tree, kdr_numbering *n) {
    struct {
        uint32_t from, to;
        kdr_box cell;
    } stack[KDR_MAX_DEPTH + 2];
    uint32_t top = 0, pair = 1, group = 0;
    n->job_count = n->closed_count = 0;
    stack[top].from = root;
    stack[top].to = 0;
    stack[top].cell = tree->bounds;
    top++;
    tree->nodes[1] = kdr_node_leaf(0, 0);
    while (top > 0) {
        top--;
        uint32_t from = stack[top].from, to = stack[top].to;
        const kdr_box cell = stack[top].cell;
        kdr_node node = *kdr_growing_node(shop, from);
        if (kdr_node_is_leaf(node)) {
            tree->nodes[to] = number_leaf(shop, node, to, &cell, &group, n);
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
}

/* Memory for the closed nodes of the tree, and how many references they have. False when there is none. */
static bool find_closings(kdr_build_state *state, kdr_numbering *n, uint64_t *references) {
    kdr_arena *arena = &state->shop->workers[0].arena;
    uint32_t count = state->closing_count;
    *references = 0;
    if (count == 0)
        return true;
    n->by_number = kdr_closings_by_number(state);
    n->closings = kdr_arena_get(arena, count * sizeof(kdr_closing *));
    n->places = kdr_arena_get(arena, count * sizeof *n->places);
    for (uint32_t i = 0; n->by_number && i < count; i++)
        *references += n->by_number[i]->task.references.count;
    return n->by_number && n->closings && n->places;
}

static kdr_status lay_out(kdr_build_state *state, kdr_tree *tree, kdr_numbering *n, uint64_t references,
                          uint64_t interiors, uint64_t groups, uint64_t leaves) {
    kdr_workshop *shop = state->shop;
    uint32_t node_count = (uint32_t)(2 + 2 * interiors), group_count = (uint32_t)groups;
    kdr_closed_room room = kdr_closed_room_for(&state->plan, references, node_count, group_count);
    if (references == 0)
        room = (kdr_closed_room){0};
    size_t job_bytes = leaves * sizeof(kdr_leaf_job), shown_bytes = (2 + 2 * interiors) * sizeof(kdr_shown);
    size_t wide_bytes = state->plan.wide ? shown_bytes + state->input->count : 0;
    if (!kdr_buffer_reserve(shop->alloc, &shop->layout, job_bytes + wide_bytes) ||
        !kdr_tree_reserve(tree, shop->bulk, node_count + 2 * room.pairs, group_count + room.groups))
        return KDR_ERROR_OUT_OF_MEMORY;

    n->jobs = shop->layout.memory;
    filling f = {.state = state, .jobs = n->jobs, .blocks = tree->blocks};
    if (state->plan.wide) {
        f.shown = (kdr_shown *)(n->jobs + leaves);
        f.whole = (uint8_t *)f.shown + shown_bytes;
        memset(f.whole, 0, state->input->count);
    }
    n->shown = f.shown;
    tree->node_count = node_count;
    kdr_number_nodes(shop, 0, tree, n);
    kdr_build_report(state, KDR_BUILD_NUMBERED);
    kdr_parallel_for(state->crew, n->job_count, FILL_GRAIN, fill_range, &f);
    kdr_build_report(state, KDR_BUILD_FILLED);
    if (f.shown)
        kdr_parallel_for(state->crew, n->job_count, FILL_GRAIN, sort_range, &f);
    bool memory = kdr_build_failed(state) || !f.shown || kdr_tree_add_wide(tree, shop->bulk, f.shown, room.wide);
    if (memory && n->closed_count > 0 && !kdr_build_failed(state))
        memory =
            kdr_tree_add_closed(state, tree, n->closings, n->places, n->closed_count, &room, node_count, group_count);
    tree->node_count = node_count + 2 * room.pairs;
    if (!memory)
        kdr_build_fail(state, KDR_ERROR_OUT_OF_MEMORY);
    if (kdr_build_failed(state))
        kdr_tree_release(tree, shop->bulk);
    return (kdr_status)atomic_load(&state->status);
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
    kdr_arena_mark mark = kdr_arena_save(&shop->workers[0].arena);
    kdr_status status = KDR_ERROR_OUT_OF_MEMORY;
    kdr_numbering n = {0};
    uint64_t references;
    if (find_closings(state, &n, &references))
        status = lay_out(state, tree, &n, references, interiors, groups, leaves);
    kdr_arena_restore(&shop->workers[0].arena, mark);
    return status;
}
