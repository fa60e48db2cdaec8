/* The value of a given rank among numbers of a node's references, without sorting: see rank.c. */
#ifndef KDR_BUILD_RANK_H
#define KDR_BUILD_RANK_H

#include <stdint.h>

#define KDR_RANK_TALLIES 256 /* counters of one digit */

/* What a selection keeps for one worker. */
typedef struct kdr_rank_tallies {
    uint32_t tallies[KDR_RANK_TALLIES], next;
} kdr_rank_tallies;

struct kdr_opening;

/* Which numbers: the centres of the boxes on an axis, one a reference, or both ends of the boxes, two a reference. */
typedef enum kdr_rank_of { KDR_RANK_CENTRES, KDR_RANK_ENDS } kdr_rank_of;

/* The number of rank 0, 1 ... from below, and in *next (may be NULL) the one of the rank after it, or the same number
 * where there is none. Equal for any number of workers. Cost: four passes over the references, five with next. */
float kdr_rank_select(const struct kdr_opening *opening, uint32_t axis, kdr_rank_of of, uint64_t rank, float *next);

#endif
