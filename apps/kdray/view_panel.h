/* What is written over a view's picture: figures, a scale of colours, a bar for the time, the list of keys. */
#ifndef KDR_APPS_KDRAY_VIEW_PANEL_H
#define KDR_APPS_KDRAY_VIEW_PANEL_H

#include "canvas.h"
#include "view_clock.h"
#include "view_show.h"

#include <stddef.h>

typedef struct kdr_view_figures {
    const char *file, *plan, *trace, *note; /* note: NULL, or the last thing that happened */
    size_t triangles;
    kdr_view_show show;
    double sample_ms, build_ms, trace_ms, frames_a_second, mega_rays; /* frames_a_second 0: the picture rests */
    uint32_t width, height, scale, samples; /* of the window; pixels a picture's pixel; samples a pixel */
    bool cells, cells_cut;
    uint32_t cell_depth, cell_count;
    double low, high; /* of the scale of colours */
} kdr_view_figures;

#define KDR_PANEL_LINES 7
#define KDR_PANEL_LINE_SIZE 80

/* The figures as lines; returns how many. */
int kdr_view_panel_lines(const kdr_view_figures *figures, char lines[KDR_PANEL_LINES][KDR_PANEL_LINE_SIZE]);

void kdr_view_panel_draw(kdr_canvas *canvas, const kdr_view_figures *figures);
void kdr_view_panel_draw_scale(kdr_canvas *canvas, const kdr_view_figures *figures);
void kdr_view_panel_draw_help(kdr_canvas *canvas);

/* The bar, and where a point of the canvas is on it: 0 to 1 from end to end, below 0 if it is not on it. */
void kdr_view_panel_draw_bar(kdr_canvas *canvas, const kdr_view_clock *clock);
double kdr_view_panel_on_bar(int width, int height, int x, int y);

/* The same wherever the point is above or below it; kept within 0 and 1. */
double kdr_view_panel_along_bar(int width, int height, int x);

#endif
