/* Searches about a point as a table of functions, one table for each instruction set: all give the same answers. */
#ifndef KDR_TRACE_POINTS_H
#define KDR_TRACE_POINTS_H

#include "geometry/triangle_point.h"
#include "tree/tree.h"

typedef struct kdr_nearest {
    kdr_surface_point point;
    uint32_t primitive; /* UINT32_MAX: nothing yet, and point.square is the largest that counts */
} kdr_nearest;

/* False ends the search. */
typedef bool kdr_near_fn(const kdr_nearest *found, void *context);

/* Coordinates of `query` are finite. */
typedef struct kdr_point_searches {
    /* Makes *nearest the closest of itself and the tree's primitives; of equal squares the lowest primitive. */
    void (*closest)(const kdr_tree *tree, const float query[3], kdr_nearest *nearest);

    /* Calls visit once for each primitive whose square is at most `square`. False if visit ended it. */
    bool (*within)(const kdr_tree *tree, const float query[3], double square, kdr_near_fn *visit, void *context);
} kdr_point_searches;

/* The table for an instruction set that this machine has. */
const kdr_point_searches *kdr_point_searches_for(kdr_isa isa);

#endif
