/* The wide tree: the same cells, sixteen children a node, each with the tight box of what lies in it (SPEC B13).
 *
 * A node is the top of a subtree of the kd-tree, opened largest first until it has 16 members. Members lie in disjoint
 * cells, so for each octant of directions they have a fixed front-to-back order: no sorting, and early exit holds.
 * The box of a member is the union over its leaves of (triangle's box, cut to the leaf's cell): what the cell shows to
 * a ray, without its empty space.
 *
 * An annex made from the finished tree. It shares the leaves, adds about 4 bytes a triangle, and holds nothing that the
 * tree does not say. 512 bytes a node. */
#ifndef KDR_TREE_WIDE_H
#define KDR_TREE_WIDE_H

#include "tree/tree.h"

#define KDR_WIDE 16

typedef struct kdr_wide_node {
    _Alignas(64) float lo[3][KDR_WIDE], hi[3][KDR_WIDE]; /* an unused place has an empty box */
    uint32_t child[KDR_WIDE]; /* a wide node, or KDR_WIDE_LEAF | index of a leaf among the nodes */
    uint32_t rank[KDR_WIDE];  /* four bits an octant: the child's place in its order; octant bit k: runs down axis k */
} kdr_wide_node;

#define KDR_WIDE_LEAF 0x80000000u

/* Makes the wide nodes. boxes has one entry a node: for leaf i its tight box; those of interior nodes are written here.
 * A tree whose root is a leaf has no wide nodes. False when there is no memory. */
bool kdr_tree_add_wide(kdr_tree *tree, kdr_bulk *bulk, kdr_box *boxes);

#endif
