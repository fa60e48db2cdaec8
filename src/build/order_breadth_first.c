/* Breadth first: one level of the tree after the other, its nodes by all workers at once.
 *
 * There are two lists of tasks, and for each worker two arenas of references: one of this level, one of the next. When
 * a level is done they change places, and the arenas of the level that is done are emptied at once. The children of
 * task i have places 2i and 2i + 1 of the next list, so nothing is shared while a level is opened. Source: "Parallel KD
 * Tree Acceleration Structures for Ray Tracing on Multi-Core Processor", thesis, 2009, section 4.5. Cost: a whole
 * level's references are held at once, and go through the cache once a level. */
#include "build/order.h"

#include "base/primitives.h"
#include "build/share.h"

/* Children's memory: from the worker's arena of the next level, if it is not large. */
static void *give(kdr_build_state *state, kdr_build_worker *worker, uint32_t count, kdr_build_task *child) {
    if (count <= KDR_LOCAL_LIMIT)
        return kdr_arena_get(&worker->levels[1 - state->level], child->memory_size);
    return child->memory = kdr_bulk_get(state->shop->bulk, &child->memory_size);
}

typedef struct level {
    kdr_build_state *state;
    kdr_build_task *tasks, *next;
    bool together; /* large nodes are opened by all workers at once, before the others */
} level;

static bool is_large(const level *l, const kdr_build_task *task) {
    return l->together && task->references.count > KDR_SHARED_LIMIT;
}

static void open_task(const level *l, size_t i, uint32_t worker, bool parallel) {
    kdr_build_task *task = &l->tasks[i], *children = &l->next[2 * i];
    kdr_opened opened = kdr_expand(l->state, &l->state->shop->workers[worker], parallel, task, children);
    kdr_bulk_put(l->state->shop->bulk, task->memory, task->memory_size);
    if (opened != KDR_OPENED_PAIR)
        children[0].references.primitive = children[1].references.primitive = NULL;
}

static void open_range(void *context, size_t begin, size_t end, uint32_t worker) {
    const level *l = context;
    for (size_t i = begin; i < end; i++)
        if (!is_large(l, &l->tasks[i]))
            open_task(l, i, worker, false);
}

/* Opens a level; returns how many tasks the next one has. */
static size_t open_level(level *l, size_t count) {
    kdr_build_state *state = l->state;
    for (size_t i = 0; i < count; i++)
        if (is_large(l, &l->tasks[i]))
            open_task(l, i, 0, true);
    kdr_parallel_for(state->crew, count, 1 + count / 1024, open_range, l);
    size_t next = 0;
    for (size_t i = 0; i < 2 * count; i++)
        if (l->next[i].references.primitive)
            l->next[next++] = l->next[i];
    return next;
}

static void empty_level(kdr_build_state *state, uint32_t which) {
    for (uint32_t w = 0; w < state->shop->worker_count; w++)
        kdr_arena_restore(&state->shop->workers[w].levels[which], (kdr_arena_mark){0});
}

static kdr_status run(kdr_build_state *state, const kdr_build_task *given, uint32_t given_count) {
    kdr_workshop *shop = state->shop;
    level l = {.state = state, .together = state->share->together && state->crew->worker_count > 1};
    const kdr_build_task *tasks = given;
    size_t count = given_count;
    bool memory = kdr_buffer_reserve(shop->alloc, &shop->levels[0], count * sizeof *given);
    if (memory && count > 0) {
        l.tasks = memcpy(shop->levels[0].memory, given, count * sizeof *given);
        tasks = l.tasks;
    }
    for (state->level = 0; count > 0 && memory; state->level ^= 1) {
        uint32_t next = 1 - state->level;
        memory = kdr_buffer_reserve(shop->alloc, &shop->levels[next], 2 * count * sizeof *given);
        if (!memory)
            break;
        l.next = shop->levels[next].memory;
        count = open_level(&l, count);
        tasks = l.tasks = l.next;
        empty_level(state, state->level);
    }
    if (!memory) {
        kdr_build_fail(state, KDR_ERROR_OUT_OF_MEMORY);
        for (size_t i = 0; i < count; i++)
            kdr_bulk_put(shop->bulk, tasks[i].memory, tasks[i].memory_size);
    }
    empty_level(state, 0);
    empty_level(state, 1);
    return (kdr_status)atomic_load(&state->status);
}

const kdr_order kdr_order_breadth_first = {.run = run, .give = give};
