/* One ray through a tree of boxes, front to back, with a stack of far children: the traversal of stack_body.h over the
 * other kind of leaf (SPEC B11).
 *
 * Before a primitive's function is called the ray meets its box, where it passes the cell: a call costs many times as
 * much. Everything is done in doubles, in which the intervals of step.h hold for every ray, by the same rule as there:
 * closed, and never shorter than the true ones. So every primitive is asked whose box the ray meets no later than the
 * closest hit.
 * Cost: one plane crossing a node, six crossings a box, and the calls. */
#include "trace/custom.h"

#include "geometry/ray_frame.h"

#define REAL double
#define EPSILON 0x1p-53
#define LARGEST 0x1p400
#define STEP(name) double_##name
#include "trace/step.h"

/* A search under way. */
typedef struct custom_search {
    const kdr_tree *tree;
    const kdr_custom_answers *answers;
    double_ray interval;
    kdr_ray ray;        /* tmax: the distance of the closest hit so far */
    uint32_t primitive; /* of hits at tmax itself those below it count */
    bool found;
    kdr_custom_hit *hit;
} custom_search;

/* True unless the ray surely misses the box between two distances, or meets it only behind the closest hit. A ray that
 * lies in a face gives NaN there, which limits nothing. */
static bool meets(const custom_search *s, const kdr_box *box, double enter, double leave) {
    const double_ray *r = &s->interval;
    for (int k = 0; k < 3; k++) {
        double near = r->near_is_right[k] ? box->hi[k] : box->lo[k],
               far = r->near_is_right[k] ? box->lo[k] : box->hi[k];
        double sooner = (near - r->origin[k]) * r->reciprocal[k] - r->slack;
        double later = (far - r->origin[k]) * r->reciprocal[k] + r->slack;
        enter = sooner > enter ? sooner : enter;
        leave = later < leave ? later : leave;
    }
    return enter <= leave && (float)enter <= s->ray.tmax;
}

/* Asks one primitive. Comparisons are written so that a distance that is NaN is no hit. */
static void ask(custom_search *s, uint32_t primitive) {
    kdr_custom_hit hit = {0};
    if (!s->answers->intersect(s->answers->context, &s->ray, primitive, &hit) || !(hit.t > s->ray.tmin))
        return;
    if (hit.t < s->ray.tmax || (hit.t == s->ray.tmax && primitive < s->primitive)) {
        s->ray.tmax = hit.t;
        s->primitive = primitive;
        s->found = true;
        *s->hit = hit;
    }
}

/* Asks the primitives of a leaf; true ends the search. */
static inline bool ask_leaf(custom_search *s, kdr_node leaf, double enter, double leave, const bool any) {
    const kdr_boxed *entries = kdr_boxed_of(s->tree, leaf);
    for (uint32_t i = 0, count = kdr_node_count(leaf); i < count; i++) {
        if (!meets(s, &entries[i].box, enter, leave))
            continue;
        if (!any)
            ask(s, entries[i].primitive);
        else if (s->answers->occluded(s->answers->context, &s->ray, entries[i].primitive))
            return true;
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
    bool holds;
    return kdr_ray_is_valid(&s->ray) && !kdr_box_is_empty(&s->tree->bounds) &&
           double_begin(&s->interval, &s->ray, &s->tree->bounds, &holds);
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
