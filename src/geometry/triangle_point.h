/* The point of a triangle that is closest to a query point, in doubles.
 *
 * A face's point is found by weights from the triangle's normal, an edge's by projection; only edges whose outer side
 * the query point is on can have it. Triangles so thin that their normal is in doubt have all edges asked as well.
 *
 * What searches rely on:
 *   the point lies in the triangle's box, to the bit, so in every cell and box that encloses what lies there of it;
 *   `square` is kdr_point_square of that very point. Rounding keeps order, so a box that holds the point is never
 *   farther by kdr_box_square, and is left out by comparing the two, with no room for errors;
 *   the ends of an edge are put in order first, so triangles that share it give the same point for it.
 *
 * The distance is never less than the exact one by more than 2^-50 of the largest coordinate, and never more by more
 * than that and 2^-20 of the triangle's size, which only the thinnest of triangles come near.
 * Cost: some 60 operations for a face, 30 for an edge. Coordinates are finite; no product leaves the range of double.
 */
#ifndef KDR_GEOMETRY_TRIANGLE_POINT_H
#define KDR_GEOMETRY_TRIANGLE_POINT_H

#include <math.h>
#include <stdbool.h>

typedef struct kdr_surface_point {
    double square; /* of its distance to the query point */
    double at[3];
    double u, v; /* at = (1 - u - v) a + u b + v c */
} kdr_surface_point;

static inline double kdr_point_square(const float query[3], const double at[3]) {
    double x = at[0] - query[0], y = at[1] - query[1], z = at[2] - query[2];
    return (x * x + y * y) + z * z;
}

/* The square of the distance to an interval on one axis: 0 inside. The terms of kdr_box_square. */
static inline double kdr_interval_square(float query, float lo, float hi) {
    double below = (double)lo - query, above = (double)query - hi, x = below > above ? below : above;
    return x > 0 ? x * x : 0;
}

/* At most kdr_point_square of any point of the box. */
static inline double kdr_box_square(const float query[3], const float lo[3], const float hi[3]) {
    double x = kdr_interval_square(query[0], lo[0], hi[0]), y = kdr_interval_square(query[1], lo[1], hi[1]),
           z = kdr_interval_square(query[2], lo[2], hi[2]);
    return (x + y) + z;
}

static inline double kdr_clamp(double x, double lo, double hi) { return x < lo ? lo : x > hi ? hi : x; }

static inline void kdr_cross(const double p[3], const double q[3], double product[3]) {
    for (int k = 0; k < 3; k++)
        product[k] = p[(k + 1) % 3] * q[(k + 2) % 3] - p[(k + 2) % 3] * q[(k + 1) % 3];
}

static inline double kdr_dot(const double p[3], const double q[3]) { return (p[0] * q[0] + p[1] * q[1]) + p[2] * q[2]; }

static inline bool kdr_comes_before(const float a[3], const float b[3]) {
    for (int k = 0; k < 3; k++)
        if (a[k] != b[k])
            return a[k] < b[k];
    return false;
}

/* The closest point of the edge from p to q; *along is its place on it, from 0 to 1. */
static inline void kdr_edge_point(const float query[3], const float p[3], const float q[3], double at[3],
                                  double *along) {
    bool turned = kdr_comes_before(q, p);
    const float *from = turned ? q : p, *to = turned ? p : q;
    double edge[3], seen[3];
    for (int k = 0; k < 3; k++) {
        edge[k] = (double)to[k] - from[k];
        seen[k] = (double)query[k] - from[k];
    }
    double t = kdr_dot(seen, edge) / kdr_dot(edge, edge);
    t = t > 0 ? (t < 1 ? t : 1) : 0;
    for (int k = 0; k < 3; k++) {
        double lo = from[k] < to[k] ? from[k] : to[k], hi = from[k] < to[k] ? to[k] : from[k];
        at[k] = t == 1 ? to[k] : kdr_clamp(from[k] + t * edge[k], lo, hi);
    }
    *along = turned ? 1 - t : t;
}

/* Takes the closest point of edge number i, from corner i to the next, if that is closer. */
static inline void kdr_take_edge(const float query[3], const float corner[3][3], int i, kdr_surface_point *closest) {
    kdr_surface_point p;
    double along;
    kdr_edge_point(query, corner[i], corner[(i + 1) % 3], p.at, &along);
    p.square = kdr_point_square(query, p.at);
    if (!(p.square < closest->square))
        return;
    p.u = i == 0 ? along : i == 1 ? 1 - along : 0;
    p.v = i == 0 ? 0 : i == 1 ? along : 1 - along;
    *closest = p;
}

/* The closest point of triangle a, b, c. */
static inline kdr_surface_point kdr_triangle_point(const float query[3], const float corner[3][3]) {
    double edge[3][3], seen[3][3], normal[3], product[3], side[3];
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            edge[i][k] = (double)corner[(i + 1) % 3][k] - corner[i][k];
            seen[i][k] = (double)query[k] - corner[i][k];
        }
    }
    kdr_cross(edge[0], edge[1], normal);

    /* On which side of each edge the query point lies, above the plane: positive is inside. */
    bool inside = true;
    for (int i = 0; i < 3; i++) {
        kdr_cross(edge[i], seen[i], product);
        side[i] = kdr_dot(product, normal);
        inside = inside && side[i] >= 0;
    }
    double longest = 0;
    for (int i = 0; i < 3; i++)
        longest = fmax(longest, kdr_dot(edge[i], edge[i]));
    bool thin = !(kdr_dot(normal, normal) > 0x1p-40 * longest * longest);

    kdr_surface_point closest = {.square = INFINITY};
    for (int i = 0; i < 3; i++)
        if (side[i] < 0 || thin)
            kdr_take_edge(query, corner, i, &closest);
    double sum = (side[0] + side[1]) + side[2];
    if (!inside || !(sum > 0))
        return closest;

    /* The weight of a corner is the side of the edge across from it. */
    kdr_surface_point face = {.u = side[2] / sum, .v = side[0] / sum};
    for (int k = 0; k < 3; k++) {
        double a = corner[0][k], b = corner[1][k], c = corner[2][k];
        double least = a < b ? a : b, most = a < b ? b : a;
        face.at[k] =
            kdr_clamp(a + (face.u * edge[0][k] - face.v * edge[2][k]), least < c ? least : c, most > c ? most : c);
    }
    face.square = kdr_point_square(query, face.at);
    return face.square < closest.square ? face : closest;
}

#endif
