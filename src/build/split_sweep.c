/* The surface area heuristic exactly, by a sweep over sorted events.
 *
 * On each axis the cost of every plane at which a box begins or ends follows from the counts on its two sides, which
 * change from one event to the next. Ends at a position leave the right side before its plane is weighed, begins join
 * the left side after. What lies in the plane is tried on both sides (three events); or nothing does, since boxes
 * without extent are widened (two events).
 *
 * Sources: I. Wald, V. Havran, "On building fast kd-trees for ray tracing, and on doing that in O(N log N)", 2006;
 * "Parallel KD Tree Acceleration Structures for Ray Tracing on Multi-Core Processor", thesis, 2009, sections 3.1
 * and 4.1. Cost: O(N) a node on each axis, some 4 ns an event; events are never sorted again (events.c). */
#include "build/events.h"
#include "build/splitter.h"

typedef struct sweep {
    const kdr_opening *opening;
    kdr_fractions fractions;
    uint32_t axes;
    kdr_split *best; /* an axis */
} sweep;

static double weigh(const sweep *s, uint32_t axis, float plane, uint64_t left, uint64_t right) {
    const kdr_plan *plan = &s->opening->state->plan;
    const kdr_box *cell = &s->opening->task->cell;
    double cost = kdr_fraction(&s->fractions, axis, (double)plane - cell->lo[axis]) * (double)left +
                  kdr_fraction(&s->fractions, axis, (double)cell->hi[axis] - plane) * (double)right;
    double bonus = left == 0 || right == 0 ? (double)plan->empty_bonus : 1;
    return (double)plan->cost_traversal + (double)plan->cost_intersection * bonus * cost;
}

static void sweep_axis(void *context, uint32_t axis) {
    const sweep *s = context;
    const kdr_build_task *task = s->opening->task;
    const kdr_events *events = task->events;
    const kdr_event *list = events->list[axis];
    uint32_t count = events->count[axis];
    uint64_t left = 0, right = task->references.count;
    kdr_split best = {.axis = axis, .cost = INFINITY};
    double least = INFINITY;
    if (!(s->axes >> axis & 1))
        count = 0;
    for (uint32_t i = 0; i < count;) {
        /* Count the events of one plane. */
        float plane = list[i].position;
        uint32_t ends = 0, lying = 0, begins = 0;
        for (; i < count && list[i].position == plane && kdr_event_is(list[i]) == KDR_EVENT_END; i++)
            ends++;
        for (; i < count && list[i].position == plane && kdr_event_is(list[i]) == KDR_EVENT_LYING; i++)
            lying++;
        for (; i < count && list[i].position == plane; i++)
            begins++;

        /* Weigh it, with what lies in it on either side. */
        right -= ends + lying;
        if (plane > task->cell.lo[axis] && plane < task->cell.hi[axis]) {
            double as_left = weigh(s, axis, plane, left + lying, right);
            double as_right = lying > 0 ? weigh(s, axis, plane, left, right + lying) : INFINITY;
            bool flat_left = as_left <= as_right;
            double cost = flat_left ? as_left : as_right;
            if (cost < least) {
                least = cost;
                best = (kdr_split){.axis = axis, .plane = plane, .flat_left = flat_left, .cost = (float)cost};
            }
        }
        left += lying + begins;
    }
    s->best[axis] = best;
}

static kdr_split choose(kdr_opening *opening, uint32_t axes) {
    sweep s = {.opening = opening,
               .fractions = kdr_fractions_of(&opening->task->cell),
               .axes = axes,
               .best = opening->scratch[0].splits};
    if (opening->parallel)
        kdr_crew_run(opening->state->crew, sweep_axis, &s, 3);
    else
        for (uint32_t axis = 0; axis < 3; axis++)
            sweep_axis(&s, axis);
    kdr_split best = s.best[0];
    for (uint32_t axis = 1; axis < 3; axis++)
        if (s.best[axis].cost < best.cost)
            best = s.best[axis];
    return best;
}

const kdr_splitter kdr_split_sweep = {.weighs = true,
                                      .event_bytes = kdr_events_bytes,
                                      .prepare = kdr_events_prepare,
                                      .divide = kdr_events_divide,
                                      .choose = choose};
