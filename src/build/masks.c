/* Small nodes by bit masks: exact surface area heuristic without sorting or moving anything.
 *
 * A node of at most 32 primitives makes, once, for every begin and end of a box on every axis the set of primitives to
 * its left and to its right. From then on a node is one 32-bit set: the counts of a plane are two ANDs and two
 * population counts, a split is two ANDs. This takes the place of the sorted exact candidates of section 3.4 of the
 * 2007 paper. Cost: 192 planes a node, KDR_LANES at a time. */
#include "build/splitter.h"

typedef struct masked_node {
    uint32_t set, node, depth;
    kdr_box cell;
    uint64_t budget;
} masked_node;

typedef struct masking {
    kdr_build_state *state;
    kdr_build_worker *worker;
    const kdr_references *references;
    kdr_mask_table table;
} masking;

static void make_leaf(const masking *m, const masked_node *at) {
    uint32_t *ids = kdr_grow_leaf(m->state, m->worker, at->node, (uint32_t)__builtin_popcount(at->set));
    if (!ids)
        return;
    for (uint32_t set = at->set; set; set &= set - 1)
        *ids++ = m->references->primitive[__builtin_ctz(set)];
}

/* Makes a leaf, or a pair and goes on with both. Recursion is bounded by the depth limit. */
static void open_masked(const masking *m, const masked_node *at) {
    const kdr_plan *plan = &m->state->plan;
    uint32_t count = (uint32_t)__builtin_popcount(at->set);
    if (kdr_must_be_leaf(m->state, count, at->depth)) {
        make_leaf(m, at);
        return;
    }

    /* The first plane worth taking, axis after axis. */
    uint32_t sets[3], set_count = kdr_axis_sets(plan->axis, &at->cell, at->depth, sets);
    uint32_t left_set = 0, right_set = 0, left_count = 0, right_count = 0;
    bool found = false;
    kdr_split split;
    for (uint32_t i = 0; i < set_count && !found; i++) {
        split = m->state->kernels->choose_masked(&m->table, at->set, &at->cell, plan, sets[i], &left_set, &right_set);
        if (!(split.cost < INFINITY))
            continue;
        left_count = (uint32_t)__builtin_popcount(left_set);
        right_count = (uint32_t)__builtin_popcount(right_set);
        bool pays = split.cost < kdr_plan_leaf_cost(plan, count);
        bool forced = count > plan->leaf_limit;
        bool separates = left_count < count || right_count < count;
        found = (pays || forced) && separates && left_count + right_count <= at->budget;
    }
    if (!found) {
        make_leaf(m, at);
        return;
    }

    uint32_t pair;
    if (!kdr_grow_interior(m->state, m->worker, at->node, split.axis, split.plane, &pair))
        return;
    uint64_t left_budget = at->budget * left_count / (left_count + right_count);
    masked_node left = {left_set, 2 * pair, at->depth + 1, at->cell, left_budget};
    masked_node right = {right_set, 2 * pair + 1, at->depth + 1, at->cell, at->budget - left_budget};
    left.cell.hi[split.axis] = right.cell.lo[split.axis] = split.plane;
    open_masked(m, &left);
    open_masked(m, &right);
}

void kdr_expand_masked(kdr_build_state *state, kdr_build_worker *worker, const kdr_build_task *task) {
    uint32_t count = task->references.count;
    masking m = {.state = state, .worker = worker, .references = &task->references};
    masked_node root = {count == 32 ? UINT32_MAX : (1u << count) - 1, task->node, task->depth, task->cell,
                        task->budget};
    if (!kdr_must_be_leaf(state, count, task->depth))
        state->kernels->masks(&task->references, &m.table);
    open_masked(&m, &root);
}
