/* The whole build: gather, open the large nodes with all workers, hand the rest out as tasks, lay the tree out.
 *
 * Source: M. Shevtsov, A. Soupikov, A. Kapustin, "Highly Parallel Fast KD-tree Construction for Interactive Ray Tracing
 * of Dynamic Scenes", 2007: the bounded pool of tasks (section 4.1), the right child to the pool and the left one kept,
 * per-worker memory (3.5). Instead of clusters cut at medians, the top of the tree is split by the heuristic like the
 * rest, each pass shared by all workers.
 * Cost: O(N log N) with small constants: 28 bytes read and about as many written a reference and level. */
#include "build/builder.h"

#include "base/check.h"
#include "build/splitter.h"

#include <math.h>

#define ARENA_CHUNK ((size_t)1 << 20)
#define SHARED_LIMIT 65536 /* larger nodes are opened by all workers together */
#define TOP_TASKS 256      /* at most so many tasks wait before the pool starts */
#define OFFER_LIMIT 2048   /* smaller nodes are not worth handing over */

kdr_workshop *kdr_workshop_create(kdr_alloc *alloc, kdr_bulk *bulk, uint32_t worker_count) {
    kdr_workshop *shop = kdr_alloc_get(alloc, sizeof *shop, 64);
    if (!shop)
        return NULL;
    *shop = (kdr_workshop){.alloc = alloc, .bulk = bulk, .worker_count = worker_count};
    shop->workers = kdr_alloc_array(alloc, worker_count, sizeof *shop->workers, 128);
    bool pairs = kdr_chunks_init(&shop->pairs, alloc, 2 * KDR_PAIRS_PER_CHUNK * sizeof(kdr_node),
                                 (KDR_NODE_MAX_INDEX + 1) / KDR_PAIRS_PER_CHUNK);
    bool ids = kdr_chunks_init(&shop->ids, alloc, KDR_IDS_PER_CHUNK * sizeof(uint32_t),
                               (KDR_NODE_MAX_INDEX + 1) / KDR_IDS_PER_CHUNK);
    for (uint32_t i = 0; shop->workers && i < worker_count; i++) {
        shop->workers[i] = (kdr_build_worker){0};
        kdr_arena_init(&shop->workers[i].arena, alloc, ARENA_CHUNK);
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
    for (uint32_t i = 0; shop->workers && i < shop->worker_count; i++)
        kdr_arena_destroy(&shop->workers[i].arena);
    kdr_alloc_release(alloc, shop->workers, shop->worker_count * sizeof *shop->workers);
    kdr_chunks_release(&shop->pairs, alloc);
    kdr_chunks_release(&shop->ids, alloc);
    kdr_buffer_release(alloc, &shop->layout);
    kdr_alloc_release(alloc, shop, sizeof *shop);
}

_Static_assert(sizeof(kdr_build_task) == KDR_TASK_BYTES, "the pool copies whole tasks");

void kdr_workshop_trim(kdr_workshop *shop) {
    for (uint32_t i = 0; i < shop->worker_count; i++) {
        kdr_arena_destroy(&shop->workers[i].arena);
        kdr_arena_init(&shop->workers[i].arena, shop->alloc, ARENA_CHUNK);
    }
    kdr_chunks_trim(&shop->pairs, shop->alloc);
    kdr_chunks_trim(&shop->ids, shop->alloc);
    kdr_buffer_release(shop->alloc, &shop->layout);
}

/* Opens a task and all that comes of it; right children go to the pool while it takes them. */
static void open_all(kdr_build_state *state, kdr_pool *pool, uint32_t worker, kdr_build_task task) {
    kdr_build_worker *w = &state->shop->workers[worker];
    for (;;) {
        kdr_build_task children[2];
        kdr_arena_mark mark = kdr_arena_save(&w->arena);
        kdr_opened opened = kdr_expand(state, w, false, &task, children);
        kdr_bulk_put(state->shop->bulk, task.memory, task.memory_size);
        if (opened != KDR_OPENED_PAIR) {
            kdr_arena_restore(&w->arena, mark);
            return;
        }

        /* Children in the arena are opened here; the arena gives them back together. */
        if (!children[0].memory) {
            open_all(state, pool, worker, children[0]);
            open_all(state, pool, worker, children[1]);
            kdr_arena_restore(&w->arena, mark);
            return;
        }
        bool large = children[1].references.count >= OFFER_LIMIT;
        if (!large || !kdr_pool_offer(pool, &children[1]))
            open_all(state, pool, worker, children[1]);
        task = children[0];
    }
}

static void run_task(kdr_pool *pool, void *task, uint32_t worker, void *context) {
    kdr_build_task copy;
    memcpy(&copy, task, sizeof copy);
    open_all(context, pool, worker, copy);
}

/* Opens the largest nodes one after the other, all workers on each, until what is left can be handed out. */
static kdr_status open_top(kdr_build_state *state, const kdr_build_task *root) {
    kdr_build_worker *w = &state->shop->workers[0];
    kdr_arena_mark mark = kdr_arena_save(&w->arena);
    kdr_build_task *tasks = kdr_arena_get(&w->arena, (TOP_TASKS + 1) * sizeof *tasks);
    if (!tasks) {
        kdr_bulk_put(state->shop->bulk, root->memory, root->memory_size);
        return KDR_ERROR_OUT_OF_MEMORY;
    }
    uint32_t count = 0, next = 0;
    tasks[count++] = *root;
    bool parallel = state->crew->worker_count > 1;
    while (parallel && next < count && count < TOP_TASKS) {
        if (tasks[next].references.count <= SHARED_LIMIT) {
            next++;
            continue;
        }
        kdr_build_task task = tasks[next], children[2];
        kdr_opened opened = kdr_expand(state, w, true, &task, children);
        kdr_bulk_put(state->shop->bulk, task.memory, task.memory_size);
        if (opened == KDR_OPENED_PAIR) {
            tasks[next] = children[0];
            tasks[count++] = children[1];
        } else {
            tasks[next] = tasks[--count];
        }
    }
    kdr_status status = kdr_pool_run(state->crew, state->shop->alloc, tasks, count, run_task, state);
    if (status != KDR_OK)
        for (uint32_t i = 0; i < count; i++)
            kdr_bulk_put(state->shop->bulk, tasks[i].memory, tasks[i].memory_size);
    kdr_arena_restore(&w->arena, mark);
    return status != KDR_OK ? status : (kdr_status)atomic_load(&state->status);
}

static void start_over(kdr_workshop *shop) {
    kdr_chunks_reset(&shop->pairs, shop->alloc);
    kdr_chunks_reset(&shop->ids, shop->alloc);
    for (uint32_t i = 0; i < shop->worker_count; i++) {
        kdr_build_worker *w = &shop->workers[i];
        w->pair = w->pair_end = w->id = w->id_end = 0;
        w->interiors = w->leaf_groups = w->leaves = 0;
    }
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
                             .plan = *plan};
    *counts = (kdr_input_counts){0};
    if (input->count > KDR_NODE_MAX_INDEX)
        return KDR_ERROR_LIMIT;
    start_over(shop);

    kdr_build_task root;
    kdr_status status = kdr_build_gather(&state, &root, counts);
    if (status != KDR_OK)
        return status;
    uint32_t count = root.references.count;
    if (state.plan.depth_limit == 0)
        state.plan.depth_limit = 8 + (uint32_t)(1.3 * log2(count > 0 ? count : 1));
    if (state.plan.depth_limit > KDR_MAX_DEPTH)
        state.plan.depth_limit = KDR_MAX_DEPTH;
    double budget = (double)count * state.plan.reference_limit;
    root.budget = budget < KDR_NODE_MAX_INDEX ? (uint64_t)budget : KDR_NODE_MAX_INDEX;

    /* The root is the first node of the first pair; its sibling stays unused. */
    uint32_t pair;
    if (!kdr_grow_pair(&state, &shop->workers[0], &pair)) {
        kdr_bulk_put(shop->bulk, root.memory, root.memory_size);
        return (kdr_status)atomic_load(&state.status);
    }
    root.node = 2 * pair;
    *kdr_growing_node(shop, root.node) = *kdr_growing_node(shop, root.node + 1) = kdr_node_leaf(0, 0);

    kdr_box bounds = root.box;
    status = open_top(&state, &root);
    if (status != KDR_OK)
        return status;
    kdr_tree made = {.bounds = bounds,
                     .boxed = input->boxed,
                     .primitive_count = count,
                     .dropped_count = counts->dropped,
                     .degenerate_count = counts->degenerate,
                     .cost_traversal = plan->cost_traversal,
                     .cost_intersection = plan->cost_intersection,
                     .depth_limit = state.plan.depth_limit};
    status = kdr_build_layout(&state, &made);
    if (status == KDR_OK)
        *tree = made;
    return status;
}
