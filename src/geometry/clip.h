/* The part of a triangle that lies in a box, as the bounds of a polygon.
 *
 * The triangle is cut at the box's six planes, one after the other, in double. A point on an edge is computed with a
 * few roundings of the largest coordinate; planes are moved outwards by many more, and so are the bounds in the end, so
 * that what the true polygon has inside the box is never lost. Twenty bits are left until the margin shows in a float.
 * Source: I. E. Sutherland, G. W. Hodgman, "Reentrant Polygon Clipping", 1974. Cost: some 200 operations. */
#ifndef KDR_GEOMETRY_CLIP_H
#define KDR_GEOMETRY_CLIP_H

#include "geometry/box.h"

#define KDR_CLIP_MARGIN 0x1p-44 /* of the largest coordinate, and */
#define KDR_CLIP_BESIDE 0x1p-17 /* of the triangle's longest extent */
#define KDR_CLIP_CORNERS 10     /* a triangle has three, each of six planes adds at most one */

typedef struct kdr_polygon {
    double corner[KDR_CLIP_CORNERS][3];
    int count;
} kdr_polygon;

/* Keeps what lies on one side of a plane: below it, or above it. */
static inline void kdr_polygon_cut(kdr_polygon *polygon, int axis, double plane, bool below) {
    kdr_polygon from = *polygon;
    polygon->count = 0;
    for (int i = 0; i < from.count; i++) {
        const double *a = from.corner[i], *b = from.corner[i + 1 < from.count ? i + 1 : 0];
        bool a_inside = below ? a[axis] <= plane : a[axis] >= plane;
        bool b_inside = below ? b[axis] <= plane : b[axis] >= plane;
        if (a_inside) {
            for (int k = 0; k < 3; k++)
                polygon->corner[polygon->count][k] = a[k];
            polygon->count++;
        }
        if (a_inside == b_inside)
            continue;
        double t = (plane - a[axis]) / (b[axis] - a[axis]);
        for (int k = 0; k < 3; k++)
            polygon->corner[polygon->count][k] = k == axis ? plane : a[k] + (b[k] - a[k]) * t;
        polygon->count++;
    }
}

/* The nearest float that is not above, or not below. */
static inline float kdr_float_below(double x) {
    float near = (float)x;
    return (double)near > x ? nextafterf(near, -INFINITY) : near;
}

static inline float kdr_float_above(double x) {
    float near = (float)x;
    return (double)near < x ? nextafterf(near, INFINITY) : near;
}

/* False if the triangle surely does not meet the box. *part lies inside the box and holds all that does. */
static inline bool kdr_triangle_clip(const float corners[3][3], const kdr_box *box, kdr_box *part) {
    kdr_polygon polygon = {.count = 3};
    double margin[3], beside = 0;
    for (int k = 0; k < 3; k++) {
        double largest = fmax(fabs(box->lo[k]), fabs(box->hi[k])), lo = corners[0][k], hi = lo;
        for (int i = 0; i < 3; i++) {
            double x = polygon.corner[i][k] = corners[i][k];
            largest = fmax(largest, fabs(x));
            lo = fmin(lo, x);
            hi = fmax(hi, x);
        }
        margin[k] = largest * KDR_CLIP_MARGIN;
        beside = fmax(beside, (hi - lo) * KDR_CLIP_BESIDE);
    }
    for (int k = 0; k < 3; k++)
        margin[k] += beside;
    for (int k = 0; k < 3 && polygon.count > 0; k++) {
        kdr_polygon_cut(&polygon, k, box->lo[k] - margin[k], false);
        kdr_polygon_cut(&polygon, k, box->hi[k] + margin[k], true);
    }
    if (polygon.count == 0)
        return false;
    for (int k = 0; k < 3; k++) {
        double lo = polygon.corner[0][k], hi = lo;
        for (int i = 1; i < polygon.count; i++) {
            lo = fmin(lo, polygon.corner[i][k]);
            hi = fmax(hi, polygon.corner[i][k]);
        }
        float low = kdr_float_below(lo - margin[k]), high = kdr_float_above(hi + margin[k]);
        part->lo[k] = low > box->lo[k] ? low : box->lo[k];
        part->hi[k] = high < box->hi[k] ? high : box->hi[k];
    }
    return true;
}

#endif
