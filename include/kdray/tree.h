/* What the trees of a committed scene tell about themselves: part of kdray/kdray.h, which includes it. */
#ifndef KDR_TREE_H
#define KDR_TREE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define KDR_HISTOGRAM_SIZE 64

/* Of a scene with several trees, of dynamic triangles, of static ones, of custom primitives: numbers, bytes, costs and
 * histograms of all of them, added up; depth and largest_leaf are the largest ones, mean_leaf_depth is over all leaves.
 * A tree of no primitive is one empty leaf. */
typedef struct kdr_tree_stats {
    uint64_t triangle_count;   /* in the trees */
    uint64_t static_count;     /* of these, in the tree of static triangles */
    uint64_t custom_count;     /* custom primitives in the tree */
    uint64_t dropped_count;    /* left out: a vertex or a box is NaN or infinite */
    uint64_t degenerate_count; /* left out: exactly zero area, no ray can hit them */
    uint64_t closed_count;     /* nodes that the commit left closed, see kdr_build_def.lazy_limit */
    uint64_t opened_count;     /* of these, opened by rays since: all other figures are those of the whole tree */
    uint64_t interior_count;
    uint64_t leaf_count; /* with empty ones */
    uint64_t empty_leaf_count;
    uint64_t reference_count; /* primitives over all leaves; over their number: the duplication */
    uint32_t depth;           /* of the deepest leaf; the root has 0 */
    uint32_t largest_leaf;
    double mean_leaf_depth; /* over all leaves */
    double cost;            /* by the surface area heuristic, with the constants the tree was built with */
    size_t node_bytes;      /* nodes of the tree, in every form that is kept */
    size_t leaf_bytes;      /* blocks of the leaves */
    double build_seconds;   /* wall time of the commit */
    uint64_t depth_histogram[KDR_HISTOGRAM_SIZE]; /* leaves at each depth */
    uint64_t leaf_histogram[KDR_HISTOGRAM_SIZE];  /* leaves with i primitives; the last counts all larger ones */
} kdr_tree_stats;

/* A node of the committed tree: a box of space, divided in two by a plane or else a leaf. */
typedef struct kdr_cell {
    float bounds[6]; /* {min x, y, z, max x, y, z} */
    uint32_t depth;  /* the root has 0 */
    bool is_leaf;
    bool is_static, is_custom; /* of the tree of static triangles; of the tree of custom primitives */
    uint32_t axis;             /* of the split plane: 0, 1, 2; 0 for a leaf */
    float plane;               /* where it cuts that axis; 0 for a leaf */
    uint32_t primitive_count;  /* in the leaf, each counted in every leaf that has it; 0 if not a leaf */
} kdr_cell;

/* What a visitor wants next: cells inside this one and what follows, what follows, or nothing more. */
typedef enum kdr_cell_step { KDR_CELL_INTO, KDR_CELL_PAST, KDR_CELL_STOP } kdr_cell_step;
typedef kdr_cell_step kdr_cell_fn(const kdr_cell *cell, void *user); /* cell: valid during the call only */

#endif
