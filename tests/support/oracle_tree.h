/* A tree of the oracle's own, for scenes too large for brute force: boxes halved at the median of their longest axis.
 *
 * Boxes are exact and the distances of their sides get a margin far above what doubles can be wrong by, so no triangle
 * that the ray hits is ever passed over. Answers are those of oracle_closest and oracle_any.
 * Cost: O(n log n) to make, O(log n) boxes a ray. */
#ifndef KDR_TESTS_SUPPORT_ORACLE_TREE_H
#define KDR_TESTS_SUPPORT_ORACLE_TREE_H

#include "support/oracle.h"

typedef struct oracle_node {
    float low[3], high[3];
    uint32_t first; /* leaf: in `order`; interior: number of the right child, the left one follows its parent */
    uint32_t count; /* of a leaf's primitives; 0: interior */
} oracle_node;

typedef struct oracle_tree {
    const oracle_scene *scene; /* outlives the tree */
    uint32_t *order;           /* numbers of the primitives, leaf by leaf */
    oracle_node *nodes;
    uint32_t node_count;
} oracle_tree;

/* Aborts without memory. */
oracle_tree oracle_tree_create(const oracle_scene *scene);
void oracle_tree_destroy(oracle_tree *tree);

oracle_hit oracle_tree_closest(const oracle_tree *tree, const kdr_ray *ray);
bool oracle_tree_any(const oracle_tree *tree, const kdr_ray *ray);

#endif
