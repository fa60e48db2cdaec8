/* A lone ray on its way through the kd-tree: made ready, walked in floats or, rarely, in doubles, and reported. */
#ifndef KDR_TRACE_LONE_LANES_H
#define KDR_TRACE_LONE_LANES_H

#include "trace/search_lanes.h"

#define REAL float
#define EPSILON 0x1p-24f
#define LARGEST 0x1p100f
#define STEP(name) float_##name
#include "trace/step.h"
#include "trace/stack_body.h"
#include "trace/restart_body.h"
#include "trace/backtrack_body.h"
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
#include "trace/restart_body.h"
#include "trace/backtrack_body.h"
#undef REAL
#undef EPSILON
#undef LARGEST
#undef STEP

/* A ray outside the range of float intervals: rare, so its code is kept apart, one loop a walk for all searches. */
typedef bool kdr_walk_in_double(const kdr_search *search, const kdr_entry *entry, const kdr_ray *ray);

#define KDR_WALK_IN_DOUBLE(name, walk)                                                                                 \
    static __attribute__((noinline)) bool name(const kdr_search *search, const kdr_entry *entry, const kdr_ray *ray) { \
        double_ray r;                                                                                                  \
        bool holds;                                                                                                    \
        return double_begin(&r, ray, &entry->box, &holds) && walk(*search, entry->node, &r);                           \
    }

/* Searches what lies below an entry. s: all but the interval and the frame, which is set in *f. */
KDR_LANES_INLINE bool kdr_search_run(kdr_search s, const kdr_entry *entry, const kdr_ray *ray, kdr_ray_frame *f,
                                     kdr_walk_in_double *walk_in_double) {
    if (!kdr_ray_is_valid(ray) || kdr_box_is_empty(&entry->box))
        return false;
    float_ray r;
    bool holds;
    if (!float_begin(&r, ray, &entry->box, &holds) && holds)
        return false;
    kdr_ray_frame_set(f, ray, r.reciprocal, &s.tree->bounds);
    s.frame = f;
    s.tmin = ray->tmin;
    s.tmax = ray->tmax;
    if (__builtin_expect(!holds, 0))
        return walk_in_double(&s, entry, ray);
    switch (s.trace) {
    case KDR_TRACE_BACKTRACK: return float_backtrack(s, entry->node, &r);
    case KDR_TRACE_RESTART:
    case KDR_TRACE_PUSH_DOWN:
    case KDR_TRACE_SHORT_STACK: return float_restart(s, entry->node, &r);
    default: return float_stack(s, entry->node, &r);
    }
}

/* Hands over what was found. */
KDR_LANES_INLINE void kdr_search_report(kdr_closest *closest, const kdr_ray_frame *f, kdr_found *found) {
    kdr_closest_settle(closest, f);
    found->t = closest->hit.t;
    found->u = closest->hit.u;
    found->v = closest->hit.v;
    memcpy(found->normal, closest->hit.normal, sizeof found->normal);
    found->primitive = closest->primitive;
}

/* What a table's function returns with. */
KDR_LANES_INLINE bool kdr_search_leave(bool answer) {
    kdr_lanes_leave();
    return answer;
}

#endif
