/* Lazy building: the commit opens the top of the tree, and rays open what they reach.
 *
 * The build stops at nodes of few references and makes leaves of them, whose blocks hold all their triangles, so that
 * the tree is whole and needs nothing of the caller's any more. Opening goes on where the eager build would have: with
 * the triangles' boxes, cut to the cell, or, where triangles were cut at planes, with the boxes of their parts, which
 * are kept. So once all is open the tree is the same, plane for plane.
 *
 * Source: on-demand construction is named as a natural extension in M. Shevtsov, A. Soupikov, A. Kapustin, "Highly
 * Parallel Fast KD-tree Construction for Interactive Ray Tracing of Dynamic Scenes", 2007, section 7; how nodes are
 * claimed, opened and published is our own.
 * Invariant: room for what opening makes is set aside by the commit, so nothing moves under a ray.
 * Cost: 40 bytes a reference of a closed node, 64 where boxes are kept, beside the room, of which only what is used
 * has pages. */
#include "build/closing.h"

#include "base/primitives.h"

#define COPY_GRAIN 64
#define COMMON_COST 16 /* of a step, in triangle tests: leaves have some eight triangles */
#define GROUPS_A_WIDE_NODE 4

static void copy_boxes(const kdr_references *to, const kdr_references *from) {
    for (int k = 0; k < 3; k++) {
        memcpy(to->lo[k], from->lo[k], from->count * sizeof(float));
        memcpy(to->hi[k], from->hi[k], from->count * sizeof(float));
    }
}

void kdr_close(kdr_build_state *state, kdr_build_worker *worker, const kdr_build_task *task) {
    const kdr_references *from = &task->references;
    kdr_closing *closing = kdr_arena_get(&worker->levels[0], sizeof *closing);
    bool boxes = kdr_keeps_boxes(&state->plan);
    size_t number_bytes = from->count * sizeof *from->primitive;
    void *memory = kdr_arena_get(&worker->levels[0], boxes ? kdr_references_bytes(from->count) : number_bytes);
    if (!closing || !memory) {
        kdr_build_fail(state, KDR_ERROR_OUT_OF_MEMORY);
        return;
    }
    kdr_references to = {.primitive = memory, .count = from->count};
    if (boxes) {
        to = kdr_references_in(memory, from->count);
        copy_boxes(&to, from);
    }
    memcpy(to.primitive, from->primitive, number_bytes);
    *closing = (kdr_closing){.before = worker->closings, .task = *task};
    closing->task.references = to;
    closing->number = atomic_fetch_add_explicit(&state->closing_count, 1, memory_order_relaxed);
    worker->closings = closing;
    worker->leaf_groups += kdr_block_groups(from->count);
    worker->leaves++;
    *kdr_growing_node(state->shop, task->node) = kdr_node_leaf(from->count, closing->number) | KDR_NODE_CLOSED;
    kdr_build_finished(state, worker, task);
}

const kdr_closing **kdr_closings_by_number(kdr_build_state *state) {
    kdr_workshop *shop = state->shop;
    const kdr_closing **all =
        kdr_arena_get(&shop->workers[0].arena, (state->closing_count + 1) * sizeof(kdr_closing *));
    for (uint32_t w = 0; all && w < shop->worker_count; w++)
        for (const kdr_closing *c = shop->workers[w].closings; c; c = c->before)
            all[c->number] = c;
    return all;
}

static uint32_t at_most(uint64_t count, uint32_t limit) { return count < limit ? (uint32_t)count : limit; }

kdr_closed_room kdr_closed_room_for(const kdr_plan *plan, uint64_t references, uint32_t node_count,
                                    uint32_t group_count) {
    /* A group has four triangles, and a leaf of a common plan twice as many, so this is a few times what is used. Where
     * leaves have one or two, it is the budget. */
    bool fine = plan->cost_traversal < COMMON_COST * plan->cost_intersection || plan->leaf_limit < COMMON_COST;
    double groups = (double)references * (fine && plan->reference_limit > 1 ? (double)plan->reference_limit : 1);
    uint64_t most = groups < KDR_NODE_MAX_INDEX ? (uint64_t)groups : KDR_NODE_MAX_INDEX;
    return (kdr_closed_room){.pairs = at_most(2 * most, (KDR_WIDE_MAX_LEAF - node_count) / 2),
                             .groups = at_most(most, KDR_NODE_MAX_INDEX - group_count),
                             .wide = at_most(most / GROUPS_A_WIDE_NODE + 64, KDR_NODE_MAX_INDEX / 16)};
}

typedef struct copying {
    kdr_lazy *lazy;
    const kdr_closing **closings;
} copying;

/* Copies boxes alone: primitives are told by the block. */
static void copy_range(void *context, size_t begin, size_t end, uint32_t worker) {
    (void)worker;
    const copying *c = context;
    for (size_t i = begin; i < end; i++) {
        const kdr_closed_node *node = &c->lazy->nodes[i];
        const kdr_references *from = &c->closings[i]->task.references;
        kdr_references to = kdr_references_in(c->lazy->references + node->references, node->count);
        copy_boxes(&to, from);
    }
}

static void release(kdr_closed *closed, kdr_bulk *bulk) {
    kdr_lazy *lazy = (kdr_lazy *)closed;
    kdr_bulk_put(bulk, lazy->references, lazy->reference_bytes);
    kdr_bulk_put(bulk, lazy, lazy->bytes);
}

/* Parts of one block of memory, each on a cache line. */
static void *part(char **at, size_t size) {
    void *here = *at;
    *at += (size + 63) / 64 * 64;
    return here;
}

bool kdr_tree_add_closed(kdr_build_state *state, kdr_tree *tree, const kdr_closing **closings, const uint32_t *places,
                         uint32_t count, const kdr_closed_room *room, uint32_t node_count, uint32_t group_count) {
    kdr_workshop *shop = state->shop;
    if (!shop->openers)
        shop->openers = kdr_openers_create(shop->alloc, shop->bulk, shop->worker_count);
    size_t bytes = sizeof(kdr_lazy) + 5 * 64 + node_count * (sizeof(kdr_node) + 2 * sizeof(uint32_t) + 1) +
                   count * sizeof(kdr_closed_node);
    bool boxes = kdr_keeps_boxes(&state->plan);
    size_t reference_bytes = 1;
    for (uint32_t i = 0; i < count && boxes; i++)
        reference_bytes += kdr_references_bytes(closings[i]->task.references.count);
    char *at = shop->openers ? kdr_bulk_get(shop->bulk, &bytes) : NULL;
    char *references = kdr_bulk_get(shop->bulk, &reference_bytes);
    if (!at || !references) {
        kdr_bulk_put(shop->bulk, at, bytes);
        kdr_bulk_put(shop->bulk, references, reference_bytes);
        return false;
    }
    kdr_lazy *lazy = part(&at, sizeof *lazy);
    kdr_node *committed = part(&at, node_count * sizeof *committed);
    uint32_t *child = part(&at, node_count * sizeof *child), *number = part(&at, node_count * sizeof *number);
    uint8_t *states = part(&at, node_count);
    kdr_closed_node *nodes = part(&at, count * sizeof *nodes);
    memcpy(committed, tree->nodes, node_count * sizeof *committed);
    memset(child, 0, node_count * sizeof *child);
    memset(states, KDR_CLOSED_IDLE, node_count);
    size_t first = 0;
    for (uint32_t i = 0; i < count; i++) {
        const kdr_build_task *task = &closings[i]->task;
        number[places[i]] = i;
        nodes[i] = (kdr_closed_node){.cell = task->cell,
                                     .box = task->box,
                                     .budget = task->budget,
                                     .depth = task->depth,
                                     .count = task->references.count,
                                     .references = first};
        first += kdr_references_bytes(task->references.count);
    }
    *lazy = (kdr_lazy){.closed = {.open = kdr_lazy_open,
                                  .release = release,
                                  .committed = committed,
                                  .committed_count = node_count,
                                  .committed_groups = group_count,
                                  .child = child,
                                  .state = states,
                                  .count = count,
                                  .pair_room = room->pairs,
                                  .group_room = room->groups,
                                  .wide_room = room->wide},
                       .openers = shop->openers,
                       .kernels = state->kernels,
                       .unsplit = state->unsplit,
                       .plan = state->plan,
                       .number = number,
                       .nodes = nodes,
                       .references = references,
                       .bytes = bytes,
                       .reference_bytes = reference_bytes};
    lazy->plan.lazy_limit = 0;
    tree->closed = &lazy->closed;
    copying c = {lazy, closings};
    if (boxes)
        kdr_parallel_for(state->crew, count, COPY_GRAIN, copy_range, &c);
    return true;
}
