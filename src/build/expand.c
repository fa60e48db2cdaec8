/* Opens one task: chooses a plane, divides the references, makes a leaf or a pair.
 *
 * The same few steps serve small nodes in one worker's arena and the largest ones, whose passes all workers share.
 * Counts are integers and ranges are cut at fixed places, so the tree is the same either way. */
#include "build/splitter.h"

/* One division of a node's references, by one worker or by all. */
typedef struct division {
    const kdr_opening *opening;
    kdr_split split;
    kdr_references to[2];
    kdr_box *boxes[2]; /* a worker */
} division;

static void divide_range(void *context, size_t begin, size_t end, uint32_t worker) {
    division *d = context;
    const kdr_opening *o = d->opening;
    size_t range = begin / KDR_PASS_GRAIN;
    o->state->kernels->divide(&o->task->references, (uint32_t)begin, (uint32_t)end, &d->split, &d->to[0],
                              o->left[range], &d->to[1], o->right[range], &d->boxes[0][worker], &d->boxes[1][worker]);
}

/* Turns counts a range into places. */
static void place(uint32_t *counts, uint32_t ranges) {
    uint32_t sum = 0;
    for (uint32_t i = 0; i < ranges; i++) {
        uint32_t count = counts[i];
        counts[i] = sum;
        sum += count;
    }
}

/* Where no primitive straddles the plane, it moves to the cheaper edge of the gap around it. */
static void move_into_gap(kdr_split *split, const kdr_build_task *task, const kdr_build_task children[2]) {
    uint32_t axis = split->axis, left = children[0].references.count, right = children[1].references.count;
    float edges[2] = {left > 0 ? children[0].box.hi[axis] : split->plane,
                      right > 0 ? children[1].box.lo[axis] : split->plane};
    if (left + right != task->references.count || !(edges[0] < edges[1]))
        return;
    kdr_shares shares = kdr_shares_of(&task->cell);
    double least = INFINITY;
    for (int i = 0; i < 2; i++) {
        double cost = kdr_share(&shares, axis, (double)edges[i] - task->cell.lo[axis]) * left +
                      kdr_share(&shares, axis, (double)task->cell.hi[axis] - edges[i]) * right;
        if (cost < least && edges[i] > task->cell.lo[axis] && edges[i] < task->cell.hi[axis]) {
            least = cost;
            split->plane = edges[i];
        }
    }
}

/* Memory for a child's references: its own for large nodes, the worker's arena for small ones. */
static bool give_memory(kdr_build_state *state, kdr_build_worker *worker, bool local, uint32_t count,
                        kdr_build_task *child) {
    child->memory = NULL;
    child->memory_size = kdr_references_bytes(count > 0 ? count : 1);
    void *memory;
    if (local)
        memory = kdr_arena_get(&worker->arena, child->memory_size);
    else
        memory = child->memory = kdr_bulk_get(state->shop->bulk, &child->memory_size);
    if (memory)
        child->references = kdr_references_in(memory, count);
    return memory != NULL;
}

static kdr_opened make_leaf(kdr_build_state *state, kdr_build_worker *worker, const kdr_build_task *task) {
    uint32_t *ids = kdr_grow_leaf(state, worker, task->node, task->references.count);
    if (!ids)
        return KDR_OPENED_FAILED;
    memcpy(ids, task->references.primitive, task->references.count * sizeof *ids);
    return KDR_OPENED_LEAF;
}

static bool pays(const kdr_build_state *state, uint32_t count, const kdr_split *split) {
    return !state->splitter->weighs || split->cost < kdr_plan_leaf_cost(&state->plan, count);
}

/* True if the counts of a plane speak for it. A plane that does not pay is taken only to break up a leaf that is too
 * large, and only where it separates most of it or cuts off empty space. */
static bool is_worth_it(const kdr_build_state *state, const kdr_build_task *task, const kdr_split *split, uint64_t left,
                        uint64_t right) {
    uint64_t count = task->references.count;
    if ((left == count && right == count) || left + right > task->budget || left > UINT32_MAX || right > UINT32_MAX)
        return false;
    if (pays(state, (uint32_t)count, split))
        return true;
    return count > state->plan.leaf_limit && 2 * (left + right) <= 3 * count;
}

/* The first plane worth taking, axis after axis; leaves the counts of its ranges. */
static bool choose(kdr_opening *opening, kdr_split *split, uint32_t counts[2]) {
    const kdr_build_state *state = opening->state;
    const kdr_build_task *task = opening->task;
    uint32_t sets[3], set_count = kdr_axis_sets(state->plan.axis, &task->cell, task->depth, sets);
    if (state->splitter->begin)
        state->splitter->begin(opening);
    for (uint32_t i = 0; i < set_count; i++) {
        *split = state->splitter->choose(opening, sets[i]);
        bool pointless =
            !pays(state, task->references.count, split) && task->references.count <= state->plan.leaf_limit;
        if (!(split->cost < INFINITY) || pointless)
            continue;

        /* Count first: places are then known, and a plane that separates nothing is found out. */
        uint64_t left, right;
        kdr_opening_count(opening, split, &left, &right);
        if (is_worth_it(state, task, split, left, right)) {
            counts[0] = (uint32_t)left;
            counts[1] = (uint32_t)right;
            return true;
        }
    }
    return false;
}

static kdr_opened divide(kdr_build_state *state, kdr_build_worker *worker, division *d, const uint32_t counts[2],
                         kdr_build_task *task, kdr_build_task children[2]) {
    bool local = task->references.count <= KDR_LOCAL_LIMIT;
    children[0] = children[1] = (kdr_build_task){.cell = task->cell, .depth = task->depth + 1};
    bool memory = give_memory(state, worker, local, counts[0], &children[0]);
    if (!memory || !give_memory(state, worker, local, counts[1], &children[1])) {
        kdr_bulk_put(state->shop->bulk, children[0].memory, children[0].memory_size);
        kdr_build_fail(state, KDR_ERROR_OUT_OF_MEMORY);
        return KDR_OPENED_FAILED;
    }

    /* Send every reference to its side, and find the children's bounds on the way. */
    const kdr_opening *opening = d->opening;
    place(opening->left, opening->range_count);
    place(opening->right, opening->range_count);
    for (int i = 0; i < 2; i++) {
        d->to[i] = children[i].references;
        for (uint32_t w = 0; w < opening->worker_count; w++)
            d->boxes[i][w] = kdr_box_empty();
    }
    kdr_opening_pass(opening, divide_range, d);
    for (int i = 0; i < 2; i++) {
        children[i].box = d->boxes[i][0];
        for (uint32_t w = 1; w < opening->worker_count; w++)
            kdr_box_add(&children[i].box, &d->boxes[i][w]);
    }

    /* Write the node. */
    if (state->splitter->weighs)
        move_into_gap(&d->split, task, children);
    uint32_t axis = d->split.axis, pair;
    uint64_t sum = (uint64_t)counts[0] + counts[1];
    children[0].cell.hi[axis] = children[1].cell.lo[axis] = d->split.plane;
    children[0].budget = (uint64_t)((unsigned __int128)task->budget * counts[0] / sum);
    children[1].budget = task->budget - children[0].budget;
    if (!kdr_grow_interior(state, worker, task->node, axis, d->split.plane, &pair)) {
        for (int i = 0; i < 2; i++)
            kdr_bulk_put(state->shop->bulk, children[i].memory, children[i].memory_size);
        return KDR_OPENED_FAILED;
    }
    children[0].node = 2 * pair;
    children[1].node = 2 * pair + 1;
    return KDR_OPENED_PAIR;
}

kdr_opened kdr_expand(kdr_build_state *state, kdr_build_worker *worker, bool parallel, kdr_build_task *task,
                      kdr_build_task children[2]) {
    uint32_t count = task->references.count;
    if (kdr_build_failed(state))
        return KDR_OPENED_FAILED;
    if (kdr_must_be_leaf(state, count, task->depth))
        return make_leaf(state, worker, task);
    if (count <= state->splitter->finish_limit) {
        state->splitter->finish(state, worker, task);
        return KDR_OPENED_LEAF;
    }

    /* One range and one worker need no memory but this. */
    kdr_split_scratch scratch;
    kdr_box boxes[2];
    uint32_t places[2];
    kdr_opening o = {.state = state,
                     .task = task,
                     .parallel = parallel,
                     .worker_count = parallel ? state->shop->worker_count : 1,
                     .range_count = (count + KDR_PASS_GRAIN - 1) / KDR_PASS_GRAIN,
                     .scratch = &scratch,
                     .left = &places[0],
                     .right = &places[1]};
    division d = {.opening = &o, .boxes = {&boxes[0], &boxes[1]}};
    kdr_arena_mark mark = kdr_arena_save(&worker->arena);
    bool arena = o.range_count > 1 || o.worker_count > 1;
    if (arena) {
        o.scratch = kdr_arena_get(&worker->arena, o.worker_count * sizeof *o.scratch);
        d.boxes[0] = kdr_arena_get(&worker->arena, o.worker_count * sizeof *d.boxes[0]);
        d.boxes[1] = kdr_arena_get(&worker->arena, o.worker_count * sizeof *d.boxes[1]);
        o.left = kdr_arena_get(&worker->arena, o.range_count * sizeof *o.left);
        o.right = kdr_arena_get(&worker->arena, o.range_count * sizeof *o.right);
        if (!o.scratch || !d.boxes[0] || !d.boxes[1] || !o.left || !o.right) {
            kdr_build_fail(state, KDR_ERROR_OUT_OF_MEMORY);
            kdr_arena_restore(&worker->arena, mark);
            return KDR_OPENED_FAILED;
        }
    }

    uint32_t counts[2];
    kdr_opened opened;
    if (choose(&o, &d.split, counts))
        opened = divide(state, worker, &d, counts, task, children);
    else
        opened = make_leaf(state, worker, task);
    if (arena)
        kdr_arena_restore(&worker->arena, mark);
    return opened;
}
