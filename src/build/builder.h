/* Builds a tree over numbered primitives. */
#ifndef KDR_BUILD_BUILDER_H
#define KDR_BUILD_BUILDER_H

#include "base/bulk.h"
#include "base/task.h"
#include "build/input.h"
#include "build/split.h"
#include "tree/tree.h"

/* Working memory that is kept from build to build; one build at a time. */
typedef struct kdr_workshop kdr_workshop;

/* For trees of at most so many nodes and references. NULL when there is no memory. bulk must live as long. */
kdr_workshop *kdr_workshop_create(kdr_alloc *alloc, kdr_bulk *bulk, uint32_t worker_count, uint32_t most);
void kdr_workshop_destroy(kdr_workshop *workshop); /* NULL is allowed */
void kdr_workshop_trim(kdr_workshop *workshop);    /* gives back what is kept */

/* The tree depends on input and plan alone. depth_limit 0 stands for 8 + 1.3 log2(primitives).
 * Errors: OUT_OF_MEMORY, LIMIT (more than 2^30 primitives, references or nodes), INVALID_DATA (*counts says how many
 * primitives are invalid), CANCELLED. *tree is set only on success. */
kdr_status kdr_build(kdr_workshop *workshop, const kdr_crew *crew, kdr_isa isa, const kdr_input *input,
                     const kdr_plan *plan, kdr_tree *tree, kdr_input_counts *counts);

#endif
