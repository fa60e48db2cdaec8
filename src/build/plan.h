/* The plan of a build as data: from a def, from text, and back to text (kdr_build_def_parse and its like). */
#ifndef KDR_BUILD_PLAN_H
#define KDR_BUILD_PLAN_H

#include "build/split.h"

#define KDR_PLAN_COST_LIMIT 1e6 /* of costs and of references a primitive */

/* A sentence about what is wrong with a def, or NULL; static storage. */
const char *kdr_build_def_problem(const kdr_build_def *def);

/* What a sound def asks for, with defaults that depend on the split resolved. `wide` is left false. */
kdr_plan kdr_plan_of(const kdr_build_def *def);

#endif
