/* The standard traversal: front to back, with a stack of far children. Included after step.h with the same REAL and
 * STEP.
 *
 * Source: M. Pharr, G. Humphreys, "Physically Based Rendering", 2004, for the iterative form; intervals and leaves are
 * our own: see step.h and block_lanes.h.
 * Invariant: the cells on the stack and the current one cover the rest of the ray's interval; the stack is ordered by
 * distance, but for the slack. Cells that begin behind the closest hit are left out; an equal distance is still
 * visited, since a lower primitive may wait there. Cost: one plane crossing a node; depth is bounded by the builder, so
 * the stack is never checked. */

static inline __attribute__((always_inline)) bool STEP(stack)(const kdr_search s, uint32_t root, const STEP(ray) * r) {
    struct {
        uint32_t node;
        REAL tmin, tmax;
    } stack[KDR_MAX_DEPTH + 1];
    uint32_t top = 0, node_index = root;
    REAL enter = r->tmin, leave = r->tmax;
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
                stack[top].node = near_index ^ 1;
                stack[top].tmin = far_enter;
                stack[top].tmax = leave;
                top++;
                leave = near_leave;
            }
            node = kdr_search_node(s, node_index);
        }
        if (kdr_search_leaf(s, node))
            return true;

        /* Take the next cell that begins no later than the closest hit. Widened intervals are not quite in order, so
         * one that begins later does not speak for those below it. */
        do {
            if (top == 0)
                return kdr_search_end(s);
            top--;
            enter = stack[top].tmin;
        } while (KDR_SEARCH_IS_BEHIND(s, enter));
        node_index = stack[top].node;
        leave = stack[top].tmax;
    }
}
