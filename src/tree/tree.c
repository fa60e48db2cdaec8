#include "tree/boxed.h"
#include "tree/closed.h"

bool kdr_tree_reserve(kdr_tree *tree, kdr_bulk *bulk, uint32_t node_count, uint32_t group_count) {
    size_t node_bytes = (size_t)node_count * sizeof(kdr_node);
    size_t group_bytes = (size_t)group_count * kdr_leaf_group_bytes(tree->boxed);
    size_t block_bytes = group_bytes + KDR_BLOCK_TAIL_BYTES;
    size_t node_size = node_bytes, block_size = block_bytes;
    kdr_node *nodes = kdr_bulk_get(bulk, &node_size);
    float *blocks = kdr_bulk_get(bulk, &block_size);
    if (!nodes || !blocks) {
        kdr_bulk_put(bulk, nodes, node_bytes);
        kdr_bulk_put(bulk, blocks, block_bytes);
        return false;
    }

    /* What is read past the last block must be numbers, though nobody cares which. */
    memset((char *)blocks + group_bytes, 0, KDR_BLOCK_TAIL_BYTES);
    tree->nodes = nodes;
    tree->blocks = blocks;
    tree->node_count = node_count;
    tree->group_count = group_count;
    tree->node_bytes = node_bytes;
    tree->block_bytes = block_bytes;
    return true;
}

bool kdr_tree_init_empty(kdr_tree *tree, kdr_bulk *bulk) {
    *tree = (kdr_tree){.bounds = kdr_box_empty(), .cost_traversal = 1, .cost_intersection = 1};
    if (!kdr_tree_reserve(tree, bulk, 2, 0))
        return false;
    tree->nodes[0] = tree->nodes[1] = kdr_node_leaf(0, 0);
    return true;
}

void kdr_tree_release(kdr_tree *tree, kdr_bulk *bulk) {
    if (tree->closed)
        tree->closed->release(tree->closed, bulk);
    kdr_bulk_put(bulk, tree->nodes, tree->node_bytes);
    kdr_bulk_put(bulk, tree->blocks, tree->block_bytes);
    kdr_bulk_put(bulk, tree->wide, tree->wide_bytes);
    kdr_bulk_put(bulk, tree->arrays.plane, tree->arrays.bytes);
    kdr_bulk_put(bulk, tree->links.box, tree->links.bytes);
    kdr_bulk_put(bulk, tree->projections.rows, tree->projections.bytes);
    *tree = (kdr_tree){.bounds = kdr_box_empty()};
}
