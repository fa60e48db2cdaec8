/* Numbering the nodes of a tree that has grown; see layout.c. */
#ifndef KDR_BUILD_LAYOUT_H
#define KDR_BUILD_LAYOUT_H

#include "build/closing.h"

/* A leaf whose block is to be filled. */
typedef struct kdr_leaf_job {
    kdr_node leaf;       /* as in the finished tree */
    const uint32_t *ids; /* of its primitives */
    uint32_t node;       /* its number in the finished tree */
    kdr_box cell;
} kdr_leaf_job;

/* What the numbering writes, beside tree->nodes. There is room for all leaves and nodes. */
typedef struct kdr_numbering {
    kdr_leaf_job *jobs; /* leaves with a block */
    uint64_t job_count;
    kdr_shown *shown; /* a node: those of leaves without a block, and of closed ones; NULL: not wanted */

    /* Closed nodes: by kdr_closing.number; in order, with their places. Not used where there are none. */
    const kdr_closing **by_number, **closings;
    uint32_t *places;
    uint32_t closed_count;
} kdr_numbering;

/* Numbers the nodes below the growing node `root` anew, in depth-first order, and writes them. tree->bounds is the
 * root's cell. */
void kdr_number_nodes(const kdr_workshop *shop, uint32_t root, kdr_tree *tree, kdr_numbering *numbering);

#endif
