/* Visits every node of a tree, depth first, left before right, with its cell. Depth is at most KDR_MAX_DEPTH.
 * Closed nodes are opened on the way. */
#ifndef KDR_TREE_WALK_H
#define KDR_TREE_WALK_H

#include "tree/tree.h"

typedef struct kdr_walk {
    uint32_t node, depth;
    kdr_box cell;
} kdr_walk;

/* Says how the walk goes on. A walk that goes past a node leaves out all that is below it. */
typedef kdr_cell_step kdr_walk_step_fn(const kdr_tree *tree, const kdr_walk *at, void *context);

/* True if the walk ended by itself. */
bool kdr_tree_walk_steps(const kdr_tree *tree, kdr_walk_step_fn *visit, void *context);

/* The same for a walk to every node. False stops it. */
typedef bool kdr_walk_fn(const kdr_tree *tree, const kdr_walk *at, void *context);

bool kdr_tree_walk(const kdr_tree *tree, kdr_walk_fn *visit, void *context);

#endif
