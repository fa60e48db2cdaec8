/* The hinge: opens one task, chooses a plane, and makes a leaf or a pair. It knows neither order nor workers. */
#include "build/order.h"
#include "build/splitter.h"

static kdr_opened make_leaf(kdr_build_state *state, kdr_build_worker *worker, const kdr_build_task *task) {
    uint32_t *ids = kdr_grow_leaf(state, worker, task->node, task->references.count);
    if (!ids)
        return KDR_OPENED_FAILED;
    memcpy(ids, task->references.primitive, task->references.count * sizeof *ids);
    kdr_build_finished(state, worker, task);
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

/* The first plane worth taking, axis after axis; it is the one that was counted last. */
static bool choose(kdr_opening *opening, kdr_split *split, uint64_t *left, uint64_t *right) {
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
        kdr_opening_count(opening, split, left, right);
        if (is_worth_it(state, task, split, *left, *right))
            return true;
    }
    return false;
}

kdr_opened kdr_expand(kdr_build_state *state, kdr_build_worker *worker, bool parallel, kdr_build_task *task,
                      kdr_build_task children[2]) {
    const kdr_splitter *splitter = state->splitter;
    uint32_t count = task->references.count;
    if (kdr_build_failed(state))
        return KDR_OPENED_FAILED;
    if (kdr_must_be_leaf(state, count, task->depth))
        return make_leaf(state, worker, task);
    if (count <= splitter->finish_limit) {
        splitter->finish(state, worker, task);
        kdr_build_finished(state, worker, task);
        return KDR_OPENED_LEAF;
    }
    if (count > KDR_SHARED_LIMIT)
        kdr_build_report_opening(state);
    if (splitter->prepare && !task->events && !splitter->prepare(state, worker, parallel, task)) {
        kdr_build_fail(state, KDR_ERROR_OUT_OF_MEMORY);
        return KDR_OPENED_FAILED;
    }

    kdr_opening o;
    kdr_split split;
    uint64_t left, right;
    if (!kdr_opening_begin(&o, state, worker, parallel, task))
        return KDR_OPENED_FAILED;
    kdr_opened opened;
    if (!choose(&o, &split, &left, &right))
        opened = make_leaf(state, worker, task);
    else if (kdr_opening_divide(&o, &split, left, right, splitter->weighs, children))
        opened = KDR_OPENED_PAIR;
    else
        opened = KDR_OPENED_FAILED;
    kdr_opening_end(&o);
    return opened;
}
