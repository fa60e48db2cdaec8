#include "tree/node_arrays.h"

bool kdr_tree_add_arrays(kdr_tree *tree, kdr_bulk *bulk) {
    size_t count = tree->node_count;
    size_t bytes = count * (sizeof(float) + 2 * sizeof(uint32_t) + sizeof(uint8_t)), size = bytes;
    char *memory = kdr_bulk_get(bulk, &size);
    if (!memory)
        return false;
    kdr_node_arrays arrays = {.plane = (float *)(void *)memory,
                              .link = (uint32_t *)(void *)(memory + count * sizeof(float)),
                              .count = (uint32_t *)(void *)(memory + count * (sizeof(float) + sizeof(uint32_t))),
                              .kind = (uint8_t *)memory + count * (sizeof(float) + 2 * sizeof(uint32_t)),
                              .bytes = bytes};
    for (size_t i = 0; i < count; i++) {
        kdr_node node = tree->nodes[i];
        bool leaf = kdr_node_is_leaf(node);
        arrays.plane[i] = leaf ? 0 : kdr_node_plane(node);
        arrays.link[i] = leaf ? kdr_node_first(node) : kdr_node_child(node) / 2;
        arrays.count[i] = leaf ? kdr_node_count(node) : 0;
        arrays.kind[i] = (uint8_t)(node & KDR_NODE_LEAF);
    }
    tree->arrays = arrays;
    return true;
}
