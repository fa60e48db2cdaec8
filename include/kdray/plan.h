/* The plan of a build as data: part of kdray/kdray.h, which includes it. */
#ifndef KDR_PLAN_H
#define KDR_PLAN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Where a node is cut. */
typedef enum kdr_split_rule {
    KDR_SPLIT_BINNED, /* where the surface area heuristic says: by bins, small nodes exactly */
    KDR_SPLIT_SPACE,  /* spatial median: the middle of the cell */
    KDR_SPLIT_OBJECT, /* object median: the median of the centres of the primitives' boxes */
    KDR_SPLIT_SWEEP,  /* where the surface area heuristic says, exactly, by sorted events */
} kdr_split_rule;

/* On which axis. Where an axis has no plane worth taking, another one is tried. */
typedef enum kdr_axis_rule {
    KDR_AXIS_DEFAULT, /* binned, sweep: best; space, object: longest */
    KDR_AXIS_BEST,    /* the axis whose plane costs least by the surface area heuristic */
    KDR_AXIS_LONGEST, /* the longest axis of the cell */
    KDR_AXIS_ROBIN,   /* one after the other, by depth */
} kdr_axis_rule;

/* What is opened next. It never changes the tree. */
typedef enum kdr_order_rule { KDR_ORDER_DEPTH_FIRST, KDR_ORDER_BREADTH_FIRST } kdr_order_rule;

/* Who works on what. All but NONE first divide the scene at medians into share_count regions, whatever the number of
 * workers, which become subtrees of one tree. */
typedef enum kdr_share_rule {
    KDR_SHARE_NONE,    /* no regions: all workers on each of the largest nodes, then nodes are handed around */
    KDR_SHARE_SERIAL,  /* regions by medians of begins and ends, found by one worker; one worker a region */
    KDR_SHARE_LINE,    /* slices of the longest axis, by bins, found by all workers; one worker a region */
    KDR_SHARE_GRID,    /* boxes, by one histogram on three axes, found by all workers; one worker a region */
    KDR_SHARE_CLUSTER, /* slices of the longest axis, by 512 bins a region; then nodes are handed around */
} kdr_share_rule;

#define KDR_MAX_SHARE_COUNT 1024

#define KDR_MIN_LAZY_LIMIT 64
#define KDR_MAX_LAZY_LIMIT 8192

/* Events of the sweep. */
typedef enum kdr_event_form {
    KDR_EVENTS_TWO = 2,  /* begin and end; boxes without extent are widened by the least amount */
    KDR_EVENTS_THREE = 3 /* begin, lying in the plane, end; what lies in a plane is tried on both sides */
} kdr_event_form;

/* What becomes of a primitive on both sides of a plane. */
typedef enum kdr_straddle_rule {
    KDR_STRADDLE_AUTO,    /* CLIP where the boxes of triangles are mostly empty, otherwise GENERAL */
    KDR_STRADDLE_GENERAL, /* its box is cut at the plane: works for every primitive */
    KDR_STRADDLE_CLIP,    /* the triangle is cut: each side sees the bounds of its part; sweep: by polygons, exactly */
} kdr_straddle_rule;

/* How single rays go through the tree; never changes an answer. All but AUTO ask every ray of every query alone. */
typedef enum kdr_trace_rule {
    KDR_TRACE_AUTO,        /* the fastest there is: the wide tree where there are lanes, rays together in packets */
    KDR_TRACE_STACK,       /* front to back through the kd-tree, with a stack of far children */
    KDR_TRACE_RESTART,     /* no stack: from the root again for every leaf */
    KDR_TRACE_PUSH_DOWN,   /* restart, from the deepest node above which nothing waits */
    KDR_TRACE_SHORT_STACK, /* a stack of few places; push-down where it has lost what waits */
    KDR_TRACE_BACKTRACK,   /* no stack: up by parent links, which add 28 bytes a node */
} kdr_trace_rule;

/* How the nodes lie that are traced; never changes an answer. */
typedef enum kdr_nodes_rule {
    KDR_NODES_STRUCTURES, /* a word of 8 bytes each */
    KDR_NODES_ARRAYS,     /* as well, an array for each field, 13 bytes a node: STACK and RESTART only */
} kdr_nodes_rule;

/* Triangles that a ray remembers, so that none of them is tested again in another leaf; never changes an answer. Not
 * with KDR_TRACE_AUTO, which has few triangles in two leaves. */
typedef enum kdr_mailbox_rule {
    KDR_MAILBOX_NONE,
    KDR_MAILBOX_8,
    KDR_MAILBOX_16,
    KDR_MAILBOX_32,
    KDR_MAILBOX_64,
} kdr_mailbox_rule;

/* How a ray is tested against a triangle. All but WATERTIGHT are for comparing methods, not with KDR_TRACE_AUTO: they
 * work in floats, so rays may pass between two triangles that share an edge, and distances and weights have the
 * roundings of floats. */
typedef enum kdr_triangle_test {
    KDR_TEST_WATERTIGHT,      /* as exact arithmetic would: see kdr_intersect1 */
    KDR_TEST_MOLLER_TRUMBORE, /* from the corners */
    KDR_TEST_PROJECTION, /* precomputed planes and edges along one axis, distance first: 40 bytes a reference more */
} kdr_triangle_test;

/* How the tree is built and traced: the plan. Costs are relative costs of the surface area heuristic. */
typedef struct kdr_build_def {
    size_t size; /* set by kdr_default_build_def */
    kdr_split_rule split;
    kdr_axis_rule axis;
    kdr_order_rule order;
    kdr_share_rule share;
    uint32_t share_count;  /* regions; 1 to KDR_MAX_SHARE_COUNT; 0 with KDR_SHARE_NONE */
    kdr_event_form events; /* sweep only */
    kdr_straddle_rule straddle;
    bool retract;            /* take back splits that did not pay, once the tree is built */
    float box_weight;        /* sweep: how much of a plane's cost goes by the bounds of what lies on its two sides,
                                which the wide tree shows to rays, instead of the two parts of the cell; 0 to 1 */
    float empty_bonus;       /* factor of the cost of triangle tests where a plane leaves one side empty: over 0, at
                                most 1; binned and sweep only. 0: 0.8 for sweep, 1 for binned */
    float cost_traversal;    /* of one step through an interior node; > 0 */
    float cost_intersection; /* of one triangle test; > 0 */
    uint32_t leaf_limit;     /* more primitives than this are split even where the heuristic would not; space, object:
                                no more than this are never split. 0: 64 for binned and sweep, 8 for the others */
    uint32_t depth_limit;    /* 0: 8 + 1.3 log2(primitives); at most KDR_MAX_DEPTH */
    float reference_limit;   /* references a primitive, over the whole tree, that splitting may use; >= 1. 0: 4, or 8
                                where the boxes of triangles are next to empty */
    uint32_t lazy_limit;     /* nodes of at most so many references stay closed until the first ray reaches them:
                                KDR_MIN_LAZY_LIMIT to KDR_MAX_LAZY_LIMIT. 0: the commit opens all */
    kdr_trace_rule trace;
    kdr_nodes_rule nodes;
    kdr_mailbox_rule mailbox;
    kdr_triangle_test test;
} kdr_build_def;

#endif
