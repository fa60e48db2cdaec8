/* The whole build: gather, divide among the workers, open in order, lay the tree out.
 *
 * Three tables answer three questions that do not depend on each other: where a node is cut (splitter.h), what is
 * opened next (order.h), who works on what (share.h). Cost: O(N log N): by binning 28 bytes read and about as many
 * written a reference and level. */
#include "build/builder.h"

#include "base/check.h"
#include "build/closing.h"
#include "build/order.h"
#include "build/share.h"
#include "build/splitter.h"

#include <math.h>

#define ARENA_CHUNK ((size_t)1 << 20)

static void init_worker(kdr_build_worker *worker, kdr_alloc *alloc) {
    kdr_arena_init(&worker->arena, alloc, ARENA_CHUNK);
    for (int i = 0; i < 2; i++)
        kdr_arena_init(&worker->levels[i], alloc, ARENA_CHUNK);
}

static void empty_worker(kdr_build_worker *worker, kdr_alloc *alloc) {
    kdr_buffer_release(alloc, &worker->sorting);
    kdr_arena_destroy(&worker->arena);
    for (int i = 0; i < 2; i++)
        kdr_arena_destroy(&worker->levels[i]);
}

static void release_buffers(kdr_workshop *shop) {
    kdr_buffer_release(shop->alloc, &shop->layout);
    for (int i = 0; i < 2; i++)
        kdr_buffer_release(shop->alloc, &shop->levels[i]);
}

kdr_workshop *kdr_workshop_create(kdr_alloc *alloc, kdr_bulk *bulk, uint32_t worker_count, uint32_t most) {
    kdr_workshop *shop = kdr_alloc_get(alloc, sizeof *shop, 64);
    if (!shop)
        return NULL;
    *shop = (kdr_workshop){.alloc = alloc, .bulk = bulk, .worker_count = worker_count};
    shop->workers = kdr_alloc_array(alloc, worker_count, sizeof *shop->workers, 128);
    bool pairs = kdr_chunks_init(&shop->pairs, alloc, 2 * KDR_PAIRS_PER_CHUNK * sizeof(kdr_node),
                                 (most + 1) / KDR_PAIRS_PER_CHUNK + 1);
    bool ids =
        kdr_chunks_init(&shop->ids, alloc, KDR_IDS_PER_CHUNK * sizeof(uint32_t), (most + 1) / KDR_IDS_PER_CHUNK + 1);
    for (uint32_t i = 0; shop->workers && i < worker_count; i++) {
        shop->workers[i] = (kdr_build_worker){0};
        init_worker(&shop->workers[i], alloc);
    }
    if (!shop->workers || !pairs || !ids) {
        kdr_workshop_destroy(shop);
        return NULL;
    }
    return shop;
}

void kdr_workshop_destroy(kdr_workshop *shop) {
    if (!shop)
        return;
    kdr_alloc *alloc = shop->alloc;
    kdr_openers_destroy(shop->openers);
    for (uint32_t i = 0; shop->workers && i < shop->worker_count; i++)
        empty_worker(&shop->workers[i], alloc);
    kdr_alloc_release(alloc, shop->workers, shop->worker_count * sizeof *shop->workers);
    kdr_chunks_release(&shop->pairs, alloc);
    kdr_chunks_release(&shop->ids, alloc);
    release_buffers(shop);
    kdr_alloc_release(alloc, shop, sizeof *shop);
}

_Static_assert(sizeof(kdr_build_task) == KDR_TASK_BYTES, "the pool copies whole tasks");

void kdr_workshop_trim(kdr_workshop *shop) {
    for (uint32_t i = 0; i < shop->worker_count; i++) {
        empty_worker(&shop->workers[i], shop->alloc);
        init_worker(&shop->workers[i], shop->alloc);
    }
    kdr_chunks_trim(&shop->pairs, shop->alloc);
    kdr_chunks_trim(&shop->ids, shop->alloc);
    release_buffers(shop);
    if (shop->openers)
        kdr_openers_trim(shop->openers);
}

void kdr_workshop_start(kdr_workshop *shop) {
    kdr_chunks_reset(&shop->pairs, shop->alloc);
    kdr_chunks_reset(&shop->ids, shop->alloc);
    for (uint32_t i = 0; i < shop->worker_count; i++) {
        kdr_build_worker *w = &shop->workers[i];
        w->pair = w->pair_end = w->id = w->id_end = 0;
        w->interiors = w->leaf_groups = w->leaves = w->done = 0;
        w->closings = NULL;
        kdr_arena_restore(&w->levels[0], (kdr_arena_mark){0});
    }
}

/* Divides the root among the workers and opens all that comes of it. */
static kdr_status open_root(kdr_build_state *state, kdr_build_task *root) {
    const kdr_share *share = state->share;
    if (!share->divide)
        return state->order->run(state, root, 1);
    kdr_arena *arena = &state->shop->workers[0].arena;
    kdr_arena_mark mark = kdr_arena_save(arena);
    kdr_build_task *tasks = kdr_arena_get(arena, KDR_MAX_REGIONS * sizeof *tasks);
    if (!tasks) {
        kdr_bulk_put(state->shop->bulk, root->memory, root->memory_size);
        return KDR_ERROR_OUT_OF_MEMORY;
    }
    /* Regions are halved until there are as many as asked for, or as many as the depth allows. */
    uint32_t wanted = state->plan.share_count, levels = state->plan.depth_limit;
    if (levels < 32 && wanted > 1u << levels)
        wanted = 1u << levels;
    uint32_t count = share->divide(state, root, wanted, tasks);
    kdr_status status = state->order->run(state, tasks, count);
    kdr_arena_restore(arena, mark);
    return status;
}

kdr_status kdr_build(kdr_workshop *shop, const kdr_crew *crew, kdr_isa isa, const kdr_input *input,
                     const kdr_plan *plan, kdr_tree *tree, kdr_input_counts *counts) {
    KDR_CHECK(crew->worker_count <= shop->worker_count);
    kdr_build_state state = {.shop = shop,
                             .crew = crew,
                             .kernels = kdr_build_kernels_for(isa),
                             .unsplit = kdr_unsplit_for(isa),
                             .input = input,
                             .splitter = kdr_splitter_for(plan->split),
                             .order = plan->own_order ? plan->own_order : kdr_order_for(plan->order),
                             .share = kdr_share_for(plan->share),
                             .plan = *plan};
    *counts = (kdr_input_counts){0};
    if (input->count > KDR_NODE_MAX_INDEX)
        return KDR_ERROR_LIMIT;
    kdr_workshop_start(shop);

    kdr_build_task root;
    kdr_status status = kdr_build_gather(&state, &root, counts);
    if (status != KDR_OK)
        return status;
    uint32_t count = root.references.count;
    if (state.plan.depth_limit == 0)
        state.plan.depth_limit = 8 + (uint32_t)(1.3 * log2(count > 0 ? count : 1));
    if (state.plan.depth_limit > KDR_MAX_DEPTH)
        state.plan.depth_limit = KDR_MAX_DEPTH;
    status = kdr_build_settle_straddle(&state, &root.references);
    if (count <= state.plan.lazy_limit || input->boxed)
        state.plan.lazy_limit = 0;
    double budget = (double)count * state.plan.reference_limit;
    root.budget = budget < KDR_NODE_MAX_INDEX ? (uint64_t)budget : KDR_NODE_MAX_INDEX;
    state.budget = root.budget;
    if (status == KDR_OK)
        kdr_build_report(&state, KDR_BUILD_GATHERED);

    /* The root is the first node of the first pair; its sibling stays unused. */
    uint32_t pair;
    if (status != KDR_OK || !kdr_grow_pair(&state, &shop->workers[0], &pair)) {
        kdr_bulk_put(shop->bulk, root.memory, root.memory_size);
        kdr_build_release_corners(&state);
        return status != KDR_OK ? status : (kdr_status)atomic_load(&state.status);
    }
    root.node = 2 * pair;
    *kdr_growing_node(shop, root.node) = *kdr_growing_node(shop, root.node + 1) = kdr_node_leaf(0, 0);

    kdr_box bounds = root.box;
    status = open_root(&state, &root);
    kdr_build_release_corners(&state);
    if (status == KDR_OK && plan->retract)
        kdr_build_retract(&state, &bounds);
    kdr_build_report(&state, KDR_BUILD_OPENED);
    if (status == KDR_OK)
        status = (kdr_status)atomic_load(&state.status);
    if (status != KDR_OK)
        return status;
    kdr_tree made = {.bounds = bounds,
                     .boxed = input->boxed,
                     .primitive_count = count,
                     .dropped_count = counts->dropped,
                     .degenerate_count = counts->degenerate,
                     .cost_traversal = plan->cost_traversal,
                     .cost_intersection = plan->cost_intersection,
                     .depth_limit = state.plan.depth_limit,
                     .flat_in_both = plan->split == KDR_SPLIT_SWEEP && plan->events == KDR_EVENTS_TWO,
                     .clipped = state.plan.straddle == KDR_STRADDLE_CLIP};
    status = kdr_build_layout(&state, &made);
    if (status == KDR_OK)
        *tree = made;
    return status;
}
