/* Precomputed projections: for each triangle of a block its plane and its edges as seen along the axis on which its
 * normal is longest, in place of its corners. An annex, laid out as the blocks are, for the triangle test of that name.
 *
 *   row   0    1    2    3    4    5    6    7    8    9
 *         n_u  n_v  n_d  b_u  b_v  b_d  c_u  c_v  c_d  axis
 *
 * With k the axis and u, v the next two, the plane is x_k + n_u x_u + n_v x_v = n_d, and the weights of corners b and c
 * at a point of it are b_u x_u + b_v x_v + b_d and c_u x_u + c_v x_v + c_d.
 * Source: I. Wald, "Realtime Ray Tracing and Interactive Global Illumination", thesis, 2004, section 7.1. */
#ifndef KDR_TREE_PROJECTIONS_H
#define KDR_TREE_PROJECTIONS_H

#include "tree/tree.h"

/* Made in double, one triangle after the other. False when there is no memory. */
bool kdr_tree_add_projections(kdr_tree *tree, kdr_bulk *bulk);

#endif
