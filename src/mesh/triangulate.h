/* Polygons into triangles. */
#ifndef KDR_MESH_TRIANGULATE_H
#define KDR_MESH_TRIANGULATE_H

#include <stddef.h>
#include <stdint.h>

/* Polygons of more corners are always cut as a fan: the time for ears grows with the square of the corners. */
#define KDR_EAR_CORNERS 64

/* Cuts a polygon of 3 to 2^32 - 1 corners, given as vertex numbers, into corner_count - 2 triangles. `triangles` gets
 * three corners each, as places in the polygon (0 to corner_count - 1).
 * Convex polygons: a fan around the first corner. Concave ones: ears. What has no ears (it crosses itself) or no plane:
 * a fan. Every triangle turns the way of the polygon. */
void kdr_triangulate(const float *positions, const uint32_t *corners, size_t corner_count, uint32_t *triangles);

#endif
