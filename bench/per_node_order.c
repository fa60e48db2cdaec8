/* Memory node by node: what the pools of the builder save.
 *
 * The hinge writes its nodes into the pool whatever the order is, so the pair that is asked for here stands beside
 * them, written once, and is given back when the tree is done. A child's references are given back as soon as the child
 * is opened. Regions of a share come in the builder's own memory, which goes back to where it came from. */
#include "per_node_order.h"

#include "build/share.h"

#include <stdlib.h>

#define ALIGNMENT 64

typedef struct node_pair {
    struct node_pair *next;
    kdr_node nodes[2];
} node_pair;

/* What one worker holds. */
typedef struct worker_memory {
    _Alignas(128) node_pair *pairs;
    void *given[2]; /* to the children of the node being opened */
    uint32_t given_count;
} worker_memory;

typedef struct per_node {
    kdr_order order; /* first: the builder knows no more */
    worker_memory workers[KDR_MAX_WORKERS];
} per_node;

static worker_memory *memory_of(const kdr_build_state *state, const kdr_build_worker *worker) {
    return &((per_node *)(uintptr_t)state->order)->workers[worker - state->shop->workers];
}

/* Aligned by hand: the allocator's own aligned form is slower than its plain one, and would be held against it. */
static void *get_aligned(size_t size) {
    char *block = malloc(size + sizeof block + ALIGNMENT);
    if (!block)
        return NULL;
    char *memory = block + sizeof block;
    memory += -(uintptr_t)memory % ALIGNMENT;
    memcpy(memory - sizeof block, &block, sizeof block);
    return memory;
}

static void free_aligned(void *memory) {
    char *block = NULL;
    if (memory)
        memcpy(&block, (char *)memory - sizeof block, sizeof block);
    free(block);
}

static void *give(kdr_build_state *state, kdr_build_worker *worker, uint32_t count, kdr_build_task *child) {
    (void)count;
    worker_memory *m = memory_of(state, worker);
    void *memory = get_aligned(child->memory_size);
    if (memory)
        m->given[m->given_count++] = memory;
    return memory;
}

static void add_pair(kdr_build_state *state, worker_memory *m, const kdr_build_task children[2]) {
    node_pair *pair = malloc(sizeof *pair);
    if (!pair) {
        kdr_build_fail(state, KDR_ERROR_OUT_OF_MEMORY);
        return;
    }
    pair->next = m->pairs;
    for (int i = 0; i < 2; i++)
        pair->nodes[i] = kdr_node_leaf(children[i].references.count, 0);
    m->pairs = pair;
}

static void open_all(kdr_build_state *state, uint32_t worker, kdr_build_task *task) {
    kdr_build_worker *w = &state->shop->workers[worker];
    worker_memory *m = memory_of(state, w);
    kdr_build_task children[2];
    void *own = task->memory ? NULL : task->references.lo[0];
    m->given_count = 0;
    kdr_opened opened = kdr_expand(state, w, false, task, children);
    kdr_bulk_put(state->shop->bulk, task->memory, task->memory_size);
    free_aligned(own);
    if (opened == KDR_OPENED_PAIR) {
        add_pair(state, m, children);
        for (int i = 0; i < 2; i++)
            open_all(state, worker, &children[i]);
        return;
    }
    for (uint32_t i = 0; i < m->given_count; i++)
        free_aligned(m->given[i]);
}

static void run_task(kdr_pool *pool, void *task, uint32_t worker, void *context) {
    (void)pool;
    kdr_build_task copy;
    memcpy(&copy, task, sizeof copy);
    open_all(context, worker, &copy);
}

static kdr_status run(kdr_build_state *state, const kdr_build_task *tasks, uint32_t count) {
    kdr_status status = kdr_pool_run(state->crew, state->shop->alloc, tasks, count, run_task, state);
    if (status != KDR_OK)
        for (uint32_t i = 0; i < count; i++)
            kdr_bulk_put(state->shop->bulk, tasks[i].memory, tasks[i].memory_size);
    for (uint32_t i = 0; i < state->shop->worker_count; i++) {
        worker_memory *m = memory_of(state, &state->shop->workers[i]);
        for (node_pair *pair = m->pairs, *next; pair; pair = next) {
            next = pair->next;
            free(pair);
        }
        m->pairs = NULL;
    }
    return status != KDR_OK ? status : (kdr_status)atomic_load(&state->status);
}

const kdr_order *kdr_per_node_order(void) {
    static per_node order = {.order = {.run = run, .give = give}};
    return &order.order;
}
