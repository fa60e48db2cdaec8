/* The table of traversals: the stack of one ray, the fastest way of one ray, and streams. */
#include "trace/lone_lanes.h"
#include "trace/stream_lanes.h"
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

static void stream_closest(const kdr_tree *tree, const kdr_ray *rays, size_t stride, uint32_t count, kdr_found *found) {
    stream s;
    s.tree = tree;
    stream_begin(&s, rays, stride, count, false);
    stream_run(&s, false);
    for (uint32_t i = 0; i < count; i++) {
        stream_ray *ray = &s.rays[i];
        found[i].primitive = UINT32_MAX;
        if (ray->octant == STREAM_ALONE)
            single_closest(tree, ray->ray, &found[i]);
        else if (s.closest[i].primitive != UINT32_MAX)
            kdr_search_report(&s.closest[i], &s.frames[i], &found[i]);
    }
    kdr_lanes_leave();
}

static void stream_any(const kdr_tree *tree, const kdr_ray *rays, size_t stride, uint32_t count, uint8_t *occluded) {
    stream s;
    s.tree = tree;
    stream_begin(&s, rays, stride, count, true);
    stream_run(&s, true);
    for (uint32_t i = 0; i < count; i++)
        occluded[i] = s.rays[i].octant == STREAM_ALONE ? single_any(tree, s.rays[i].ray) : s.rays[i].t < s.rays[i].tmin;
    kdr_lanes_leave();
}

extern const kdr_traversals KDR_LANES_SYMBOL(kdr_traversals);
const kdr_traversals KDR_LANES_SYMBOL(kdr_traversals) = {.stack_closest = stack_closest,
                                                         .stack_any = stack_any,
                                                         .wants_wide = KDR_LANES > 1,
                                                         .single_closest = single_closest,
                                                         .single_any = single_any,
                                                         .stream_closest = stream_closest,
                                                         .stream_any = stream_any};
