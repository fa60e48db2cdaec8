/* Depth first: the left child goes on, right children wait on a stack, or go to the pool, where other workers take
 * them.
 *
 * References of a node of at most KDR_LOCAL_LIMIT live in one worker's arena, which is a stack: its subtree is opened
 * by this worker alone, and memory goes back in the reverse order of its taking.
 * Sources: M. Shevtsov, A. Soupikov, A. Kapustin, "Highly Parallel Fast KD-tree Construction for Interactive Ray
 * Tracing of Dynamic Scenes", 2007: the bounded pool of tasks (section 4.1), memory by chunks (3.5); "Parallel KD Tree
 * Acceleration Structures for Ray Tracing on Multi-Core Processor", thesis, 2009, section 4.4: the left child takes its
 * parent's place in one array, right children are pushed on another. */
#include "base/check.h"
#include "build/closing.h"
#include "build/order.h"
#include "build/share.h"

#define TOP_TASKS 256    /* at most so many tasks wait before the pool starts */
#define OFFER_LIMIT 2048 /* smaller nodes are not worth handing over */

static void *give(kdr_build_state *state, kdr_build_worker *worker, uint32_t count, kdr_build_task *child) {
    if (count <= KDR_LOCAL_LIMIT)
        return kdr_arena_get(&worker->arena, child->memory_size);
    return child->memory = kdr_bulk_get(state->shop->bulk, &child->memory_size);
}

/* Opens a task and all that comes of it. */
static void open_all(kdr_build_state *state, kdr_pool *pool, uint32_t worker, kdr_build_task task) {
    kdr_build_worker *w = &state->shop->workers[worker];
    for (;;) {
        kdr_build_task children[2];
        kdr_arena_mark mark = kdr_arena_save(&w->arena);
        if (kdr_stays_closed(state, task.references.count)) {
            kdr_close(state, w, &task);
            kdr_bulk_put(state->shop->bulk, task.memory, task.memory_size);
            return;
        }
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
        bool large = children[1].references.count >= OFFER_LIMIT && state->share->hands_over;
        if (!large || !kdr_pool_offer(pool, &children[1]))
            open_all(state, pool, worker, children[1]);
        task = children[0];
    }
}

void kdr_open_alone(kdr_build_state *state, kdr_build_worker *worker, const kdr_build_task *task) {
    KDR_CHECK(!state->share->hands_over && task->references.count <= KDR_LOCAL_LIMIT);
    open_all(state, NULL, (uint32_t)(worker - state->shop->workers), *task);
}

static void run_task(kdr_pool *pool, void *task, uint32_t worker, void *context) {
    kdr_build_task copy;
    memcpy(&copy, task, sizeof copy);
    open_all(context, pool, worker, copy);
}

/* Opens the largest nodes one after the other, all workers on each, until what is left can be handed out. Returns how
 * many tasks there are then; there is room for one more than TOP_TASKS. */
static uint32_t open_top(kdr_build_state *state, kdr_build_task *tasks, uint32_t count) {
    kdr_build_worker *w = &state->shop->workers[0];
    for (uint32_t next = 0; next < count && count < TOP_TASKS;) {
        if (tasks[next].references.count <= KDR_SHARED_LIMIT) {
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
    return count;
}

static kdr_status run(kdr_build_state *state, const kdr_build_task *given, uint32_t count) {
    kdr_arena *arena = &state->shop->workers[0].arena;
    kdr_arena_mark mark = kdr_arena_save(arena);
    kdr_build_task *tasks = kdr_arena_get(arena, (count + TOP_TASKS + 1) * sizeof *tasks);
    void *room = kdr_arena_get(arena, kdr_pool_bytes());
    kdr_status status = KDR_ERROR_OUT_OF_MEMORY;
    if (tasks && room) {
        memcpy(tasks, given, count * sizeof *tasks);
        if (state->share->together && state->crew->worker_count > 1)
            count = open_top(state, tasks, count);
        given = tasks;
        kdr_pool_run_in(room, state->crew, tasks, count, run_task, state);
        status = KDR_OK;
    }
    if (status != KDR_OK)
        for (uint32_t i = 0; i < count; i++)
            kdr_bulk_put(state->shop->bulk, given[i].memory, given[i].memory_size);
    kdr_arena_restore(arena, mark);
    return status != KDR_OK ? status : (kdr_status)atomic_load(&state->status);
}

const kdr_order kdr_order_depth_first = {.run = run, .give = give};
