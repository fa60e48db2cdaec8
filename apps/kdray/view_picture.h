/* The picture of a view: traced by all workers, coarse or fine, and its pixels as a screen wants them. */
#ifndef KDR_APPS_KDRAY_VIEW_PICTURE_H
#define KDR_APPS_KDRAY_VIEW_PICTURE_H

#include "canvas.h"
#include "view_tile.h"

#define KDR_VIEW_CODES 4096 /* steps from linear light to the code of a screen */

/* All zero at first. */
typedef struct kdr_view_picture {
    kdr_view_raster raster; /* of the last pass */
    float (*sums)[3];
    float *depth;      /* distance from the camera's plane; infinity where nothing is hit */
    float *values;     /* what is shown, where that is a number */
    uint32_t *colours; /* of the pixels, 0x00RRGGBB */
    size_t capacity;   /* pixels */
    float low, high;   /* ends of the scale, where there is one */
    uint64_t rays;     /* of the last pass */
    double seconds;    /* that it took */
    kdr_view_painter *painters;
    uint32_t painter_count;
    uint8_t codes[KDR_VIEW_CODES + 1];
} kdr_view_picture;

/* Traces a pass. raster: window, scale and sample; the size follows. Samples above 0 are added to those of the pass
 * before, which had the same size. frame: that of the look's camera. */
void kdr_view_picture_trace(kdr_view_picture *picture, kdr_device *device, const kdr_view_look *look,
                            const kdr_camera_frame *frame, kdr_view_raster raster);

/* Copies the pixels to a canvas of the window's size. */
void kdr_view_picture_copy(const kdr_view_picture *picture, kdr_canvas *canvas);

void kdr_view_picture_release(kdr_view_picture *picture);

#endif
