/* Rays of a packet made ready, KDR_LANES at a time: what boxes and triangles need of them, and their closest hits.
 *
 * All is as for a lone ray (wide_begin, kdr_ray_frame_set), but that the rays of a group share the axis of their shear,
 * which need not be the longest axis of each: see packet_frame. */
#ifndef KDR_TRACE_PACKET_RAYS_LANES_H
#define KDR_TRACE_PACKET_RAYS_LANES_H

#include "trace/packet.h"
#include "trace/wide_lanes.h"

#define PACKET_VECTORS (KDR_PACKET_RAYS / KDR_LANES)

/* One bit a ray. */
typedef uint64_t packet_bits;

/* A number for each ray. */
typedef union packet_row {
    float of[KDR_PACKET_RAYS];
    kdr_lanes_f lanes[PACKET_VECTORS];
} packet_row;

typedef union packet_row_u {
    uint32_t of[KDR_PACKET_RAYS];
    kdr_lanes_u lanes[PACKET_VECTORS];
} packet_row_u;

typedef struct packet {
    const kdr_tree *tree;
    const kdr_packet_rays *rays;
    uint32_t vectors;
    packet_row origin[3], direction[3], tmin;
    packet_row t; /* of the closest hit so far; for any hit the ray's tmax, and -infinity when one is found */

    /* As in wide_ray. */
    packet_row reciprocal[3], near[3], far[3];
    packet_row_u octant;

    /* As in kdr_ray_frame, of the group that is on its way: axis[2] is that of the shear. */
    uint32_t axis[3];
    packet_row shear_x, shear_y, doubt, doubt_least;
    packet_bits framed; /* those whose frame is set, for leaves that they ask alone */
    kdr_ray_frame frames[KDR_PACKET_RAYS];

    /* As in kdr_closest. */
    packet_bits sure;
    packet_row least;
    packet_row_u primitive, corner, length; /* corner: where it lies, in floats behind the tree's blocks */
    kdr_triangle_hit hit[KDR_PACKET_RAYS];
} packet;

KDR_LANES_INLINE kdr_lane_bits packet_lanes_of(packet_bits bits, uint32_t vector) {
    return (kdr_lane_bits)(bits >> vector * KDR_LANES) & KDR_LANE_BITS_ALL;
}

KDR_LANES_INLINE packet_bits packet_bits_of(kdr_lane_bits lanes, uint32_t vector) {
    return (packet_bits)lanes << vector * KDR_LANES;
}

/* Makes rays ready for boxes; returns those that are valid and of the usual kind. For what is done and why it is right
 * see wide_begin. */
KDR_LANES_INLINE packet_bits packet_begin(packet *p, const kdr_tree *tree, const kdr_packet_rays *rays,
                                          const bool any) {
    p->tree = tree;
    p->rays = rays;
    p->vectors = (rays->count + KDR_LANES - 1) / KDR_LANES;
    p->sure = 0;
    packet_bits fits = 0;
    for (uint32_t v = 0; v < p->vectors; v++) {
        kdr_lanes_f size[3], direction[3], reach[3];
        kdr_lane_bits usual = KDR_LANE_BITS_ALL, enough = 0, small = 0;
        kdr_lanes_u octant = {0};
        for (uint32_t k = 0; k < 3; k++) {
            kdr_lanes_f origin = kdr_lanes_load(&rays->origin[k][v * KDR_LANES]);
            direction[k] = kdr_lanes_load(&rays->direction[k][v * KDR_LANES]);
            size[k] = kdr_lanes_abs(direction[k]);
            p->origin[k].lanes[v] = origin;
            p->direction[k].lanes[v] = direction[k];
            reach[k] = kdr_lanes_abs(origin) + tree->reach[k];
            usual &= ~kdr_lanes_less(kdr_lanes_all(KDR_WIDE_LARGEST), kdr_lanes_abs(origin));
            usual &= kdr_lanes_less(origin - origin + size[k], kdr_lanes_all(0x1.8p60f));
            enough |= ~kdr_lanes_less(size[k], kdr_lanes_all(0x1p-40f));
            small |= kdr_lanes_less(size[k], kdr_lanes_all(0x1p-63f));
            octant |= ((kdr_lanes_u)direction[k] >> 31) << k;
        }
        if (__builtin_expect(small != 0, 0)) {
            kdr_lanes_f longest = kdr_lanes_max(kdr_lanes_max(reach[0], reach[1]), reach[2]);
            for (int k = 0; k < 3; k++)
                reach[k] = longest;
        }
        for (uint32_t k = 0; k < 3; k++) {
            kdr_lanes_f size_reciprocal = 1 / kdr_lanes_max(size[k], kdr_lanes_all(0x1p-63f));
            kdr_lanes_f reciprocal =
                (kdr_lanes_f)((kdr_lanes_u)size_reciprocal | ((kdr_lanes_u)direction[k] & 0x80000000u));
            kdr_lanes_f slack = reach[k] * size_reciprocal * 0x1p-21f + 0x1p-120f;
            kdr_lanes_f start = p->origin[k].lanes[v] * reciprocal;
            p->reciprocal[k].lanes[v] = reciprocal;
            p->near[k].lanes[v] = -start - slack;
            p->far[k].lanes[v] = slack - start;
        }
        kdr_lanes_f tmin = kdr_lanes_load(&rays->tmin[v * KDR_LANES]);
        kdr_lanes_f tmax = kdr_lanes_load(&rays->tmax[v * KDR_LANES]);
        p->octant.lanes[v] = octant;
        p->tmin.lanes[v] = tmin;
        p->t.lanes[v] = tmax;
        if (!any) {
            p->least.lanes[v] = tmax;
            p->primitive.lanes[v] = ~(kdr_lanes_u){0};
            p->corner.lanes[v] = p->length.lanes[v] = (kdr_lanes_u){0};
        }
        /* A tmin that is NaN is not less than tmax. */
        usual &= enough & kdr_lanes_less(tmin, tmax) & ~kdr_lanes_less(tmin, (kdr_lanes_f){0});
        fits |= packet_bits_of(usual & KDR_LANE_BITS_ALL, v);
    }
    /* Distances are worked out for eight rays at once. */
    for (uint32_t v = p->vectors; !any && v * KDR_LANES % 8 != 0; v++)
        p->corner.lanes[v] = p->length.lanes[v] = (kdr_lanes_u){0};
    return fits & rays->valid;
}

/* Makes rays ready for triangles, in a shear along one axis: p->axis[2]. The rays given have no shear above 2. With a
 * shear of s a sheared coordinate is off by at most e = 2^-24 (2 + 5 s) m; kdr_ray_frame_set has s = 1, which no ray
 * along its longest axis exceeds, and `doubt` is in proportion to e. */
KDR_LANES_INLINE void packet_frame(packet *p) {
    const uint32_t x = p->axis[0], y = p->axis[1], z = p->axis[2];
    const kdr_box *bounds = &p->tree->bounds;
    p->framed = 0;
    for (uint32_t v = 0; v < p->vectors; v++) {
        kdr_lanes_f scale = p->reciprocal[z].lanes[v], largest = {0};
        p->shear_x.lanes[v] = p->direction[x].lanes[v] * scale;
        p->shear_y.lanes[v] = p->direction[y].lanes[v] * scale;
        for (uint32_t k = 0; k < 3; k++) {
            kdr_lanes_f origin = p->origin[k].lanes[v];
            largest = kdr_lanes_max(largest, kdr_lanes_larger(bounds->lo[k] - origin, bounds->hi[k] - origin));
        }
        kdr_lanes_f most = kdr_lanes_max(largest, largest * kdr_lanes_abs(scale));
        kdr_lane_bits beyond = kdr_lanes_less(kdr_lanes_all(KDR_RAY_FRAME_LARGEST), most);
        kdr_lanes_f shear = kdr_lanes_larger(p->shear_x.lanes[v], p->shear_y.lanes[v]);
        kdr_lanes_f factor = kdr_lanes_add_product(kdr_lanes_all(19 * 0x1p-24f), kdr_lanes_all(46 * 0x1p-24f), shear);
        kdr_lanes_f doubt = kdr_lanes_choose(beyond, kdr_lanes_all(INFINITY), factor * largest);
        p->doubt.lanes[v] = doubt;
        p->doubt_least.lanes[v] = 0x1p-4f * doubt * doubt + 0x1p-126f;
    }
}

KDR_LANES_INLINE kdr_ray packet_ray(const packet *p, uint32_t i) { return kdr_packet_ray(p->rays, i); }

/* Its frame, along the axis of the group. */
KDR_LANES_INLINE const kdr_ray_frame *packet_ray_frame(packet *p, uint32_t i) {
    kdr_ray_frame *f = &p->frames[i];
    if (p->framed >> i & 1)
        return f;
    p->framed |= (packet_bits)1 << i;
    for (int k = 0; k < 3; k++) {
        f->origin[k] = p->origin[k].of[i];
        f->direction[k] = p->direction[k].of[i];
        f->origin_along[k] = p->origin[p->axis[k]].of[i];
    }
    f->axis_x = p->axis[0];
    f->axis_y = p->axis[1];
    f->axis_z = p->axis[2];
    f->shear_x = p->shear_x.of[i];
    f->shear_y = p->shear_y.of[i];
    f->scale_z = p->reciprocal[p->axis[2]].of[i];
    f->doubt = p->doubt.of[i];
    f->doubt_least = p->doubt_least.of[i];
    return f;
}

/* The closest hit of a ray, taken out and put back. */
KDR_LANES_INLINE kdr_closest packet_closest_get(const packet *p, uint32_t i) {
    return (kdr_closest){.least = p->least.of[i],
                         .t = p->t.of[i],
                         .primitive = p->primitive.of[i],
                         .sure = p->sure >> i & 1,
                         .block = {p->tree->blocks + p->corner.of[i], p->length.of[i], 0},
                         .place = 0,
                         .hit = p->hit[i]};
}

KDR_LANES_INLINE void packet_closest_put(packet *p, uint32_t i, const kdr_closest *closest) {
    p->least.of[i] = closest->least;
    p->t.of[i] = closest->t;
    p->primitive.of[i] = closest->primitive;
    p->sure = (p->sure & ~((packet_bits)1 << i)) | (packet_bits)closest->sure << i;
    p->corner.of[i] = (uint32_t)(closest->block.rows + closest->place - p->tree->blocks);
    p->length.of[i] = (uint32_t)closest->block.length;
    p->hit[i] = closest->hit;
}

#endif
