/* The table of traversals: the stack of one ray, the fastest way of one ray, and packets. */
#include "trace/flight_lanes.h"
#include "trace/lone_lanes.h"
#include "trace/packet_lanes.h"
#include "trace/wide_lanes.h"

KDR_WALK_IN_DOUBLE(stack_in_double, double_stack)

static __attribute__((noinline)) bool stack_closest(const kdr_tree *tree, const kdr_entry *entry, const kdr_ray *ray,
                                                    kdr_found *found) {
    kdr_ray_frame f;
    kdr_closest closest;
    kdr_closest_begin(&closest, ray->tmax);
    kdr_search search = {.tree = tree, .trace = KDR_TRACE_STACK, .closest = &closest};
    bool hit = kdr_search_run(search, entry, ray, &f, stack_in_double);
    if (hit)
        kdr_search_report(&closest, &f, found);
    return kdr_search_leave(hit);
}

static __attribute__((noinline)) bool stack_any(const kdr_tree *tree, const kdr_entry *entry, const kdr_ray *ray) {
    kdr_ray_frame f;
    kdr_search search = {.tree = tree, .trace = KDR_TRACE_STACK, .any = true};
    return kdr_search_leave(kdr_search_run(search, entry, ray, &f, stack_in_double));
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
        kdr_search_report(&closest, &f, found);
    return kdr_search_leave(hit);
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
    return kdr_search_leave(kdr_wide_walk(tree, 0, ray, &r, true, &framed, &f, NULL));
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
        alone &= ~fit;
        alone |= rays->go_together ? packet_run(&p, fit, false) : fit;
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
        packet_bits fit = packet_begin(&p, tree, rays, true), apart = fit;
        if (rays->go_together)
            apart = packet_run(&p, fit, true);
#if FLIGHT_PAYS
        if (apart)
            apart = flight_any(&p, apart);
#endif
        alone = (alone & ~fit) | apart;
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
                                                         .takes_any_apart = FLIGHT_PAYS,
                                                         .packet_closest = packet_closest,
                                                         .packet_any = packet_any};
