/* Rays that go together through the wide tree: a node's boxes are in registers while each ray of a list is tested
 * against them and goes into the lists of the children it meets; a list that has become short ends as lone rays.
 *
 * Lone rays wait for one node after the other; here all steps of a list are independent of each other, and a node, a
 * block and the code for each are fetched once a list. Rays are sorted by octant first, so that all of a list take
 * children in one order: front to back for the closest hit, so that early exit holds as for a lone ray, and the largest
 * box first for any hit.
 *
 * Source of the idea: J. A. Tsakok, "Faster Incoherent Rays: Multi-BVH Ray Stream Tracing", 2009; R. Barringer, T.
 * Akenine-Moller, "Dynamic Ray Stream Traversal", 2014.
 * Invariant: a ray is asked by the same steps as if it were alone, so its answer is the same to the bit. Where lists
 * find no more room, their rays go on alone. Cost: some 35 operations a ray and node; about 90 KB of stack. */
#ifndef KDR_TRACE_STREAM_LANES_H
#define KDR_TRACE_STREAM_LANES_H

#include "trace/trace.h"
#include "trace/wide_lanes.h"

#define STREAM_FEW 4     /* lists of at most so many rays end as lone rays */
#define STREAM_ROOM 4096 /* rays that wait together; where there is no room for more, rays go on alone */
#define STREAM_ALONE 8   /* in place of an octant: a ray that the wide tree cannot answer */

/* What the boxes of a node need of a ray: one cache line. */
typedef struct stream_ray {
    _Alignas(64) float reciprocal[3];
    float near[3], far[3]; /* as in wide_ray */
    float tmin, t; /* t: of the closest hit so far; for any hit the ray's tmax, and below tmin when one is found */
    uint8_t octant;
    bool framed;
    const kdr_ray *ray;
} stream_ray;

/* A child with the rays that wait for it: `count` places from `begin` on. */
typedef struct stream_job {
    uint32_t child, begin, count;
} stream_job;

typedef struct stream {
    const kdr_tree *tree;
    uint32_t count;
    stream_ray rays[KDR_STREAM_RAYS];
    kdr_ray_frame frames[KDR_STREAM_RAYS];
    kdr_closest closest[KDR_STREAM_RAYS];

    /* Rays that wait, and where each enters the box of the child that it waits for. */
    uint32_t waiting[STREAM_ROOM];
    float enter[STREAM_ROOM];
    stream_job jobs[WIDE_STACK];

    /* Of the node that is being opened: its rays, which boxes each meets, and where. */
    uint32_t ray[KDR_STREAM_RAYS], met[KDR_STREAM_RAYS];
    float enters[KDR_STREAM_RAYS][KDR_WIDE];
} stream;

KDR_LANES_INLINE void stream_begin(stream *s, const kdr_ray *rays, size_t stride, uint32_t count, const bool any) {
    s->count = count;
    for (uint32_t i = 0; i < count; i++) {
        stream_ray *at = &s->rays[i];
        at->ray = (const kdr_ray *)((const char *)rays + i * stride);
        at->framed = false;
        at->tmin = at->ray->tmin;
        at->t = at->ray->tmax;
        at->octant = STREAM_ALONE;
        if (!any)
            kdr_closest_begin(&s->closest[i], at->t);
        wide_ray r;
        if (!wide_begin(&r, at->ray, s->tree))
            continue;
        at->octant = (uint8_t)(r.places - wide_places_of);
        memcpy(at->reciprocal, r.reciprocal, sizeof at->reciprocal);
        memcpy(at->near, r.near, sizeof at->near);
        memcpy(at->far, r.far, sizeof at->far);
    }
}

/* What is left of a ray's search after a step that found a hit or not. */
KDR_LANES_INLINE void stream_shorten(stream *s, uint32_t ray, const bool any, bool hit) {
    if (!any)
        s->rays[ray].t = s->closest[ray].t;
    else if (hit)
        s->rays[ray].t = -INFINITY;
}

/* Rays at a child go on alone. */
static __attribute__((noinline)) void stream_part(stream *s, const stream_job *job, const bool any) {
    for (uint32_t i = job->begin; i < job->begin + job->count; i++) {
        uint32_t ray = s->waiting[i];
        stream_ray *at = &s->rays[ray];
        if (s->enter[i] > at->t)
            continue;
        wide_ray r = {.places = &wide_places_of[at->octant], .tmin = at->tmin};
        memcpy(r.reciprocal, at->reciprocal, sizeof at->reciprocal);
        memcpy(r.near, at->near, sizeof at->near);
        memcpy(r.far, at->far, sizeof at->far);
        KDR_LANES_KEEP_IN_MEMORY(r);
        bool hit = kdr_wide_walk(s->tree, job->child, at->ray, &r, any, &at->framed, &s->frames[ray], &s->closest[ray]);
        stream_shorten(s, ray, any, hit);
    }
}

/* Rays at a leaf ask its block. */
KDR_LANES_INLINE void stream_ask(stream *s, const stream_job *job, const bool any) {
    kdr_block block = kdr_wide_block(s->tree, job->child);
    for (uint32_t i = job->begin; i < job->begin + job->count; i++) {
        uint32_t ray = s->waiting[i];
        stream_ray *at = &s->rays[ray];
        if (s->enter[i] > at->t)
            continue;
        if (!at->framed) {
            at->framed = true;
            kdr_ray_frame_set(&s->frames[ray], at->ray, at->reciprocal, &s->tree->bounds);
        }
        bool hit = any && kdr_block_any(block, &s->frames[ray], at->tmin, at->t);
        if (!any)
            kdr_block_closest(block, &s->frames[ray], at->tmin, &s->closest[ray]);
        stream_shorten(s, ray, any, hit);
    }
}

/* Tests the rays of a job against the boxes of a node: s->ray, s->met, s->enters. Returns how many there are. */
KDR_LANES_INLINE uint32_t stream_meet(stream *s, const stream_job *job, const wide_places *places) {
    const char *node = (const char *)&s->tree->wide[job->child];
    uint32_t count = 0;
    for (uint32_t i = job->begin; i < job->begin + job->count; i++) {
        s->ray[count] = s->waiting[i];
        s->met[count] = 0;
        count += !(s->enter[i] > s->rays[s->waiting[i]].t);
    }
    for (uint32_t first = 0; first < KDR_WIDE; first += KDR_LANES) {
        kdr_lanes_f near[3], far[3];
        for (int k = 0; k < 3; k++) {
            near[k] = kdr_lanes_load((const float *)(node + places->near[k]) + first);
            far[k] = kdr_lanes_load((const float *)(node + places->far[k]) + first);
        }
        for (uint32_t i = 0; i < count; i++) {
            const stream_ray *at = &s->rays[s->ray[i]];
            kdr_lanes_f sooner[3], later[3];
            for (int k = 0; k < 3; k++) {
                kdr_lanes_f reciprocal = kdr_lanes_all(at->reciprocal[k]);
                sooner[k] = kdr_lanes_add_product(kdr_lanes_all(at->near[k]), near[k], reciprocal);
                later[k] = kdr_lanes_add_product(kdr_lanes_all(at->far[k]), far[k], reciprocal);
            }
            kdr_lanes_f enter = kdr_lanes_later(kdr_lanes_later(sooner[0], sooner[1]),
                                                kdr_lanes_later(sooner[2], kdr_lanes_all(at->tmin)));
            kdr_lanes_f leave = kdr_lanes_sooner(kdr_lanes_sooner(later[0], later[1]),
                                                 kdr_lanes_sooner(later[2], kdr_lanes_all(at->t)));
            kdr_lanes_store(&s->enters[i][first], enter);
            s->met[i] |= (KDR_LANE_BITS_ALL & ~kdr_lanes_less(leave, enter)) << first;
        }
    }
    return count;
}

/* Lists the rays that meet the box in a place, from `used` on; there is room. Returns how many they are. */
KDR_LANES_INLINE uint32_t stream_list(stream *s, uint32_t count, uint32_t place, uint32_t used) {
    uint32_t begin = used;
#if KDR_LANES == KDR_WIDE
    for (uint32_t i = 0; i < count; i += KDR_LANES) {
        kdr_lane_bits bits = kdr_lanes_share(kdr_lanes_load_u(&s->met[i]), 1u << place) & kdr_lanes_first(count - i);
        kdr_lanes_f enter = kdr_lanes_gather(bits, &s->enters[i][place], kdr_lanes_count() * KDR_WIDE);
        kdr_lanes_u ray = kdr_lanes_load_u(&s->ray[i]);
        kdr_lanes_store(&s->enter[used], kdr_lanes_packed(bits, enter));
        kdr_lanes_store((float *)&s->waiting[used], kdr_lanes_packed(bits, (kdr_lanes_f)ray));
        used += (uint32_t)__builtin_popcount(bits);
    }
#else
    for (uint32_t i = 0; i < count; i++) {
        s->enter[used] = s->enters[i][place];
        s->waiting[used] = s->ray[i];
        used += s->met[i] >> place & 1;
    }
#endif
    return used - begin;
}

/* All rays of one octant. */
KDR_LANES_INLINE void stream_octant(stream *s, uint32_t octant, const bool any) {
    const wide_places *places = &wide_places_of[octant];
    uint32_t top = 0, used = 0;
    for (uint32_t i = 0; i < s->count; i++) {
        s->waiting[used] = i;
        s->enter[used] = s->rays[i].ray->tmin;
        used += s->rays[i].octant == octant;
    }
    if (used > 0)
        s->jobs[top++] = (stream_job){0, 0, used};
    while (top > 0) {
        const stream_job job = s->jobs[--top];
        if (job.child & KDR_WIDE_LEAF) {
            stream_ask(s, &job, any);
            continue;
        }
        if (job.count <= STREAM_FEW || job.begin + KDR_WIDE * job.count > STREAM_ROOM - KDR_WIDE) {
            stream_part(s, &job, any);
            continue;
        }

        /* The children's lists take the place of the job's, the first child's on top. */
        uint32_t count = stream_meet(s, &job, places), met = 0;
        for (uint32_t i = 0; i < count; i++)
            met |= s->met[i];
        const kdr_wide_node *node = &s->tree->wide[job.child];
        uint64_t order;
        memcpy(&order, (const char *)node + places->order, sizeof order);
        used = job.begin;
        for (uint32_t i = KDR_WIDE; i-- > 0;) {
            uint32_t place = any ? i : order >> KDR_WIDE_ORDER_SHIFT(i) & 15;
            if (!(met >> place & 1))
                continue;
            uint32_t length = stream_list(s, count, place, used);
            s->jobs[top++] = (stream_job){node->child[place], used, length};
            used += length;
        }
    }
}

KDR_LANES_INLINE void stream_run(stream *s, const bool any) {
    for (uint32_t octant = 0; octant < 8; octant++)
        stream_octant(s, octant, any);
}

#endif
