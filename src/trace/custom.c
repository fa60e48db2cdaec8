/* One ray through a tree of boxes, front to back, with a stack of far children: the traversal of stack_body.h over the
 * other kind of leaf (SPEC B11).
 *
 * Before a primitive's function is called the ray meets its box, where it passes the cell: a call costs many times as
 * much. Planes are crossed in doubles, in which the intervals of step.h hold for every ray. Boxes are met four at a
 * time in floats; rays for which floats do not hold, or are too coarse since they come from far away, meet them one by
 * one in doubles. The rule is that of step.h: intervals are closed, and never shorter than the true ones. So every
 * primitive is asked whose box the ray meets no later than the closest hit.
 *
 * Cost: one plane crossing a node, six crossings four boxes, and the calls. */
#include "trace/custom.h"

#include "geometry/quad.h"
#include "geometry/ray_frame.h"

#define REAL float
#define EPSILON 0x1p-24f
#define LARGEST 0x1p100f
#define STEP(name) float_##name
#include "trace/step.h"
#undef REAL
#undef EPSILON
#undef LARGEST
#undef STEP

#define REAL double
#define EPSILON 0x1p-53
#define LARGEST 0x1p400
#define STEP(name) double_##name
#include "trace/step.h"

/* Floats serve a ray that is so many times as long, inside the bounds, as a distance in floats may be off. */
#define COARSE 4096

/* A search under way. */
typedef struct custom_search {
    const kdr_tree *tree;
    const kdr_custom_answers *answers;
    double_ray interval;
    float_ray rough; /* the same in floats, if `in_floats` */
    bool in_floats;
    uint32_t near[3], far[3]; /* of a group's rows, the faces that the ray meets first and last */
    kdr_ray ray;              /* tmax: the distance of the closest hit so far */
    uint32_t primitive;       /* of hits at tmax itself those below it count */
    bool found;
    kdr_custom_hit *hit;
} custom_search;

/* The boxes of a group that the ray meets where it passes the cell, no later than the closest hit, as bits; and where
 * it enters them, but no sooner than the cell. A ray that lies in a face gives NaN there, which limits nothing. */
static inline uint32_t meet_group(const custom_search *s, const kdr_boxed_group *group, double cell_enter,
                                  double cell_leave, float entry[KDR_BLOCK_GROUP]) {
    const float_ray *r = &s->rough;
    const kdr_quad slack = kdr_quad_all(r->slack);
    kdr_quad enter = kdr_quad_all((float)cell_enter - r->slack), leave = kdr_quad_all((float)cell_leave + r->slack);
    for (uint32_t k = 0; k < 3; k++) {
        kdr_quad origin = kdr_quad_all(r->origin[k]), reciprocal = kdr_quad_all(r->reciprocal[k]);
        enter = kdr_quad_max((kdr_quad_load(group->face[s->near[k]]) - origin) * reciprocal - slack, enter);
        leave = kdr_quad_min((kdr_quad_load(group->face[s->far[k]]) - origin) * reciprocal + slack, leave);
    }
    kdr_quad_store(entry, enter);
    return kdr_quad_bits((enter <= leave) & (enter <= kdr_quad_all(s->ray.tmax)));
}

/* The same one by one. */
static uint32_t meet_boxes(const custom_search *s, const kdr_boxed_group *group, double cell_enter, double cell_leave,
                           float entry[KDR_BLOCK_GROUP]) {
    const double_ray *r = &s->interval;
    uint32_t met = 0;
    for (uint32_t i = 0; i < KDR_BLOCK_GROUP; i++) {
        double enter = cell_enter, leave = cell_leave;
        for (uint32_t k = 0; k < 3; k++) {
            double sooner = (group->face[s->near[k]][i] - r->origin[k]) * r->reciprocal[k] - r->slack;
            double later = (group->face[s->far[k]][i] - r->origin[k]) * r->reciprocal[k] + r->slack;
            enter = sooner > enter ? sooner : enter;
            leave = later < leave ? later : leave;
        }
        entry[i] = (float)enter;
        met |= (uint32_t)(enter <= leave && entry[i] <= s->ray.tmax) << i;
    }
    return met;
}

/* Asks one primitive for its closest hit. Comparisons are written so that a distance that is NaN is no hit. */
static void ask(custom_search *s, uint32_t primitive) {
    kdr_custom_hit hit = {0};
    if (!s->answers->intersect(s->answers->context, &s->ray, primitive, &hit) || !(hit.t > s->ray.tmin))
        return;
    if (hit.t < s->ray.tmax || (hit.t == s->ray.tmax && primitive < s->primitive)) {
        s->ray.tmax = hit.t;
        s->primitive = primitive;
        s->found = true;
        *s->hit = hit;
        s->answers->take(s->answers->context);
    }
}

/* Asks the primitives of a leaf; true ends the search. */
static inline bool ask_leaf(custom_search *s, kdr_node leaf, double enter, double leave, const bool any) {
    const kdr_boxed_group *group = kdr_boxed_of(s->tree, leaf), *end = group + kdr_block_groups(kdr_node_count(leaf));
    for (; group < end; group++) {
        float entry[KDR_BLOCK_GROUP];
        uint32_t met = __builtin_expect(s->in_floats, 1) ? meet_group(s, group, enter, leave, entry)
                                                         : meet_boxes(s, group, enter, leave, entry);
        for (; met; met &= met - 1) {
            uint32_t i = (uint32_t)__builtin_ctz(met);
            if (any && s->answers->occluded(s->answers->context, &s->ray, group->primitive[i]))
                return true;
            if (!any && entry[i] <= s->ray.tmax)
                ask(s, group->primitive[i]);
        }
    }
    return false;
}

static inline __attribute__((always_inline)) bool walk(custom_search *s, const bool any) {
    const double_ray *r = &s->interval;
    struct {
        uint32_t node;
        double tmin, tmax;
    } stack[KDR_MAX_DEPTH + 1];
    uint32_t top = 0, node_index = 0;
    double enter = r->tmin, leave = r->tmax;
    for (;;) {
        /* Go down to a leaf. */
        kdr_node node = s->tree->nodes[node_index];
        while (!kdr_node_is_leaf(node)) {
            uint32_t axis = kdr_node_axis(node);
            uint32_t near_index = kdr_node_child(node) + r->near_is_right[axis];
            double near_leave, far_enter;
            double_side side = double_cross(r, axis, kdr_node_plane(node), enter, leave, &near_leave, &far_enter);
            node_index = near_index;
            if (side == double_far_only) {
                node_index = near_index ^ 1;
            } else if (side == double_both) {
                stack[top].node = near_index ^ 1;
                stack[top].tmin = far_enter;
                stack[top].tmax = leave;
                top++;
                leave = near_leave;
            }
            node = s->tree->nodes[node_index];
        }
        if (ask_leaf(s, node, enter, leave, any))
            return true;

        /* Take the next cell that begins no later than the closest hit. */
        do {
            if (top == 0)
                return s->found;
            top--;
            enter = stack[top].tmin;
        } while (!any && (float)enter > s->ray.tmax);
        node_index = stack[top].node;
        leave = stack[top].tmax;
    }
}

/* False if the ray misses the tree's bounds. */
static bool begin(custom_search *s) {
    if (!kdr_ray_is_valid(&s->ray) || kdr_box_is_empty(&s->tree->bounds))
        return false;
    bool holds;
    if (!float_begin(&s->rough, &s->ray, &s->tree->bounds, &holds) && holds)
        return false;
    s->in_floats = holds && s->rough.slack * COARSE <= s->rough.tmax - s->rough.tmin;
    if (!double_begin(&s->interval, &s->ray, &s->tree->bounds, &holds))
        return false;
    for (uint32_t k = 0; k < 3; k++) {
        s->near[k] = s->interval.near_is_right[k] ? 3 + k : k;
        s->far[k] = s->interval.near_is_right[k] ? k : 3 + k;
    }
    return true;
}

bool kdr_custom_closest(const kdr_tree *tree, const kdr_custom_answers *answers, const kdr_ray *ray, uint32_t limit,
                        kdr_custom_hit *hit, uint32_t *primitive) {
    custom_search s = {.tree = tree, .answers = answers, .ray = *ray, .primitive = limit, .hit = hit};
    if (!begin(&s) || !walk(&s, false))
        return false;
    *primitive = s.primitive;
    return true;
}

bool kdr_custom_any(const kdr_tree *tree, const kdr_custom_answers *answers, const kdr_ray *ray) {
    custom_search s = {.tree = tree, .answers = answers, .ray = *ray};
    return begin(&s) && walk(&s, true);
}
