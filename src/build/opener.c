/* Opens a closed node on behalf of a query.
 *
 * One thread claims the node, takes a workshop that is free and builds the subtree in it, serially, from the
 * triangles of the node's own block and, where the commit has kept them, their boxes. Then it takes places for nodes,
 * blocks and wide nodes by three atomic additions, writes them there and publishes the node. Whoever finds the node
 * claimed, or no workshop free, asks the node's block instead. Publishing a node before all below it is written would
 * give wrong pictures, so nothing is handed to other threads on the way.
 *
 * Invariant: nothing that a query may be reading is written, but for the claim and the node's word.
 * Cost: that of building a subtree of so many references by one thread; memory comes from the workshop and is kept. */
#include "build/layout.h"
#include "build/order.h"
#include "build/share.h"
#include "build/splitter.h"

#include <math.h>

#define MOST_IN_A_NODE ((1u << 22) - 1) /* nodes or references below one closed node */
#define GAP 1                           /* groups: what is read past a block must not be what another thread writes */

struct kdr_openers {
    kdr_alloc *alloc;
    uint32_t count;
    struct opener {
        _Alignas(128) uint32_t busy;
        kdr_workshop *shop;
    } * all;
};

kdr_openers *kdr_openers_create(kdr_alloc *alloc, kdr_bulk *bulk, uint32_t count) {
    kdr_openers *openers = kdr_alloc_get(alloc, sizeof *openers, 64);
    if (!openers)
        return NULL;
    *openers = (kdr_openers){.alloc = alloc, .count = count};
    openers->all = kdr_alloc_array(alloc, count, sizeof *openers->all, 128);
    bool made = openers->all != NULL;
    for (uint32_t i = 0; openers->all && i < count; i++) {
        openers->all[i] = (struct opener){.shop = kdr_workshop_create(alloc, bulk, 1, MOST_IN_A_NODE)};
        made &= openers->all[i].shop != NULL;
    }
    if (made)
        return openers;
    kdr_openers_destroy(openers);
    return NULL;
}

void kdr_openers_destroy(kdr_openers *openers) {
    if (!openers)
        return;
    for (uint32_t i = 0; openers->all && i < openers->count; i++)
        kdr_workshop_destroy(openers->all[i].shop);
    kdr_alloc_release(openers->alloc, openers->all, openers->count * sizeof *openers->all);
    kdr_alloc_release(openers->alloc, openers, sizeof *openers);
}

static struct opener *take_opener(kdr_openers *openers) {
    for (uint32_t i = 0; i < openers->count; i++)
        if (!__atomic_load_n(&openers->all[i].busy, __ATOMIC_RELAXED) &&
            !__atomic_exchange_n(&openers->all[i].busy, 1, __ATOMIC_ACQUIRE))
            return &openers->all[i];
    return NULL;
}

static void give_opener(struct opener *opener) { __atomic_store_n(&opener->busy, 0, __ATOMIC_RELEASE); }

void kdr_openers_trim(kdr_openers *openers) {
    for (uint32_t i = 0; i < openers->count; i++) {
        if (__atomic_exchange_n(&openers->all[i].busy, 1, __ATOMIC_ACQUIRE))
            continue;
        kdr_workshop_trim(openers->all[i].shop);
        give_opener(&openers->all[i]);
    }
}

/* A closed node's own triangles, numbered as they stand in its block. */
static void corners_of(const void *context, uint32_t primitive, float corners[3][3]) {
    kdr_block_triangle(*(const kdr_block *)context, primitive, corners);
}

static void fill(const void *context, float *blocks, kdr_node leaf, const uint32_t *primitives) {
    const kdr_block *from = context;
    for (uint32_t i = 0; i < kdr_node_count(leaf); i++) {
        float vertices[3][3];
        kdr_block_triangle(*from, primitives[i], vertices);
        kdr_block_set(blocks, leaf, i, (const float(*)[3])vertices, primitives[i]);
    }
    kdr_block_pad(blocks, leaf);
}

/* Gives the triangles of a leaf the numbers that they have in the scene. */
static void rename_primitives(float *blocks, kdr_node leaf, const kdr_block *from) {
    uint32_t length = kdr_block_groups(kdr_node_count(leaf)) * KDR_BLOCK_GROUP;
    kdr_block block = kdr_block_of(blocks, leaf);
    for (uint32_t i = 0; i < length; i++) {
        uint32_t primitive = kdr_block_primitive(block, i);
        if (primitive != UINT32_MAX)
            kdr_block_set_primitive(blocks, leaf, i, kdr_block_primitive(*from, primitive));
    }
}

/* The opening of one node. */
typedef struct opening {
    const kdr_lazy *lazy;
    const kdr_tree *tree;
    const kdr_closed_node *node;
    uint32_t index; /* its number in the tree */
    kdr_workshop *shop;
    kdr_block block; /* its own */
    kdr_tree subtree;
} opening;

/* Where nodes and blocks of the subtree go in the tree. */
typedef struct places {
    kdr_wide_graft graft;
    uint32_t child; /* of the wide tree */
} places;

/* The boxes of the node's triangles, cut to its cell. */
static void cut_boxes(const opening *o, const kdr_references *to) {
    for (uint32_t i = 0; i < to->count; i++) {
        float v[3][3];
        kdr_block_triangle(o->block, i, v);
        for (int k = 0; k < 3; k++) {
            float lo = fminf(fminf(v[0][k], v[1][k]), v[2][k]), hi = fmaxf(fmaxf(v[0][k], v[1][k]), v[2][k]);
            to->lo[k][i] = fmaxf(lo, o->node->cell.lo[k]);
            to->hi[k][i] = fminf(hi, o->node->cell.hi[k]);
        }
    }
}

/* Grows the subtree in the workshop; the number of its root there in *root. False when it cannot be. */
static bool grow(opening *o, kdr_build_state *state, uint32_t *root) {
    kdr_build_worker *worker = &o->shop->workers[0];
    uint32_t count = o->node->count;
    void *memory = kdr_arena_get(&worker->arena, kdr_references_bytes(count));
    float *corners = NULL;
    if (o->lazy->plan.straddle == KDR_STRADDLE_CLIP)
        corners = kdr_arena_get(&worker->arena, (size_t)count * 9 * sizeof(float));
    uint32_t pair;
    if (!memory || (o->lazy->plan.straddle == KDR_STRADDLE_CLIP && !corners) || !kdr_grow_pair(state, worker, &pair))
        return false;
    kdr_references references = kdr_references_in(memory, count);
    if (kdr_keeps_boxes(&o->lazy->plan))
        memcpy(memory, o->lazy->references + o->node->references, kdr_references_bytes(count));
    else
        cut_boxes(o, &references);
    kdr_build_task task = {.references = references,
                           .cell = o->node->cell,
                           .box = o->node->box,
                           .budget = o->node->budget,
                           .node = 2 * pair,
                           .depth = o->node->depth};
    for (uint32_t i = 0; i < count; i++) {
        task.references.primitive[i] = i;
        if (corners)
            corners_of(&o->block, i, (float(*)[3])(corners + (size_t)9 * i));
    }
    state->corners = corners;
    state->budget = task.budget;
    *root = task.node;
    kdr_open_alone(state, worker, &task);
    return !kdr_build_failed(state);
}

/* Takes so much of a room; false if it is not there. */
static bool take_room(uint32_t *taken, uint32_t count, uint32_t room, uint32_t *first) {
    *first = __atomic_load_n(taken, __ATOMIC_RELAXED);
    do {
        if (count > room - *first)
            return false;
    } while (!__atomic_compare_exchange_n(taken, first, *first + count, false, __ATOMIC_RELAXED, __ATOMIC_RELAXED));
    return true;
}

/* Copies the wide nodes of the subtree to their places. */
static bool graft_wide(opening *o, places *p, kdr_shown *shown, kdr_wide_node *wide) {
    kdr_closed *closed = o->tree->closed;
    uint32_t count = kdr_wide_write_graft(&o->subtree, &p->graft, shown, wide), first;
    if (!take_room(&closed->wide_count, count, closed->wide_room, &first))
        return false;
    first += o->tree->wide_count;
    for (uint32_t i = 0; i < count; i++) {
        for (uint32_t k = 0; k < KDR_WIDE; k++)
            if (!(wide[i].child[k] & KDR_WIDE_LEAF))
                wide[i].child[k] += first;
        o->tree->wide[first + i] = wide[i];
    }
    p->child = first;
    return true;
}

/* Lays the subtree out in the tree, all but its root, whose word is *word then. False when there is no room. */
static bool lay_out(opening *o, const kdr_build_state *state, uint32_t root, places *p, kdr_node *word) {
    const kdr_build_worker *worker = &o->shop->workers[0];
    kdr_closed *closed = o->tree->closed;
    uint32_t pairs = (uint32_t)worker->interiors, nodes = 2 + 2 * pairs, pair, group;
    size_t node_bytes = (nodes * sizeof(kdr_node) + 63) / 64 * 64;
    size_t shown_bytes = (nodes * sizeof(kdr_shown) + 63) / 64 * 64, wide_bytes = pairs * sizeof(kdr_wide_node);
    size_t job_bytes = (worker->leaves * sizeof(kdr_leaf_job) + 63) / 64 * 64;
    if (!kdr_buffer_reserve(o->shop->alloc, &o->shop->layout,
                            wide_bytes + node_bytes + shown_bytes + job_bytes + o->node->count) ||
        !take_room(&closed->pair_count, pairs, closed->pair_room, &pair) ||
        !take_room(&closed->group_count, (uint32_t)worker->leaf_groups + GAP, closed->group_room, &group))
        return false;

    /* Number the nodes from 0, write the blocks to their places. */
    char *at = o->shop->layout.memory;
    kdr_wide_node *wide = (kdr_wide_node *)at;
    at += wide_bytes;
    o->subtree = (kdr_tree){.nodes = (kdr_node *)at, .node_count = nodes, .bounds = o->node->cell};
    at += node_bytes;
    kdr_shown *shown = (kdr_shown *)at;
    at += shown_bytes;
    kdr_numbering n = {.jobs = (kdr_leaf_job *)at, .shown = shown};
    at += job_bytes;
    uint8_t *whole = memset(at, 0, o->node->count);
    kdr_number_nodes(o->shop, root, &o->subtree, &n);
    p->graft = (kdr_wide_graft){.root = o->index,
                                .first_node = closed->committed_count + 2 * pair,
                                .first_group = closed->committed_groups + GAP + group};
    float *blocks = o->tree->blocks + (size_t)p->graft.first_group * (KDR_BLOCK_GROUP_BYTES / sizeof(float));
    for (uint64_t i = 0; i < n.job_count; i++) {
        const kdr_leaf_job *job = &n.jobs[i];
        fill(&o->block, blocks, job->leaf, job->ids);
        state->unsplit->claim(blocks, job->leaf, &job->cell, whole, &shown[job->node]);
    }
    for (uint64_t i = 0; i < n.job_count; i++) {
        const kdr_leaf_job *job = &n.jobs[i];
        state->unsplit->sort(blocks, job->leaf, &job->cell, whole, &shown[job->node]);
        rename_primitives(blocks, job->leaf, &o->block);
    }
    if (o->tree->wide && !graft_wide(o, p, shown, wide))
        return false;

    /* Nodes but the root, with the numbers that they have in the tree. */
    for (uint32_t i = 0; i < nodes; i++) {
        kdr_node node = o->subtree.nodes[i];
        if (kdr_node_is_leaf(node))
            node = kdr_node_leaf(kdr_node_count(node), kdr_node_first(node) + p->graft.first_group);
        else
            node = kdr_node_interior(kdr_node_axis(node), kdr_node_plane(node),
                                     (kdr_node_child(node) - 2 + p->graft.first_node) / 2);
        if (i == 0)
            *word = node;
        else if (i > 1)
            o->tree->nodes[p->graft.first_node + i - 2] = node;
    }
    return true;
}

/* Builds what is below the node; its new word in *word. False: it stays closed. */
static bool open_node(opening *o, kdr_node closed_word, kdr_node *word, uint32_t *child) {
    static const kdr_crew alone = {.worker_count = 1};
    const kdr_lazy *lazy = o->lazy;
    kdr_input input = {.context = &o->block, .count = o->node->count, .corners = corners_of, .fill = fill};
    kdr_build_state state = {.shop = o->shop,
                             .crew = &alone,
                             .kernels = lazy->kernels,
                             .unsplit = lazy->unsplit,
                             .input = &input,
                             .splitter = kdr_splitter_for(lazy->plan.split),
                             .order = &kdr_order_depth_first,
                             .share = &kdr_share_serial,
                             .plan = lazy->plan};
    places p = {0};
    uint32_t root;
    kdr_workshop_start(o->shop);
    kdr_arena_mark mark = kdr_arena_save(&o->shop->workers[0].arena);
    bool grown = grow(o, &state, &root);
    if (grown && o->shop->workers[0].interiors == 0) {
        *word = closed_word & ~KDR_NODE_CLOSED;
        *child = 0;
    } else if (grown) {
        grown = lay_out(o, &state, root, &p, word);
        *child = p.child;
    }
    kdr_arena_restore(&o->shop->workers[0].arena, mark);
    return grown;
}

kdr_node kdr_lazy_open(kdr_closed *closed, const kdr_tree *tree, uint32_t index) {
    kdr_lazy *lazy = (kdr_lazy *)closed;
    uint8_t idle = KDR_CLOSED_IDLE;
    if (!__atomic_compare_exchange_n(&closed->state[index], &idle, KDR_CLOSED_OPENING, false, __ATOMIC_ACQUIRE,
                                     __ATOMIC_RELAXED))
        return __atomic_load_n(&tree->nodes[index], __ATOMIC_ACQUIRE);
    struct opener *opener = take_opener(lazy->openers);
    if (!opener) {
        __atomic_store_n(&closed->state[index], KDR_CLOSED_IDLE, __ATOMIC_RELEASE);
        return closed->committed[index];
    }
    kdr_node committed = closed->committed[index], word = committed;
    opening o = {.lazy = lazy,
                 .tree = tree,
                 .node = &lazy->nodes[lazy->number[index]],
                 .index = index,
                 .shop = opener->shop,
                 .block = kdr_block_of(tree->blocks, committed)};
    uint32_t child = 0;
    bool opened = open_node(&o, committed, &word, &child);
    if (opened) {
        __atomic_store_n(&closed->child[index], child, __ATOMIC_RELAXED);
        __atomic_store_n(&tree->nodes[index], word, __ATOMIC_RELEASE);
        __atomic_fetch_add(&closed->opened_count, 1, __ATOMIC_RELAXED);
    } else {
        __atomic_store_n(&closed->state[index], KDR_CLOSED_FOR_GOOD, __ATOMIC_RELEASE);
    }
    give_opener(opener);
    return opened ? word : committed;
}
