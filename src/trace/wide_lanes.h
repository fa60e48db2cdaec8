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
    const kdr_wide_node *node;
    uint32_t left;           /* a bit a rank, front first */
    uint8_t child[KDR_WIDE]; /* the child at a rank */
    float enter[KDR_WIDE];   /* where the ray enters a child's box; by child */
} wide_visit;

/* Finds the children whose boxes the ray meets no later than tmax. */
KDR_LANES_INLINE void wide_visit_begin(const kdr_wide_node *node, const float_ray *r, uint32_t octant, float tmax,
                                       wide_visit *visit) {
    const float *near[3], *far[3];
    for (int k = 0; k < 3; k++) {
        near[k] = r->near_is_right[k] ? node->hi[k] : node->lo[k];
        far[k] = r->near_is_right[k] ? node->lo[k] : node->hi[k];
    }
    uint32_t met = 0;
    for (uint32_t i = 0; i < KDR_WIDE; i += KDR_LANES) {
        kdr_lanes_f enter = kdr_lanes_all(r->tmin + r->slack), leave = kdr_lanes_all(tmax - r->slack);
        for (int k = 0; k < 3; k++) {
            enter = kdr_lanes_max((kdr_lanes_load(near[k] + i) - r->origin[k]) * r->reciprocal[k], enter);
            leave = kdr_lanes_min((kdr_lanes_load(far[k] + i) - r->origin[k]) * r->reciprocal[k], leave);
        }
        enter -= r->slack;
        leave += r->slack;
        kdr_lanes_store(visit->enter + i, enter);
        met |= (KDR_LANE_BITS_ALL & ~kdr_lanes_less(leave, enter)) << i;
    }

    /* Sort by rank, which is a matter of bits. */
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
    wide_visit stack[KDR_MAX_DEPTH + 1];
    wide_visit *visit = stack;
    wide_visit_begin(&tree->wide[0], r, octant, r->tmax, visit);
    for (;;) {
        while (visit->left == 0) {
            if (visit == stack)
                return !any && closest->primitive != UINT32_MAX;
            visit--;
        }
        uint32_t place = visit->child[__builtin_ctz(visit->left)];
        visit->left &= visit->left - 1;
        if (!any && visit->enter[place] > closest->t)
            continue;
        uint32_t child = visit->node->child[place];
        if (!(child & KDR_WIDE_LEAF)) {
            float end = !any && closest->t < r->tmax ? closest->t : r->tmax;
            wide_visit_begin(&tree->wide[child], r, octant, end, visit + 1);
            visit++;
            continue;
        }
        kdr_node leaf = tree->nodes[child & ~KDR_WIDE_LEAF];
        if (any && kdr_block_any(tree->blocks, leaf, f, tmin, tmax))
            return true;
        if (!any)
            kdr_block_closest(tree->blocks, leaf, f, tmin, closest);
    }
}

#endif
