/* The plan of a build as data: defaults, plans for a purpose, and what a plan cannot be. */
#include "build/plan.h"

#include "tree/tree.h"

#define WEIGHED_LEAF_LIMIT 64
#define MEDIAN_LEAF_LIMIT 8 /* half a block of the widest lanes: medians never ask whether a leaf would do */
#define SWEEP_BONUS 0.8f    /* as in the thesis */

/* The coarsest tree whose building and whose picture of primary and shadow rays take the least time together; a third
 * finer it takes no longer. */
#define FAST_TRAVERSAL 96
#define FAST_LEAF_LIMIT 384

/* Nodes that take half a millisecond to open: larger ones leave a thread that meets them waiting for longer than the
   commit saved, smaller ones leave the commit more to split. */
#define LAZY_LIMIT 4096

kdr_build_def kdr_default_build_def(void) {
    return (kdr_build_def){
        .size = sizeof(kdr_build_def), .events = KDR_EVENTS_TWO, .cost_traversal = 16, .cost_intersection = 1};
}

kdr_build_def kdr_quality_build_def(kdr_quality quality) {
    kdr_build_def def = kdr_default_build_def();
    if (quality == KDR_QUALITY_FAST || quality == KDR_QUALITY_LAZY) {
        def.cost_traversal = FAST_TRAVERSAL;
        def.leaf_limit = FAST_LEAF_LIMIT;
        def.lazy_limit = quality == KDR_QUALITY_LAZY ? LAZY_LIMIT : 0;
    } else if (quality == KDR_QUALITY_BEST) {
        def.split = KDR_SPLIT_SWEEP;
        def.straddle = KDR_STRADDLE_CLIP;
        def.retract = true;
        def.box_weight = 0.8f;
        def.empty_bonus = 1;
        def.leaf_limit = 32;
    }
    return def;
}

static bool weighs_planes(kdr_split_rule split) { return split == KDR_SPLIT_BINNED || split == KDR_SPLIT_SWEEP; }

/* Comparisons are written so that NaN is wrong. */
const char *kdr_build_def_problem(const kdr_build_def *def) {
    if (def->size != sizeof(kdr_build_def))
        return "the build def was not made by kdr_default_build_def";
    bool weighs = weighs_planes(def->split), sweep = def->split == KDR_SPLIT_SWEEP;
    if ((unsigned)def->split > KDR_SPLIT_SWEEP)
        return "split must be one of kdr_split_rule";
    if ((unsigned)def->axis > KDR_AXIS_ROBIN)
        return "axis must be one of kdr_axis_rule";
    if ((unsigned)def->order > KDR_ORDER_BREADTH_FIRST)
        return "order must be one of kdr_order_rule";
    if ((unsigned)def->share > KDR_SHARE_CLUSTER)
        return "share must be one of kdr_share_rule";
    if (def->share == KDR_SHARE_NONE && def->share_count != 0)
        return "share_count must be 0 where there are no regions";
    if (def->share != KDR_SHARE_NONE && (def->share_count < 1 || def->share_count > KDR_MAX_SHARE_COUNT))
        return "share_count must be from 1 to 1024";
    if (def->events != KDR_EVENTS_TWO && def->events != KDR_EVENTS_THREE)
        return "events must be one of kdr_event_form";
    if (def->events != KDR_EVENTS_TWO && !sweep)
        return "three events are for the sweep only: split=binned, space and object have no events";
    if ((unsigned)def->straddle > KDR_STRADDLE_CLIP)
        return "straddle must be one of kdr_straddle_rule";
    if (!(def->box_weight >= 0 && def->box_weight <= 1))
        return "box_weight must be from 0 to 1";
    if (def->box_weight > 0 && !sweep)
        return "only the sweep weighs boxes: box-weight goes with split=sweep";
    if (!(def->empty_bonus >= 0 && def->empty_bonus <= 1))
        return "empty_bonus must be over 0 and at most 1, or 0 for the default";
    if (def->empty_bonus != 0 && def->empty_bonus != 1 && !weighs)
        return "empty-bonus is a constant of the heuristic, which split=space and object do not ask";
    if (!(def->cost_traversal > 0 && (double)def->cost_traversal <= KDR_PLAN_COST_LIMIT))
        return "cost_traversal must be over 0 and at most 1,000,000";
    if (!(def->cost_intersection > 0 && (double)def->cost_intersection <= KDR_PLAN_COST_LIMIT))
        return "cost_intersection must be over 0 and at most 1,000,000";
    if (def->depth_limit > KDR_MAX_DEPTH)
        return "depth_limit must be at most 60";
    if (def->reference_limit != 0 &&
        !(def->reference_limit >= 1 && (double)def->reference_limit <= KDR_PLAN_COST_LIMIT))
        return "reference_limit must be 0, for the default, or at least 1 and at most 1,000,000";
    if (def->lazy_limit != 0 && (def->lazy_limit < KDR_MIN_LAZY_LIMIT || def->lazy_limit > KDR_MAX_LAZY_LIMIT))
        return "lazy_limit must be 0, or from 64 to 8192";
    if (def->lazy_limit != 0 && sweep)
        return "the sweep sorts the whole scene first: lazy-limit goes with split=binned, space or object";
    if (def->lazy_limit != 0 && (def->order != KDR_ORDER_DEPTH_FIRST || def->retract))
        return "lazy-limit goes with order=dfs and retract=no: rays open one node after the other";
    if (def->lazy_limit != 0 &&
        (def->nodes == KDR_NODES_ARRAYS || def->trace == KDR_TRACE_BACKTRACK || def->test == KDR_TEST_PROJECTION))
        return "nodes=arrays, trace=backtrack and test=projection need the whole tree: they do not go with lazy-limit";
    if ((unsigned)def->trace > KDR_TRACE_BACKTRACK)
        return "trace must be one of kdr_trace_rule";
    if ((unsigned)def->nodes > KDR_NODES_ARRAYS)
        return "nodes must be one of kdr_nodes_rule";
    if ((unsigned)def->mailbox > KDR_MAILBOX_64)
        return "mailbox must be one of kdr_mailbox_rule";
    if (def->nodes == KDR_NODES_ARRAYS && def->trace != KDR_TRACE_STACK && def->trace != KDR_TRACE_RESTART)
        return "nodes=arrays goes with trace=stack or trace=restart";
    if (def->mailbox != KDR_MAILBOX_NONE && def->trace == KDR_TRACE_AUTO)
        return "a mailbox goes with a traversal by name, not with trace=auto";
    if ((unsigned)def->test > KDR_TEST_PROJECTION)
        return "test must be one of kdr_triangle_test";
    if (def->test != KDR_TEST_WATERTIGHT && def->trace == KDR_TRACE_AUTO)
        return "another triangle test goes with a traversal by name, not with trace=auto";
    return NULL;
}

kdr_plan kdr_plan_of(const kdr_build_def *def) {
    bool weighs = weighs_planes(def->split);
    kdr_plan plan = {.split = def->split,
                     .axis = def->axis,
                     .order = def->order,
                     .share = def->share,
                     .share_count = def->share_count,
                     .events = def->events,
                     .straddle = def->straddle,
                     .retract = def->retract,
                     .box_weight = def->box_weight,
                     .empty_bonus = def->empty_bonus,
                     .cost_traversal = def->cost_traversal,
                     .cost_intersection = def->cost_intersection,
                     .leaf_limit = def->leaf_limit,
                     .depth_limit = def->depth_limit,
                     .reference_limit = def->reference_limit,
                     .lazy_limit = def->lazy_limit,
                     .trace = def->trace,
                     .nodes = def->nodes,
                     .mailbox = def->mailbox,
                     .test = def->test};
    if (plan.axis == KDR_AXIS_DEFAULT)
        plan.axis = weighs ? KDR_AXIS_BEST : KDR_AXIS_LONGEST;
    if (plan.leaf_limit == 0)
        plan.leaf_limit = weighs ? WEIGHED_LEAF_LIMIT : MEDIAN_LEAF_LIMIT;
    if (plan.empty_bonus == 0)
        plan.empty_bonus = def->split == KDR_SPLIT_SWEEP ? SWEEP_BONUS : 1;
    return plan;
}
