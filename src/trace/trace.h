/* Traversals as a table of functions, one table for each instruction set. */
#ifndef KDR_TRACE_TRACE_H
#define KDR_TRACE_TRACE_H

#include "kdray/kdray.h"
#include "trace/packet.h"
#include "tree/tree.h"

/* Where a traversal starts. The root's entry is {0, bounds}; a beam may find a deeper one. */
typedef struct kdr_entry {
    uint32_t node;
    kdr_box box; /* of the node's cell */
} kdr_entry;

/* What a closest-hit traversal found. */
typedef struct kdr_found {
    float t, u, v;
    float normal[3];
    uint32_t primitive; /* UINT32_MAX: nothing */
} kdr_found;

typedef struct kdr_traversals {
    /* True, and *found filled in, if the ray hits something. */
    bool (*stack_closest)(const kdr_tree *tree, const kdr_entry *entry, const kdr_ray *ray, kdr_found *found);
    bool (*stack_any)(const kdr_tree *tree, const kdr_entry *entry, const kdr_ray *ray);

    /* The same answers by the fastest way for a lone ray from the root. It may want the tree's wide nodes. */
    bool wants_wide;
    bool (*single_closest)(const kdr_tree *tree, const kdr_ray *ray, kdr_found *found);
    bool (*single_any)(const kdr_tree *tree, const kdr_ray *ray);

    /* The same for a packet, on any tree. packet_any gives one bit a ray. */
    bool takes_any_apart; /* packet_any is also the fastest way for rays that do not go together */
    void (*packet_closest)(const kdr_tree *tree, const kdr_packet_rays *rays, kdr_packet_found *found);
    uint64_t (*packet_any)(const kdr_tree *tree, const kdr_packet_rays *rays);
} kdr_traversals;

/* A lone ray from the root, closest hit and any hit; as stack_closest and stack_any. */
typedef struct kdr_lone {
    bool (*closest)(const kdr_tree *tree, const kdr_ray *ray, kdr_found *found);
    bool (*any)(const kdr_tree *tree, const kdr_ray *ray);
} kdr_lone;

/* Traversals of the kd-tree by name: [trace rule][nodes rule][0: no mailbox, 1: of the tree's mailbox_size]. NULL where
 * there is none. The tree has the annexes that they want: arrays, and links for backtrack. */
typedef struct kdr_named_traversals {
    kdr_lone of[KDR_TRACE_BACKTRACK + 1][2][2];
} kdr_named_traversals;

/* The tables for an instruction set that this machine has. */
const kdr_traversals *kdr_traversals_for(kdr_isa isa);
const kdr_named_traversals *kdr_named_traversals_for(kdr_isa isa);

/* How a plan asks a lone ray. The rules go together, as kdr_scene_commit checks. */
kdr_lone kdr_lone_for(kdr_isa isa, kdr_trace_rule trace, kdr_nodes_rule nodes, kdr_mailbox_rule mailbox);

static inline kdr_entry kdr_entry_root(const kdr_tree *tree) { return (kdr_entry){0, tree->bounds}; }

#endif
