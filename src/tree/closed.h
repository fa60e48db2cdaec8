/* Nodes that stay closed until a ray comes (SPEC B9).
 *
 * A closed node is a leaf like any other: its block holds all its triangles, and whoever asks it gets the right answer.
 * Who reaches it first opens it: builds the subtree below it in room that the commit has set aside, and then publishes
 * the node's new word with one release. Others that come meanwhile ask the block, so nobody waits. A node that cannot
 * be opened, because memory or room runs out, stays as it is.
 *
 * Invariant: a word that is not closed never changes again, and all that it leads to was written before it. */
#ifndef KDR_TREE_CLOSED_H
#define KDR_TREE_CLOSED_H

#include "tree/wide.h"

/* What is done about a closed node. */
typedef enum kdr_closed_state { KDR_CLOSED_IDLE, KDR_CLOSED_OPENING, KDR_CLOSED_FOR_GOOD } kdr_closed_state;

typedef struct kdr_closed kdr_closed;
struct kdr_closed {
    /* Opens a closed node, if nobody does already. Returns its word, which may still be closed. */
    kdr_node (*open)(kdr_closed *closed, const kdr_tree *tree, uint32_t node);
    void (*release)(kdr_closed *closed, kdr_bulk *bulk);
    const kdr_node *committed;                  /* the words of all nodes when the commit ended */
    uint32_t committed_count, committed_groups; /* nodes; groups of blocks */
    uint32_t *child; /* of each of them: what the wide tree has below it since it was opened; 0: nothing */
    uint8_t *state;  /* of each of them: a kdr_closed_state */
    uint32_t count;  /* of closed nodes when the commit ended */

    /* Change by atomic steps. */
    uint32_t opened_count;
    uint32_t pair_count, group_count, wide_count; /* of the room that are taken; they may exceed it */
    uint32_t pair_room, group_room, wide_room;
};

/* The word of a node on the way of a ray; opens the node. */
static inline kdr_node kdr_tree_node(const kdr_tree *tree, uint32_t index) {
    kdr_node node = __atomic_load_n(&tree->nodes[index], __ATOMIC_ACQUIRE);
    if (__builtin_expect(kdr_node_is_closed(node), 0))
        return tree->closed->open(tree->closed, tree, index);
    return node;
}

/* The same for who wants the whole tree: waits where another opens the node. A word that is closed stays so. */
kdr_node kdr_tree_node_settled(const kdr_tree *tree, uint32_t index);

uint32_t kdr_closed_child(const kdr_tree *tree, uint32_t child);

/* What a ray that reaches a leaf of the wide tree asks: the leaf, or the wide node that a closed one has become. */
static inline uint32_t kdr_wide_settle(const kdr_tree *tree, uint32_t child) {
    if (__builtin_expect((child & KDR_WIDE_MAX_GROUPS) != 0 || !tree->closed, 1))
        return child;
    return kdr_closed_child(tree, child);
}

/* The block of a child that is a leaf. A closed one keeps its block, whatever has become of it. */
static inline kdr_block kdr_wide_block(const kdr_tree *tree, uint32_t child) {
    uint32_t shown = child & KDR_WIDE_MAX_GROUPS, index = (child & ~KDR_WIDE_LEAF) >> KDR_WIDE_GROUP_BITS;
    if (__builtin_expect(shown == 0, 0)) {
        bool kept = tree->closed && index < tree->closed->committed_count;
        return kdr_block_of(tree->blocks, kept ? tree->closed->committed[index] : tree->nodes[index]);
    }
    return kdr_block_at(tree->blocks, index >> KDR_WIDE_GROUP_BITS, index & KDR_WIDE_MAX_GROUPS, shown);
}

/* Bytes of nodes and blocks that are in use. */
size_t kdr_tree_node_bytes(const kdr_tree *tree);
size_t kdr_tree_block_bytes(const kdr_tree *tree);

#endif
