/* A tile of a view's picture: rays, hits, colours or values of its pixels. */
#ifndef KDR_APPS_KDRAY_VIEW_TILE_H
#define KDR_APPS_KDRAY_VIEW_TILE_H

#include "view_camera.h"
#include "view_show.h"

#define KDR_TILE_SIDE 32u
#define KDR_TILE_PIXELS (KDR_TILE_SIDE * KDR_TILE_SIDE)

/* What a view looks at, and how. */
typedef struct kdr_view_look {
    const kdr_scene *scene; /* geometry 0 is the mesh */
    const kdr_mesh *mesh;
    const kdr_picture_def *picture; /* camera, lights, background */
    kdr_view_show show;
    bool shadows;
} kdr_view_look;

/* A picture coarser than its window: pixel (x, y) is the square of scale * scale pixels of the window that begins at
 * (x * scale, y * scale). */
typedef struct kdr_view_raster {
    uint32_t window_width, window_height;
    uint32_t scale;
    uint32_t width, height; /* pixels */
    uint32_t sample;        /* 0: through the middle of a pixel; others are strewn over it */
} kdr_view_raster;

/* One worker's room. */
typedef struct kdr_view_painter {
    uint64_t rays;
    kdr_ray_hit hits[KDR_TILE_PIXELS];
    kdr_ray shadows[KDR_TILE_PIXELS];
    uint8_t hidden[KDR_TILE_PIXELS];
    uint16_t lit[KDR_TILE_PIXELS]; /* whose shadow ray it is */
    float points[KDR_TILE_PIXELS][3], normals[KDR_TILE_PIXELS][3], colours[KDR_TILE_PIXELS][3];
} kdr_view_painter;

/* Traces the tile that begins at pixel (x, y): sums[p], p being row * raster->width + column of the picture, gets a
 * linear colour, added to what is there unless the sample is 0, or in [0] the value that is shown, -1 where nothing is
 * hit. depth[p] becomes the distance from the camera's plane, infinity where nothing is hit, with sample 0 only. */
void kdr_view_tile_trace(kdr_view_painter *painter, const kdr_view_look *look, const kdr_camera_frame *frame,
                         const kdr_view_raster *raster, uint32_t x, uint32_t y, float (*sums)[3], float *depth);

#endif
