#include "build/opening.h"

#include "build/order.h"
#include "build/splitter.h"

bool kdr_opening_begin(kdr_opening *o, kdr_build_state *state, kdr_build_worker *worker, bool parallel,
                       const kdr_build_task *task) {
    o->state = state;
    o->worker = worker;
    o->task = task;
    o->parallel = parallel;
    o->owned = false;
    o->worker_count = parallel ? state->shop->worker_count : 1;
    o->range_count = (task->references.count + KDR_PASS_GRAIN - 1) / KDR_PASS_GRAIN;
    o->borrows = o->range_count > 1 || o->worker_count > 1;
    o->scratch = &o->own_scratch;
    o->left = &o->own_places[0];
    o->right = &o->own_places[1];
    for (int i = 0; i < 2; i++)
        o->boxes[i] = &o->own_boxes[i];
    if (!o->borrows)
        return true;
    kdr_arena *arena = &worker->arena;
    o->mark = kdr_arena_save(arena);
    o->scratch = kdr_arena_get(arena, o->worker_count * sizeof *o->scratch);
    o->left = kdr_arena_get(arena, o->range_count * sizeof *o->left);
    o->right = kdr_arena_get(arena, o->range_count * sizeof *o->right);
    for (int i = 0; i < 2; i++)
        o->boxes[i] = kdr_arena_get(arena, o->worker_count * sizeof *o->boxes[i]);
    if (o->scratch && o->left && o->right && o->boxes[0] && o->boxes[1])
        return true;
    kdr_build_fail(state, KDR_ERROR_OUT_OF_MEMORY);
    kdr_opening_end(o);
    return false;
}

void kdr_opening_end(kdr_opening *o) {
    if (o->borrows)
        kdr_arena_restore(&o->worker->arena, o->mark);
}

void kdr_opening_pass(const kdr_opening *o, kdr_range_fn *fn, void *context) {
    uint32_t count = o->task->references.count;
    if (o->parallel) {
        kdr_parallel_for(o->state->crew, count, KDR_PASS_GRAIN, fn, context);
        return;
    }
    for (uint32_t begin = 0; begin < count; begin += KDR_PASS_GRAIN)
        fn(context, begin, count - begin < KDR_PASS_GRAIN ? count : begin + KDR_PASS_GRAIN, 0);
}

typedef struct counting {
    const kdr_opening *opening;
    const kdr_split *split;
} counting;

static void count_range(void *context, size_t begin, size_t end, uint32_t worker) {
    (void)worker;
    const counting *c = context;
    const kdr_opening *o = c->opening;
    size_t range = begin / KDR_PASS_GRAIN;
    o->state->kernels->count(&o->task->references, (uint32_t)begin, (uint32_t)end, c->split, &o->left[range],
                             &o->right[range]);
}

void kdr_opening_count(const kdr_opening *o, const kdr_split *split, uint64_t *left, uint64_t *right) {
    counting c = {o, split};
    kdr_opening_pass(o, count_range, &c);
    *left = *right = 0;
    for (uint32_t i = 0; i < o->range_count; i++) {
        *left += o->left[i];
        *right += o->right[i];
    }
}

typedef struct division {
    const kdr_opening *opening;
    const kdr_split *split;
    kdr_references to[2];
} division;

static void divide_range(void *context, size_t begin, size_t end, uint32_t worker) {
    const division *d = context;
    const kdr_opening *o = d->opening;
    size_t range = begin / KDR_PASS_GRAIN;
    o->state->kernels->divide(&o->task->references, (uint32_t)begin, (uint32_t)end, d->split, o->state->corners,
                              &d->to[0], o->left[range], &d->to[1], o->right[range], &o->boxes[0][worker],
                              &o->boxes[1][worker]);
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

/* Sends every reference to its side, and finds the children's bounds on the way. */
static void divide_references(const kdr_opening *o, const kdr_split *split, kdr_build_task children[2]) {
    place(o->left, o->range_count);
    place(o->right, o->range_count);
    for (uint32_t w = 0; w < o->worker_count; w++)
        o->boxes[0][w] = o->boxes[1][w] = kdr_box_empty();
    division d = {o, split, {children[0].references, children[1].references}};
    kdr_opening_pass(o, divide_range, &d);
    for (int i = 0; i < 2; i++) {
        children[i].box = o->boxes[i][0];
        for (uint32_t w = 1; w < o->worker_count; w++)
            kdr_box_add(&children[i].box, &o->boxes[i][w]);
    }
}

/* Where no primitive straddles the plane, it moves to the cheaper edge of the gap around it. */
static void move_into_gap(kdr_split *split, const kdr_build_task *task, const kdr_build_task children[2]) {
    uint32_t axis = split->axis, left = children[0].references.count, right = children[1].references.count;
    float edges[2] = {left > 0 ? children[0].box.hi[axis] : split->plane,
                      right > 0 ? children[1].box.lo[axis] : split->plane};
    if (left + right != task->references.count || !(edges[0] < edges[1]))
        return;
    kdr_fractions fractions = kdr_fractions_of(&task->cell);
    double least = INFINITY;
    for (int i = 0; i < 2; i++) {
        double cost = kdr_fraction(&fractions, axis, (double)edges[i] - task->cell.lo[axis]) * left +
                      kdr_fraction(&fractions, axis, (double)task->cell.hi[axis] - edges[i]) * right;
        if (cost < least && edges[i] > task->cell.lo[axis] && edges[i] < task->cell.hi[axis]) {
            least = cost;
            split->plane = edges[i];
        }
    }
}

/* Memory for what a child gets: its references, and behind them what the splitter keeps about them. */
static bool give_memory(const kdr_opening *o, uint32_t count, kdr_build_task *child) {
    const kdr_splitter *splitter = o->state->splitter;
    bool events = o->task->events != NULL;
    size_t bytes = kdr_references_bytes(count > 0 ? count : 1);
    child->memory_size = bytes + (events ? splitter->event_bytes(count) : 0);
    char *memory;
    if (o->owned)
        memory = child->memory = kdr_bulk_get(o->state->shop->bulk, &child->memory_size);
    else
        memory = o->state->order->give(o->state, o->worker, o->task->references.count, child);
    if (!memory)
        return false;
    child->references = kdr_references_in(memory, count);
    child->events = events ? memory + bytes : NULL;
    return true;
}

static bool fail(kdr_opening *o, kdr_build_task children[2]) {
    for (int i = 0; i < 2; i++)
        kdr_bulk_put(o->state->shop->bulk, children[i].memory, children[i].memory_size);
    kdr_build_fail(o->state, KDR_ERROR_OUT_OF_MEMORY);
    return false;
}

bool kdr_opening_divide(kdr_opening *o, const kdr_split *given, uint64_t left, uint64_t right, bool weighed,
                        kdr_build_task children[2]) {
    const kdr_build_task *task = o->task;
    kdr_build_state *state = o->state;
    kdr_split split = *given;
    children[0] = children[1] = (kdr_build_task){.cell = task->cell, .depth = task->depth + 1};
    if (!give_memory(o, (uint32_t)left, &children[0]) || !give_memory(o, (uint32_t)right, &children[1]))
        return fail(o, children);
    divide_references(o, &split, children);
    if (weighed)
        move_into_gap(&split, task, children);
    children[0].cell.hi[split.axis] = children[1].cell.lo[split.axis] = split.plane;
    if (task->events && !state->splitter->divide(o, given, children))
        return fail(o, children);

    /* Write the node. */
    uint32_t pair;
    children[0].budget = (uint64_t)((unsigned __int128)task->budget * left / (left + right));
    children[1].budget = task->budget - children[0].budget;
    if (!kdr_grow_interior(state, o->worker, task->node, split.axis, split.plane, &pair))
        return fail(o, children);
    children[0].node = 2 * pair;
    children[1].node = 2 * pair + 1;
    return true;
}
