/* An order as builders were written before they had pools, for comparison alone. */
#ifndef KDR_BENCH_PER_NODE_ORDER_H
#define KDR_BENCH_PER_NODE_ORDER_H

#include "build/order.h"

/* Depth first, like kdr_order_depth_first, and makes the same trees; but the references of every child and a pair of
 * nodes for every split are asked of the system's allocator one by one, and given back one by one. It has state of its
 * own: one build at a time in the process. */
const kdr_order *kdr_per_node_order(void);

#endif
