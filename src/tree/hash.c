/* The canonical hash: nodes in depth-first order, and of each leaf its set of primitives, so that memory order, chunks
 * and threads leave no trace. The mixing step is the finaliser of a 64-bit multiply-xorshift generator; it is no
 * defence against an adversary. */
#include "tree/boxed.h"
#include "tree/walk.h"

static uint64_t mix(uint64_t hash, uint64_t value) {
    hash = (hash ^ value) * 0x9e3779b97f4a7c15u;
    hash = (hash ^ (hash >> 32)) * 0xd6e8feb86659fd93u;
    return hash ^ (hash >> 29);
}

static bool hash_node(const kdr_tree *tree, const kdr_walk *at, void *context) {
    uint64_t *hash = context;
    kdr_node node = tree->nodes[at->node];
    if (!kdr_node_is_leaf(node)) {
        *hash = mix(*hash, (node & ~(uint64_t)UINT32_MAX) | kdr_node_axis(node));
        return true;
    }
    uint32_t count = kdr_node_count(node);
    *hash = mix(*hash, (uint64_t)count << 32 | KDR_NODE_LEAF);
    uint64_t sum = 0;
    for (uint32_t i = 0; i < count; i++)
        sum += mix(0, kdr_leaf_primitive(tree, node, i));
    *hash = mix(*hash, sum);
    return true;
}

uint64_t kdr_tree_hash(const kdr_tree *tree) {
    uint64_t hash = 0x6b64726179u;
    for (int k = 0; k < 3; k++) {
        uint32_t lo, hi;
        memcpy(&lo, &tree->bounds.lo[k], sizeof lo);
        memcpy(&hi, &tree->bounds.hi[k], sizeof hi);
        hash = mix(hash, (uint64_t)lo << 32 | hi);
    }
    kdr_tree_walk(tree, hash_node, &hash);
    return hash | 1; /* 0 is kept for "no tree" */
}
