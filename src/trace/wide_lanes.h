/* One ray through the wide tree: sixteen tight boxes a step, KDR_LANES at a time, then leaves of SIMD blocks.
 *
 * Children that the ray meets are visited by their rank in the ray's octant, which is front to back, so nothing is
 * sorted by distance and a hit ends the search of all that begins behind it. Invariants are those of step.h: a box is
 * left out only if the ray misses it by more than the error of its six distances; NaN (a ray in the plane of a face)
 * leaves the interval as it was, since min and max return their second operand. A box encloses all that its cell shows,
 * so whatever the plain traversal finds is found here. Cost: 512 bytes and about 25 operations a vector of boxes.
 * Included after step.h in its float form. */
#ifndef KDR_TRACE_WIDE_LANES_H
#define KDR_TRACE_WIDE_LANES_H

#include "tree/block_lanes.h"
#include "tree/wide.h"

/* A child that waits: where the ray enters its box, and which it is. */
typedef struct wide_wait {
    float enter;
    uint32_t child;
} wide_wait;

/* A path opens at most KDR_MAX_DEPTH nodes and leaves at most 15 children of each waiting. */
#define WIDE_STACK (KDR_MAX_DEPTH * (KDR_WIDE - 1) + 1)

/* The children whose boxes the ray meets no later than tmax, a bit each, and where it enters them. */
KDR_LANES_INLINE uint32_t wide_meet(const kdr_wide_node *node, const float_ray *r, float tmax, float enters[KDR_WIDE]) {
    const float *near[3], *far[3];
    for (int k = 0; k < 3; k++) {
        near[k] = r->near_is_right[k] ? node->hi[k] : node->lo[k];
        far[k] = r->near_is_right[k] ? node->lo[k] : node->hi[k];
    }
    uint32_t met = 0;
    for (uint32_t i = 0; i < KDR_WIDE; i += KDR_LANES) {
        kdr_lanes_f enter = kdr_lanes_all(-INFINITY), leave = kdr_lanes_all(INFINITY);
        for (int k = 0; k < 3; k++) {
            enter = kdr_lanes_max((kdr_lanes_load(near[k] + i) - r->origin[k]) * r->reciprocal[k], enter);
            leave = kdr_lanes_min((kdr_lanes_load(far[k] + i) - r->origin[k]) * r->reciprocal[k], leave);
        }
        enter = kdr_lanes_max(enter - r->slack, kdr_lanes_all(r->tmin));
        leave = kdr_lanes_min(leave + r->slack, kdr_lanes_all(tmax));
        kdr_lanes_store(enters + i, enter);
        met |= (KDR_LANE_BITS_ALL & ~kdr_lanes_less(leave, enter)) << i;
    }
    return met;
}

/* Puts all children met but the first on the stack, the last of them lowest, and returns the first. Their order is that
 * of their ranks, so nothing is compared but small whole numbers. */
KDR_LANES_INLINE uint32_t wide_push(const kdr_wide_node *node, uint32_t met, uint32_t rank_shift,
                                    const float enters[KDR_WIDE], wide_wait *stack, uint32_t *top) {
    uint32_t a = (uint32_t)__builtin_ctz(met);
    met &= met - 1;
    if (met == 0)
        return node->child[a];
    uint32_t b = (uint32_t)__builtin_ctz(met);
    met &= met - 1;
    if (met == 0) {
        bool swapped = (node->rank[b] >> rank_shift & 15) < (node->rank[a] >> rank_shift & 15);
        uint32_t first = swapped ? b : a, second = swapped ? a : b;
        stack[(*top)++] = (wide_wait){enters[second], node->child[second]};
        return node->child[first];
    }

    /* Three or more: a place for each rank. */
    uint8_t at[KDR_WIDE];
    uint32_t ranks = 0;
    for (met |= 1u << a | 1u << b; met; met &= met - 1) {
        uint32_t child = (uint32_t)__builtin_ctz(met), rank = node->rank[child] >> rank_shift & 15;
        at[rank] = (uint8_t)child;
        ranks |= 1u << rank;
    }
    uint32_t first = (uint32_t)__builtin_ctz(ranks);
    for (ranks &= ranks - 1; ranks;) {
        uint32_t last = 31 - (uint32_t)__builtin_clz(ranks);
        stack[(*top)++] = (wide_wait){enters[at[last]], node->child[at[last]]};
        ranks ^= 1u << last;
    }
    return node->child[at[first]];
}

KDR_LANES_INLINE bool kdr_wide_walk(const kdr_tree *tree, const float_ray *r, const kdr_ray_frame *f, float tmin,
                                    float tmax, const bool any, kdr_closest *closest) {
    const uint32_t octant = r->near_is_right[0] | r->near_is_right[1] << 1 | r->near_is_right[2] << 2;
    wide_wait stack[WIDE_STACK];
    float enters[KDR_WIDE];
    uint32_t top = 0, child = 0;
    for (;;) {
        if (!(child & KDR_WIDE_LEAF)) {
            /* Open a node, and go on with the first child that the ray meets. */
            const kdr_wide_node *node = &tree->wide[child];
            float end = !any && closest->t < r->tmax ? closest->t : r->tmax;
            uint32_t met = wide_meet(node, r, end, enters);
            if (met != 0) {
                child = wide_push(node, met, 4 * octant, enters, stack, &top);
                continue;
            }
        } else {
            /* Ask a leaf. */
            kdr_node leaf = tree->nodes[child & ~KDR_WIDE_LEAF];
            if (any && kdr_block_any(tree->blocks, leaf, f, tmin, tmax))
                return true;
            if (!any)
                kdr_block_closest(tree->blocks, leaf, f, tmin, closest);
        }

        /* Take the next child that begins no later than the closest hit. */
        do {
            if (top == 0)
                return !any && closest->primitive != UINT32_MAX;
            top--;
        } while (!any && stack[top].enter > closest->t);
        child = stack[top].child;
    }
}

#endif
