/* What is opened next: a row of functions for each order. */
#ifndef KDR_BUILD_ORDER_H
#define KDR_BUILD_ORDER_H

#include "build/work.h"

typedef struct kdr_order {
    /* Opens tasks and all that comes of them, by all workers. Memory of the tasks is given back, also on failure. */
    kdr_status (*run)(kdr_build_state *state, const kdr_build_task *tasks, uint32_t count);

    /* Memory of child->memory_size bytes for a child of a node of `count` references; 64-byte aligned. Sets
     * child->memory if it must be put back to the bulk on its own. NULL when there is none. */
    void *(*give)(kdr_build_state *state, kdr_build_worker *worker, uint32_t count, kdr_build_task *child);
} kdr_order;

extern const kdr_order kdr_order_depth_first, kdr_order_breadth_first;

const kdr_order *kdr_order_for(kdr_order_rule rule);

/* Nodes of more references are opened by all workers together, where the share lets them. */
#define KDR_SHARED_LIMIT 65536

#endif
