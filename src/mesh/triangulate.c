/* Ear clipping of small polygons.
 *
 * Source: G. Meisters, "Polygons have ears", 1975: every simple polygon of four corners or more has two ears, corners
 * whose triangle with both neighbours lies inside; cut off, they leave a simple polygon.
 *
 * The polygon is projected along the largest component of its normal (Newell's sum over the edges, which minds no
 * slight unevenness), mirrored to turn counter-clockwise. A corner is an ear if it turns left and no corner that turns
 * right lies in its triangle. Invariant: `next` links the corners that are left in their order.
 * Cost: one pass for convex polygons, at worst the cube of the corners, of which there are at most KDR_EAR_CORNERS. */
#include "mesh/triangulate.h"

#include <math.h>
#include <stdbool.h>

typedef struct polygon {
    double x[KDR_EAR_CORNERS], y[KDR_EAR_CORNERS];
    uint32_t previous[KDR_EAR_CORNERS], next[KDR_EAR_CORNERS];
} polygon;

/* Twice the area of a, b, c; positive if they turn left. */
static double turn(const polygon *shape, uint32_t a, uint32_t b, uint32_t c) {
    return (shape->x[b] - shape->x[a]) * (shape->y[c] - shape->y[a]) -
           (shape->y[b] - shape->y[a]) * (shape->x[c] - shape->x[a]);
}

/* Fills x and y; false when the polygon spans no plane. */
static bool project(const float *positions, const uint32_t *corners, uint32_t count, polygon *shape) {
    double normal[3] = {0, 0, 0};
    const float *origin = positions + 3 * (size_t)corners[0];
    for (uint32_t i = 0; i < count; i++) {
        const float *p = positions + 3 * (size_t)corners[i];
        const float *q = positions + 3 * (size_t)corners[i + 1 < count ? i + 1 : 0];
        for (int axis = 0; axis < 3; axis++) {
            int u = (axis + 1) % 3, v = (axis + 2) % 3;
            double pu = (double)p[u] - (double)origin[u], pv = (double)p[v] - (double)origin[v];
            double qu = (double)q[u] - (double)origin[u], qv = (double)q[v] - (double)origin[v];
            normal[axis] += pu * qv - pv * qu;
        }
    }
    int axis = fabs(normal[0]) > fabs(normal[1]) ? 0 : 1;
    if (!(fabs(normal[axis]) > fabs(normal[2])))
        axis = 2;
    if (!(fabs(normal[axis]) > 0) || !isfinite(normal[0] + normal[1] + normal[2]))
        return false;
    int u = (axis + 1) % 3, v = (axis + 2) % 3;
    double mirror = normal[axis] < 0 ? -1 : 1;
    for (uint32_t i = 0; i < count; i++) {
        const float *p = positions + 3 * (size_t)corners[i];
        shape->x[i] = mirror * ((double)p[u] - (double)origin[u]);
        shape->y[i] = (double)p[v] - (double)origin[v];
    }
    return true;
}

static bool is_convex(const polygon *shape, uint32_t count) {
    for (uint32_t i = 0; i < count; i++)
        if (turn(shape, i, (i + 1) % count, (i + 2) % count) < 0)
            return false;
    return true;
}

static bool same_point(const polygon *shape, uint32_t a, uint32_t b) {
    return shape->x[a] == shape->x[b] && shape->y[a] == shape->y[b];
}

static bool is_ear(const polygon *shape, uint32_t b) {
    uint32_t a = shape->previous[b], c = shape->next[b];
    if (!(turn(shape, a, b, c) > 0))
        return false;
    for (uint32_t i = shape->next[c]; i != a; i = shape->next[i]) {
        if (turn(shape, shape->previous[i], i, shape->next[i]) > 0)
            continue;
        if (same_point(shape, i, a) || same_point(shape, i, b) || same_point(shape, i, c))
            continue;
        if (turn(shape, a, b, i) >= 0 && turn(shape, b, c, i) >= 0 && turn(shape, c, a, i) >= 0)
            return false;
    }
    return true;
}

static uint32_t *emit(uint32_t *triangle, uint32_t a, uint32_t b, uint32_t c) {
    triangle[0] = a;
    triangle[1] = b;
    triangle[2] = c;
    return triangle + 3;
}

static void clip_ears(polygon *shape, uint32_t count, uint32_t *triangles) {
    for (uint32_t i = 0; i < count; i++) {
        shape->previous[i] = i ? i - 1 : count - 1;
        shape->next[i] = i + 1 < count ? i + 1 : 0;
    }
    uint32_t left = count, tried = 0, corner = 0;
    while (left > 3 && tried < left) {
        uint32_t a = shape->previous[corner], c = shape->next[corner];
        if (is_ear(shape, corner)) {
            triangles = emit(triangles, a, corner, c);
            shape->next[a] = c;
            shape->previous[c] = a;
            left--;
            tried = 0;
        } else {
            tried++;
        }
        corner = c;
    }

    // One triangle is left, or a polygon without ears.
    for (uint32_t i = shape->next[corner]; shape->next[i] != corner; i = shape->next[i])
        triangles = emit(triangles, corner, i, shape->next[i]);
}

void kdr_triangulate(const float *positions, const uint32_t *corners, size_t corner_count, uint32_t *triangles) {
    if (corner_count > 3 && corner_count <= KDR_EAR_CORNERS) {
        polygon shape;
        uint32_t count = (uint32_t)corner_count;
        if (project(positions, corners, count, &shape) && !is_convex(&shape, count)) {
            clip_ears(&shape, count, triangles);
            return;
        }
    }
    for (size_t i = 2; i < corner_count; i++)
        triangles = emit(triangles, 0, (uint32_t)i - 1, (uint32_t)i);
}
