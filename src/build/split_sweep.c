/* The surface area heuristic exactly, by a sweep over sorted events.
 *
 * On each axis the cost of every plane at which a box begins or ends follows from the counts on its two sides, which
 * change from one event to the next. Ends at a position leave the right side before its plane is weighed, begins join
 * the left side after. What lies in the plane is tried on both sides (three events); or nothing does, since boxes
 * without extent are widened (two events).
 *
 * Areas are those of the two parts of the cell, as a ray sees them that walks the kd-tree. The wide tree shows rays the
 * bounds of what lies in each part instead: box_weight says how much of the cost goes by these. They are gathered by
 * two sweeps more, in nodes that are not large; at the top, where they cost most, they tell little.
 *
 * Sources: I. Wald, V. Havran, "On building fast kd-trees for ray tracing, and on doing that in O(N log N)", 2006;
 * "Parallel KD Tree Acceleration Structures for Ray Tracing on Multi-Core Processor", thesis, 2009, sections 3.1
 * and 4.1; M. Stich, H. Friedrich, A. Dietrich, "Spatial Splits in Bounding Volume Hierarchies", 2009, for bounds by
 * sweeps. Cost: O(N) a node on each axis, some 4 ns an event; events are never sorted again (events.c). */
#include "build/events.h"
#include "build/splitter.h"

#define BOX_LIMIT 65536 /* references of the largest node whose planes are weighed by boxes */

typedef struct sweep {
    const kdr_opening *opening;
    kdr_fractions fractions;
    uint32_t axes;
    kdr_split *best;       /* an axis */
    double *right_area[3]; /* an event: of the bounds of what lies right of it; NULL: boxes are not asked */
    double inverse_area;   /* of the node's bounds */
} sweep;

/* Bounds that grow. */
typedef struct sweep_bounds {
    double lo[3], hi[3];
} sweep_bounds;

static const sweep_bounds no_bounds = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};

static void add_reference(sweep_bounds *b, const kdr_references *r, uint32_t i) {
    for (int k = 0; k < 3; k++) {
        b->lo[k] = (double)r->lo[k][i] < b->lo[k] ? (double)r->lo[k][i] : b->lo[k];
        b->hi[k] = (double)r->hi[k][i] > b->hi[k] ? (double)r->hi[k][i] : b->hi[k];
    }
}

/* Area of the part of the bounds below or above a plane. */
static double area_beside(sweep_bounds b, uint32_t axis, double plane, bool below) {
    if (below)
        b.hi[axis] = b.hi[axis] < plane ? b.hi[axis] : plane;
    else
        b.lo[axis] = b.lo[axis] > plane ? b.lo[axis] : plane;
    double x = b.hi[0] - b.lo[0], y = b.hi[1] - b.lo[1], z = b.hi[2] - b.lo[2];
    return x >= 0 && y >= 0 && z >= 0 ? x * y + y * z + z * x : 0;
}

/* Sweeps down: bounds of all that ends at an event or behind it. */
static void find_right_areas(const sweep *s, uint32_t axis) {
    const kdr_build_task *task = s->opening->task;
    const kdr_events *events = task->events;
    sweep_bounds bounds = no_bounds;
    for (uint32_t i = events->count[axis]; i-- > 0;) {
        kdr_event event = events->list[axis][i];
        if (kdr_event_is(event) != KDR_EVENT_BEGIN)
            add_reference(&bounds, &task->references, kdr_event_reference(event));
        s->right_area[axis][i] = area_beside(bounds, axis, event.position, false);
    }
}

/* A plane with what lies on its two sides. */
typedef struct candidate {
    float plane;
    uint64_t left, right;
    double left_area, right_area; /* of bounds */
} candidate;

static double weigh(const sweep *s, uint32_t axis, const candidate *c) {
    const kdr_plan *plan = &s->opening->state->plan;
    const kdr_box *cell = &s->opening->task->cell;
    double cost = kdr_fraction(&s->fractions, axis, (double)c->plane - cell->lo[axis]) * (double)c->left +
                  kdr_fraction(&s->fractions, axis, (double)cell->hi[axis] - c->plane) * (double)c->right;
    if (s->right_area[axis]) {
        double boxes = (c->left_area * (double)c->left + c->right_area * (double)c->right) * s->inverse_area;
        cost += (double)plan->box_weight * (boxes - cost);
    }
    double bonus = c->left == 0 || c->right == 0 ? (double)plan->empty_bonus : 1;
    return (double)plan->cost_traversal + (double)plan->cost_intersection * bonus * cost;
}

static void sweep_axis(void *context, uint32_t axis) {
    const sweep *s = context;
    const kdr_build_task *task = s->opening->task;
    const kdr_events *events = task->events;
    const kdr_event *list = events->list[axis];
    uint32_t count = s->axes >> axis & 1 ? events->count[axis] : 0;
    bool boxes = s->right_area[axis] != NULL;
    if (boxes && count > 0)
        find_right_areas(s, axis);
    sweep_bounds bounds = no_bounds;
    candidate c = {.right = task->references.count};
    kdr_split best = {.axis = axis, .cost = INFINITY};
    double least = INFINITY;
    for (uint32_t i = 0; i < count;) {
        /* Count the events of one plane. */
        c.plane = list[i].position;
        uint32_t first = i, lying = 0;
        for (; i < count && list[i].position == c.plane && kdr_event_is(list[i]) == KDR_EVENT_END; i++)
            c.right--;
        for (; i < count && list[i].position == c.plane && kdr_event_is(list[i]) == KDR_EVENT_LYING; i++)
            lying++;
        uint32_t begins = i;
        for (; i < count && list[i].position == c.plane; i++)
            ;

        /* Weigh it, with what lies in it on either side. */
        c.right -= lying;
        if (c.plane > task->cell.lo[axis] && c.plane < task->cell.hi[axis]) {
            if (boxes) {
                c.left_area = area_beside(bounds, axis, c.plane, true);
                c.right_area = begins < count ? s->right_area[axis][begins] : 0;
            }
            candidate as_left = c, as_right = c;
            as_left.left += lying;
            as_right.right += lying;
            double left_cost = weigh(s, axis, &as_left);
            double right_cost = lying > 0 ? weigh(s, axis, &as_right) : INFINITY;
            bool flat_left = left_cost <= right_cost;
            double cost = flat_left ? left_cost : right_cost;
            if (cost < least) {
                least = cost;
                best = (kdr_split){.axis = axis, .plane = c.plane, .flat_left = flat_left, .cost = (float)cost};
            }
        }
        c.left += lying + (i - begins);
        for (; boxes && first < i; first++)
            if (kdr_event_is(list[first]) != KDR_EVENT_END)
                add_reference(&bounds, &task->references, kdr_event_reference(list[first]));
    }
    s->best[axis] = best;
}

/* Memory for the areas; without it the build fails. */
static bool ask_boxes(kdr_opening *opening, sweep *s) {
    const kdr_events *events = opening->task->events;
    double area = kdr_box_area(&opening->task->box);
    if (opening->state->plan.box_weight == 0 || opening->task->references.count > BOX_LIMIT || !(area > 0))
        return true;
    s->inverse_area = 1 / area;
    for (int k = 0; k < 3; k++) {
        s->right_area[k] = kdr_arena_get(&opening->worker->arena, events->count[k] * sizeof(double));
        if (!s->right_area[k]) {
            kdr_build_fail(opening->state, KDR_ERROR_OUT_OF_MEMORY);
            return false;
        }
    }
    return true;
}

static kdr_split choose(kdr_opening *opening, uint32_t axes) {
    kdr_arena_mark mark = kdr_arena_save(&opening->worker->arena);
    sweep s = {.opening = opening,
               .fractions = kdr_fractions_of(&opening->task->cell),
               .axes = axes,
               .best = opening->scratch[0].splits};
    kdr_split best = {.cost = INFINITY};
    if (ask_boxes(opening, &s)) {
        if (opening->parallel)
            kdr_crew_run(opening->state->crew, sweep_axis, &s, 3);
        else
            for (uint32_t axis = 0; axis < 3; axis++)
                sweep_axis(&s, axis);
        for (uint32_t axis = 0; axis < 3; axis++)
            if (s.best[axis].cost < best.cost)
                best = s.best[axis];
    }
    kdr_arena_restore(&opening->worker->arena, mark);
    return best;
}

const kdr_splitter kdr_split_sweep = {.weighs = true,
                                      .event_bytes = kdr_events_bytes,
                                      .prepare = kdr_events_prepare,
                                      .divide = kdr_events_divide,
                                      .choose = choose};
