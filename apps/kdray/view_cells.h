/* Cells of the tree as boxes of lines in a picture. */
#ifndef KDR_APPS_KDRAY_VIEW_CELLS_H
#define KDR_APPS_KDRAY_VIEW_CELLS_H

#include "canvas.h"
#include "view_picture.h"

#define KDR_CELLS_MOST 20000 /* boxes that are kept */

typedef struct kdr_view_cells {
    float (*boxes)[6];
    bool *leaves; /* of the boxes: else they are divided further */
    uint32_t count, capacity;
    uint32_t depth; /* that they were asked for */
    bool cut;       /* there are more than are kept */
} kdr_view_cells;

/* Takes the leaves with primitives down to a depth, and the cells at that depth that are divided further. */
void kdr_view_cells_take(kdr_view_cells *cells, const kdr_scene *scene, uint32_t depth);

/* Draws them into a picture that is on the canvas already: what lies behind a surface is faint. */
void kdr_view_cells_draw(const kdr_view_cells *cells, const kdr_camera_frame *frame, const kdr_view_picture *picture,
                         kdr_canvas *canvas);

void kdr_view_cells_release(kdr_view_cells *cells);

#endif
