/* Up to 64 rays through the wide tree together: one walk, steered by the beam around them.
 *
 * A node's sixteen boxes are tested against the beam at once, whatever the number of rays. Children that it meets wait
 * in the order of the octant; when one's turn comes its box is tested against the rays, KDR_LANES at a time, and those
 * that meet it go on. So the beam saves tests, and rays are never asked more than what their own boxes say. At a leaf
 * the beam picks triangles, and rays or triangles are in lanes, whichever takes fewer steps. Hits shorten rays, and the
 * beam when all rays have one.
 *
 * Rays are split by the axis along which they run and by its direction, since a beam has one. Signs on the other axes
 * may differ: boxes are then tested without regard to them, in the order of one ray's octant. Rays that run apart have
 * a wide beam, which is worth nothing, and go alone.
 *
 * Sources: I. Wald, P. Slusallek, C. Benthin, M. Wagner, "Interactive Rendering with Coherent Ray Tracing", 2001; A.
 * Reshetov, "Omnidirectional Ray Tracing Traversal Algorithm for kd-trees", 2006.
 * Invariant: a ray is asked for every leaf whose box it meets no later than its closest hit, so its answer is that of a
 * lone ray to the bit. Cost: some 14 operations a vector of boxes for all rays, 10 a vector of rays and box, 35 a
 * vector of rays and triangle; about 30 KB of stack. */
#ifndef KDR_TRACE_PACKET_LANES_H
#define KDR_TRACE_PACKET_LANES_H

#include "trace/beam_lanes.h"
#include "trace/packet_leaf_lanes.h"

#define PACKET_WIDEST 0.25f /* of the scene's largest coordinate; rays in a wider beam go alone */
#define PACKET_FEW 2        /* so many rays at a node go on alone */
#define PACKET_FEW_ASK 7    /* for so many at a leaf the beam need not pick triangles */

/* A child that waits: a node's number and its place there. */
typedef struct packet_job {
    uint32_t parent, place;
    packet_bits rays; /* that meet the parent */
} packet_job;

typedef struct packet_stack {
    uint32_t top;
    packet_job jobs[WIDE_STACK];
} packet_stack;

/* Rays that meet a child's box no later than their closest hit. places: those of the octant of all, or NULL if they
 * differ. */
KDR_LANES_INLINE packet_bits packet_meet_box(const packet *p, const packet_job *job, const wide_places *places) {
    const char *at = (const char *)&p->tree->wide[job->parent] + job->place * sizeof(float);
    packet_bits met = 0;
    for (uint32_t v = 0; v < p->vectors; v++) {
        kdr_lane_bits lanes = packet_lanes_of(job->rays, v);
        if (lanes == 0)
            continue;
        kdr_lanes_f enter = p->tmin.lanes[v], leave = p->t.lanes[v];
        for (uint32_t k = 0; k < 3; k++) {
            kdr_lanes_f near = p->near[k].lanes[v], far = p->far[k].lanes[v], reciprocal = p->reciprocal[k].lanes[v];
            if (places) {
                kdr_lanes_f first = kdr_lanes_all(*(const float *)(at + places->near[k]));
                kdr_lanes_f last = kdr_lanes_all(*(const float *)(at + places->far[k]));
                enter = kdr_lanes_max(enter, kdr_lanes_add_product(near, first, reciprocal));
                leave = kdr_lanes_min(leave, kdr_lanes_add_product(far, last, reciprocal));
            } else {
                kdr_lanes_f low = kdr_lanes_all(*(const float *)(at + WIDE_FACE(k, 0))) * reciprocal;
                kdr_lanes_f high = kdr_lanes_all(*(const float *)(at + WIDE_FACE(k, 1))) * reciprocal;
                enter = kdr_lanes_max(enter, near + kdr_lanes_min(low, high));
                leave = kdr_lanes_min(leave, far + kdr_lanes_max(low, high));
            }
        }
        met |= packet_bits_of(lanes & ~kdr_lanes_less(leave, enter), v);
    }
    return met;
}

/* A few rays go on alone from a child. */
static __attribute__((noinline)) void packet_part(packet *p, uint32_t child, packet_bits rays, const bool any) {
    for (; rays; rays &= rays - 1) {
        uint32_t i = (uint32_t)__builtin_ctzll(rays);
        kdr_ray ray = packet_ray(p, i);
        wide_ray r = {.places = &wide_places_of[p->octant.of[i]], .tmin = ray.tmin};
        for (int k = 0; k < 3; k++) {
            r.reciprocal[k] = p->reciprocal[k].of[i];
            r.near[k] = p->near[k].of[i];
            r.far[k] = p->far[k].of[i];
        }
        KDR_LANES_KEEP_IN_MEMORY(r);
        bool framed = true;
        packet_ray_frame(p, i);
        if (any) {
            if (kdr_wide_walk(p->tree, child, &ray, &r, true, &framed, &p->frames[i], NULL))
                p->t.of[i] = -INFINITY;
        } else {
            kdr_closest closest = packet_closest_get(p, i);
            kdr_wide_walk(p->tree, child, &ray, &r, false, &framed, &p->frames[i], &closest);
            packet_closest_put(p, i, &closest);
        }
    }
}

/* Rays ask a leaf, KDR_LANES triangles at a time; returns those whose search for any hit ends. Whether rays or
 * triangles are in lanes is a matter of which way takes fewer steps. */
KDR_LANES_INLINE packet_bits packet_ask(packet *p, const beam *b, kdr_block block, packet_bits rays, const bool any) {
    packet_bits found = 0;
    kdr_block_count_block();
    for (size_t first = 0; first < block.shown; first += KDR_LANES) {
        packet_bits left = rays & ~found;
        uint32_t asking = (uint32_t)__builtin_popcountll(left);
        if (any && left == 0)
            return found;
        size_t shown = block.shown - first < KDR_LANES ? block.shown - first : KDR_LANES;
        kdr_block part = {block.rows + first, block.length, shown};
        kdr_lane_bits triangles = asking > PACKET_FEW_ASK ? beam_meet_triangles(b, part) : 0;
        uint32_t steps = (uint32_t)__builtin_popcount(triangles) * ((asking + KDR_LANES - 1) / KDR_LANES);
        packet_meets meets;
        meets.set = 0;
        if (asking <= PACKET_FEW_ASK || 3 * steps > 2 * asking)
            packet_meet_by_rays(p, left, part, &meets);
        else
            packet_meet_by_triangles(p, left, part, triangles, &meets);
        found |= packet_look(p, &meets, part, any);
    }
    return found;
}

/* Has a child on its way to the caches while others have their turn. */
KDR_LANES_INLINE void packet_await(const kdr_tree *tree, uint32_t child) {
    if (child & KDR_WIDE_LEAF) {
        kdr_block block = kdr_wide_block(tree, child);
        for (uint32_t row = 0; row < 9; row++)
            __builtin_prefetch(block.rows + row * block.length);
    } else {
        for (size_t at = 0; at < sizeof(kdr_wide_node); at += 64)
            __builtin_prefetch((const char *)&tree->wide[child] + at);
    }
}

/* The children of a node that the beam meets go on the stack, the first on top. */
KDR_LANES_INLINE void packet_open(const packet *p, const beam *b, uint32_t index, packet_bits rays, size_t order,
                                  const bool any, packet_stack *stack) {
    const kdr_wide_node *node = &p->tree->wide[index];
    KDR_COUNT(nodes, 1);
    KDR_COUNT(node_rays, (uint32_t)__builtin_popcountll(rays));
    uint32_t met = beam_meet(b, node);
    if (any) {
        while (met) {
            uint32_t place = 31 - (uint32_t)__builtin_clz(met);
            met ^= 1u << place;
            packet_await(p->tree, node->child[place]);
            stack->jobs[stack->top++] = (packet_job){index, place, rays};
        }
        return;
    }
    uint64_t word = *(const uint64_t *)((const char *)node + order);
#if KDR_LANES == KDR_WIDE
    kdr_lanes_u places = kdr_lanes_nibbles((const uint64_t *)((const char *)node + order)) & 15;
    uint32_t in_order = kdr_lanes_share((kdr_lanes_u)_mm512_sllv_epi32(_mm512_set1_epi32(1), (__m512i)places), met);
    while (in_order) {
        uint32_t i = 31 - (uint32_t)__builtin_clz(in_order);
        in_order ^= 1u << i;
        uint32_t place = word >> KDR_WIDE_ORDER_SHIFT(i) & 15;
        packet_await(p->tree, node->child[place]);
        stack->jobs[stack->top++] = (packet_job){index, place, rays};
    }
#else
    for (uint32_t i = KDR_WIDE; i-- > 0;) {
        uint32_t place = word >> KDR_WIDE_ORDER_SHIFT(i) & 15;
        stack->jobs[stack->top] = (packet_job){index, place, rays};
        stack->top += met >> place & 1;
    }
#endif
}

/* Draws the end of the beam in to the last closest hit, when all have one. */
KDR_LANES_INLINE void packet_shorten(const packet *p, packet_bits group, beam *b) {
    const uint32_t z = p->axis[2];
    beam_bounds depth = beam_nothing();
    for (uint32_t v = 0; v < p->vectors; v++) {
        kdr_lanes_f end = p->origin[z].lanes[v] + p->t.lanes[v] * p->direction[z].lanes[v];
        beam_add(&depth, packet_lanes_of(group, v), end);
    }
    if (b->runs_down) {
        float from = kdr_lanes_least(depth.lo) - b->slack;
        b->from = from > b->from ? from : b->from;
    } else {
        float to = kdr_lanes_most(depth.hi) + b->slack;
        b->to = to < b->to ? to : b->to;
    }
}

/* Rays of a group from the root on. */
KDR_LANES_INLINE void packet_walk(packet *p, packet_bits group, const wide_places *places, size_t order, beam *b,
                                  const bool any) {
    packet_stack stack;
    stack.top = 0;
    packet_open(p, b, 0, group, order, any, &stack);
    packet_bits done = 0;
    while (stack.top > 0) {
        packet_job job = stack.jobs[--stack.top];
        job.rays &= ~done;
        packet_bits rays = packet_meet_box(p, &job, places);
        if (rays == 0)
            continue;
        uint32_t child = p->tree->wide[job.parent].child[job.place];
        if (child & KDR_WIDE_LEAF)
            child = kdr_wide_settle(p->tree, child);
        if (child & KDR_WIDE_LEAF) {
            packet_bits found = packet_ask(p, b, kdr_wide_block(p->tree, child), rays, any);
            if (any) {
                done |= found;
                if (done == group)
                    return;
            } else {
                packet_shorten(p, group, b);
            }
        } else if (__builtin_popcountll(rays) <= PACKET_FEW) {
            packet_part(p, child, rays, any);
        } else {
            packet_open(p, b, child, rays, order, any, &stack);
        }
    }
}

/* Rays of `rays` that go with ray i: one way along the axis on which it is longest, and not too steeply away. Sets the
 * axes of the shear. */
KDR_LANES_INLINE packet_bits packet_group(packet *p, packet_bits rays, uint32_t i) {
    float x = fabsf(p->direction[0].of[i]), y = fabsf(p->direction[1].of[i]), z = fabsf(p->direction[2].of[i]);
    p->axis[2] = x > y ? (x > z ? 0 : 2) : (y > z ? 1 : 2);
    p->axis[0] = p->axis[2] == 2 ? 0 : p->axis[2] + 1;
    p->axis[1] = p->axis[0] == 2 ? 0 : p->axis[0] + 1;
    packet_bits alike = 0;
    float sign = p->direction[p->axis[2]].of[i] < 0 ? -2.0f : 2.0f;
    for (uint32_t v = 0; v < p->vectors; v++) {
        kdr_lanes_f along = sign * p->direction[p->axis[2]].lanes[v];
        kdr_lanes_f aside = kdr_lanes_larger(p->direction[p->axis[0]].lanes[v], p->direction[p->axis[1]].lanes[v]);
        alike |= packet_bits_of(kdr_lanes_less(aside, along), v);
    }
    return alike & rays;
}

/* Rays of the usual kind, one group after the other; returns those that are to go alone. */
KDR_LANES_INLINE packet_bits packet_run(packet *p, packet_bits rays, const bool any) {
    packet_bits alone = 0;
    while (rays) {
        uint32_t leader = (uint32_t)__builtin_ctzll(rays);
        packet_bits group = packet_group(p, rays, leader);
        group |= (packet_bits)1 << leader;
        rays &= ~group;
        packet_frame(p);
        beam b;
        if (__builtin_popcountll(group) <= PACKET_FEW) {
            alone |= group;
            continue;
        }
        if (!beam_begin(&b, p, group))
            continue;
        if (b.width > PACKET_WIDEST * b.reach) {
            alone |= group;
            continue;
        }
        b.runs_down = p->direction[p->axis[2]].of[leader] < 0;
        const wide_places *places = &wide_places_of[p->octant.of[leader]];
        size_t order = places->order;
        packet_bits differ = 0;
        kdr_lanes_f octant = kdr_lanes_all((float)p->octant.of[leader]);
        for (uint32_t v = 0; v < p->vectors; v++) {
            kdr_lanes_f other = __builtin_convertvector((kdr_lanes_i)p->octant.lanes[v], kdr_lanes_f);
            differ |= packet_bits_of(kdr_lanes_less(octant, other) | kdr_lanes_less(other, octant), v);
        }
        packet_walk(p, group, (group & differ) == 0 ? places : NULL, order, &b, any);
    }
    return alone;
}

#endif
