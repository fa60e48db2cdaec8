/* Stack traversal of one ray, closest hit and any hit, over leaves of SIMD blocks (SPEC T1).
 *
 * Source: M. Pharr, G. Humphreys, "Physically Based Rendering", 2004, for the iterative form; intervals and leaves are
 * our own: see step.h and block_lanes.h.
 * Both searches are one inlined body with a constant argument. */
#include "trace/trace.h"

#include "tree/block_lanes.h"

#define REAL float
#define EPSILON 0x1p-24f
#define LARGEST 0x1p100f
#define STEP(name) float_##name
#include "trace/step.h"
#include "trace/stack_body.h"
#undef REAL
#undef EPSILON
#undef LARGEST
#undef STEP

#define REAL double
#define EPSILON 0x1p-53
#define LARGEST 0x1p400
#define STEP(name) double_##name
#include "trace/step.h"
#include "trace/stack_body.h"
#undef REAL
#undef EPSILON
#undef LARGEST
#undef STEP

#include "trace/packet_lanes.h"
#include "trace/wide_lanes.h"

/* A ray outside the range of float intervals: rare, so its code is kept apart. */
static __attribute__((noinline)) bool walk_in_double(const kdr_tree *tree, const kdr_entry *entry, const kdr_ray *ray,
                                                     const kdr_ray_frame *f, bool any, kdr_closest *closest) {
    double_ray r;
    bool holds;
    if (!double_begin(&r, ray, &entry->box, &holds))
        return false;
    if (any)
        return double_walk(tree, entry->node, &r, f, ray->tmin, ray->tmax, true, closest);
    return double_walk(tree, entry->node, &r, f, ray->tmin, ray->tmax, false, closest);
}

static inline __attribute__((always_inline)) bool search(const kdr_tree *tree, const kdr_entry *entry,
                                                         const kdr_ray *ray, const bool any, kdr_ray_frame *f,
                                                         kdr_closest *closest) {
    if (!kdr_ray_is_valid(ray) || kdr_box_is_empty(&entry->box))
        return false;
    float_ray r;
    bool holds;
    if (!float_begin(&r, ray, &entry->box, &holds) && holds)
        return false;
    kdr_ray_frame_set(f, ray, r.reciprocal, &tree->bounds);
    if (__builtin_expect(!holds, 0))
        return walk_in_double(tree, entry, ray, f, any, closest);
    return float_walk(tree, entry->node, &r, f, ray->tmin, ray->tmax, any, closest);
}

/* Hands over what was found. */
KDR_LANES_INLINE void report(kdr_closest *closest, const kdr_ray_frame *f, kdr_found *found) {
    kdr_closest_settle(closest, f);
    found->t = closest->hit.t;
    found->u = closest->hit.u;
    found->v = closest->hit.v;
    memcpy(found->normal, closest->hit.normal, sizeof found->normal);
    found->primitive = closest->primitive;
}

/* What a table's function returns with. */
static inline __attribute__((always_inline)) bool leave(bool answer) {
    kdr_lanes_leave();
    return answer;
}

static __attribute__((noinline)) bool stack_closest(const kdr_tree *tree, const kdr_entry *entry, const kdr_ray *ray,
                                                    kdr_found *found) {
    kdr_ray_frame f;
    kdr_closest closest;
    kdr_closest_begin(&closest, ray->tmax);
    bool hit = search(tree, entry, ray, false, &f, &closest);
    if (hit)
        report(&closest, &f, found);
    return leave(hit);
}

static __attribute__((noinline)) bool stack_any(const kdr_tree *tree, const kdr_entry *entry, const kdr_ray *ray) {
    kdr_ray_frame f;
    return leave(search(tree, entry, ray, true, &f, NULL));
}

/* Lone rays take the wide tree where there is one, if they are of a usual kind. */
static bool single_closest(const kdr_tree *tree, const kdr_ray *ray, kdr_found *found) {
    wide_ray r;
    if (__builtin_expect(!wide_begin(&r, ray, tree) || !tree->wide, 0)) {
        kdr_entry root = kdr_entry_root(tree);
        return stack_closest(tree, &root, ray, found);
    }
    KDR_LANES_KEEP_IN_MEMORY(r);
    kdr_ray_frame f;
    kdr_closest closest;
    kdr_closest_begin(&closest, ray->tmax);
    bool framed = false, hit = kdr_wide_walk(tree, 0, ray, &r, false, &framed, &f, &closest);
    if (hit)
        report(&closest, &f, found);
    return leave(hit);
}

static bool single_any(const kdr_tree *tree, const kdr_ray *ray) {
    wide_ray r;
    if (__builtin_expect(!wide_begin(&r, ray, tree) || !tree->wide, 0)) {
        kdr_entry root = kdr_entry_root(tree);
        return stack_any(tree, &root, ray);
    }
    KDR_LANES_KEEP_IN_MEMORY(r);
    kdr_ray_frame f;
    bool framed = false;
    return leave(kdr_wide_walk(tree, 0, ray, &r, true, &framed, &f, NULL));
}

/* Packets keep where a triangle lies in 32 bits: blocks of 17 GB at most. */
static bool has_packets(const kdr_tree *tree) {
    return KDR_LANES > 1 && tree->wide && tree->group_count <= UINT32_MAX / (KDR_BLOCK_GROUP_BYTES / sizeof(float));
}

static void packet_closest(const kdr_tree *tree, const kdr_packet_rays *rays, kdr_packet_found *found) {
    packet p;
    packet_bits alone = rays->valid;
    if (has_packets(tree)) {
        packet_bits fit = packet_begin(&p, tree, rays, false);
        alone = (alone & ~fit) | packet_run(&p, fit, false);
        packet_report(&p, fit & ~alone, found);
    }
    for (; alone; alone &= alone - 1) {
        uint32_t i = (uint32_t)__builtin_ctzll(alone);
        kdr_ray ray = kdr_packet_ray(rays, i);
        kdr_found one = {.primitive = UINT32_MAX};
        single_closest(tree, &ray, &one);
        found->t[i] = one.t;
        found->u[i] = one.u;
        found->v[i] = one.v;
        for (int k = 0; k < 3; k++)
            found->normal[k][i] = one.normal[k];
        found->primitive[i] = one.primitive;
    }
    kdr_lanes_leave();
}

static uint64_t packet_any(const kdr_tree *tree, const kdr_packet_rays *rays) {
    packet p;
    packet_bits alone = rays->valid, found = 0;
    if (has_packets(tree)) {
        packet_bits fit = packet_begin(&p, tree, rays, true);
        alone = (alone & ~fit) | packet_run(&p, fit, true);
        for (uint32_t v = 0; v < p.vectors; v++)
            found |= packet_bits_of(kdr_lanes_less(p.t.lanes[v], p.tmin.lanes[v]), v);
        found &= fit & ~alone;
    }
    for (; alone; alone &= alone - 1) {
        uint32_t i = (uint32_t)__builtin_ctzll(alone);
        kdr_ray ray = kdr_packet_ray(rays, i);
        found |= (packet_bits)single_any(tree, &ray) << i;
    }
    kdr_lanes_leave();
    return found;
}

extern const kdr_traversals KDR_LANES_SYMBOL(kdr_traversals);
const kdr_traversals KDR_LANES_SYMBOL(kdr_traversals) = {.stack_closest = stack_closest,
                                                         .stack_any = stack_any,
                                                         .wants_wide = KDR_LANES > 1,
                                                         .single_closest = single_closest,
                                                         .single_any = single_any,
                                                         .packet_closest = packet_closest,
                                                         .packet_any = packet_any};
