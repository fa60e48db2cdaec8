/* The beam around a group of rays: four planes and a range, all along one axis, that hold what the rays can meet.
 *
 * Seen along axis z, on which all rays of the group run one way, each ray is a line x(z), and so is y(z). The least and
 * the largest x of all rays where they may begin, and where they may end, give two lines that no ray crosses between:
 * planes x = start + slope z. So rays need neither share an origin nor a target nor the signs of their other
 * directions, and rays that do, either one, have a beam that is tight.
 *
 * Source of the idea: A. Reshetov, A. Soupikov, J. Hurley, "Multi-Level Ray Tracing Algorithm", 2005.
 * Invariant: a box or triangle is left out only if it lies outside of one plane or of the range, so that no ray meets
 * it within its interval. With M the largest coordinate of the scene and the rays' origins, and slopes of at most 2,
 * less than 64 roundings of M are lost on the way from the rays to here and in the tests; the planes stand off by twice
 * as much. Cost: 14 operations a vector of boxes, 42 a vector of triangles. */
#ifndef KDR_TRACE_BEAM_LANES_H
#define KDR_TRACE_BEAM_LANES_H

#include "trace/packet_rays_lanes.h"

typedef struct beam {
    struct {
        float start, slope;
        size_t face, depth; /* where in a wide node the faces are that reach furthest to the inside: of x or y, and z */
    } side[4];              /* x from below, x from above, y from below, y from above */
    float from, to;         /* z: from <= to */
    size_t from_face, to_face;
    uint32_t axis[3];
    float slack;
    float width, reach; /* how wide it is on x or y, the mean of both ends; the scene's largest coordinate */
    bool runs_down;     /* rays run down z, and end at `from` */
} beam;

typedef struct beam_bounds {
    kdr_lanes_f lo, hi;
} beam_bounds;

/* Takes in the chosen lanes. */
KDR_LANES_INLINE void beam_add(beam_bounds *bounds, kdr_lane_bits lanes, kdr_lanes_f v) {
    bounds->lo = kdr_lanes_min(bounds->lo, kdr_lanes_choose(lanes, v, kdr_lanes_all(INFINITY)));
    bounds->hi = kdr_lanes_max(bounds->hi, kdr_lanes_choose(lanes, v, kdr_lanes_all(-INFINITY)));
}

KDR_LANES_INLINE beam_bounds beam_nothing(void) {
    return (beam_bounds){kdr_lanes_all(INFINITY), kdr_lanes_all(-INFINITY)};
}

/* One plane through what was found at both ends, standing off to the side of `slack`. */
KDR_LANES_INLINE void beam_side(beam *b, uint32_t side, float at_from, float at_to, float slack) {
    double slope = ((double)at_to - at_from) / ((double)b->to - b->from);
    uint32_t upper = side % 2 == 0, k = b->axis[side / 2];
    b->side[side].slope = (float)slope;
    b->side[side].start = (float)(at_from - slope * b->from + slack);
    b->side[side].face = WIDE_FACE(k, upper);
    b->side[side].depth = WIDE_FACE(b->axis[2], (slope > 0) ^ upper);
}

/* Around the rays of a group; packet_frame has been called. False if no ray of it reaches the scene. */
KDR_LANES_INLINE bool beam_begin(beam *b, const packet *p, packet_bits group) {
    const uint32_t x = p->axis[0], y = p->axis[1], z = p->axis[2];
    const kdr_box *box = &p->tree->bounds;
    beam_bounds depth = beam_nothing();
    kdr_lanes_f size = {0};
    for (uint32_t v = 0; v < p->vectors; v++) {
        kdr_lane_bits lanes = packet_lanes_of(group, v);
        kdr_lanes_f at = p->origin[z].lanes[v], direction = p->direction[z].lanes[v];
        beam_add(&depth, lanes, at + p->tmin.lanes[v] * direction);
        beam_add(&depth, lanes, at + p->t.lanes[v] * direction);
        kdr_lanes_f reach = kdr_lanes_larger(kdr_lanes_larger(p->origin[x].lanes[v], p->origin[y].lanes[v]), at);
        size = kdr_lanes_max(size, kdr_lanes_choose(lanes, reach, (kdr_lanes_f){0}));
    }
    float most = kdr_lanes_most(size);
    for (int k = 0; k < 3; k++)
        most = p->tree->reach[k] > most ? p->tree->reach[k] : most;
    const float slack = most * 0x1p-17f + 0x1p-120f;
    float from = kdr_lanes_least(depth.lo) - slack, to = kdr_lanes_most(depth.hi) + slack;
    from = from > box->lo[z] - slack ? from : box->lo[z] - slack;
    to = to < box->hi[z] + slack ? to : box->hi[z] + slack;
    if (from > to)
        return false;
    /* Long enough for slopes to be worth something. */
    to = to > from + 0x1p-8f * most ? to : from + 0x1p-8f * most;

    beam_bounds ends[4] = {beam_nothing(), beam_nothing(), beam_nothing(), beam_nothing()};
    for (uint32_t v = 0; v < p->vectors; v++) {
        kdr_lane_bits lanes = packet_lanes_of(group, v);
        kdr_lanes_f before = from - p->origin[z].lanes[v], behind = to - p->origin[z].lanes[v];
        kdr_lanes_f shear_x = p->shear_x.lanes[v], shear_y = p->shear_y.lanes[v];
        beam_add(&ends[0], lanes, kdr_lanes_add_product(p->origin[x].lanes[v], shear_x, before));
        beam_add(&ends[1], lanes, kdr_lanes_add_product(p->origin[x].lanes[v], shear_x, behind));
        beam_add(&ends[2], lanes, kdr_lanes_add_product(p->origin[y].lanes[v], shear_y, before));
        beam_add(&ends[3], lanes, kdr_lanes_add_product(p->origin[y].lanes[v], shear_y, behind));
    }
    b->from = from;
    b->to = to;
    b->slack = slack;
    b->from_face = WIDE_FACE(z, 1);
    b->to_face = WIDE_FACE(z, 0);
    memcpy(b->axis, p->axis, sizeof b->axis);
    b->reach = most;
    b->width = 0;
    for (uint32_t i = 0; i < 2; i++) {
        float lo[2], hi[2];
        for (uint32_t end = 0; end < 2; end++) {
            lo[end] = kdr_lanes_least(ends[2 * i + end].lo);
            hi[end] = kdr_lanes_most(ends[2 * i + end].hi);
        }
        beam_side(b, 2 * i, lo[0], lo[1], -slack);
        beam_side(b, 2 * i + 1, hi[0], hi[1], slack);
        float width = 0.5f * ((hi[0] - lo[0]) + (hi[1] - lo[1]));
        b->width = width > b->width ? width : b->width;
    }
    return true;
}

/* Boxes of a node that it may meet, by their places. NaN, from the empty boxes of unused places, is outside. */
KDR_LANES_INLINE uint32_t beam_meet(const beam *b, const kdr_wide_node *node) {
    const char *at = (const char *)node;
    uint32_t met = 0;
    for (uint32_t i = 0; i < KDR_WIDE; i += KDR_LANES) {
        kdr_lane_bits inside = KDR_LANE_BITS_ALL;
        for (int side = 0; side < 4; side++) {
            kdr_lanes_f face = kdr_lanes_load((const float *)(at + b->side[side].face) + i);
            kdr_lanes_f depth = kdr_lanes_load((const float *)(at + b->side[side].depth) + i);
            kdr_lanes_f plane =
                kdr_lanes_add_product(kdr_lanes_all(b->side[side].start), kdr_lanes_all(b->side[side].slope), depth);
            inside &= side % 2 == 0 ? kdr_lanes_less(plane, face) : kdr_lanes_less(face, plane);
        }
        inside &= kdr_lanes_less(kdr_lanes_all(b->from), kdr_lanes_load((const float *)(at + b->from_face) + i));
        inside &= kdr_lanes_less(kdr_lanes_load((const float *)(at + b->to_face) + i), kdr_lanes_all(b->to));
        met |= inside << i;
    }
    return met;
}

/* Triangles of a block of at most KDR_LANES that it may meet. */
KDR_LANES_INLINE kdr_lane_bits beam_meet_triangles(const beam *b, kdr_block block) {
    kdr_lanes_f z[3];
    const float *rows = block.rows;
    for (uint32_t i = 0; i < 3; i++)
        z[i] = kdr_lanes_load(rows + (3 * i + b->axis[2]) * block.length);
    kdr_lane_bits outside = kdr_lanes_less(kdr_lanes_max(kdr_lanes_max(z[0], z[1]), z[2]), kdr_lanes_all(b->from)) |
                            kdr_lanes_less(kdr_lanes_all(b->to), kdr_lanes_min(kdr_lanes_min(z[0], z[1]), z[2]));
    for (uint32_t k = 0; k < 2; k++) {
        kdr_lanes_f below[3], above[3];
        kdr_lanes_f start_lo = kdr_lanes_all(b->side[2 * k].start), start_hi = kdr_lanes_all(b->side[2 * k + 1].start);
        kdr_lanes_f slope_lo = kdr_lanes_all(b->side[2 * k].slope), slope_hi = kdr_lanes_all(b->side[2 * k + 1].slope);
        for (uint32_t i = 0; i < 3; i++) {
            kdr_lanes_f x = kdr_lanes_load(rows + (3 * i + b->axis[k]) * block.length);
            below[i] = kdr_lanes_less_product(x - start_lo, slope_lo, z[i]);
            above[i] = kdr_lanes_less_product(x - start_hi, slope_hi, z[i]);
        }
        outside |= kdr_lanes_less(kdr_lanes_max(kdr_lanes_max(below[0], below[1]), below[2]), (kdr_lanes_f){0}) |
                   kdr_lanes_less((kdr_lanes_f){0}, kdr_lanes_min(kdr_lanes_min(above[0], above[1]), above[2]));
    }
    return ~outside & kdr_lanes_first((uint32_t)block.shown);
}

#endif
