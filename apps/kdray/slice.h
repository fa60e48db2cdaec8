/* The cells of a tree that a plane square to an axis cuts, as a drawing.
 *
 *   slice    the plane, as asked for
 *   sheet    what is to be drawn, in pixels: a rectangle a leaf, with the smallest ones drawn together (slice.c)
 *   drawing  a sheet as SVG, with a legend (slice_svg.c) */
#ifndef KDR_APPS_KDRAY_SLICE_H
#define KDR_APPS_KDRAY_SLICE_H

#include <kdray/render.h>
#include <stdbool.h>
#include <stdio.h>

typedef struct kdr_slice {
    uint32_t axis;
    double position;
    bool percent; /* position is a percentage of the box, not a coordinate */
} kdr_slice;

#define KDR_SLICE_SIDE 800u        /* pixels of the longer side of the cut */
#define KDR_SLICE_RECTANGLES 6000u /* at most so many: some 200 kB of SVG */
#define KDR_SLICE_SEGMENTS 6000u   /* the same for the triangles */
#define KDR_SLICE_LEAST_SIDE 0.5   /* pixels; cells that are narrower are not divided further */

typedef struct kdr_slice_rectangle {
    float left, top, right, bottom;
    uint32_t depth;
    bool empty;
} kdr_slice_rectangle;

/* Where a triangle meets the plane. */
typedef struct kdr_slice_segment {
    float from[2], to[2];
} kdr_slice_segment;

typedef struct kdr_slice_sheet {
    uint32_t axis, across, up; /* the axis of the slice; those that go to the right and up */
    double position;           /* coordinate on the axis of the slice */
    double part;               /* of the box that lies below it, from 0 to 1 */
    double low[2], scale[2];   /* pixel = (coordinate - low) * scale, to the right and up */
    double width, height;      /* pixels */

    kdr_slice_rectangle *rectangles; /* in the order of the tree */
    size_t rectangle_count;
    size_t together_count; /* of these: those that stand for several cells, drawn together */
    size_t leaf_count, empty_count;
    uint32_t least_depth, largest_depth; /* of rectangles */

    kdr_slice_segment *segments; /* the longest ones, if there are too many */
    size_t segment_count;
} kdr_slice_sheet;

/* Cuts the committed tree of a mesh. Returns NULL, or a sentence about a plane that does not meet the box, which is
 * written to problem. Release the sheet: kdr_slice_release. */
const char *kdr_slice_cut(const kdr_slice *slice, const kdr_scene *scene, const kdr_mesh *mesh, kdr_slice_sheet *out,
                          char *problem, size_t problem_size);

/* Zeros are allowed. */
void kdr_slice_release(kdr_slice_sheet *sheet);

/* What the legend tells of the whole. */
typedef struct kdr_slice_legend {
    const char *name; /* of the mesh; any bytes */
    const char *plan; /* how the tree was built */
    const kdr_tree_stats *tree;
} kdr_slice_legend;

/* Writes it as one SVG document. Errors stay with the file: ask ferror. */
void kdr_slice_draw(FILE *file, const kdr_slice_sheet *sheet, const kdr_slice_legend *legend);

#endif
