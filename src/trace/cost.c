/* Counts what a ray passes on its way through a tree, up to a distance that is known before.
 *
 * A traversal front to back that ends at the closest hit visits the nodes whose interval begins no later than that
 * hit: nothing behind it is opened before it is found, and nothing before it is left out. So whoever knows the hit can
 * count in any order. Intervals are those of step.h in doubles, which hold for every ray; a ray in a split plane is on
 * both sides of it.
 *
 * Cost: one plane crossing a node. */
#include "trace/cost.h"

#include "geometry/ray_frame.h"
#include "tree/closed.h"

#define REAL double
#define EPSILON 0x1p-53
#define LARGEST 0x1p400
#define STEP(name) double_##name
#include "trace/step.h"

typedef struct passed {
    uint32_t node;
    double enter, leave;
} passed;

void kdr_cost_add(const kdr_tree *tree, const kdr_ray *ray, kdr_ray_cost *cost) {
    double_ray r;
    bool holds;
    if (!kdr_ray_is_valid(ray) || kdr_box_is_empty(&tree->bounds) || !double_begin(&r, ray, &tree->bounds, &holds))
        return;
    passed stack[KDR_MAX_DEPTH + 1];
    uint32_t top = 0;
    stack[top++] = (passed){0, r.tmin, r.tmax};
    while (top > 0) {
        passed at = stack[--top];
        for (;;) {
            kdr_node node = kdr_tree_node(tree, at.node);
            cost->nodes++;
            if (kdr_node_is_leaf(node)) {
                cost->leaves++;
                cost->primitives += kdr_node_count(node);
                break;
            }
            uint32_t axis = kdr_node_axis(node);
            double near_leave, far_enter;
            double_side side =
                double_cross(&r, axis, kdr_node_plane(node), at.enter, at.leave, &near_leave, &far_enter);
            at.node = kdr_node_child(node) + r.near_is_right[axis];
            if (side == double_far_only) {
                at.node ^= 1;
            } else if (side == double_both) {
                stack[top++] = (passed){at.node ^ 1, far_enter, at.leave};
                at.leave = near_leave;
            }
        }
    }
}
