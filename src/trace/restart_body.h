/* Traversals that forget what waits and find it again from above: restart, push-down and short stack (SPEC T2).
 * Included after step.h with the same REAL and STEP.
 *
 * Sources: T. Foley, J. Sugerman, "KD-Tree Acceleration Structures for a GPU Raytracer", 2005, for restart; D. R. Horn,
 * J. Sugerman, M. Houston, P. Hanrahan, "Interactive k-D Tree GPU Raytracing", 2007, for push-down and the short
 * stack; S. Laine, "Restart Trail for Stackless BVH Traversal", 2010, for the bits that say what was done.
 *
 * The published restart knows one distance: how far the ray has come. Here cells overlap by the slack, some are
 * shorter than it, and a ray in a split plane is in cells on both sides all the way: no distance tells what is done.
 * One bit a level does: set where the near child is done and the far one is not. So a restart goes down by the steps
 * of the stack traversal with the same intervals to the bit, and visits the same leaves in the same order.
 *
 *   restart      begins at the root
 *   push-down    begins at the deepest node above which nothing waits
 *   short stack  is a stack of a few places, where the newest takes the place of the oldest; when it is empty and
 *                something still waits, push-down finds it
 *
 * Invariants: `waiting` has the levels on the path whose far child is still to be visited; `done` those where the path
 * took the far child in its turn. Read as a number with the top level highest, `done` grows from leaf to leaf, so the
 * loop ends. Cost: a plane crossing a node, and down again from the start for each leaf. */

/* Bits of levels: the entry's is the highest. */
#define KDR_TOP_LEVEL ((uint64_t)1 << 63)

#ifndef KDR_SHORT_STACK
#define KDR_SHORT_STACK 4 /* a power of two */
#endif

typedef struct STEP(place) {
    uint32_t node;
    REAL enter, leave;
    uint64_t level;
} STEP(place);

static inline __attribute__((always_inline)) bool STEP(restart)(const kdr_search s, uint32_t root,
                                                                const STEP(ray) * r) {
    const bool keeps = s.trace == KDR_TRACE_SHORT_STACK, moves = s.trace != KDR_TRACE_RESTART;
    STEP(place) start = {root, r->tmin, r->tmax, KDR_TOP_LEVEL}, at = start, ring[KDR_SHORT_STACK];
    uint32_t top = 0, kept = 0;
    uint64_t waiting = 0, done = 0;
    for (;;) {
        /* Go down to a leaf. */
        kdr_node node = kdr_search_node(s, at.node);
        while (!kdr_node_is_leaf(node)) {
            uint32_t axis = kdr_node_axis(node);
            uint32_t near_index = kdr_node_child(node) + r->near_is_right[axis];
            REAL near_leave, far_enter;
            STEP(side) side = STEP(cross)(r, axis, kdr_node_plane(node), at.enter, at.leave, &near_leave, &far_enter);
            bool behind = KDR_SEARCH_IS_BEHIND(s, far_enter);
            at.node = near_index;
            if (side == STEP(far_only)) {
                at.node = near_index ^ 1;
            } else if (side == STEP(both) && (done & at.level) == 0) {
                if (!behind) {
                    waiting |= at.level;
                    if (keeps) {
                        ring[top++ % KDR_SHORT_STACK] =
                            (STEP(place)){near_index ^ 1, far_enter, at.leave, at.level >> 1};
                        kept += kept < KDR_SHORT_STACK;
                    }
                }
                at.leave = near_leave;
            } else if (side == STEP(both)) {
                at.node = near_index ^ 1;
                at.enter = far_enter;
                if (behind) {
                    node = kdr_node_leaf(0, 0);
                    break;
                }
            }
            at.level >>= 1;
            if (moves && waiting == 0)
                start = at;
            node = kdr_search_node(s, at.node);
        }
        if (kdr_search_leaf(s, node))
            return true;

        /* Turn to the far child at the deepest level where one waits. */
        bool found;
        do {
            if (waiting == 0)
                return kdr_search_end(s);
            uint64_t level = waiting & -waiting;
            waiting ^= level;
            done = (done & -level) | level;
            found = keeps && kept > 0;
            if (found) {
                kept--;
                at = ring[--top % KDR_SHORT_STACK];
            }
        } while (found && KDR_SEARCH_IS_BEHIND(s, at.enter));
        if (!found) {
            at = start;
            waiting = 0;
        }
    }
}
