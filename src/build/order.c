/* The table of orders. */
#include "build/order.h"

#include "base/check.h"

const kdr_order *kdr_order_for(kdr_order_rule rule) {
    static const kdr_order *const rows[] = {
        [KDR_ORDER_DEPTH_FIRST] = &kdr_order_depth_first,
        [KDR_ORDER_BREADTH_FIRST] = &kdr_order_breadth_first,
    };
    KDR_CHECK((size_t)rule < sizeof rows / sizeof rows[0]);
    return rows[rule];
}
