/* Visits every node of a tree, depth first, left before right, with its cell. Depth is at most KDR_MAX_DEPTH. */
#ifndef KDR_TREE_WALK_H
#define KDR_TREE_WALK_H

#include "tree/tree.h"

typedef struct kdr_walk {
    uint32_t node, depth;
    kdr_box cell;
} kdr_walk;

/* False stops the walk. */
typedef bool kdr_walk_fn(const kdr_tree *tree, const kdr_walk *at, void *context);

/* True if the walk ended by itself. */
bool kdr_tree_walk(const kdr_tree *tree, kdr_walk_fn *visit, void *context);

#endif
