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
    kdr_block block; /* where it lies, at `place` */
    size_t place;
} kdr_closest;

/* Lanes as the edge functions of the sheared triangles left them. */
typedef struct kdr_block_edges {
    kdr_lanes_f edge[3], z[3]; /* z: along the ray, as seen from the origin, unscaled */
    kdr_lanes_f bound;         /* at least the error of an edge function */
} kdr_block_edges;

/* Lanes from `first` on whose triangle the ray's line is not proven to miss. */
KDR_LANES_INLINE kdr_lane_bits kdr_block_meet(kdr_block block, const kdr_ray_frame *f, size_t first,
                                              kdr_block_edges *e) {
    /* Shear the vertices, as seen from the origin. */
    const float *at = block.rows + first;
    const float *at_x = at + (size_t)f->axis_x * block.length, *at_y = at + (size_t)f->axis_y * block.length;
    const float *at_z = at + (size_t)f->axis_z * block.length;
    kdr_lanes_f shear_x = kdr_lanes_all(f->shear_x), shear_y = kdr_lanes_all(f->shear_y);
    kdr_lanes_f x[3], y[3], size[3];
    for (size_t i = 0, row = 0; i < 3; i++, row += 3 * block.length) {
        e->z[i] = kdr_lanes_load(at_z + row) - f->origin[f->axis_z];
        x[i] = kdr_lanes_less_product(kdr_lanes_load(at_x + row) - f->origin[f->axis_x], shear_x, e->z[i]);
        y[i] = kdr_lanes_less_product(kdr_lanes_load(at_y + row) - f->origin[f->axis_y], shear_y, e->z[i]);
        size[i] = kdr_lanes_abs(x[i]) + kdr_lanes_abs(y[i]);
    }

    /* Edge functions, and one bound for the three of a triangle. */
    for (int i = 0; i < 3; i++) {
        int p = (i + 1) % 3, q = (i + 2) % 3;
        e->edge[i] = kdr_lanes_less_product(x[q] * y[p], y[q], x[p]);
    }
    kdr_lanes_f doubt = kdr_lanes_all(f->doubt), least_bound = kdr_lanes_all(f->doubt * f->doubt + 0x1p-126f);
    e->bound = kdr_lanes_add_product(least_bound, doubt, (size[0] + size[1]) + size[2]);

    /* A lane misses if one is surely positive and another surely negative. */
    kdr_lanes_f least = kdr_lanes_min(kdr_lanes_min(e->edge[0], e->edge[1]), e->edge[2]);
    kdr_lanes_f most = kdr_lanes_max(kdr_lanes_max(e->edge[0], e->edge[1]), e->edge[2]);
    kdr_lane_bits missed = kdr_lanes_less(least, -e->bound) & kdr_lanes_less(e->bound, most);
    return ~missed & kdr_lanes_first((uint32_t)(block.length - first));
}

/* Where the line meets the planes of the lanes' triangles: num / den. `doubt` is at least the error of den, and
 * doubt times reach that of num; four of each cover every rounding of a comparison with it. */
typedef struct kdr_block_distances {
    kdr_lanes_f num, den, doubt, reach;
    kdr_lane_bits front, back; /* den is surely positive, surely negative */
} kdr_block_distances;

KDR_LANES_INLINE kdr_block_distances kdr_block_distances_of(const kdr_block_edges *e, const kdr_ray_frame *f) {
    kdr_block_distances d = {.num = kdr_lanes_all(0), .reach = kdr_lanes_all(0)};
    d.den = (e->edge[0] + e->edge[1]) + e->edge[2];
    for (int i = 0; i < 3; i++) {
        kdr_lanes_f z = e->z[i] * f->scale_z;
        d.num += e->edge[i] * z;
        d.reach += kdr_lanes_abs(z);
    }
    d.doubt = 3 * e->bound;
    d.front = kdr_lanes_less(d.doubt, d.den);
    d.back = kdr_lanes_less(d.den, -d.doubt);
    return d;
}

/* Lanes surely beyond t; lanes surely not beyond t. */
KDR_LANES_INLINE void kdr_block_compare(const kdr_block_distances *d, float t, kdr_lane_bits *beyond,
                                        kdr_lane_bits *before) {
    kdr_lanes_f difference = d->num - t * d->den, doubt = 4 * d->doubt * (d->reach + fabsf(t)) + 0x1p-126f;
    kdr_lane_bits above = kdr_lanes_less(doubt, difference), below = kdr_lanes_less(difference, -doubt);
    *beyond = (d->front & above) | (d->back & below);
    *before = (d->front & below) | (d->back & above);
}

/* The nearest of some lanes, about. */
KDR_LANES_INLINE uint32_t kdr_block_nearest(const kdr_block_distances *d, kdr_lane_bits lanes) {
    uint32_t nearest = (uint32_t)__builtin_ctz(lanes);
    lanes &= lanes - 1;
    if (__builtin_expect(lanes == 0, 1))
        return nearest;
    float t[KDR_LANES];
    kdr_lanes_store(t, d->num / d->den);
    for (; lanes; lanes &= lanes - 1) {
        uint32_t lane = (uint32_t)__builtin_ctz(lanes);
        nearest = t[lane] < t[nearest] ? lane : nearest;
    }
    return nearest;
}

KDR_LANES_INLINE kdr_corners kdr_block_corners(kdr_block block, size_t i) {
    const float *at = block.rows + i;
    kdr_corners corners;
    for (size_t k = 0; k < 3; k++, at += block.length)
        corners.axis[k] = (kdr_quad){at[0], at[3 * block.length], at[6 * block.length]};
    return corners;
}

/* Decides one triangle that passed the filter. */
static __attribute__((noinline, unused)) bool kdr_block_decide(kdr_block block, size_t i, const kdr_ray_frame *f,
                                                               kdr_triangle_hit *hit) {
    kdr_corners corners = kdr_block_corners(block, i);
    return kdr_triangle_meet(f->origin, f->direction, &corners, hit);
}

/* Makes *closest the closest of itself and the block's hits beyond tmin; of equal distances the lowest primitive. */
KDR_LANES_INLINE void kdr_block_closest(kdr_block block, const kdr_ray_frame *f, float tmin, kdr_closest *closest) {
    for (size_t first = 0; first < block.length; first += KDR_LANES) {
        kdr_block_edges e;
        kdr_lane_bits left = kdr_block_meet(block, f, first, &e), out, in;
        if (__builtin_expect(left == 0, 1))
            continue;
        kdr_block_distances d = kdr_block_distances_of(&e, f);
        kdr_block_compare(&d, tmin, &in, &out);
        left &= ~out;
        kdr_block_compare(&d, closest->t, &out, &in);
        left &= ~out;
        while (left) {
            uint32_t lane = kdr_block_nearest(&d, left);
            left ^= 1u << lane;
            uint32_t primitive = kdr_block_primitive(block, first + lane);
            kdr_triangle_hit hit;
            if (primitive == UINT32_MAX || !kdr_block_decide(block, first + lane, f, &hit))
                continue;
            bool closer = hit.t < closest->t || (hit.t == closest->t && primitive < closest->primitive);
            if (hit.t > tmin && closer) {
                closest->t = hit.t;
                closest->u = hit.u;
                closest->v = hit.v;
                closest->primitive = primitive;
                closest->block = block;
                closest->place = first + lane;
                kdr_block_compare(&d, hit.t, &out, &in);
                left &= ~out;
            }
        }
    }
}

/* True if the block has a hit in (tmin, tmax]. Where the filter is sure of one, nothing else is asked. */
KDR_LANES_INLINE bool kdr_block_any(kdr_block block, const kdr_ray_frame *f, float tmin, float tmax) {
    for (size_t first = 0; first < block.length; first += KDR_LANES) {
        kdr_block_edges e;
        kdr_lane_bits left = kdr_block_meet(block, f, first, &e);
        if (__builtin_expect(left == 0, 1))
            continue;
        kdr_block_distances d = kdr_block_distances_of(&e, f);
        kdr_lane_bits before, after, within, beyond, unused;
        kdr_block_compare(&d, tmin, &after, &before);
        kdr_block_compare(&d, tmax < KDR_RAY_FRAME_LARGEST ? tmax : KDR_RAY_FRAME_LARGEST, &unused, &within);
        kdr_lanes_f least = kdr_lanes_min(kdr_lanes_min(e.edge[0], e.edge[1]), e.edge[2]);
        kdr_lanes_f most = kdr_lanes_max(kdr_lanes_max(e.edge[0], e.edge[1]), e.edge[2]);
        kdr_lane_bits inside = kdr_lanes_less(e.bound, least) | kdr_lanes_less(most, -e.bound);
        if (left & inside & after & within)
            return true;
        kdr_block_compare(&d, tmax, &beyond, &unused);
        for (left &= ~(before | beyond); left; left &= left - 1) {
            size_t i = first + (uint32_t)__builtin_ctz(left);
            kdr_triangle_hit hit;
            if (kdr_block_primitive(block, i) != UINT32_MAX && kdr_block_decide(block, i, f, &hit) && hit.t > tmin &&
                hit.t <= tmax)
                return true;
        }
    }
    return false;
}

#endif
