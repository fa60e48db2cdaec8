/* Which triangles of a block may be near enough to a point: two filters in floats over all lanes, both of which keep
 * every triangle that is.
 *
 * By boxes: squares of the distances to them, against the square searched for, with room for roundings.
 *
 * By a plane: all points x of a triangle have g . x >= the least g . corner, for any direction g whatever; seen from
 * the query point, a triangle with g . corner > T |g| for all corners is farther away than T. With g the direction to
 * its closest point this is as sharp as the distance itself, and g need not be exact, only the three products, whose
 * errors are within 2^-22 |g| of the longest distance to a corner. Cost: some 140 operations, so it is asked where
 * boxes have left several triangles. */
#ifndef KDR_TRACE_NEAR_LANES_H
#define KDR_TRACE_NEAR_LANES_H

#include "geometry/lanes.h"
#include "tree/tree.h"

typedef struct near_limit {
    float square;   /* of a box, at most: not less than the one searched for */
    float plane;    /* the square of T */
    float reach;    /* no corner of the tree's is farther away */
    bool has_plane; /* the numbers are in the range of the second filter: nothing overflows or is lost */
} near_limit;

/* Has a limit stand for a square. In float each of a box's three differences, squares and sums is rounded, less than
 * 2^-21 in all, and at most 2^-147 is added below the smallest floats. */
KDR_LANES_INLINE void near_limit_set(near_limit *limit, double square) {
    double most = square * (1 + 0x1p-20) + 0x1p-140;
    limit->square = most < 0x1p127 ? (float)most : INFINITY;
    double distance = sqrt(square) * (1 + 0x1p-16) + 0x1p-20 * limit->reach;
    limit->plane = distance < 0x1p63 ? (float)(distance * distance) : INFINITY;
}

KDR_LANES_INLINE void near_limit_begin(near_limit *limit, const kdr_tree *tree, const float query[3], double square) {
    double reach = 0;
    for (int k = 0; k < 3; k++) {
        double below = (double)query[k] - tree->bounds.lo[k], above = (double)tree->bounds.hi[k] - query[k];
        reach += fmax(fabs(below), fabs(above));
    }
    limit->has_plane = KDR_LANES > 1 && reach > 0x1p-30 && reach < 0x1p30;
    limit->reach = limit->has_plane ? (float)reach : 1;
    near_limit_set(limit, square);
}

/* Adds one axis to the squares of the distances to boxes. */
KDR_LANES_INLINE kdr_lanes_f near_add_axis(kdr_lanes_f square, kdr_lanes_f lo, kdr_lanes_f hi, float query) {
    kdr_lanes_f at = kdr_lanes_all(query);
    kdr_lanes_f beyond = kdr_lanes_max(kdr_lanes_max(lo - at, at - hi), kdr_lanes_all(0));
    return kdr_lanes_add_product(square, beyond, beyond);
}

/* Lanes from `first` on where the triangle's box is not surely beyond the limit; with a cell, its part in the cell. */
KDR_LANES_INLINE kdr_lane_bits near_boxes(kdr_block block, size_t first, const kdr_box *cell, const float query[3],
                                          const near_limit *limit) {
    kdr_lanes_f square = kdr_lanes_all(0);
    for (size_t k = 0; k < 3; k++) {
        const float *row = block.rows + k * block.length + first;
        kdr_lanes_f a = kdr_lanes_load(row), b = kdr_lanes_load(row + 3 * block.length);
        kdr_lanes_f c = kdr_lanes_load(row + 6 * block.length);
        kdr_lanes_f lo = kdr_lanes_min(kdr_lanes_min(a, b), c), hi = kdr_lanes_max(kdr_lanes_max(a, b), c);
        if (cell) {
            lo = kdr_lanes_max(lo, kdr_lanes_all(cell->lo[k]));
            hi = kdr_lanes_min(hi, kdr_lanes_all(cell->hi[k]));
        }
        square = near_add_axis(square, lo, hi, query[k]);
    }
    return ~kdr_lanes_less(kdr_lanes_all(limit->square), square) & kdr_lanes_first((uint32_t)(block.shown - first));
}

KDR_LANES_INLINE kdr_lanes_f near_dot(const kdr_lanes_f p[3], const kdr_lanes_f q[3]) {
    return kdr_lanes_add_product(kdr_lanes_add_product(p[0] * q[0], p[1], q[1]), p[2], q[2]);
}

KDR_LANES_INLINE void near_cross(const kdr_lanes_f p[3], const kdr_lanes_f q[3], kdr_lanes_f product[3]) {
    for (int k = 0; k < 3; k++)
        product[k] = kdr_lanes_less_product(p[(k + 1) % 3] * q[(k + 2) % 3], p[(k + 2) % 3], q[(k + 1) % 3]);
}

/* Squares that those of the lanes' triangles are not less than, but for what is in near_limit.plane. */
KDR_LANES_INLINE kdr_lanes_f near_planes(kdr_block block, size_t first, const float query[3]) {
    kdr_lanes_f corner[3][3], edge[3][3], normal[3], product[3];
    for (size_t i = 0; i < 3; i++)
        for (size_t k = 0; k < 3; k++)
            corner[i][k] = kdr_lanes_load(block.rows + (3 * i + k) * block.length + first) - kdr_lanes_all(query[k]);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            edge[i][k] = corner[(i + 1) % 3][k] - corner[i][k];

    /* The closest point of the edges, about. */
    kdr_lanes_f to[3] = {{0}, {0}, {0}}, least = kdr_lanes_all(INFINITY);
    for (int i = 0; i < 3; i++) {
        kdr_lanes_f along = -near_dot(corner[i], edge[i]) * kdr_lanes_reciprocal(near_dot(edge[i], edge[i]));
        along = kdr_lanes_min(kdr_lanes_max(along, kdr_lanes_all(0)), kdr_lanes_all(1));
        kdr_lanes_f point[3];
        for (int k = 0; k < 3; k++)
            point[k] = kdr_lanes_add_product(corner[i][k], along, edge[i][k]);
        kdr_lanes_f square = near_dot(point, point);
        kdr_lane_bits less = i == 0 ? KDR_LANE_BITS_ALL : kdr_lanes_less(square, least);
        least = kdr_lanes_choose(less, square, least);
        for (int k = 0; k < 3; k++)
            to[k] = i == 0 ? point[k] : kdr_lanes_choose(less, point[k], to[k]);
    }

    /* The normal, where the query point is above the triangle. */
    near_cross(edge[0], edge[1], normal);
    kdr_lane_bits outside = 0;
    for (int i = 0; i < 3; i++) {
        near_cross(corner[i], corner[(i + 1) % 3], product);
        outside |= kdr_lanes_less(near_dot(product, normal), kdr_lanes_all(0));
    }
    for (int k = 0; k < 3; k++)
        to[k] = kdr_lanes_choose(outside, to[k], normal[k]);

    /* How far along it the corners are, on whichever side. */
    kdr_lanes_f a = near_dot(corner[0], to), b = near_dot(corner[1], to), c = near_dot(corner[2], to);
    kdr_lanes_f low = kdr_lanes_min(kdr_lanes_min(a, b), c), high = kdr_lanes_max(kdr_lanes_max(a, b), c);
    kdr_lanes_f apart = kdr_lanes_max(kdr_lanes_max(low, -high), kdr_lanes_all(0)), length = near_dot(to, to);
    kdr_lane_bits known = kdr_lanes_less(kdr_lanes_all(0x1p-110f), length);
    return kdr_lanes_choose(known, apart * (apart * kdr_lanes_reciprocal(length)), kdr_lanes_all(0));
}

/* Lanes of some squares that are not beyond the limit. */
KDR_LANES_INLINE kdr_lane_bits near_within(kdr_lanes_f squares, const near_limit *limit) {
    return ~kdr_lanes_less(kdr_lanes_all(limit->plane), squares);
}

#endif
