/* Opens one task: chooses a plane, divides the references, makes a leaf or a pair.
 *
 * The same few steps serve small nodes in one worker's arena and the largest ones, whose passes all workers share.
 * Counts are integers and ranges are cut at fixed places, so the tree is the same either way. */
#include "build/work.h"

#include "base/primitives.h"

#define PASS_GRAIN 8192

/* One pass over a task's references, by one worker or by all. */
typedef struct pass {
    const kdr_build_state *state;
    const kdr_build_task *task;
    kdr_split split;
    kdr_bin_grid grid;
    uint32_t step;
    kdr_bins *bins;         /* a worker */
    uint32_t *left, *right; /* a range: counts, then places */
    kdr_references to[2];
    kdr_box *boxes[2]; /* a worker */
} pass;

static void bin_range(void *context, size_t begin, size_t end, uint32_t worker) {
    pass *p = context;
    /* Every step-th of the whole node, wherever the range begins. */
    size_t first = (begin + p->step - 1) / p->step * p->step;
    kdr_bins_add(&p->bins[worker], &p->grid, &p->task->references, (uint32_t)first, (uint32_t)end, p->step);
}

static void count_range(void *context, size_t begin, size_t end, uint32_t worker) {
    (void)worker;
    pass *p = context;
    size_t range = begin / PASS_GRAIN;
    p->state->kernels->count(&p->task->references, (uint32_t)begin, (uint32_t)end, &p->split, &p->left[range],
                             &p->right[range]);
}

static void divide_range(void *context, size_t begin, size_t end, uint32_t worker) {
    pass *p = context;
    size_t range = begin / PASS_GRAIN;
    p->state->kernels->divide(&p->task->references, (uint32_t)begin, (uint32_t)end, &p->split, &p->to[0],
                              p->left[range], &p->to[1], p->right[range], &p->boxes[0][worker], &p->boxes[1][worker]);
}

static void run(pass *p, bool parallel, kdr_range_fn *fn) {
    uint32_t count = p->task->references.count;
    if (parallel) {
        kdr_parallel_for(p->state->crew, count, PASS_GRAIN, fn, p);
        return;
    }
    for (uint32_t begin = 0; begin < count; begin += PASS_GRAIN)
        fn(p, begin, count - begin < PASS_GRAIN ? count : begin + PASS_GRAIN, 0);
}

static kdr_split choose(pass *p, bool parallel) {
    const kdr_build_task *task = p->task;
    uint32_t workers = parallel ? p->state->shop->worker_count : 1;
    p->step = kdr_bins_step(task->references.count);
    p->grid = kdr_bin_grid_of(&task->box);
    memset(p->bins, 0, workers * sizeof *p->bins);
    run(p, parallel, bin_range);
    for (uint32_t i = 1; i < workers; i++)
        kdr_bins_merge(&p->bins[0], &p->bins[i]);
    return p->state->kernels->choose_binned(&p->bins[0], &p->grid, task->references.count, &task->box, &task->cell,
                                            &p->state->plan);
}

/* Turns counts a range into places and returns the sum. */
static uint64_t place(uint32_t *counts, uint32_t ranges) {
    uint64_t sum = 0;
    for (uint32_t i = 0; i < ranges; i++) {
        uint32_t count = counts[i];
        counts[i] = (uint32_t)sum;
        sum += count;
    }
    return sum;
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

/* True if the counts of a plane speak for it. A plane that does not pay is taken only to break up a leaf that is too
 * large, and only where it separates most of it or cuts off empty space. */
static bool is_worth_it(const kdr_build_state *state, const kdr_build_task *task, const kdr_split *split, uint64_t left,
                        uint64_t right) {
    uint64_t count = task->references.count;
    if ((left == count && right == count) || left + right > task->budget || left > UINT32_MAX || right > UINT32_MAX)
        return false;
    if (split->cost < kdr_plan_leaf_cost(&state->plan, (uint32_t)count))
        return true;
    return count > state->plan.leaf_limit && 2 * (left + right) <= 3 * count;
}

static kdr_opened divide(kdr_build_state *state, kdr_build_worker *worker, bool parallel, pass *p, kdr_build_task *task,
                         kdr_build_task children[2]) {
    /* Count first: places are then known, and a plane that separates nothing is found out. */
    uint32_t ranges = (task->references.count + PASS_GRAIN - 1) / PASS_GRAIN;
    run(p, parallel, count_range);
    uint64_t left = place(p->left, ranges), right = place(p->right, ranges);
    if (!is_worth_it(state, task, &p->split, left, right))
        return make_leaf(state, worker, task);

    bool local = task->references.count <= KDR_LOCAL_LIMIT;
    children[0] = children[1] = (kdr_build_task){.cell = task->cell, .depth = task->depth + 1};
    bool memory = give_memory(state, worker, local, (uint32_t)left, &children[0]);
    if (!memory || !give_memory(state, worker, local, (uint32_t)right, &children[1])) {
        kdr_bulk_put(state->shop->bulk, children[0].memory, children[0].memory_size);
        kdr_build_fail(state, KDR_ERROR_OUT_OF_MEMORY);
        return KDR_OPENED_FAILED;
    }

    /* Send every reference to its side, and find the children's bounds on the way. */
    uint32_t workers = parallel ? state->shop->worker_count : 1;
    for (int i = 0; i < 2; i++) {
        p->to[i] = children[i].references;
        for (uint32_t w = 0; w < workers; w++)
            p->boxes[i][w] = kdr_box_empty();
    }
    run(p, parallel, divide_range);
    for (int i = 0; i < 2; i++) {
        children[i].box = p->boxes[i][0];
        for (uint32_t w = 1; w < workers; w++)
            kdr_box_add(&children[i].box, &p->boxes[i][w]);
    }

    /* Write the node. */
    move_into_gap(&p->split, task, children);
    uint32_t axis = p->split.axis, pair;
    children[0].cell.hi[axis] = children[1].cell.lo[axis] = p->split.plane;
    children[0].budget = (uint64_t)((unsigned __int128)task->budget * left / (left + right));
    children[1].budget = task->budget - children[0].budget;
    if (!kdr_grow_interior(state, worker, task->node, axis, p->split.plane, &pair)) {
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
    if (kdr_must_be_leaf(&state->plan, count, task->depth))
        return make_leaf(state, worker, task);
    if (count <= KDR_MASK_LIMIT) {
        kdr_expand_masked(state, worker, task);
        return KDR_OPENED_LEAF;
    }

    /* One range and one worker need no memory but this. */
    kdr_bins bins;
    kdr_box boxes[2];
    uint32_t places[2];
    pass p = {.state = state,
              .task = task,
              .bins = &bins,
              .left = &places[0],
              .right = &places[1],
              .boxes = {&boxes[0], &boxes[1]}};
    uint32_t ranges = (count + PASS_GRAIN - 1) / PASS_GRAIN, workers = parallel ? state->shop->worker_count : 1;
    kdr_arena_mark mark = kdr_arena_save(&worker->arena);
    bool arena = ranges > 1 || workers > 1;
    if (arena) {
        p.bins = kdr_arena_get(&worker->arena, workers * sizeof *p.bins);
        p.boxes[0] = kdr_arena_get(&worker->arena, workers * sizeof *p.boxes[0]);
        p.boxes[1] = kdr_arena_get(&worker->arena, workers * sizeof *p.boxes[1]);
        p.left = kdr_arena_get(&worker->arena, ranges * sizeof *p.left);
        p.right = kdr_arena_get(&worker->arena, ranges * sizeof *p.right);
        if (!p.bins || !p.boxes[0] || !p.boxes[1] || !p.left || !p.right) {
            kdr_build_fail(state, KDR_ERROR_OUT_OF_MEMORY);
            kdr_arena_restore(&worker->arena, mark);
            return KDR_OPENED_FAILED;
        }
    }

    p.split = choose(&p, parallel);
    bool pays = p.split.cost < kdr_plan_leaf_cost(&state->plan, count);
    kdr_opened opened;
    if (!(p.split.cost < INFINITY) || (!pays && count <= state->plan.leaf_limit))
        opened = make_leaf(state, worker, task);
    else
        opened = divide(state, worker, parallel, &p, task, children);
    if (arena)
        kdr_arena_restore(&worker->arena, mark);
    return opened;
}
