#include "tree/node_links.h"

#include "tree/walk.h"

static bool link_node(const kdr_tree *tree, const kdr_walk *at, void *context) {
    kdr_node_links *links = context;
    kdr_node node = tree->nodes[at->node];
    links->box[at->node] = at->cell;
    if (!kdr_node_is_leaf(node))
        links->parent[kdr_node_child(node)] = links->parent[kdr_node_child(node) + 1] = at->node;
    return true;
}

bool kdr_tree_add_links(kdr_tree *tree, kdr_bulk *bulk) {
    size_t count = tree->node_count, bytes = count * (sizeof(kdr_box) + sizeof(uint32_t)), size = bytes;
    char *memory = kdr_bulk_get(bulk, &size);
    if (!memory)
        return false;
    tree->links = (kdr_node_links){.box = (kdr_box *)(void *)memory,
                                   .parent = (uint32_t *)(void *)(memory + count * sizeof(kdr_box)),
                                   .bytes = bytes};
    tree->links.parent[0] = 0;
    kdr_tree_walk(tree, link_node, &tree->links);
    return true;
}
