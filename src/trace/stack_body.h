/* The standard traversal: front to back, with a stack of far children. Included after step.h with the same REAL and
 * STEP.
 *
 * Invariant: the cells on the stack and the current one cover the rest of the ray's interval; the stack is ordered by
 * distance, but for the slack. Cells that begin behind the closest hit are left out; an equal distance is still
 * visited, since a lower primitive may wait there. Cost: one plane crossing a node; depth is bounded by the builder, so
 * the stack is never checked. */

static inline __attribute__((always_inline)) bool STEP(walk)(const kdr_tree *tree, uint32_t root, const STEP(ray) * r,
                                                             const kdr_ray_frame *f, float tmin, float tmax,
                                                             const bool any, kdr_closest *closest) {
    struct {
        uint32_t node;
        REAL tmin, tmax;
    } stack[KDR_MAX_DEPTH + 1];
    uint32_t top = 0, node_index = root;
    REAL enter = r->tmin, leave = r->tmax;
    for (;;) {
        /* Go down to a leaf. */
        kdr_node node = tree->nodes[node_index];
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
            node = tree->nodes[node_index];
        }

        /* Ask its block. */
        if (kdr_node_count(node) > 0) {
            if (any && kdr_block_any(kdr_block_of(tree->blocks, node), f, tmin, tmax))
                return true;
            if (!any)
                kdr_block_closest(kdr_block_of(tree->blocks, node), f, tmin, closest);
        }

        /* Take the next cell that begins no later than the closest hit. Widened intervals are not quite in order, so
         * one that begins later does not speak for those below it. */
        do {
            if (top == 0)
                return !any && closest->primitive != UINT32_MAX;
            top--;
            enter = stack[top].tmin;
        } while (!any && (float)enter > closest->t);
        node_index = stack[top].node;
        leave = stack[top].tmax;
    }
}
