/* Which rectangles a slice consists of.
 *
 * The tree is walked once, past every cell that the plane does not cut. A cell on whose side the plane lies belongs to
 * what is above the plane, as a cell at the upper end of the box does to what is below, so that every point of the
 * slice has one leaf.
 *
 * Cells that nobody could tell apart are drawn together: a cell narrower than half a pixel, or smaller than an area, is
 * one rectangle of the mean depth of its leaves. The area is doubled until there are few enough rectangles. Cost: a
 * walk over the slice for each doubling, 20 at most. */
#include "slice.h"

#include "memory.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

static const char axis_names[] = "xyz";

/* One attempt to fill the sheet. */
typedef struct cutting {
    kdr_slice_sheet *sheet;
    float end;         /* of the box on the axis of the slice */
    double least_area; /* square pixels; smaller cells are drawn together */
    bool together;     /* below such a cell */
    uint32_t top;      /* its depth */
    double area, deep; /* of its leaves so far: sums of areas, and of areas times depths */
    kdr_slice_rectangle group;
    bool full;
} cutting;

static double side(float from, float to) { return (double)to - (double)from; }

static void add_rectangle(cutting *c, const kdr_slice_rectangle *rectangle) {
    kdr_slice_sheet *sheet = c->sheet;
    if (sheet->rectangle_count == KDR_SLICE_RECTANGLES) {
        c->full = true;
        return;
    }
    sheet->rectangles[sheet->rectangle_count++] = *rectangle;
    if (rectangle->depth < sheet->least_depth)
        sheet->least_depth = rectangle->depth;
    if (rectangle->depth > sheet->largest_depth)
        sheet->largest_depth = rectangle->depth;
}

/* Ends what is drawn together. */
static void finish_group(cutting *c) {
    c->together = false;
    if (c->area > 0)
        c->group.depth = (uint32_t)lround(c->deep / c->area);
    c->sheet->together_count++;
    add_rectangle(c, &c->group);
}

static kdr_slice_rectangle rectangle_of(const kdr_slice_sheet *sheet, const kdr_cell *cell) {
    const float *lo = cell->bounds, *hi = cell->bounds + 3;
    uint32_t across = sheet->across, up = sheet->up;
    return (kdr_slice_rectangle){.left = (float)(((double)lo[across] - sheet->low[0]) * sheet->scale[0]),
                                 .right = (float)(((double)hi[across] - sheet->low[0]) * sheet->scale[0]),
                                 .bottom = (float)(sheet->height - ((double)lo[up] - sheet->low[1]) * sheet->scale[1]),
                                 .top = (float)(sheet->height - ((double)hi[up] - sheet->low[1]) * sheet->scale[1]),
                                 .depth = cell->depth,
                                 .empty = cell->is_leaf && cell->primitive_count == 0};
}

static kdr_cell_step cut_cell(const kdr_cell *cell, void *user) {
    cutting *c = user;
    kdr_slice_sheet *sheet = c->sheet;
    if (c->together && cell->depth <= c->top)
        finish_group(c);
    if (c->full)
        return KDR_CELL_STOP;
    float lo = cell->bounds[sheet->axis], hi = cell->bounds[sheet->axis + 3];
    double p = sheet->position;
    if (!((double)lo <= p && (p < (double)hi || hi >= c->end)))
        return KDR_CELL_PAST;

    kdr_slice_rectangle rectangle = rectangle_of(sheet, cell);
    double width = side(rectangle.left, rectangle.right), height = side(rectangle.top, rectangle.bottom);
    if (!cell->is_leaf) {
        bool small = fmin(width, height) < KDR_SLICE_LEAST_SIDE || width * height < c->least_area;
        if (small && !c->together) {
            c->together = true;
            c->top = cell->depth;
            c->area = c->deep = 0;
            c->group = rectangle;
            c->group.empty = true;
        }
        return KDR_CELL_INTO;
    }
    sheet->leaf_count++;
    sheet->empty_count += rectangle.empty;
    if (c->together) {
        c->area += width * height;
        c->deep += width * height * cell->depth;
        c->group.empty = c->group.empty && rectangle.empty;
    } else {
        add_rectangle(c, &rectangle);
    }
    return KDR_CELL_INTO;
}

static void cut_cells(kdr_slice_sheet *sheet, const kdr_scene *scene, float end) {
    cutting c = {.sheet = sheet, .end = end, .least_area = 1};
    do {
        sheet->rectangle_count = sheet->together_count = sheet->leaf_count = sheet->empty_count = 0;
        sheet->least_depth = KDR_MAX_DEPTH;
        sheet->largest_depth = 0;
        c.full = c.together = false;
        kdr_scene_cells(scene, cut_cell, &c);
        if (c.together)
            finish_group(&c);
        c.least_area *= 2;
    } while (c.full);
}

/* ---- triangles */

/* Where the plane meets a triangle; false if it does not, or only along the plane. */
static bool cut_triangle(const kdr_slice_sheet *sheet, const float *const corners[3], kdr_slice_segment *out) {
    int found = 0;
    for (int i = 0; i < 3 && found < 2; i++) {
        const float *a = corners[i], *b = corners[(i + 1) % 3];
        double below = (double)a[sheet->axis] - sheet->position, above = (double)b[sheet->axis] - sheet->position;
        if ((below < 0) == (above < 0))
            continue;
        double part = below / (below - above);
        float *to = found++ ? out->to : out->from;
        double right = (double)a[sheet->across] + part * side(a[sheet->across], b[sheet->across]);
        double up = (double)a[sheet->up] + part * side(a[sheet->up], b[sheet->up]);
        to[0] = (float)((right - sheet->low[0]) * sheet->scale[0]);
        to[1] = (float)(sheet->height - (up - sheet->low[1]) * sheet->scale[1]);
    }
    return found == 2;
}

static void cut_triangles(kdr_slice_sheet *sheet, const kdr_mesh *mesh) {
    double least = 0.1; /* pixels; shorter ones are left out */
    bool full;
    do {
        full = false;
        sheet->segment_count = 0;
        for (size_t i = 0; i < mesh->triangle_count && !full; i++) {
            const float *corners[3];
            for (int k = 0; k < 3; k++)
                corners[k] = mesh->positions + 3 * (size_t)mesh->indices[3 * i + (size_t)k];
            kdr_slice_segment segment;
            if (!cut_triangle(sheet, corners, &segment))
                continue;
            double right = side(segment.from[0], segment.to[0]), down = side(segment.from[1], segment.to[1]);
            if (!(hypot(right, down) >= least))
                continue;
            full = sheet->segment_count == KDR_SLICE_SEGMENTS;
            if (!full)
                sheet->segments[sheet->segment_count++] = segment;
        }
        least *= 2;
    } while (full);
}

/* ---- the sheet */

/* Lays the box on the sheet: one scale on both axes, but no side thinner than a few pixels. */
static void place(kdr_slice_sheet *sheet, const float bounds[6]) {
    uint32_t axes[2] = {sheet->across, sheet->up};
    double extents[2], longest = 0, sides[2];
    for (int i = 0; i < 2; i++) {
        extents[i] = side(bounds[axes[i]], bounds[axes[i] + 3]);
        longest = fmax(longest, extents[i]);
        sheet->low[i] = (double)bounds[axes[i]];
    }
    for (int i = 0; i < 2; i++) {
        sides[i] = fmax(longest > 0 ? KDR_SLICE_SIDE * (extents[i] / longest) : 0, 8);
        sheet->scale[i] = extents[i] > 0 ? sides[i] / extents[i] : 0;
    }
    sheet->width = sides[0];
    sheet->height = sides[1];
}

const char *kdr_slice_cut(const kdr_slice *slice, const kdr_scene *scene, const kdr_mesh *mesh, kdr_slice_sheet *out,
                          char *problem, size_t problem_size) {
    /* +y is up; of x and z, x goes to the right. */
    static const uint32_t across[] = {2, 0, 0}, up[] = {1, 2, 1};
    float bounds[6];
    kdr_scene_bounds(scene, bounds);
    *out = (kdr_slice_sheet){.axis = slice->axis, .across = across[slice->axis], .up = up[slice->axis]};
    float lo = bounds[slice->axis], hi = bounds[slice->axis + 3];
    if (!(lo <= hi)) {
        snprintf(problem, problem_size, "there are no triangles, and so no cells to draw");
        return problem;
    }
    out->position = slice->percent ? (double)lo + side(lo, hi) * (slice->position / 100) : slice->position;
    if (!(out->position >= (double)lo && out->position <= (double)hi)) {
        snprintf(problem, problem_size, "--slice: the box reaches from %g to %g on the axis %c, and %g lies outside",
                 (double)lo, (double)hi, axis_names[slice->axis], out->position);
        return problem;
    }
    out->part = hi > lo ? (out->position - (double)lo) / side(lo, hi) : 0;
    place(out, bounds);
    out->rectangles = kdr_memory_get(KDR_SLICE_RECTANGLES, sizeof *out->rectangles);
    out->segments = kdr_memory_get(KDR_SLICE_SEGMENTS, sizeof *out->segments);
    cut_cells(out, scene, hi);
    cut_triangles(out, mesh);
    return NULL;
}

void kdr_slice_release(kdr_slice_sheet *sheet) {
    kdr_memory_release(sheet->rectangles);
    kdr_memory_release(sheet->segments);
    *sheet = (kdr_slice_sheet){0};
}
