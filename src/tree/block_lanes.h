/* One ray against the triangles of a leaf, KDR_LANES at a time.
 *
 * A float filter over all lanes (edge functions of the sheared triangle, with an error bound) leaves the few triangles
 * that the ray meets or nearly meets; each of these is decided exactly. So a hit never depends on the width of lanes.
 * Source of the filter: S. Woop, C. Benthin, I. Wald, "Watertight Ray/Triangle Intersection", 2013.
 * Cost: about 50 vector operations a step, and 100 flops for each triangle that passes. */
#ifndef KDR_TREE_BLOCK_LANES_H
#define KDR_TREE_BLOCK_LANES_H

#include "geometry/lanes.h"
#include "geometry/ray_frame.h"
#include "geometry/triangle.h"
#include "tree/block.h"

/* The closest hit so far. Before the first: t is the ray's tmax and primitive UINT32_MAX. */
typedef struct kdr_closest {
    float t, u, v;
    uint32_t primitive;
    float vertices[3][3];
} kdr_closest;

/* Rows of a leaf's block in the order of the ray's axes. */
typedef struct kdr_block_rows {
    const float *row[3][3]; /* vertex, axis x, y, z of the shear */
    uint32_t count;
} kdr_block_rows;

KDR_LANES_INLINE kdr_block_rows kdr_block_rows_of(const float *blocks, kdr_node leaf, const kdr_ray_frame *f) {
    kdr_block_rows rows = {.count = kdr_node_count(leaf)};
    size_t length = (size_t)kdr_block_groups(rows.count) * KDR_BLOCK_GROUP;
    const float *first = blocks + (size_t)kdr_node_first(leaf) * (KDR_BLOCK_GROUP_BYTES / sizeof(float));
    for (int vertex = 0; vertex < 3; vertex++, first += 3 * length) {
        rows.row[vertex][0] = first + (size_t)f->axis_x * length;
        rows.row[vertex][1] = first + (size_t)f->axis_y * length;
        rows.row[vertex][2] = first + (size_t)f->axis_z * length;
    }
    return rows;
}

/* Lanes whose triangle is not proven to be missed in (tmin, tmax], among those from `first` on. */
KDR_LANES_INLINE kdr_lane_bits kdr_block_filter(const kdr_block_rows *rows, const kdr_ray_frame *f, uint32_t first,
                                                float tmin, float tmax) {
    /* Shear the vertices, as seen from the origin. */
    kdr_lanes_f x[3], y[3], z[3], size[3];
    for (int i = 0; i < 3; i++) {
        z[i] = kdr_lanes_load(rows->row[i][2] + first) - f->origin[f->axis_z];
        x[i] = (kdr_lanes_load(rows->row[i][0] + first) - f->origin[f->axis_x]) - f->shear_x * z[i];
        y[i] = (kdr_lanes_load(rows->row[i][1] + first) - f->origin[f->axis_y]) - f->shear_y * z[i];
        size[i] = kdr_lanes_abs(x[i]) + kdr_lanes_abs(y[i]);
    }

    /* Edge functions: a lane misses if one is surely positive and another surely negative. */
    kdr_lanes_f edge[3], doubt = kdr_lanes_all(0);
    kdr_lane_bits positive = 0, negative = 0;
    for (int i = 0; i < 3; i++) {
        int p = (i + 1) % 3, q = (i + 2) % 3;
        edge[i] = x[q] * y[p] - y[q] * x[p];
        kdr_lanes_f bound = f->doubt * (size[p] + size[q] + f->doubt) + 0x1p-126f;
        positive |= kdr_lanes_less(bound, edge[i]);
        negative |= kdr_lanes_less(edge[i], -bound);
        doubt += bound;
    }
    kdr_lane_bits left = ~(positive & negative) & kdr_lanes_first(rows->count - first);
    if (__builtin_expect(left == 0, 1))
        return 0;

    /* Distance: sum of edge x z over sum of edges. It is compared with the ends of the interval multiplied out; the
     * doubt of an edge is at least 8 roundings of it, so four doubts of the terms cover every rounding here. */
    kdr_lanes_f den = edge[0] + edge[1] + edge[2], num = kdr_lanes_all(0), reach = kdr_lanes_all(0);
    for (int i = 0; i < 3; i++) {
        z[i] *= f->scale_z;
        num += edge[i] * z[i];
        reach += kdr_lanes_abs(z[i]);
    }
    kdr_lanes_f beyond = num - tmax * den, beyond_doubt = 4 * doubt * (reach + fabsf(tmax)) + 0x1p-126f;
    kdr_lanes_f before = tmin * den - num, before_doubt = 4 * doubt * (reach + fabsf(tmin)) + 0x1p-126f;
    kdr_lane_bits front = kdr_lanes_less(doubt, den), back = kdr_lanes_less(den, -doubt);
    kdr_lane_bits front_out = kdr_lanes_less(beyond_doubt, beyond) | kdr_lanes_less(before_doubt, before);
    kdr_lane_bits back_out = kdr_lanes_less(beyond, -beyond_doubt) | kdr_lanes_less(before, -before_doubt);
    return left & ~(front & front_out) & ~(back & back_out);
}

/* Decides one triangle that passed the filter. */
static __attribute__((noinline, unused)) bool kdr_block_decide(const float *blocks, kdr_node leaf, uint32_t i,
                                                               const kdr_ray_frame *f, float vertices[3][3],
                                                               kdr_triangle_hit *hit) {
    kdr_block_triangle(blocks, leaf, i, vertices);
    return kdr_triangle_meet(f->origin, f->direction, vertices[0], vertices[1], vertices[2], hit);
}

/* Makes *closest the closest of itself and the leaf's hits beyond tmin; of equal distances the lowest primitive. */
KDR_LANES_INLINE void kdr_block_closest(const float *blocks, kdr_node leaf, const kdr_ray_frame *f, float tmin,
                                        kdr_closest *closest) {
    kdr_block_rows rows = kdr_block_rows_of(blocks, leaf, f);
    for (uint32_t first = 0; first < rows.count; first += KDR_LANES) {
        for (kdr_lane_bits left = kdr_block_filter(&rows, f, first, tmin, closest->t); left; left &= left - 1) {
            uint32_t i = first + (uint32_t)__builtin_ctz(left);
            kdr_triangle_hit hit;
            float vertices[3][3];
            if (!kdr_block_decide(blocks, leaf, i, f, vertices, &hit))
                continue;
            uint32_t primitive = kdr_block_primitive(blocks, leaf, i);
            bool closer = hit.t < closest->t || (hit.t == closest->t && primitive < closest->primitive);
            if (hit.t > tmin && closer) {
                closest->t = hit.t;
                closest->u = hit.u;
                closest->v = hit.v;
                closest->primitive = primitive;
                memcpy(closest->vertices, vertices, sizeof vertices);
            }
        }
    }
}

/* True if the leaf has a hit in (tmin, tmax]. */
KDR_LANES_INLINE bool kdr_block_any(const float *blocks, kdr_node leaf, const kdr_ray_frame *f, float tmin,
                                    float tmax) {
    kdr_block_rows rows = kdr_block_rows_of(blocks, leaf, f);
    for (uint32_t first = 0; first < rows.count; first += KDR_LANES) {
        for (kdr_lane_bits left = kdr_block_filter(&rows, f, first, tmin, tmax); left; left &= left - 1) {
            uint32_t i = first + (uint32_t)__builtin_ctz(left);
            kdr_triangle_hit hit;
            float vertices[3][3];
            if (kdr_block_decide(blocks, leaf, i, f, vertices, &hit) && hit.t > tmin && hit.t <= tmax)
                return true;
        }
    }
    return false;
}

#endif
