/* Where a node is cut: a row of functions for each rule, called once a node. The hinge knows the rows by this alone. */
#ifndef KDR_BUILD_SPLITTER_H
#define KDR_BUILD_SPLITTER_H

#include "build/opening.h"

typedef struct kdr_splitter {
    /* Planes are weighed by the surface area heuristic: a node is a leaf where none pays, and a plane moves to the edge
     * of a gap. Otherwise a node is a leaf at the leaf limit, and planes stay where they are. */
    bool weighs;

    /* Nodes of at most so many references become whole subtrees by finish; 0 and NULL: none do. */
    uint32_t finish_limit;
    void (*finish)(kdr_build_state *state, kdr_build_worker *worker, const kdr_build_task *task);

    /* What is kept about a node's references, in the memory behind them, from the first node of a subtree on: bytes for
     * so many references, making it for a node that has none, and handing it down once the references are divided. NULL
     * where nothing is kept.
     * prepare gives the task new memory of the bulk's, and puts back the old. divide may leave out references of
     * children that turn out not to meet their cells, and narrow boxes. False when there is no memory. */
    size_t (*event_bytes)(uint32_t count);
    bool (*prepare)(kdr_build_state *state, kdr_build_worker *worker, bool parallel, kdr_build_task *task);
    bool (*divide)(kdr_opening *opening, const kdr_split *split, kdr_build_task children[2]);

    /* Looks at a node's references before planes are asked for; may be NULL. */
    void (*begin)(kdr_opening *opening);

    /* The best plane strictly inside the cell on one of the axes of a set, bit k for axis k; an infinite cost if there
     * is none. The cost is that of the heuristic where the splitter weighs. */
    kdr_split (*choose)(kdr_opening *opening, uint32_t axes);
} kdr_splitter;

extern const kdr_splitter kdr_split_binned, kdr_split_space, kdr_split_object, kdr_split_sweep;

const kdr_splitter *kdr_splitter_for(kdr_split_rule rule);

/* Every axis as a set of its own, in the order of a rule. Returns 3. */
uint32_t kdr_single_axes(kdr_axis_rule rule, const kdr_box *cell, uint32_t depth, uint32_t sets[3]);

/* The sets of axes on which a node's plane is looked for, one after the other until one has a plane worth taking.
 * Returns how many there are. */
static inline uint32_t kdr_axis_sets(kdr_axis_rule rule, const kdr_box *cell, uint32_t depth, uint32_t sets[3]) {
    sets[0] = 7;
    return rule == KDR_AXIS_BEST ? 1 : kdr_single_axes(rule, cell, depth, sets);
}

/* True if a node becomes a leaf whatever its planes are. */
static inline bool kdr_must_be_leaf(const kdr_build_state *state, uint32_t count, uint32_t depth) {
    const kdr_plan *plan = &state->plan;
    bool small = count <= plan->leaf_limit;
    if (state->splitter->weighs)
        small = small && kdr_plan_leaf_cost(plan, count) <= plan->cost_traversal;
    return count == 0 || depth >= plan->depth_limit || small;
}

#endif
