/* The nodes as a structure of arrays: an annex, with what a node's word holds in an array for each field (SPEC B5).
 *
 *   plane   split plane of an interior node; 0 of a leaf
 *   link    pair of children, or first item of a leaf
 *   count   items of a leaf; 0 of an interior node
 *   kind    axis of an interior node; KDR_NODE_LEAF
 *
 * 13 bytes a node. Nothing is lost: from the arrays the words come back to the bit. Source of the layout: the form that
 * machines without structures in memory ask for, where each field is read by many threads at once. */
#ifndef KDR_TREE_NODE_ARRAYS_H
#define KDR_TREE_NODE_ARRAYS_H

#include "tree/tree.h"

/* Makes the arrays from the nodes. False, and nothing held, when there is no memory. */
bool kdr_tree_add_arrays(kdr_tree *tree, kdr_bulk *bulk);

/* Node i as a word. */
static inline kdr_node kdr_node_of_arrays(const kdr_node_arrays *arrays, uint32_t i) {
    uint32_t kind = arrays->kind[i];
    if (kind == KDR_NODE_LEAF)
        return kdr_node_leaf(arrays->count[i], arrays->link[i]);
    return kdr_node_interior(kind, arrays->plane[i], arrays->link[i]);
}

#endif
