/* Who works on what: a row of functions for each way to divide a scene among the workers. */
#ifndef KDR_BUILD_SHARE_H
#define KDR_BUILD_SHARE_H

#include "build/work.h"

#define KDR_MAX_REGIONS 1024

typedef struct kdr_share {
    /* Nodes that are large are opened by all workers together. */
    bool together;

    /* Who opens a node may hand its right child over to another worker. */
    bool hands_over;

    /* Divides the root into regions, about `count` of them, each a task of its own: their cells do not overlap, and
     * each has every reference that reaches into it. Writes the nodes above them. tasks: room for KDR_MAX_REGIONS.
     * Returns how many regions were made; takes the root's memory over. On failure the state says why, and regions made
     * so far are returned. NULL: the root is the only task. */
    uint32_t (*divide)(kdr_build_state *state, kdr_build_task *root, uint32_t count, kdr_build_task *tasks);
} kdr_share;

extern const kdr_share kdr_share_none, kdr_share_serial, kdr_share_line, kdr_share_grid, kdr_share_cluster;

const kdr_share *kdr_share_for(kdr_share_rule rule);

#endif
