/* What a walk through the kd-tree searches, whatever way it goes: passed by value into inlined functions, so that all
 * that is constant in it is constant in their loops. */
#ifndef KDR_TRACE_SEARCH_LANES_H
#define KDR_TRACE_SEARCH_LANES_H

#include "trace/quick_lanes.h"
#include "trace/trace.h"
#include "tree/block_lanes.h"
#include "tree/closed.h"
#include "tree/node_arrays.h"

typedef struct kdr_search {
    const kdr_tree *tree;
    const kdr_ray_frame *frame;
    float tmin, tmax;
    kdr_trace_rule trace;
    bool arrays, any;
    bool quick;           /* by the tree's triangle test, if that is another than the exact one */
    kdr_mailbox *mailbox; /* NULL: none */
    kdr_closest *closest; /* NULL for any hit */
} kdr_search;

KDR_LANES_INLINE kdr_node kdr_search_node(const kdr_search s, uint32_t i) {
    KDR_COUNT(nodes, 1);
    KDR_COUNT(node_rays, 1);
    return s.arrays ? kdr_node_of_arrays(&s.tree->arrays, i) : kdr_tree_node(s.tree, i);
}

/* Asks a leaf. True if that ends the search. */
KDR_LANES_INLINE bool kdr_search_leaf(const kdr_search s, kdr_node leaf) {
    if (kdr_node_count(leaf) == 0)
        return false;
    kdr_block block = kdr_block_of(s.tree->blocks, leaf);
    if (s.quick && s.tree->test != KDR_TEST_WATERTIGHT) {
        if (s.any)
            return quick_any(s.tree, block, s.frame, s.tmin, s.tmax, s.mailbox);
        quick_closest(s.tree, block, s.frame, s.tmin, s.mailbox, s.closest);
        return false;
    }
    if (s.any)
        return kdr_block_any_new(block, s.frame, s.tmin, s.tmax, s.mailbox);
    kdr_block_closest_new(block, s.frame, s.tmin, s.mailbox, s.closest);
    return false;
}

/* True if what begins at a distance need not be searched any more. An equal distance is searched: a lower primitive may
 * wait there. */
#define KDR_SEARCH_IS_BEHIND(s, begin) (!(s).any && (float)(begin) > (s).closest->t)

/* What a walk says when nothing is left. */
KDR_LANES_INLINE bool kdr_search_end(const kdr_search s) { return !s.any && s.closest->primitive != UINT32_MAX; }

#endif
