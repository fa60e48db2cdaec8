/* A node while it is being opened: passes over its references, by one worker or by all.
 *
 * Counts are integers and ranges are cut at fixed places, so results are the same either way. */
#ifndef KDR_BUILD_OPENING_H
#define KDR_BUILD_OPENING_H

#include "base/primitives.h"
#include "build/rank.h"
#include "build/work.h"

#define KDR_PASS_GRAIN 8192 /* references of one range of a pass */

/* What a splitter keeps for one worker while it looks at one node. */
typedef union kdr_split_scratch {
    kdr_bins bins;
    kdr_rank_tallies tallies;
    kdr_split splits[3]; /* the best of each axis */
} kdr_split_scratch;

typedef struct kdr_opening {
    kdr_build_state *state;
    kdr_build_worker *worker;
    const kdr_build_task *task;
    bool parallel;              /* all workers share its passes */
    uint32_t worker_count;      /* 1 if not */
    uint32_t range_count;       /* of KDR_PASS_GRAIN references */
    kdr_split_scratch *scratch; /* a worker */
    uint32_t *left, *right;     /* a range: counts of the plane that was counted last */
    kdr_box *boxes[2];          /* a worker */
    kdr_bin_grid grid;          /* of scratch->bins */

    /* One range and one worker need no other memory than this. */
    kdr_split_scratch own_scratch;
    uint32_t own_places[2];
    kdr_box own_boxes[2];
    kdr_arena_mark mark;
    bool borrows; /* from the worker's arena */
    bool owned;   /* children get bulk memory of their own, whatever the order */
} kdr_opening;

/* False, and the state says why, when there is no memory. Parallel: the calling thread must be the one that commits. */
bool kdr_opening_begin(kdr_opening *opening, kdr_build_state *state, kdr_build_worker *worker, bool parallel,
                       const kdr_build_task *task);
void kdr_opening_end(kdr_opening *opening);

/* One pass over the references; ranges begin at multiples of KDR_PASS_GRAIN. */
void kdr_opening_pass(const kdr_opening *opening, kdr_range_fn *fn, void *context);

/* References that a plane sends left and right; leaves the counts of each range. */
void kdr_opening_count(const kdr_opening *opening, const kdr_split *split, uint64_t *left, uint64_t *right);

/* Cuts the node at a plane that was counted last: the children get their references, clipped to the plane, their bounds
 * and their share of the budget, and the node is written. Where the split was weighed the plane may move inside a gap.
 * False, and nothing held, when memory or numbers run out. */
bool kdr_opening_divide(kdr_opening *opening, const kdr_split *split, uint64_t left, uint64_t right, bool weighed,
                        kdr_build_task children[2]);

#endif
