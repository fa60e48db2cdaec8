#include "tree/walk.h"

bool kdr_tree_walk(const kdr_tree *tree, kdr_walk_fn *visit, void *context) {
    kdr_walk stack[KDR_MAX_DEPTH + 2];
    uint32_t top = 0;
    stack[top++] = (kdr_walk){0, 0, tree->bounds};
    while (top > 0) {
        kdr_walk at = stack[--top];
        if (at.node >= tree->node_count || at.depth > KDR_MAX_DEPTH || !visit(tree, &at, context))
            return false;
        kdr_node node = tree->nodes[at.node];
        if (kdr_node_is_leaf(node))
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
