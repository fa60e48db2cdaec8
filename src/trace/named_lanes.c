/* Traversals of the kd-tree by name, with and without a mailbox, and over nodes in both layouts: a loop for each, with
 * every triangle test. */
#include "trace/lone_lanes.h"

KDR_WALK_IN_DOUBLE(stack_in_double, double_stack)
KDR_WALK_IN_DOUBLE(restart_in_double, double_restart)
KDR_WALK_IN_DOUBLE(backtrack_in_double, double_backtrack)

static const kdr_search stack = {.trace = KDR_TRACE_STACK}, stack_arrays = {.trace = KDR_TRACE_STACK, .arrays = true};
static const kdr_search restart = {.trace = KDR_TRACE_RESTART};
static const kdr_search restart_arrays = {.trace = KDR_TRACE_RESTART, .arrays = true};
static const kdr_search push_down = {.trace = KDR_TRACE_PUSH_DOWN}, short_stack = {.trace = KDR_TRACE_SHORT_STACK};
static const kdr_search backtrack = {.trace = KDR_TRACE_BACKTRACK};

KDR_LANES_INLINE bool find(kdr_search s, const kdr_tree *tree, const kdr_ray *ray, const bool mailed, const bool any,
                           kdr_walk_in_double *walk_in_double, kdr_found *found) {
    kdr_entry root = kdr_entry_root(tree);
    kdr_ray_frame f;
    kdr_closest closest;
    kdr_mailbox mailbox;
    s.tree = tree;
    s.quick = true;
    s.any = any;
    s.closest = any ? NULL : &closest;
    s.mailbox = mailed ? &mailbox : NULL;
    if (mailed)
        kdr_mailbox_begin(&mailbox, tree->mailbox_size);
    if (!any)
        kdr_closest_begin(&closest, ray->tmax);
    bool hit = kdr_search_run(s, &root, ray, &f, walk_in_double);
    if (hit && !any)
        kdr_search_report(&closest, &f, found);
    return kdr_search_leave(hit);
}

#define LONE(search, mailed, walk_in_double)                                                                           \
    static bool search##_closest_##mailed(const kdr_tree *tree, const kdr_ray *ray, kdr_found *found) {                \
        return find(search, tree, ray, mailed, false, walk_in_double, found);                                          \
    }                                                                                                                  \
    static bool search##_any_##mailed(const kdr_tree *tree, const kdr_ray *ray) {                                      \
        return find(search, tree, ray, mailed, true, walk_in_double, NULL);                                            \
    }
#define BOTH(search, walk_in_double)                                                                                   \
    LONE(search, false, walk_in_double)                                                                                \
    LONE(search, true, walk_in_double)

BOTH(stack, stack_in_double)
BOTH(stack_arrays, stack_in_double)
BOTH(restart, restart_in_double)
BOTH(restart_arrays, restart_in_double)
BOTH(push_down, restart_in_double)
BOTH(short_stack, restart_in_double)
BOTH(backtrack, backtrack_in_double)

#define ROW(search)                                                                                                    \
    { {search##_closest_false, search##_any_false}, {search##_closest_true, search##_any_true}, }

extern const kdr_named_traversals KDR_LANES_SYMBOL(kdr_named_traversals);
const kdr_named_traversals KDR_LANES_SYMBOL(kdr_named_traversals) = {{
    [KDR_TRACE_STACK] = {ROW(stack), ROW(stack_arrays)},
    [KDR_TRACE_RESTART] = {ROW(restart), ROW(restart_arrays)},
    [KDR_TRACE_PUSH_DOWN] = {ROW(push_down)},
    [KDR_TRACE_SHORT_STACK] = {ROW(short_stack)},
    [KDR_TRACE_BACKTRACK] = {ROW(backtrack)},
}};
