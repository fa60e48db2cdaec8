/* The traversal that goes up again by parent links instead of keeping what waits (SPEC T3). Included after step.h with
 * the same REAL and STEP.
 *
 * Source: T. Foley, J. Sugerman, "KD-Tree Acceleration Structures for a GPU Raytracer", 2005. The published one goes up
 * until a node's box holds what is left of the ray; which levels have a child left is known here from one bit each (see
 * restart_body.h), so that cells shorter than the slack are not lost. The interval inside the far child comes from its
 * box.
 * Invariant: `waiting` has the levels on the path whose far child is still to be visited. Cost: a plane crossing a
 * node, a link for every level up, and six distances to a box for each cell that waited. */

/* The ray's interval in a box, never shorter than the true one. Distances that are NaN do not count. */
static inline __attribute__((always_inline)) void STEP(clip)(const STEP(ray) * r, const kdr_box *box, REAL *enter,
                                                             REAL *leave) {
    *enter = r->tmin;
    *leave = r->tmax;
    for (int k = 0; k < 3; k++) {
        REAL near = r->near_is_right[k] ? box->hi[k] : box->lo[k], far = r->near_is_right[k] ? box->lo[k] : box->hi[k];
        REAL sooner = (near - r->origin[k]) * r->reciprocal[k] - r->slack;
        REAL later = (far - r->origin[k]) * r->reciprocal[k] + r->slack;
        *enter = sooner > *enter ? sooner : *enter;
        *leave = later < *leave ? later : *leave;
    }
}

static inline __attribute__((always_inline)) bool STEP(backtrack)(const kdr_search s, uint32_t root,
                                                                  const STEP(ray) * r) {
    uint32_t node_index = root;
    REAL enter = r->tmin, leave = r->tmax;
    uint64_t waiting = 0, level = KDR_TOP_LEVEL;
    for (;;) {
        /* Go down to a leaf. */
        kdr_node node = kdr_search_node(s, node_index);
        while (!kdr_node_is_leaf(node)) {
            uint32_t axis = kdr_node_axis(node);
            uint32_t near_index = kdr_node_child(node) + r->near_is_right[axis];
            REAL near_leave, far_enter;
            STEP(side) side = STEP(cross)(r, axis, kdr_node_plane(node), enter, leave, &near_leave, &far_enter);
            node_index = near_index;
            if (side == STEP(far_only)) {
                node_index = near_index ^ 1;
            } else if (side == STEP(both)) {
                waiting |= level;
                leave = near_leave;
            }
            level >>= 1;
            node = kdr_search_node(s, node_index);
        }
        if (kdr_search_leaf(s, node))
            return true;

        /* Go up to the deepest level where a far child waits, and over to it, until one is met no later than the
         * closest hit. */
        do {
            if (waiting == 0)
                return kdr_search_end(s);
            uint64_t child_level = (waiting & -waiting) >> 1;
            waiting &= waiting - 1;
            for (; level < child_level; level <<= 1)
                node_index = s.tree->links.parent[node_index];
            node_index ^= 1;
            STEP(clip)(r, &s.tree->links.box[node_index], &enter, &leave);
        } while (enter > leave || KDR_SEARCH_IS_BEHIND(s, enter));
    }
}
