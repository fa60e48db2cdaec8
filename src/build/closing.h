/* Nodes that a build leaves closed, and their opening later on: see closing.c and opener.c. */
#ifndef KDR_BUILD_CLOSING_H
#define KDR_BUILD_CLOSING_H

#include "build/work.h"
#include "tree/closed.h"

/* A node of a growing tree that stays closed. */
typedef struct kdr_closing {
    struct kdr_closing *before; /* made by the same worker */
    kdr_build_task task;        /* its references, boxes only if they are kept, stay until the layout */
    uint32_t number;            /* among all, as chance has it; the growing node's first item */
} kdr_closing;

/* What the opening of a node starts from. */
typedef struct kdr_closed_node {
    kdr_box cell, box;
    uint64_t budget;
    uint32_t depth;
    uint32_t count;
    size_t references; /* where its boxes begin, as of kdr_references_in, if they are kept */
} kdr_closed_node;

/* True if the plan wants a node of that many references to stay closed. What fits one mask is opened for less than it
 * takes to keep it. */
static inline bool kdr_stays_closed(const kdr_build_state *state, uint32_t count) {
    return count <= state->plan.lazy_limit && count > KDR_MASK_LIMIT;
}

/* Boxes of parts of triangles cannot be told from the triangles and the cell. */
static inline bool kdr_keeps_boxes(const kdr_plan *plan) { return plan->straddle == KDR_STRADDLE_CLIP; }

/* Makes the task's node a closed one; its references are copied. */
void kdr_close(kdr_build_state *state, kdr_build_worker *worker, const kdr_build_task *task);

/* All closings by number, in memory of worker 0's arena. NULL: no memory. */
const kdr_closing **kdr_closings_by_number(kdr_build_state *state);

/* Room for what the opening of closed nodes of so many references in all may make. */
typedef struct kdr_closed_room {
    uint32_t pairs, groups, wide;
} kdr_closed_room;
kdr_closed_room kdr_closed_room_for(const kdr_plan *plan, uint64_t references, uint32_t node_count,
                                    uint32_t group_count);

/* Gives a finished tree what the opening of its closed nodes needs: nodes[i] became node places[i]. The tree has the
 * room. False when there is no memory. */
bool kdr_tree_add_closed(kdr_build_state *state, kdr_tree *tree, const kdr_closing **closings, const uint32_t *places,
                         uint32_t count, const kdr_closed_room *room, uint32_t node_count, uint32_t group_count);

/* ---- opener.c: workshops for opening, one for each thread that may open at once. */
typedef struct kdr_openers kdr_openers;
kdr_openers *kdr_openers_create(kdr_alloc *alloc, kdr_bulk *bulk, uint32_t count); /* NULL: no memory */
void kdr_openers_destroy(kdr_openers *openers);                                    /* NULL is allowed */
void kdr_openers_trim(kdr_openers *openers);                                       /* those that nobody uses */

/* The kdr_closed of the trees of this room. */
typedef struct kdr_lazy {
    kdr_closed closed;
    kdr_openers *openers;
    const kdr_build_kernels *kernels;
    const kdr_unsplit *unsplit;
    kdr_plan plan;
    const uint32_t *number; /* of each committed node among the closed ones */
    kdr_closed_node *nodes;
    char *references; /* of all of them; not used where boxes are not kept */
    size_t bytes, reference_bytes;
} kdr_lazy;

kdr_node kdr_lazy_open(kdr_closed *closed, const kdr_tree *tree, uint32_t node);

#endif
