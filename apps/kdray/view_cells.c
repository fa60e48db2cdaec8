#include "view_cells.h"

#include "memory.h"

#include <math.h>
#include <string.h>

#define LEAF_COLOUR 0xffb020
#define DIVIDED_COLOUR 0x30d0ff
#define COVER 200 /* of 256 */
#define FAINT 22
#define SURFACE 0.004 /* of the distance: a line this little behind a surface lies on it */

static kdr_cell_step take(const kdr_cell *cell, void *user) {
    kdr_view_cells *cells = user;
    bool divided = !cell->is_leaf && cell->depth >= cells->depth;
    if (!divided && (!cell->is_leaf || cell->primitive_count == 0))
        return KDR_CELL_INTO;
    if (cells->count == cells->capacity) {
        cells->cut = true;
        return KDR_CELL_STOP;
    }
    memcpy(cells->boxes[cells->count], cell->bounds, sizeof cells->boxes[0]);
    cells->leaves[cells->count++] = cell->is_leaf;
    return KDR_CELL_PAST;
}

void kdr_view_cells_take(kdr_view_cells *cells, const kdr_scene *scene, uint32_t depth) {
    if (!cells->boxes) {
        cells->capacity = KDR_CELLS_MOST;
        cells->boxes = kdr_memory_get(cells->capacity, sizeof *cells->boxes);
        cells->leaves = kdr_memory_get(cells->capacity, sizeof *cells->leaves);
    }
    cells->count = 0;
    cells->cut = false;
    cells->depth = depth;
    kdr_scene_cells(scene, take, cells);
}

/* A point on the canvas; z is the distance from the camera's plane. */
typedef struct spot {
    double x, y, z;
} spot;

static spot spot_of(const kdr_camera_frame *frame, const kdr_canvas *canvas, const double point[3]) {
    double seen[3], half = 0.5 * canvas->height;
    kdr_camera_frame_project(frame, point, seen);
    return (spot){0.5 * canvas->width + half * seen[0], half - half * seen[1], seen[2]};
}

static double depth_of(const kdr_camera_frame *frame, const double point[3]) {
    double depth = 0;
    for (int k = 0; k < 3; k++)
        depth += (point[k] - frame->eye[k]) * frame->forward[k];
    return depth;
}

/* Moves end `a` of a line to where it comes before the camera. False if none of it does. */
static bool bring_before(const kdr_camera_frame *frame, double a[3], const double b[3], double near) {
    double depth_a = depth_of(frame, a), depth_b = depth_of(frame, b);
    if (depth_a >= near)
        return true;
    if (depth_b < near)
        return false;
    double part = (near - depth_a) / (depth_b - depth_a);
    for (int k = 0; k < 3; k++)
        a[k] += part * (b[k] - a[k]);
    return true;
}

/* The part of a line, from *begin to *end, that has a coordinate between 0 and limit. */
static void clip(double a, double b, double limit, double *begin, double *end) {
    double way = b - a;
    if (way == 0) {
        *end = a >= 0 && a < limit ? *end : -1;
        return;
    }
    double first = (way > 0 ? -a : limit - a) / way, last = (way > 0 ? limit - a : -a) / way;
    *begin = fmax(*begin, first);
    *end = fmin(*end, last);
}

static void draw_line(const kdr_view_picture *picture, kdr_canvas *canvas, spot a, spot b, uint32_t colour) {
    double begin = 0, end = 1;
    clip(a.x, b.x, canvas->width, &begin, &end);
    clip(a.y, b.y, canvas->height, &begin, &end);
    if (!(begin <= end))
        return;
    double steps = ceil(fmax(fabs(b.x - a.x), fabs(b.y - a.y)) * (end - begin));
    uint32_t scale = picture->raster.scale, width = picture->raster.width;
    for (int i = 0; i <= (int)steps; i++) {
        double part = begin + (end - begin) * (steps > 0 ? i / steps : 0);
        int x = (int)(a.x + part * (b.x - a.x)), y = (int)(a.y + part * (b.y - a.y));
        if (x < 0 || y < 0 || x >= canvas->width || y >= canvas->height)
            continue;
        // Along a line on the canvas one over the distance changes evenly.
        double z = 1 / ((1 - part) / a.z + part / b.z);
        double surface = (double)picture->depth[(size_t)((uint32_t)y / scale) * width + (uint32_t)x / scale];
        kdr_canvas_blend(canvas, x, y, colour, z <= surface * (1 + SURFACE) ? COVER : FAINT);
    }
}

static void draw_box(const float box[6], const kdr_camera_frame *frame, const kdr_view_picture *picture,
                     kdr_canvas *canvas, uint32_t colour) {
    double size = 0;
    for (int k = 0; k < 3; k++)
        size = fmax(size, fmax(fabs((double)box[k] - frame->eye[k]), fabs((double)box[k + 3] - frame->eye[k])));
    for (int corner = 0; corner < 8; corner++)
        for (int axis = 0; axis < 3; axis++) {
            if (corner >> axis & 1)
                continue;
            double a[3], b[3];
            for (int k = 0; k < 3; k++)
                a[k] = b[k] = (double)box[k + (corner >> k & 1) * 3];
            b[axis] = (double)box[axis + 3];
            if (bring_before(frame, a, b, 1e-4 * size) && bring_before(frame, b, a, 1e-4 * size))
                draw_line(picture, canvas, spot_of(frame, canvas, a), spot_of(frame, canvas, b), colour);
        }
}

void kdr_view_cells_draw(const kdr_view_cells *cells, const kdr_camera_frame *frame, const kdr_view_picture *picture,
                         kdr_canvas *canvas) {
    for (uint32_t i = 0; i < cells->count; i++)
        draw_box(cells->boxes[i], frame, picture, canvas, cells->leaves[i] ? LEAF_COLOUR : DIVIDED_COLOUR);
}

void kdr_view_cells_release(kdr_view_cells *cells) {
    kdr_memory_release(cells->boxes);
    kdr_memory_release(cells->leaves);
    *cells = (kdr_view_cells){0};
}
