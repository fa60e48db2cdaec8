#include "tree/walk.h"

#include "tree/closed.h"

bool kdr_tree_walk_steps(const kdr_tree *tree, kdr_walk_step_fn *visit, void *context) {
    kdr_walk stack[KDR_MAX_DEPTH + 2];
    uint32_t top = 0;
    stack[top++] = (kdr_walk){0, 0, tree->bounds};
    while (top > 0) {
        kdr_walk at = stack[--top];
        if (at.node >= tree->node_count || at.depth > KDR_MAX_DEPTH)
            return false;
        kdr_node node = kdr_tree_node_settled(tree, at.node);
        kdr_cell_step step = visit(tree, &at, context);
        if (step == KDR_CELL_STOP)
            return false;
        if (step == KDR_CELL_PAST || kdr_node_is_leaf(node))
            continue;
        uint32_t axis = kdr_node_axis(node);
        kdr_walk left = {kdr_node_child(node), at.depth + 1, at.cell}, right = left;
        right.node++;
        left.cell.hi[axis] = right.cell.lo[axis] = kdr_node_plane(node);
        stack[top++] = right;
        stack[top++] = left;
    }
    return true;
}

typedef struct whole_walk {
    kdr_walk_fn *visit;
    void *context;
} whole_walk;

static kdr_cell_step visit_whole(const kdr_tree *tree, const kdr_walk *at, void *context) {
    const whole_walk *walk = context;
    return walk->visit(tree, at, walk->context) ? KDR_CELL_INTO : KDR_CELL_STOP;
}

bool kdr_tree_walk(const kdr_tree *tree, kdr_walk_fn *visit, void *context) {
    whole_walk walk = {visit, context};
    return kdr_tree_walk_steps(tree, visit_whole, &walk);
}
