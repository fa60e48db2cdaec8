/* State of one build, shared by the files of this room. */
#ifndef KDR_BUILD_WORK_H
#define KDR_BUILD_WORK_H

#include "base/arena.h"
#include "base/bulk.h"
#include "build/builder.h"
#include "build/chunks.h"
#include "build/kernels.h"
#include "tree/unsplit.h"

#define KDR_PAIRS_PER_CHUNK 16384
#define KDR_IDS_PER_CHUNK 65536

/* Nodes of at most this many references live in one worker's arena and second-level cache. */
#define KDR_LOCAL_LIMIT 8192

/* What a worker has for itself. Aligned so that no two share a cache line. */
typedef struct kdr_build_worker {
    _Alignas(128) kdr_arena arena;
    kdr_buffer sorting;              /* scratch of a sort of events */
    kdr_arena levels[2];             /* breadth first: references of this level and of the next; depth first: [0] has
                                      * those of nodes that stay closed, until they are laid out */
    uint32_t pair, pair_end;         /* pairs of the chunk it is filling */
    uint32_t id, id_end;             /* the same for leaf ids */
    uint64_t interiors, leaf_groups; /* made so far */
    uint64_t leaves;
    struct kdr_closing *closings; /* the last one it made */
    uint64_t done;                /* budget of what it finished and has not told yet */
} kdr_build_worker;

struct kdr_workshop {
    kdr_alloc *alloc;
    uint32_t worker_count;
    kdr_build_worker *workers;
    kdr_bulk *bulk;              /* the device's */
    kdr_chunks pairs;            /* of nodes, while the tree grows */
    kdr_chunks ids;              /* of the leaves' primitives */
    kdr_buffer layout;           /* for the final pass */
    kdr_buffer levels[2];        /* tasks of this level and of the next, breadth first */
    struct kdr_openers *openers; /* of closed nodes; NULL before the first build that leaves any */
};

/* A node that is still to be opened. */
typedef struct kdr_build_task {
    kdr_references references;
    void *events; /* what the splitter keeps about the references, behind them; NULL: nothing yet */
    void *memory; /* bulk memory that holds both; NULL: they are in a worker's arena */
    size_t memory_size;
    kdr_box cell;
    kdr_box box;     /* bounds of the references, inside the cell */
    uint64_t budget; /* references that the leaves below may have together */
    uint32_t node;   /* its number among the growing nodes */
    uint32_t depth;
} kdr_build_task;

typedef struct kdr_build_state {
    kdr_workshop *shop;
    const kdr_crew *crew;
    const kdr_build_kernels *kernels;
    const kdr_unsplit *unsplit;
    const kdr_input *input;
    const struct kdr_splitter *splitter;
    const struct kdr_order *order;
    const struct kdr_share *share;
    kdr_plan plan;
    const float *corners; /* nine a primitive, where triangles are cut as references are divided; otherwise NULL */
    size_t corners_size;
    uint32_t level;  /* breadth first: 0 or 1, by turns */
    uint64_t budget; /* of the root */
    _Atomic uint32_t closing_count;
    _Atomic uint64_t done; /* of it, finished and told */
    _Atomic int status;    /* the first failure; workers stop when it is not KDR_OK */
} kdr_build_state;

static inline bool kdr_build_failed(const kdr_build_state *state) {
    return atomic_load_explicit(&state->status, memory_order_relaxed) != KDR_OK;
}

static inline void kdr_build_fail(kdr_build_state *state, kdr_status status) {
    int none = KDR_OK;
    atomic_compare_exchange_strong(&state->status, &none, (int)status);
}

static inline kdr_node *kdr_growing_node(const kdr_workshop *shop, uint32_t index) {
    kdr_node *chunk = shop->pairs.table[index / (2 * KDR_PAIRS_PER_CHUNK)];
    return &chunk[index % (2 * KDR_PAIRS_PER_CHUNK)];
}

static inline uint32_t *kdr_growing_ids(const kdr_workshop *shop, uint32_t first) {
    uint32_t *chunk = shop->ids.table[first / KDR_IDS_PER_CHUNK];
    return &chunk[first % KDR_IDS_PER_CHUNK];
}

/* ---- report.c: tells who listens how far the build is; if he cancels it, the state has failed.
 * kdr_build_finished: a task was; kdr_build_report: so much of the whole build is done, 0 to 1. */
void kdr_build_finished(kdr_build_state *state, kdr_build_worker *worker, const kdr_build_task *task);
void kdr_build_report(kdr_build_state *state, double part);

/* ---- builder.c: forgets the last build; memory is kept. */
void kdr_workshop_start(kdr_workshop *shop);

/* While nodes are opened. */
void kdr_build_report_opening(kdr_build_state *state);

/* Parts of a build that are done when nodes begin to be opened, when all are, and within the layout. */
#define KDR_BUILD_GATHERED 0.05
#define KDR_BUILD_OPENED 0.85
#define KDR_BUILD_NUMBERED 0.9
#define KDR_BUILD_FILLED 0.95

/* ---- gather.c: the root's references. On failure nothing is held. */
kdr_status kdr_build_gather(kdr_build_state *state, kdr_build_task *root, kdr_input_counts *counts);

/* ---- straddle.c: settles what the plan leaves open about triangles on both sides of planes and the limit of
 * references, and gets the corners that divisions need. */
kdr_status kdr_build_settle_straddle(kdr_build_state *state, const kdr_references *root);
void kdr_build_release_corners(kdr_build_state *state);

/* ---- grow.c: the only writer of nodes. False, and the state says why, when memory or numbers run out. */
bool kdr_grow_pair(kdr_build_state *state, kdr_build_worker *worker, uint32_t *pair);
bool kdr_grow_interior(kdr_build_state *state, kdr_build_worker *worker, uint32_t node, uint32_t axis, float plane,
                       uint32_t *pair);
/* Makes the node a leaf of `count` primitives and says where to write their numbers. */
uint32_t *kdr_grow_leaf(kdr_build_state *state, kdr_build_worker *worker, uint32_t node, uint32_t count);

/* ---- expand.c: opens one task into a leaf or two tasks. */
typedef enum kdr_opened { KDR_OPENED_LEAF, KDR_OPENED_PAIR, KDR_OPENED_FAILED } kdr_opened;
/* `parallel`: the calling thread lets all workers help; it must then be the one that commits. The task's memory may be
 * exchanged for other memory; giving it back is the caller's. */
kdr_opened kdr_expand(kdr_build_state *state, kdr_build_worker *worker, bool parallel, kdr_build_task *task,
                      kdr_build_task children[2]);

/* ---- masks.c: a task of at most KDR_MASK_LIMIT references becomes a whole subtree. */
void kdr_expand_masked(kdr_build_state *state, kdr_build_worker *worker, const kdr_build_task *task);

/* ---- retract.c: makes leaves of subtrees that cost no less. Failure is left in the state. */
void kdr_build_retract(kdr_build_state *state, const kdr_box *bounds);

/* ---- order_depth_first.c: opens one task of at most KDR_LOCAL_LIMIT references by the calling thread alone. */
void kdr_open_alone(kdr_build_state *state, kdr_build_worker *worker, const kdr_build_task *task);

/* ---- layout.c: the finished tree in canonical order. */
kdr_status kdr_build_layout(kdr_build_state *state, kdr_tree *tree);

#endif
