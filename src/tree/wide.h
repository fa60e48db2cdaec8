/* The wide tree: the same cells, sixteen children a node, each with the tight box of what lies in it (SPEC B13).
 *
 * A node is the top of a subtree of the kd-tree, opened largest first until it has 16 members. Members lie in disjoint
 * cells, so for each octant of directions they have a fixed front-to-back order: no sorting, and early exit holds.
 * The box of a member is the union over its leaves of (triangle's box, cut to the leaf's cell): what the cell shows to
 * a ray, without its empty space.
 *
 * An annex made from the finished tree. It shares the leaves, adds about 7 bytes a triangle, and holds nothing that the
 * tree does not say. 512 bytes a node. */
#ifndef KDR_TREE_WIDE_H
#define KDR_TREE_WIDE_H

#include "tree/tree.h"
#include "tree/unsplit.h"

#define KDR_WIDE 16

typedef struct kdr_wide_node {
    /* Faces of the boxes: on each axis the lower ones, then the upper ones. The largest box has the first place; an
     * unused place has an empty box. */
    _Alignas(64) float face[6][KDR_WIDE];
    uint32_t child[KDR_WIDE];
    /* The children in the order of each octant of directions, four bits each; unused places come last. Octant bit k:
     * the ray runs down axis k. */
    uint64_t order[8];
} kdr_wide_node;

/* Where the i-th child's four bits are: even ones in the lower half of the word, odd ones in the upper, so that the
 * word in every pair of lanes needs one shift. */
#define KDR_WIDE_ORDER_SHIFT(i) ((i) % 2 * 32 + (i) / 2 * 4)

/* A child is a wide node, a block, or, where a block is too long or lies too far, a leaf of the tree. */
#define KDR_WIDE_LEAF 0x80000000u
#define KDR_WIDE_GROUP_BITS 4
#define KDR_WIDE_MAX_GROUPS ((1u << KDR_WIDE_GROUP_BITS) - 1)
#define KDR_WIDE_MAX_BLOCK ((1u << (31 - 2 * KDR_WIDE_GROUP_BITS)) - 2)
#define KDR_WIDE_MAX_LEAF ((1u << (31 - KDR_WIDE_GROUP_BITS)) - 2)
#define KDR_WIDE_NOTHING UINT32_MAX /* no child has this value */

/* Coordinates beyond this have no wide tree: distances in it must not overflow. */
#define KDR_WIDE_LARGEST 0x1p36f

/* Makes the wide nodes. shown has one entry a node: for leaf i what it shows; those of interior nodes are written here.
 * No wide nodes are made for a tree whose root is a leaf, that has more than 2^27 nodes, or whose coordinates are too
 * large. room: further nodes that there is to be memory for. False when there is no memory. */
bool kdr_tree_add_wide(kdr_tree *tree, kdr_bulk *bulk, kdr_shown *shown, uint32_t room);

/* A subtree that is to hang below a node of another tree: `tree` holds its nodes alone, with 0 as its root and 2 as the
 * next. Where its root, its other nodes and its blocks will be there. */
typedef struct kdr_wide_graft {
    uint32_t root, first_node, first_group;
} kdr_wide_graft;

/* Writes the wide nodes of such a subtree, whose root is not a leaf, numbered from 0; returns how many. There is room
 * for as many as the subtree has interior nodes. */
uint32_t kdr_wide_write_graft(const kdr_tree *tree, const kdr_wide_graft *graft, kdr_shown *shown, kdr_wide_node *to);

/* What the wide tree has for a leaf. */
uint32_t kdr_wide_leaf(kdr_node leaf, uint32_t index, uint32_t shown_groups);

#endif
