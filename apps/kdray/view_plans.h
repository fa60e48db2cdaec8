/* The plans and traversals that keys switch among. */
#ifndef KDR_APPS_KDRAY_VIEW_PLANS_H
#define KDR_APPS_KDRAY_VIEW_PLANS_H

#include <kdray/render.h>

#define KDR_VIEW_PLAN_FAST 1     /* for a tree that serves one frame */
#define KDR_VIEW_PLAN_BALANCED 2 /* the library's default */

/* Number 0 is the plan that was given; the others are named. NULL past the last one. */
const char *kdr_view_plan_name(uint32_t number);

/* The traversals by name, in the order of kdr_trace_rule; NULL past the last one. */
const char *kdr_view_trace_name(uint32_t trace);

/* A plan, with another traversal if it has not got this one: what goes only with its own is then left out. */
kdr_build_def kdr_view_plan(const kdr_build_def *given, uint32_t number, kdr_trace_rule trace);

#endif
