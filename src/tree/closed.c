#include "tree/closed.h"

#include <sched.h>

kdr_node kdr_tree_node_settled(const kdr_tree *tree, uint32_t index) {
    for (;;) {
        kdr_node node = kdr_tree_node(tree, index);
        if (!kdr_node_is_closed(node) ||
            __atomic_load_n(&tree->closed->state[index], __ATOMIC_ACQUIRE) == KDR_CLOSED_FOR_GOOD)
            return node;
        sched_yield();
    }
}

uint32_t kdr_closed_child(const kdr_tree *tree, uint32_t child) {
    uint32_t index = (child & ~KDR_WIDE_LEAF) >> KDR_WIDE_GROUP_BITS;
    if (index >= tree->closed->committed_count || kdr_node_is_closed(kdr_tree_node(tree, index)))
        return child;
    uint32_t below = __atomic_load_n(&tree->closed->child[index], __ATOMIC_RELAXED);
    return below != 0 ? below : child;
}

size_t kdr_tree_node_bytes(const kdr_tree *tree) {
    const kdr_closed *c = tree->closed;
    size_t bytes = tree->node_bytes + tree->wide_bytes;
    if (!c)
        return bytes;
    uint32_t pairs = __atomic_load_n(&c->pair_count, __ATOMIC_RELAXED);
    uint32_t wide = __atomic_load_n(&c->wide_count, __ATOMIC_RELAXED);
    size_t free_pairs = pairs < c->pair_room ? c->pair_room - pairs : 0;
    size_t free_wide = wide < c->wide_room ? c->wide_room - wide : 0;
    return bytes - free_pairs * 2 * sizeof(kdr_node) - free_wide * sizeof(kdr_wide_node);
}

size_t kdr_tree_block_bytes(const kdr_tree *tree) {
    const kdr_closed *c = tree->closed;
    if (!c)
        return tree->block_bytes;
    uint32_t groups = __atomic_load_n(&c->group_count, __ATOMIC_RELAXED);
    return tree->block_bytes - (groups < c->group_room ? c->group_room - groups : 0) * KDR_BLOCK_GROUP_BYTES;
}
