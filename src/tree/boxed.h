/* The other kind of leaf: of primitives that the tree knows by number and box alone, since a callback answers for them.
 *
 * A leaf's first item is the number of its first entry; entries of a leaf follow one another in ascending order of
 * their primitives. Boxes are whole, not cut to the cell. 28 bytes an entry. A tree has leaves of one kind. */
#ifndef KDR_TREE_BOXED_H
#define KDR_TREE_BOXED_H

#include "tree/tree.h"

typedef struct kdr_boxed {
    kdr_box box;
    uint32_t primitive;
} kdr_boxed;

/* The entries of a leaf. */
static inline const kdr_boxed *kdr_boxed_of(const kdr_tree *tree, kdr_node leaf) {
    return (const kdr_boxed *)tree->blocks + kdr_node_first(leaf);
}

/* The same while they are filled. */
static inline kdr_boxed *kdr_boxed_start(float *blocks, kdr_node leaf) {
    return (kdr_boxed *)blocks + kdr_node_first(leaf);
}

/* ---- what can be asked of leaves of either kind */

/* What a leaf of `count` primitives takes of a tree's groups. */
static inline uint32_t kdr_leaf_groups(bool boxed, uint32_t count) { return boxed ? count : kdr_block_groups(count); }

static inline size_t kdr_leaf_group_bytes(bool boxed) { return boxed ? sizeof(kdr_boxed) : KDR_BLOCK_GROUP_BYTES; }

/* Primitive i of a leaf. */
static inline uint32_t kdr_leaf_primitive(const kdr_tree *tree, kdr_node leaf, uint32_t i) {
    if (tree->boxed)
        return kdr_boxed_of(tree, leaf)[i].primitive;
    return kdr_block_primitive(kdr_block_of(tree->blocks, leaf), i);
}

/* Its box. */
static inline kdr_box kdr_leaf_box(const kdr_tree *tree, kdr_node leaf, uint32_t i) {
    if (tree->boxed)
        return kdr_boxed_of(tree, leaf)[i].box;
    float t[3][3];
    kdr_block_triangle(kdr_block_of(tree->blocks, leaf), i, t);
    kdr_box box;
    for (int k = 0; k < 3; k++) {
        box.lo[k] = fminf(t[0][k], fminf(t[1][k], t[2][k]));
        box.hi[k] = fmaxf(t[0][k], fmaxf(t[1][k], t[2][k]));
    }
    return box;
}

#endif
