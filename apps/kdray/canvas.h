/* Pixels to draw on: 0x00RRGGBB, rows from the top. Whatever lies outside is left out. */
#ifndef KDR_APPS_KDRAY_CANVAS_H
#define KDR_APPS_KDRAY_CANVAS_H

#include <stdint.h>

typedef struct kdr_canvas {
    uint32_t *pixels; /* width * height of them, the caller's */
    int width, height;
} kdr_canvas;

/* Lays a colour over a pixel; cover from 0 (nothing) to 256 (the colour itself). */
void kdr_canvas_blend(kdr_canvas *canvas, int x, int y, uint32_t colour, uint32_t cover);

/* The same over a rectangle. */
void kdr_canvas_fill(kdr_canvas *canvas, int x, int y, int width, int height, uint32_t colour, uint32_t cover);

#endif
