/* Rays of a packet that have nothing in common, for any hit: each on its own through the wide tree, all in turn.
 *
 * A lone ray is made ready by itself and waits: for a node, for the answer of its boxes, for a branch that was guessed
 * wrong. Here 64 are made ready in lanes. All that stand before a node open it, one after the other; then all that
 * stand before a leaf ask it. Steps of a round belong to different rays, so none waits for another, and what a node
 * leads to goes on lists without a branch. Rays need have nothing in common, and nothing is sorted.
 *
 * Source of the idea: O. Kocberber, B. Falsafi, B. Grot, "Asynchronous Memory Access Chaining", 2015, for look-ups in a
 * data base.
 * Invariant: a ray takes the steps that it takes alone, so its answer is the same. One that needs a longer stack than
 * there is goes on alone. Cost: that of the steps, 20 cycles a node and 60 a leaf where both are in the cache, and 5 a
 * ray to make it ready; 20 KB of stack. */
#ifndef KDR_TRACE_FLIGHT_LANES_H
#define KDR_TRACE_FLIGHT_LANES_H

#include "trace/packet_leaf_lanes.h"

/* With fewer lanes, steps are so long that a lone ray does not wait. */
#define FLIGHT_PAYS (KDR_LANES == KDR_WIDE)

#if FLIGHT_PAYS

#define FLIGHT_STACK 48       /* children that wait; a ray that opens a node has room for 16 more */
#define FLIGHT_AHEAD 2        /* so many rays before a leaf's turn it is asked for, */
#define FLIGHT_AHEAD_LINES 10 /* with the lines of its first 16 triangles */

/* Rays of the packet, by their numbers. */
typedef struct flight_list {
    uint32_t count;
    uint8_t ray[KDR_PACKET_RAYS + 1]; /* behind the last is room for one that does not belong there */
} flight_list;

/* Where a ray is. */
typedef struct flight_place {
    uint32_t child, top;
    uint32_t waiting[FLIGHT_STACK + KDR_WIDE];
} flight_place;

typedef struct flight {
    flight_place at[KDR_PACKET_RAYS];
    flight_list nodes, leaves; /* rays that stand before one */
    /* What triangles need of rays, each along its own longest axis: as in kdr_ray_frame. */
    packet_row_u longest;
    packet_row along[3], shear_x, shear_y, scale, doubt, doubt_least;
} flight;

/* kdr_ray_frame_set in lanes. */
KDR_LANES_INLINE void flight_frame(flight *f, const packet *p) {
    const kdr_box *bounds = &p->tree->bounds;
    for (uint32_t v = 0; v < p->vectors; v++) {
        kdr_lanes_f origin[3], direction[3], reciprocal[3], size[3], largest = {0};
        for (uint32_t k = 0; k < 3; k++) {
            origin[k] = p->origin[k].lanes[v];
            direction[k] = p->direction[k].lanes[v];
            reciprocal[k] = p->reciprocal[k].lanes[v];
            size[k] = kdr_lanes_abs(direction[k]);
            largest = kdr_lanes_max(largest, kdr_lanes_larger(bounds->lo[k] - origin[k], bounds->hi[k] - origin[k]));
        }
        kdr_lane_bits on_x = kdr_lanes_less(size[1], size[0]) & kdr_lanes_less(size[2], size[0]);
        kdr_lane_bits on_y = ~kdr_lanes_less(size[1], size[0]) & kdr_lanes_less(size[2], size[1]) & KDR_LANE_BITS_ALL;
#define FLIGHT_CHOOSE(x, y, z) kdr_lanes_choose(on_x, x, kdr_lanes_choose(on_y, y, z))
        const kdr_lanes_u zero = {0};
        f->longest.lanes[v] =
            (kdr_lanes_u)FLIGHT_CHOOSE((kdr_lanes_f)zero, (kdr_lanes_f)(zero + 1), (kdr_lanes_f)(zero + 2));
        kdr_lanes_f scale = FLIGHT_CHOOSE(reciprocal[0], reciprocal[1], reciprocal[2]);
        f->scale.lanes[v] = scale;
        f->shear_x.lanes[v] = FLIGHT_CHOOSE(direction[1], direction[2], direction[0]) * scale;
        f->shear_y.lanes[v] = FLIGHT_CHOOSE(direction[2], direction[0], direction[1]) * scale;
        f->along[0].lanes[v] = FLIGHT_CHOOSE(origin[1], origin[2], origin[0]);
        f->along[1].lanes[v] = FLIGHT_CHOOSE(origin[2], origin[0], origin[1]);
        f->along[2].lanes[v] = FLIGHT_CHOOSE(origin[0], origin[1], origin[2]);
#undef FLIGHT_CHOOSE
        kdr_lanes_f most = kdr_lanes_max(largest, largest * kdr_lanes_abs(scale));
        kdr_lane_bits beyond = kdr_lanes_less(kdr_lanes_all(KDR_RAY_FRAME_LARGEST), most);
        kdr_lanes_f doubt = kdr_lanes_choose(beyond, kdr_lanes_all(INFINITY), 64 * 0x1p-24f * largest);
        f->doubt.lanes[v] = doubt;
        f->doubt_least.lanes[v] = 0x1p-4f * doubt * doubt + 0x1p-126f;
    }
}

/* Puts the children that ray i meets on its stack, the largest on top. */
KDR_LANES_INLINE void flight_open(flight *f, const packet *p, uint32_t i) {
    flight_place *at = &f->at[i];
    const kdr_wide_node *node = &p->tree->wide[at->child];
    const wide_places *places = &wide_places_of[p->octant.of[i]];
    KDR_COUNT(nodes, 1);
    KDR_COUNT(node_rays, 1);
    kdr_lanes_f sooner[3], later[3];
    for (int k = 0; k < 3; k++) {
        const float *near = (const float *)((const char *)node + places->near[k]);
        const float *far = (const float *)((const char *)node + places->far[k]);
        kdr_lanes_f reciprocal = kdr_lanes_all(p->reciprocal[k].of[i]);
        sooner[k] = kdr_lanes_add_product(kdr_lanes_all(p->near[k].of[i]), kdr_lanes_load(near), reciprocal);
        later[k] = kdr_lanes_add_product(kdr_lanes_all(p->far[k].of[i]), kdr_lanes_load(far), reciprocal);
    }
    kdr_lanes_f begin = kdr_lanes_all(p->tmin.of[i]), end = kdr_lanes_all(p->t.of[i]);
    kdr_lanes_f enter = kdr_lanes_later(kdr_lanes_later(sooner[0], sooner[1]), kdr_lanes_later(sooner[2], begin));
    kdr_lanes_f leave = kdr_lanes_sooner(kdr_lanes_sooner(later[0], later[1]), kdr_lanes_sooner(later[2], end));
    kdr_lane_bits met = KDR_LANE_BITS_ALL & ~kdr_lanes_less(leave, enter);
    uint32_t count = (uint32_t)__builtin_popcount(met);
    kdr_lanes_f child = kdr_lanes_packed(met, kdr_lanes_load((const float *)node->child));
    kdr_lanes_store((float *)&at->waiting[at->top], kdr_lanes_permute(child, (count - 1) - kdr_lanes_count()));
    at->top += count;
}

/* Ray i takes its next child, and stands before it, or has none left. */
KDR_LANES_INLINE void flight_next(flight *f, uint32_t i) {
    uint32_t child = f->at[i].child = f->at[i].waiting[--f->at[i].top], is_leaf = child >> 31;
    f->nodes.ray[f->nodes.count] = f->leaves.ray[f->leaves.count] = (uint8_t)i;
    f->nodes.count += !is_leaf;
    f->leaves.count += is_leaf & (child != KDR_WIDE_NOTHING);
}

/* True if ray i hits one of KDR_LANES triangles: kdr_block_any. */
KDR_LANES_INLINE bool flight_meet(const flight *f, const packet *p, uint32_t i, kdr_block block, size_t first) {
    const size_t length = block.length;
    const uint32_t axis_z = f->longest.of[i], axis_x = axis_z == 2 ? 0 : axis_z + 1,
                   axis_y = axis_x == 2 ? 0 : axis_x + 1;
    const float *row_x = block.rows + axis_x * length + first, *row_y = block.rows + axis_y * length + first;
    const float *row_z = block.rows + axis_z * length + first;
    kdr_lanes_f shear_x = kdr_lanes_all(f->shear_x.of[i]), shear_y = kdr_lanes_all(f->shear_y.of[i]);
    kdr_lanes_f origin_x = kdr_lanes_all(f->along[0].of[i]), origin_y = kdr_lanes_all(f->along[1].of[i]);
    kdr_lanes_f origin_z = kdr_lanes_all(f->along[2].of[i]);
    kdr_lanes_f x[3], y[3];
    kdr_block_edges e;
    for (size_t k = 0; k < 3; k++) {
        e.z[k] = origin_z - kdr_lanes_load(row_z + 3 * k * length);
        x[k] = kdr_lanes_less_product(origin_x - kdr_lanes_load(row_x + 3 * k * length), shear_x, e.z[k]);
        y[k] = kdr_lanes_less_product(origin_y - kdr_lanes_load(row_y + 3 * k * length), shear_y, e.z[k]);
    }
    kdr_block_count_step(kdr_lanes_first((uint32_t)(block.shown - first)));
    kdr_block_edges_set(&e, x, y, kdr_lanes_all(f->doubt_least.of[i]), kdr_lanes_all(f->doubt.of[i]));
    kdr_lane_bits left = ~kdr_block_outside(&e) & kdr_lanes_first((uint32_t)(block.shown - first));
    if (left == 0)
        return false;
    kdr_block_span span = kdr_block_span_of(&e, kdr_lanes_all(f->scale.of[i]));
    kdr_lanes_f begin = kdr_lanes_all(p->tmin.of[i]), end = kdr_lanes_all(p->t.of[i]);
    if (left & kdr_block_inside(&e) & kdr_lanes_less(begin, span.from) & kdr_lanes_less(span.to, end))
        return true;
    left &= ~(kdr_lanes_less(span.to, begin) | kdr_lanes_less(end, span.from));
    for (; left; left &= left - 1) {
        size_t place = first + (uint32_t)__builtin_ctz(left);
        if (kdr_block_primitive(block, place) != UINT32_MAX && packet_decide_any(p, i, block, place))
            return true;
    }
    return false;
}

/* A leaf is on its way to the caches while others have their turn. */
KDR_LANES_INLINE void flight_await(const flight *f, const packet *p, const flight_list *list, uint32_t turn) {
    if (turn >= list->count)
        return;
    const char *rows = (const char *)kdr_wide_block(p->tree, f->at[list->ray[turn]].child).rows;
    for (size_t line = 0; line < FLIGHT_AHEAD_LINES; line++)
        __builtin_prefetch(rows + 64 * line);
}

/* Rays of the usual kind; those that hit get the distance -infinity. Returns those that are to go alone. */
static __attribute__((noinline)) packet_bits flight_any(packet *p, packet_bits rays) {
    flight f;
    packet_bits alone = 0;
    flight_frame(&f, p);
    f.nodes.count = f.leaves.count = 0;
    for (; rays; rays &= rays - 1) {
        uint32_t i = (uint32_t)__builtin_ctzll(rays);
        f.at[i].child = 0;
        f.at[i].top = 1;
        f.at[i].waiting[0] = KDR_WIDE_NOTHING;
        f.nodes.ray[f.nodes.count++] = (uint8_t)i;
    }
    while (f.nodes.count + f.leaves.count > 0) {
        flight_list list = f.nodes;
        f.nodes.count = 0;
        for (uint32_t turn = 0; turn < list.count; turn++) {
            uint32_t i = list.ray[turn];
            if (__builtin_expect(f.at[i].top > FLIGHT_STACK, 0)) {
                alone |= (packet_bits)1 << i;
                continue;
            }
            flight_open(&f, p, i);
            flight_next(&f, i);
        }
        list = f.leaves;
        f.leaves.count = 0;
        for (uint32_t turn = 0; turn < list.count; turn++) {
            flight_await(&f, p, &list, turn + FLIGHT_AHEAD);
            uint32_t i = list.ray[turn], child = kdr_wide_settle(p->tree, f.at[i].child);
            if (__builtin_expect(!(child & KDR_WIDE_LEAF), 0)) {
                f.at[i].child = child;
                f.nodes.ray[f.nodes.count++] = (uint8_t)i;
                continue;
            }
            kdr_block block = kdr_wide_block(p->tree, child);
            kdr_block_count_block();
            bool hit = false;
            for (size_t first = 0; first < block.shown && !hit; first += KDR_LANES)
                hit = flight_meet(&f, p, i, block, first);
            if (hit)
                p->t.of[i] = -INFINITY;
            else
                flight_next(&f, i);
        }
    }
    return alone;
}

#endif

#endif
