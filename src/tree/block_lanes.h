/* One ray against the triangles of a leaf, KDR_LANES at a time.
 *
 * A float filter over all lanes (edge functions of the sheared triangle, with an error bound) leaves the few triangles
 * that the ray meets or nearly meets. Where it is sure of a hit, it says so, and between which distances; only hits
 * that it is not sure of, or cannot tell apart, are decided exactly on the way, and the closest at the end. So a hit
 * never depends on the width of lanes. Source of the filter: S. Woop, C. Benthin, I. Wald, "Watertight Ray/Triangle
 * Intersection", 2013. Cost: about 35 vector operations a step, as many more where something passes, and some 70
 * operations for the closest hit and each exact decision. */
#ifndef KDR_TREE_BLOCK_LANES_H
#define KDR_TREE_BLOCK_LANES_H

#include "geometry/lanes.h"
#include "geometry/ray_frame.h"
#include "geometry/triangle.h"
#include "tree/block.h"
#include "tree/counts.h"
#include "tree/mailbox_lanes.h"

/* The closest hit so far. Before the first, `least` and `t` are the ray's tmax and primitive is UINT32_MAX. */
typedef struct kdr_closest {
    float least, t; /* its distance lies between them */
    uint32_t primitive;
    bool sure; /* found by the filter: `hit` is not yet set */
    kdr_block block;
    size_t place; /* in the block */
    kdr_triangle_hit hit;
} kdr_closest;

KDR_LANES_INLINE void kdr_closest_begin(kdr_closest *closest, float tmax) {
    closest->least = closest->t = tmax;
    closest->primitive = UINT32_MAX;
    closest->sure = false;
}

/* Lanes as the edge functions of the sheared triangles left them. */
typedef struct kdr_block_edges {
    kdr_lanes_f edge[3], z[3]; /* z: of the origin, along the axis of the shear, from the corner */
    kdr_lanes_f least, most;   /* of the three */
    kdr_lanes_f bound;         /* at least the error of each */
} kdr_block_edges;

/* A block along the axes of a ray's shear: the rows of the first corner's x, y and z; those of the next corner come
 * `corner` floats later. */
typedef struct kdr_block_rows {
    const float *x, *y, *z;
    size_t corner, shown;
} kdr_block_rows;

/* One ray asks a vector of triangles, or some of them. */
KDR_LANES_INLINE void kdr_block_count_step(kdr_lane_bits lanes) {
    (void)lanes;
    KDR_COUNT(steps, 1);
    KDR_COUNT(tests, (uint32_t)__builtin_popcount(lanes));
}

KDR_LANES_INLINE void kdr_block_count_block(void) {
    KDR_COUNT(blocks, 1);
    KDR_COUNT_WIDTH(KDR_LANES);
}

KDR_LANES_INLINE kdr_block_rows kdr_block_rows_of(kdr_block block, const kdr_ray_frame *f) {
    return (kdr_block_rows){.x = block.rows + f->axis_x * block.length,
                            .y = block.rows + f->axis_y * block.length,
                            .z = block.rows + f->axis_z * block.length,
                            .corner = 3 * block.length,
                            .shown = block.shown};
}

/* Edge functions of sheared corners, and one bound for the three of a triangle: z is set before. */
KDR_LANES_INLINE void kdr_block_edges_set(kdr_block_edges *e, const kdr_lanes_f x[3], const kdr_lanes_f y[3],
                                          kdr_lanes_f doubt_least, kdr_lanes_f doubt) {
    kdr_lanes_f size[3];
    for (int i = 0; i < 3; i++) {
        int p = (i + 1) % 3, q = (i + 2) % 3;
        size[i] = kdr_lanes_larger(x[i], y[i]);
        e->edge[i] = kdr_lanes_less_product(x[q] * y[p], y[q], x[p]);
    }
    e->bound = kdr_lanes_add_product(doubt_least, doubt, kdr_lanes_larger(kdr_lanes_larger(size[0], size[1]), size[2]));
    e->least = kdr_lanes_min(kdr_lanes_min(e->edge[0], e->edge[1]), e->edge[2]);
    e->most = kdr_lanes_max(kdr_lanes_max(e->edge[0], e->edge[1]), e->edge[2]);
}

/* Lanes that surely miss: one edge function is surely positive and another surely negative. */
KDR_LANES_INLINE kdr_lane_bits kdr_block_outside(const kdr_block_edges *e) {
    return kdr_lanes_less(e->least, -e->bound) & kdr_lanes_less(e->bound, e->most);
}

/* Lanes from `first` on whose triangle the ray's line is not proven to miss. */
KDR_LANES_INLINE kdr_lane_bits kdr_block_meet(const kdr_block_rows *rows, const kdr_ray_frame *f, size_t first,
                                              kdr_block_edges *e) {
    /* Shear the vertices, as the origin is seen from them: so that what is loaded is what is taken away. */
    kdr_lanes_f shear_x = kdr_lanes_all(f->shear_x), shear_y = kdr_lanes_all(f->shear_y);
    kdr_lanes_f origin_x = kdr_lanes_all(f->origin_along[0]), origin_y = kdr_lanes_all(f->origin_along[1]);
    kdr_lanes_f origin_z = kdr_lanes_all(f->origin_along[2]);
    kdr_lanes_f x[3], y[3];
    for (size_t i = 0; i < 3; i++) {
        size_t at = first + i * rows->corner;
        e->z[i] = origin_z - kdr_lanes_load(rows->z + at);
        x[i] = kdr_lanes_less_product(origin_x - kdr_lanes_load(rows->x + at), shear_x, e->z[i]);
        y[i] = kdr_lanes_less_product(origin_y - kdr_lanes_load(rows->y + at), shear_y, e->z[i]);
    }
    kdr_block_edges_set(e, x, y, kdr_lanes_all(f->doubt_least), kdr_lanes_all(f->doubt));
    return ~kdr_block_outside(e) & kdr_lanes_first((uint32_t)(rows->shown - first));
}

/* Lanes whose triangle it surely meets. */
KDR_LANES_INLINE kdr_lane_bits kdr_block_inside(const kdr_block_edges *e) {
    return kdr_lanes_less(e->bound, e->least) | kdr_lanes_less(e->most, -e->bound);
}

/* Between which distances the line meets the planes of the lanes' triangles; infinite where nothing is known. */
typedef struct kdr_block_span {
    kdr_lanes_f from, to;
} kdr_block_span;

/* For lanes that kdr_block_meet left. With edge functions E, distances Z and t = sum(E Z) / sum(E) in real numbers, and
 * floats e within b of E and z within four roundings of Z,
 *     computed t - t = (sum((e - E) (z - t)) + sum(E (z - Z)) + roundings) / sum(e),
 * so that what an edge function is off by counts only against the extent of the triangle along the ray. Where the sum
 * of the e is at least 16 b, their sizes add up to at most 5/4 of it; and of a triangle that is met, each z is at most
 * the extent away from t. So the first sum adds at most 3 b times the extent, for which there is room more than twice,
 * and all others 34 roundings of the largest z (16 of them for the reciprocal), for which there is room nearly twice.
 * The bound does not wait for t. */
KDR_LANES_INLINE kdr_block_span kdr_block_span_of(const kdr_block_edges *e, kdr_lanes_f scale_z) {
    kdr_lanes_f den = (e->edge[0] + e->edge[1]) + e->edge[2], inverse = kdr_lanes_reciprocal(den);
    kdr_lanes_f z[3];
    for (int i = 0; i < 3; i++)
        z[i] = e->z[i] * -scale_z;
    kdr_lanes_f num = kdr_lanes_add_product(e->edge[0] * z[0] + e->edge[1] * z[1], e->edge[2], z[2]);
    kdr_lanes_f extent =
        kdr_lanes_max(kdr_lanes_max(z[0], z[1]), z[2]) - kdr_lanes_min(kdr_lanes_min(z[0], z[1]), z[2]);
    kdr_lanes_f reach = kdr_lanes_larger(kdr_lanes_larger(z[0], z[1]), z[2]);
    kdr_lanes_f doubt_num = 8 * e->bound * extent + 0x1p-126f, doubt_t = 0x1p-18f * reach + 0x1p-120f;
    kdr_lane_bits known = kdr_lanes_less(16 * e->bound, kdr_lanes_abs(den));
    kdr_lanes_f t = num * inverse, doubt = kdr_lanes_add_product(doubt_t, doubt_num, kdr_lanes_abs(inverse));
    return (kdr_block_span){kdr_lanes_choose(known, t - doubt, kdr_lanes_all(-INFINITY)),
                            kdr_lanes_choose(known, t + doubt, kdr_lanes_all(INFINITY))};
}

/* The nearest of some lanes, about. */
KDR_LANES_INLINE uint32_t kdr_block_nearest(const kdr_block_span *span, kdr_lane_bits lanes) {
    uint32_t nearest = (uint32_t)__builtin_ctz(lanes);
    for (lanes &= lanes - 1; lanes; lanes &= lanes - 1) {
        uint32_t lane = (uint32_t)__builtin_ctz(lanes);
        nearest = kdr_lanes_get(span->from, lane) < kdr_lanes_get(span->from, nearest) ? lane : nearest;
    }
    return nearest;
}

KDR_LANES_INLINE kdr_corners kdr_block_corners(kdr_block block, size_t i) {
    return (kdr_corners){block.rows + i, block.length};
}

/* Decides one triangle that passed the filter. */
static __attribute__((noinline, unused)) bool kdr_block_decide(kdr_block block, size_t i, const kdr_ray_frame *f,
                                                               kdr_triangle_hit *hit) {
    KDR_COUNT(exact, 1);
    return kdr_triangle_meet(f->origin, f->direction, kdr_block_corners(block, i), hit);
}

/* Decides whether one triangle that passed the filter is hit in (tmin, tmax]. */
static __attribute__((noinline, unused)) bool kdr_block_decide_any(kdr_block block, size_t i, const kdr_ray_frame *f,
                                                                   float tmin, float tmax) {
    kdr_triangle_hit hit;
    KDR_COUNT(exact, 1);
    kdr_corners corners = kdr_block_corners(block, i);
    return kdr_block_primitive(block, i) != UINT32_MAX &&
           !kdr_triangle_is_behind(f->origin, f->direction, corners, tmin) &&
           kdr_triangle_meet(f->origin, f->direction, corners, &hit) && hit.t > tmin && hit.t <= tmax;
}

/* Gives a closest hit that the filter was sure of its exact distance. */
KDR_LANES_INLINE void kdr_closest_settle(kdr_closest *closest, const kdr_ray_frame *f) {
    if (!closest->sure)
        return;
    closest->sure = false;
    kdr_triangle_measure(f->origin, f->direction, kdr_block_corners(closest->block, closest->place), &closest->hit);
    closest->least = closest->t = closest->hit.t;
}

/* A hit that the filter is sure of takes the lead, or not: false if that takes an exact decision. */
KDR_LANES_INLINE bool kdr_closest_take(kdr_closest *closest, float from, float to, kdr_block block, size_t place,
                                       uint32_t primitive) {
    if (from > closest->t)
        return true;
    if (to >= closest->least)
        return false;
    closest->least = from;
    closest->t = to;
    closest->primitive = primitive;
    closest->sure = true;
    closest->block = block;
    closest->place = place;
    return true;
}

/* The same for any other. */
static __attribute__((noinline, unused)) void kdr_closest_decide(kdr_closest *closest, const kdr_ray_frame *f,
                                                                 float tmin, kdr_block block, size_t place,
                                                                 uint32_t primitive) {
    kdr_triangle_hit hit;
    if (!kdr_block_decide(block, place, f, &hit) || hit.t <= tmin)
        return;
    kdr_closest_settle(closest, f);
    if (hit.t < closest->t || (hit.t == closest->t && primitive < closest->primitive)) {
        closest->least = closest->t = hit.t;
        closest->primitive = primitive;
        closest->hit = hit;
    }
}

/* Makes *closest the closest of itself and the block's hits beyond tmin; of equal distances the lowest primitive.
 * mailbox may be NULL. */
KDR_LANES_INLINE void kdr_block_closest_new(kdr_block block, const kdr_ray_frame *f, float tmin, kdr_mailbox *mailbox,
                                            kdr_closest *closest) {
    kdr_block_rows rows = kdr_block_rows_of(block, f);
    kdr_block_count_block();
    for (size_t first = 0; first < block.shown; first += KDR_LANES) {
        kdr_lane_bits untested = kdr_mailbox_new(mailbox, block, first);
        if (untested == 0)
            continue;
        kdr_block_count_step(untested & kdr_lanes_first((uint32_t)(block.shown - first)));
        kdr_block_edges e;
        kdr_lane_bits left = kdr_block_meet(&rows, f, first, &e) & untested;
        if (__builtin_expect(left == 0, 1))
            continue;
        kdr_block_span span = kdr_block_span_of(&e, kdr_lanes_all(f->scale_z));
        kdr_lane_bits sure = kdr_block_inside(&e) & kdr_lanes_less(kdr_lanes_all(tmin), span.from);
        left &= ~kdr_lanes_less(span.to, kdr_lanes_all(tmin));
        while (left &= ~kdr_lanes_less(kdr_lanes_all(closest->t), span.from)) {
            uint32_t lane = kdr_block_nearest(&span, left), primitive = kdr_block_primitive(block, first + lane);
            left ^= 1u << lane;
            if (primitive == UINT32_MAX || primitive == closest->primitive)
                continue;
            float from = kdr_lanes_get(span.from, lane), to = kdr_lanes_get(span.to, lane);
            if (!(sure >> lane & 1) || !kdr_closest_take(closest, from, to, block, first + lane, primitive))
                kdr_closest_decide(closest, f, tmin, block, first + lane, primitive);
        }
    }
}

KDR_LANES_INLINE void kdr_block_closest(kdr_block block, const kdr_ray_frame *f, float tmin, kdr_closest *closest) {
    kdr_block_closest_new(block, f, tmin, NULL, closest);
}

/* True if the block has a hit in (tmin, tmax]. Where the filter is sure of one, nothing else is asked. mailbox may be
 * NULL; a triangle that it holds has been missed. */
KDR_LANES_INLINE bool kdr_block_any_new(kdr_block block, const kdr_ray_frame *f, float tmin, float tmax,
                                        kdr_mailbox *mailbox) {
    kdr_block_rows rows = kdr_block_rows_of(block, f);
    kdr_block_count_block();
    for (size_t first = 0; first < block.shown; first += KDR_LANES) {
        kdr_lane_bits untested = kdr_mailbox_new(mailbox, block, first);
        if (untested == 0)
            continue;
        kdr_block_count_step(untested & kdr_lanes_first((uint32_t)(block.shown - first)));
        kdr_block_edges e;
        kdr_lane_bits left = kdr_block_meet(&rows, f, first, &e) & untested;
        if (__builtin_expect(left == 0, 1))
            continue;
        kdr_block_span span = kdr_block_span_of(&e, kdr_lanes_all(f->scale_z));
        kdr_lanes_f begin = kdr_lanes_all(tmin), end = kdr_lanes_all(tmax);
        if (left & kdr_block_inside(&e) & kdr_lanes_less(begin, span.from) & kdr_lanes_less(span.to, end))
            return true;
        left &= ~(kdr_lanes_less(span.to, begin) | kdr_lanes_less(end, span.from));
        for (; left; left &= left - 1)
            if (kdr_block_decide_any(block, first + (uint32_t)__builtin_ctz(left), f, tmin, tmax))
                return true;
    }
    return false;
}

KDR_LANES_INLINE bool kdr_block_any(kdr_block block, const kdr_ray_frame *f, float tmin, float tmax) {
    return kdr_block_any_new(block, f, tmin, tmax, NULL);
}

#endif
