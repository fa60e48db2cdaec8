/* What lies on a ray's way through a tree, whatever a traversal makes of it. */
#ifndef KDR_TRACE_COST_H
#define KDR_TRACE_COST_H

#include "kdray/cost.h"
#include "tree/tree.h"

/* Adds the nodes, leaves and primitives that the ray passes up to its tmax. */
void kdr_cost_add(const kdr_tree *tree, const kdr_ray *ray, kdr_ray_cost *cost);

#endif
