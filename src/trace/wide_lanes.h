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

/* A wide node with children still to be visited. */
typedef struct wide_visit {
    float enter[KDR_WIDE]; /* where the ray enters a child's box; by child */
    const kdr_wide_node *node;
    uint32_t left;           /* a bit a rank, front first */
    uint8_t child[KDR_WIDE]; /* the child at a rank */
} wide_visit;

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

/* Sorts the children met by their rank, which is a matter of bits. */
KDR_LANES_INLINE void wide_sort(const kdr_wide_node *node, uint32_t met, uint32_t octant, wide_visit *visit) {
    visit->node = node;
    visit->left = 0;
    for (; met; met &= met - 1) {
        uint32_t child = (uint32_t)__builtin_ctz(met);
        uint32_t rank = node->rank[child] >> (4 * octant) & 15;
        visit->child[rank] = (uint8_t)child;
        visit->left |= 1u << rank;
    }
}

KDR_LANES_INLINE bool kdr_wide_walk(const kdr_tree *tree, const float_ray *r, const kdr_ray_frame *f, float tmin,
                                    float tmax, const bool any, kdr_closest *closest) {
    const uint32_t octant = r->near_is_right[0] | r->near_is_right[1] << 1 | r->near_is_right[2] << 2;
    wide_visit stack[KDR_MAX_DEPTH + 2]; /* those below `top` wait; the one at `top` is scratch */
    uint32_t top = 0, child = 0;
    for (;;) {
        if (!(child & KDR_WIDE_LEAF)) {
            /* Open a node. Most often the ray meets one child of it, which needs neither sorting nor waiting. */
            const kdr_wide_node *node = &tree->wide[child];
            float end = !any && closest->t < r->tmax ? closest->t : r->tmax;
            uint32_t met = wide_meet(node, r, end, stack[top].enter);
            if (met != 0 && (met & (met - 1)) == 0) {
                child = node->child[__builtin_ctz(met)];
                continue;
            }
            if (met != 0)
                wide_sort(node, met, octant, &stack[top++]);
        } else {
            /* Ask a leaf. */
            kdr_node leaf = tree->nodes[child & ~KDR_WIDE_LEAF];
            if (any && kdr_block_any(tree->blocks, leaf, f, tmin, tmax))
                return true;
            if (!any)
                kdr_block_closest(tree->blocks, leaf, f, tmin, closest);
        }

        /* Take the next child that begins no later than the closest hit, front to back. */
        uint32_t place;
        do {
            while (top > 0 && stack[top - 1].left == 0)
                top--;
            if (top == 0)
                return !any && closest->primitive != UINT32_MAX;
            wide_visit *visit = &stack[top - 1];
            place = visit->child[__builtin_ctz(visit->left)];
            visit->left &= visit->left - 1;
        } while (!any && stack[top - 1].enter[place] > closest->t);
        child = stack[top - 1].node->child[place];
    }
}

#endif
