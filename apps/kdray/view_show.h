/* What a view shows of a scene. */
#ifndef KDR_APPS_KDRAY_VIEW_SHOW_H
#define KDR_APPS_KDRAY_VIEW_SHOW_H

#include <stdbool.h>
#include <stdint.h>

typedef enum kdr_view_show {
    KDR_SHOW_SHADED,
    KDR_SHOW_NORMALS,
    KDR_SHOW_DEPTH,     /* distance from the camera's plane */
    KDR_SHOW_NODES,     /* that a pixel's ray passes: see kdr_cost1 */
    KDR_SHOW_TRIANGLES, /* in the leaves that it passes */
    KDR_SHOW_COUNT
} kdr_view_show;

/* "picture", "normals", "depth", "nodes", "triangles"; static storage. */
const char *kdr_view_show_name(kdr_view_show show);

/* True if a pixel is a number on a scale of colours. */
static inline bool kdr_view_show_is_value(kdr_view_show show) { return show >= KDR_SHOW_DEPTH; }

/* Colour of a part, from 0 to 1, of the scale: depth from near to far, costs from dark to bright; 0xRRGGBB. */
uint32_t kdr_view_show_colour(kdr_view_show show, double part);

/* The end of a scale from 0 that holds all but the largest of `count` values, rounded up to 1, 2 or 5 times a power of
 * ten, so that it stays while little changes. Values below 0 do not take part. */
double kdr_view_show_end(const float *values, uint64_t count);

#endif
