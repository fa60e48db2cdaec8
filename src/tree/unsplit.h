/* Whole triangles: what the wide tree need not ask twice (SPEC B13).
 *
 * The cells of a kd-tree are disjoint, so a triangle on a border lies in several leaves. The boxes of the wide tree may
 * overlap, so there one leaf can show the triangle whole and the others need not show it. It is the leaf that owns the
 * centre of its box, as long as the leaf's box grows little; what is large stays in all its leaves, cut to each.
 *
 * A leaf's block keeps all its triangles, for traversals that cut rays to cells. Those it shows come first, so the wide
 * tree asks the first groups of the block, and nothing is stored twice.
 *
 * Invariant: every triangle of the tree is shown whole by one leaf, or cut by each leaf that holds it.
 * Cost: two passes over the blocks, some 35 cycles a reference; a byte a primitive while they run. */
#ifndef KDR_TREE_UNSPLIT_H
#define KDR_TREE_UNSPLIT_H

#include "kdray/kdray.h"
#include "tree/block.h"

/* Leaves of more triangles take no part: they show all they have, cut to their cells. */
#define KDR_UNSPLIT_LIMIT 60

/* What the wide tree asks of a leaf. */
typedef struct kdr_shown {
    kdr_box box;              /* encloses all that the leaf shows */
    uint32_t groups;          /* of its block, the first ones, which hold all that it shows */
    uint64_t shared, claimed; /* places of triangles that reach out of its cell; of those it shows whole */
} kdr_shown;

/* Two passes over all leaves, each in any order and by many threads. */
typedef struct kdr_unsplit {
    /* Fills *shown with all that is in the cell, and what the leaf claims. Marks that in `whole`, a byte a primitive,
     * all 0 before. */
    void (*claim)(const float *blocks, kdr_node leaf, const kdr_box *cell, uint8_t *whole, kdr_shown *shown);

    /* When all have claimed: sorts the block and takes out of *shown what others show. */
    void (*sort)(float *blocks, kdr_node leaf, const kdr_box *cell, const uint8_t *whole, kdr_shown *shown);
} kdr_unsplit;

/* The table for an instruction set that this machine has. All give the same results. */
const kdr_unsplit *kdr_unsplit_for(kdr_isa isa);

#endif
