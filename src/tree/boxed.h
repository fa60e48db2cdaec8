/* The other kind of leaf: of primitives that the tree knows by number and box alone, since a callback answers for them.
 *
 * A leaf holds groups of four boxes, as structure of arrays, so that a ray is held against four at a time. Primitives
 * come in ascending order; places that are left over have empty boxes and the primitive UINT32_MAX. A leaf's first item
 * is the number of its first group. Boxes are whole, not cut to the cell. 112 bytes a group. A tree has leaves of one
 * kind. */
#ifndef KDR_TREE_BOXED_H
#define KDR_TREE_BOXED_H

#include "tree/tree.h"

typedef struct kdr_boxed_group {
    float face[6][KDR_BLOCK_GROUP]; /* lower faces on each axis, then upper ones */
    uint32_t primitive[KDR_BLOCK_GROUP];
} kdr_boxed_group;

/* The groups of a leaf. */
static inline const kdr_boxed_group *kdr_boxed_of(const kdr_tree *tree, kdr_node leaf) {
    return (const kdr_boxed_group *)tree->blocks + kdr_node_first(leaf);
}

/* The same while they are filled. */
static inline kdr_boxed_group *kdr_boxed_start(float *blocks, kdr_node leaf) {
    return (kdr_boxed_group *)blocks + kdr_node_first(leaf);
}

static inline kdr_box kdr_boxed_get(const kdr_boxed_group *groups, uint32_t i) {
    const kdr_boxed_group *group = &groups[i / KDR_BLOCK_GROUP];
    kdr_box box;
    for (int k = 0; k < 3; k++) {
        box.lo[k] = group->face[k][i % KDR_BLOCK_GROUP];
        box.hi[k] = group->face[3 + k][i % KDR_BLOCK_GROUP];
    }
    return box;
}

static inline void kdr_boxed_set(kdr_boxed_group *groups, uint32_t i, const kdr_box *box, uint32_t primitive) {
    kdr_boxed_group *group = &groups[i / KDR_BLOCK_GROUP];
    for (int k = 0; k < 3; k++) {
        group->face[k][i % KDR_BLOCK_GROUP] = box->lo[k];
        group->face[3 + k][i % KDR_BLOCK_GROUP] = box->hi[k];
    }
    group->primitive[i % KDR_BLOCK_GROUP] = primitive;
}

/* ---- what can be asked of leaves of either kind; both come in groups of four */

static inline size_t kdr_leaf_group_bytes(bool boxed) {
    return boxed ? sizeof(kdr_boxed_group) : KDR_BLOCK_GROUP_BYTES;
}

/* Primitive i of a leaf. */
static inline uint32_t kdr_leaf_primitive(const kdr_tree *tree, kdr_node leaf, uint32_t i) {
    if (tree->boxed)
        return kdr_boxed_of(tree, leaf)[i / KDR_BLOCK_GROUP].primitive[i % KDR_BLOCK_GROUP];
    return kdr_block_primitive(kdr_block_of(tree->blocks, leaf), i);
}

/* Its box. */
static inline kdr_box kdr_leaf_box(const kdr_tree *tree, kdr_node leaf, uint32_t i) {
    if (tree->boxed)
        return kdr_boxed_get(kdr_boxed_of(tree, leaf), i);
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
