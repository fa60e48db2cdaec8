/* What a ray costs, in any build: part of kdray/kdray.h, which includes it. */
#ifndef KDR_COST_H
#define KDR_COST_H

#include <stdint.h>

/* What lies on the way of one ray through the committed trees, up to its closest hit. */
typedef struct kdr_ray_cost {
    uint32_t nodes;      /* of the kd-trees, leaves included, whose cell the ray passes */
    uint32_t leaves;     /* of these */
    uint32_t primitives; /* in these leaves, each counted in every leaf */
} kdr_ray_cost;

#endif
