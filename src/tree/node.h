/* A node in one word.
 *
 *  63            32 31             2 1 0
 *  interior  [  split plane  ][  pair          ][axis]     children are nodes[2 * pair] and nodes[2 * pair + 1]
 *  leaf      [  item count   ][  first item    ][ 3  ]     first item: see block.h; bit 63: closed, see closed.h
 *
 * The left child holds what lies below the plane. Children are neighbours, so a sibling is index ^ 1, and pairs are
 * numbered, so a tree may have 2^31 nodes. The root is node 0 and node 1 is not used. */
#ifndef KDR_TREE_NODE_H
#define KDR_TREE_NODE_H

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

typedef uint64_t kdr_node;

#define KDR_NODE_LEAF 3u
#define KDR_NODE_MAX_INDEX ((1u << 30) - 1)
#define KDR_NODE_CLOSED ((kdr_node)1 << 63) /* of a leaf; its items are fewer than 2^31 */

static inline kdr_node kdr_node_interior(uint32_t axis, float plane, uint32_t pair) {
    uint32_t bits;
    memcpy(&bits, &plane, sizeof bits);
    return (uint64_t)bits << 32 | (uint64_t)pair << 2 | axis;
}

static inline kdr_node kdr_node_leaf(uint32_t count, uint32_t first) {
    return (uint64_t)count << 32 | (uint64_t)first << 2 | KDR_NODE_LEAF;
}

static inline bool kdr_node_is_leaf(kdr_node node) { return (node & 3) == KDR_NODE_LEAF; }

/* A leaf that the first ray makes a subtree of. */
static inline bool kdr_node_is_closed(kdr_node node) {
    const kdr_node bits = KDR_NODE_CLOSED | KDR_NODE_LEAF;
    return (node & bits) == bits;
}

static inline uint32_t kdr_node_axis(kdr_node node) { return node & 3; }

static inline float kdr_node_plane(kdr_node node) {
    uint32_t bits = (uint32_t)(node >> 32);
    float plane;
    memcpy(&plane, &bits, sizeof plane);
    return plane;
}

/* Index of the left child; the right one follows. */
static inline uint32_t kdr_node_child(kdr_node node) { return ((uint32_t)node >> 2) * 2; }

static inline uint32_t kdr_node_count(kdr_node node) { return (uint32_t)(node >> 32) & 0x7fffffffu; }

static inline uint32_t kdr_node_first(kdr_node node) { return (uint32_t)node >> 2; }

#endif
