/* The structure at rest: nodes, leaves and what was counted when they were made. Never changed once built, but that
 * closed nodes are opened. */
#ifndef KDR_TREE_TREE_H
#define KDR_TREE_TREE_H

#include "base/bulk.h"
#include "geometry/box.h"
#include "kdray/kdray.h"
#include "tree/block.h"

#define KDR_MAILBOX_LARGEST 64

/* Annexes: the nodes again in another form, made from the finished tree for a traversal that wants them. One block of
 * memory each, with `bytes` of it. */
typedef struct kdr_node_arrays {
    float *plane;
    uint32_t *link, *count;
    uint8_t *kind;
    size_t bytes;
} kdr_node_arrays;

typedef struct kdr_node_links {
    kdr_box *box;
    uint32_t *parent;
    size_t bytes;
} kdr_node_links;

typedef struct kdr_projections {
    float *rows;
    size_t bytes;
} kdr_projections;

typedef struct kdr_tree {
    kdr_node *nodes;     /* node 0 is the root; canonical order: depth first, left before right; below closed nodes
                          * in the order of their opening */
    uint32_t node_count; /* that there is room for, with the unused node 1 */
    float *blocks;       /* of triangles, or, if `boxed`, the groups of boxed.h */
    bool boxed;
    uint32_t group_count; /* of blocks or boxes */
    kdr_box bounds;       /* of the primitives: the root's cell; empty if there are none */
    uint64_t primitive_count;
    uint64_t dropped_count, degenerate_count;
    float cost_traversal, cost_intersection;
    uint32_t depth_limit;
    bool flat_in_both; /* a triangle that lies in a split plane is on both sides of it, not on one */
    bool clipped; /* triangles were cut at planes: leaves hold those that meet their cell, not all whose box does */
    struct kdr_wide_node *wide;  /* see wide.h; NULL: not asked for, or the root is a leaf */
    uint32_t wide_count;         /* of wide nodes when the commit ended */
    struct kdr_closed *closed;   /* see closed.h; NULL: every node is open */
    float reach[4];              /* largest coordinate on each axis, and 0; set with `wide` */
    kdr_node_arrays arrays;      /* see node_arrays.h; not asked for: NULL */
    kdr_node_links links;        /* see node_links.h; not asked for: NULL */
    kdr_projections projections; /* see projections.h; not asked for: NULL */
    kdr_triangle_test test;      /* of the traversals by name */
    uint32_t mailbox_size;       /* of each ray; 0, or a power of two up to KDR_MAILBOX_LARGEST */
    size_t node_bytes, block_bytes, wide_bytes;
} kdr_tree;

/* A tree of one empty leaf. False when there is no memory. */
bool kdr_tree_init_empty(kdr_tree *tree, kdr_bulk *bulk);

/* Room for nodes and groups, of the kind that tree->boxed says; contents are not set. False, and nothing held, when
 * there is no memory. */
bool kdr_tree_reserve(kdr_tree *tree, kdr_bulk *bulk, uint32_t node_count, uint32_t group_count);

/* Memory goes back to the bulk it came from, where the next tree finds it. */
void kdr_tree_release(kdr_tree *tree, kdr_bulk *bulk);

/* Equal for equal trees, however they lie in memory: planes, and the primitives of each leaf. */
uint64_t kdr_tree_hash(const kdr_tree *tree);

/* Counts nodes, leaves, depths, references and cost; fills all of *out but build_seconds. */
void kdr_tree_count(const kdr_tree *tree, kdr_tree_stats *out);

#endif
