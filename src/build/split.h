/* Where a node is cut, and what the cut is worth. */
#ifndef KDR_BUILD_SPLIT_H
#define KDR_BUILD_SPLIT_H

#include "build/references.h"
#include "kdray/kdray.h"

#include <stdbool.h>

typedef struct kdr_split {
    uint32_t axis;
    float plane;
    bool flat_left; /* primitives that lie in the plane go left; otherwise right */
    float cost;     /* by the surface area heuristic, or 0 where none is asked; infinite: there is no plane */
} kdr_split;

/* Rules, constants of the heuristic, and limits; nothing is left to a default but the depth limit. */
typedef struct kdr_plan {
    kdr_split_rule split;
    kdr_axis_rule axis;
    kdr_order_rule order;
    const struct kdr_order *own_order; /* instead of that of the rule; NULL: none */
    kdr_share_rule share;
    uint32_t share_count;
    kdr_event_form events;
    kdr_straddle_rule straddle;
    bool retract;
    float cost_traversal, cost_intersection;
    float box_weight;  /* how much planes are weighed by the bounds of what lies beside them; 0: by cells alone */
    float empty_bonus; /* factor of the cost of a plane that cuts off empty space */
    uint32_t leaf_limit, depth_limit;
    float reference_limit;
    kdr_trace_rule trace; /* this and the next three: of no concern to the builder */
    kdr_nodes_rule nodes;
    uint32_t lazy_limit; /* nodes of at most so many references stay closed; 0: none */
    kdr_mailbox_rule mailbox;
    kdr_triangle_test test;
    bool wide; /* add the wide tree */
} kdr_plan;

static inline float kdr_plan_leaf_cost(const kdr_plan *plan, uint32_t count) {
    return plan->cost_intersection * (float)count;
}

/* Halves of areas of the two parts of a cell cut at a plane, as fractions of the cell's. */
typedef struct kdr_fractions {
    double inverse_area; /* of the cell; 0 if the cell has no area */
    double face[3];      /* area of the face across each axis */
    double rim[3];       /* half its circumference */
} kdr_fractions;

static inline kdr_fractions kdr_fractions_of(const kdr_box *cell) {
    double d[3];
    for (int k = 0; k < 3; k++)
        d[k] = (double)cell->hi[k] - cell->lo[k];
    double area = d[0] * d[1] + d[1] * d[2] + d[2] * d[0];
    kdr_fractions s = {.inverse_area = area > 0 ? 1 / area : 0};
    for (int k = 0; k < 3; k++) {
        double a = d[(k + 1) % 3], b = d[(k + 2) % 3];
        s.face[k] = a * b;
        s.rim[k] = a + b;
    }
    return s;
}

/* Fraction of the cell's area that a part of the given extent on the axis has. */
static inline double kdr_fraction(const kdr_fractions *s, uint32_t axis, double extent) {
    return (s->face[axis] + s->rim[axis] * extent) * s->inverse_area;
}

#endif
