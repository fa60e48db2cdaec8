#include "scene/triangles.h"

#include "geometry/exact.h"

#include <string.h>

static inline const float *vertex_of(const kdr_triangles_def *def, uint32_t index) {
    return (const float *)((const char *)def->vertices + (size_t)index * def->vertex_stride);
}

/* Vertex numbers of a triangle. */
static inline void corners_of(const kdr_triangles_def *def, uint32_t triangle, uint32_t corner[3]) {
    if (def->indices)
        memcpy(corner, (const char *)def->indices + (size_t)triangle * def->index_stride, 3 * sizeof *corner);
    else
        for (uint32_t i = 0; i < 3; i++)
            corner[i] = 3 * triangle + i;
}

static inline float least(float x, float y) { return x < y ? x : y; }

static inline float most(float x, float y) { return x > y ? x : y; }

/* True if a cross product in double says that the area is surely not zero; cheap, and nearly always true. */
static inline bool surely_has_area(const float *a, const float *b, const float *c) {
    float ex = b[0] - a[0], ey = b[1] - a[1], ez = b[2] - a[2], fx = c[0] - a[0], fy = c[1] - a[1], fz = c[2] - a[2];
    float xy = ex * fy, yx = ey * fx, yz = ey * fz, zy = ez * fy, zx = ez * fx, xz = ex * fz;
    const float doubt = 0x1p-21f, tiny = 0x1p-120f;
    return fabsf(xy - yx) > doubt * (fabsf(xy) + fabsf(yx)) + tiny ||
           fabsf(yz - zy) > doubt * (fabsf(yz) + fabsf(zy)) + tiny ||
           fabsf(zx - xz) > doubt * (fabsf(zx) + fabsf(xz)) + tiny;
}

static uint32_t geometry_boxes(const kdr_triangles_def *def, uint32_t begin, uint32_t end, uint32_t number,
                               const kdr_references *to, uint32_t at, kdr_box *bounds, kdr_input_counts *counts) {
    const uint32_t first_place = at;
    kdr_box all = *bounds;
    for (uint32_t i = begin; i < end; i++, number++) {
        uint32_t corner[3];
        corners_of(def, i, corner);
        if (corner[0] >= def->vertex_count || corner[1] >= def->vertex_count || corner[2] >= def->vertex_count) {
            counts->invalid++;
            continue;
        }
        const float *a = vertex_of(def, corner[0]), *b = vertex_of(def, corner[1]), *c = vertex_of(def, corner[2]);
        float sum = 0; /* of zeros, unless a coordinate is not finite */
        for (int k = 0; k < 3; k++)
            sum += (a[k] - a[k]) + (b[k] - b[k]) + (c[k] - c[k]);
        if (sum != 0) {
            counts->dropped++;
            continue;
        }
        if (!surely_has_area(a, b, c) && kdr_triangle_is_flat(a, b, c)) {
            counts->degenerate++;
            continue;
        }
        for (int k = 0; k < 3; k++) {
            float lo = least(a[k], least(b[k], c[k])), hi = most(a[k], most(b[k], c[k]));
            to->lo[k][at] = lo;
            to->hi[k][at] = hi;
            all.lo[k] = least(lo, all.lo[k]);
            all.hi[k] = most(hi, all.hi[k]);
        }
        to->primitive[at++] = number;
    }
    *bounds = all;
    return at - first_place;
}

static uint32_t boxes(const void *context, uint32_t begin, uint32_t end, const kdr_references *to, uint32_t at,
                      kdr_box *bounds, kdr_input_counts *counts) {
    const kdr_triangles *t = context;
    uint32_t kept = 0;
    for (uint32_t g = kdr_geometry_of(t->first, t->count, begin); begin < end; g++) {
        uint32_t stop = t->first[g + 1] < end ? t->first[g + 1] : end;
        kept += geometry_boxes(&t->geometries[g], begin - t->first[g], stop - t->first[g], begin, to, at + kept, bounds,
                               counts);
        begin = stop;
    }
    return kept;
}

static void corners(const void *context, uint32_t primitive, float out[3][3]) {
    const kdr_triangles *t = context;
    uint32_t g = t->count == 1 ? 0 : kdr_geometry_of(t->first, t->count, primitive), corner[3];
    const kdr_triangles_def *def = &t->geometries[g];
    corners_of(def, primitive - t->first[g], corner);
    for (int i = 0; i < 3; i++)
        memcpy(out[i], vertex_of(def, corner[i]), sizeof out[i]);
}

static void fill(const void *context, float *blocks, kdr_node leaf, const uint32_t *primitives) {
    uint32_t count = kdr_node_count(leaf);
    for (uint32_t i = 0; i < count; i++) {
        float vertices[3][3];
        corners(context, primitives[i], vertices);
        kdr_block_set(blocks, leaf, i, (const float(*)[3])vertices, primitives[i]);
    }
    kdr_block_pad(blocks, leaf);
}

kdr_input kdr_triangles_input(const kdr_triangles *triangles) {
    return (kdr_input){.context = triangles,
                       .count = triangles->first[triangles->count],
                       .boxes = boxes,
                       .corners = corners,
                       .fill = fill};
}
