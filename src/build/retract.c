/* Splits that did not pay are taken back.
 *
 * A plane is chosen as if its two sides became leaves. Once they are subtrees, their true cost is known: from the
 * leaves up, a subtree that costs no less than one leaf of all its primitives becomes that leaf. Only what could be a
 * leaf at all is looked at: subtrees of few primitives. Areas are those by which the planes were weighed.
 *
 * Sources: A. Soupikov, M. Shevtsov, A. Kapustin, "Improving Kd-tree Quality at a Reasonable Construction Cost", 2008;
 * W. Jakob, "Mitsuba renderer", 2010, for retraction as a rule of a builder.
 * Cost: one walk over the nodes by the committing thread, and a merge of short ascending lists at each small one. */
#include "build/work.h"

#define MOST 64 /* primitives of a leaf that a subtree may become */

typedef struct retracting {
    kdr_build_state *state;
    kdr_build_worker *worker;
} retracting;

/* What is known of a subtree. */
typedef struct subtree {
    double cost;
    kdr_box box;    /* of what lies in it */
    uint32_t count; /* of its primitives, ascending in ids; MOST + 1: more */
    uint32_t ids[MOST];
} subtree;

static void merge(const subtree *a, const subtree *b, subtree *out) {
    out->count = MOST + 1;
    if (a->count > MOST || b->count > MOST)
        return;
    uint32_t i = 0, j = 0, count = 0;
    while (i < a->count || j < b->count) {
        if (count == MOST)
            return;
        bool both = i < a->count && j < b->count && a->ids[i] == b->ids[j];
        bool first = j == b->count || (i < a->count && a->ids[i] <= b->ids[j]);
        out->ids[count++] = first ? a->ids[i] : b->ids[j];
        i += first;
        j += !first || both;
    }
    out->count = count;
}

/* Makes the node a leaf of its subtree's primitives. */
static bool become_leaf(const retracting *r, uint32_t node, const subtree *all) {
    uint32_t *ids = kdr_grow_leaf(r->state, r->worker, node, all->count);
    if (ids)
        memcpy(ids, all->ids, all->count * sizeof *ids);
    return ids != NULL;
}

/* Nodes below `node` are no longer part of the tree. */
static void forget(const retracting *r, uint32_t node) {
    kdr_node word = *kdr_growing_node(r->state->shop, node);
    if (kdr_node_is_leaf(word)) {
        r->worker->leaves--;
        r->worker->leaf_groups -= kdr_block_groups(kdr_node_count(word));
        return;
    }
    r->worker->interiors--;
    for (uint32_t side = 0; side < 2; side++)
        forget(r, kdr_node_child(word) + side);
}

/* The area by which planes of this plan are weighed. */
static double area_of(const retracting *r, const kdr_box *cell, const kdr_box *box) {
    double area = kdr_box_area(cell);
    return area + (double)r->state->plan.box_weight * (kdr_box_area(box) - area);
}

/* The bounds of a leaf's primitives inside its cell. */
static kdr_box bounds_of(const retracting *r, const kdr_box *cell, const uint32_t *ids, uint32_t count) {
    const kdr_input *input = r->state->input;
    if (r->state->plan.box_weight == 0 || !input->corners)
        return *cell;
    kdr_box box = kdr_box_empty();
    for (uint32_t i = 0; i < count; i++) {
        float corners[3][3];
        input->corners(input->context, ids[i], corners);
        for (int k = 0; k < 3; k++) {
            float lo = fminf(fminf(corners[0][k], corners[1][k]), corners[2][k]);
            float hi = fmaxf(fmaxf(corners[0][k], corners[1][k]), corners[2][k]);
            box.lo[k] = fminf(box.lo[k], fmaxf(lo, cell->lo[k]));
            box.hi[k] = fmaxf(box.hi[k], fminf(hi, cell->hi[k]));
        }
    }
    return box;
}

/* Recursion is bounded by the depth limit. */
static void retract(const retracting *r, uint32_t node, const kdr_box *cell, subtree *out) {
    const kdr_plan *plan = &r->state->plan;
    kdr_workshop *shop = r->state->shop;
    kdr_node word = *kdr_growing_node(shop, node);
    if (kdr_node_is_leaf(word)) {
        uint32_t count = kdr_node_count(word);
        const uint32_t *ids = count > 0 ? kdr_growing_ids(shop, kdr_node_first(word)) : NULL;
        out->box = bounds_of(r, cell, ids, count);
        out->cost = area_of(r, cell, &out->box) * (double)kdr_plan_leaf_cost(plan, count);
        out->count = count <= MOST ? count : MOST + 1;
        if (count > 0 && count <= MOST)
            memcpy(out->ids, ids, count * sizeof *out->ids);
        return;
    }
    subtree sides[2];
    for (uint32_t side = 0; side < 2; side++) {
        kdr_box part = *cell;
        *(side == 0 ? &part.hi[kdr_node_axis(word)] : &part.lo[kdr_node_axis(word)]) = kdr_node_plane(word);
        retract(r, kdr_node_child(word) + side, &part, &sides[side]);
        if (kdr_build_failed(r->state))
            return;
    }
    out->box = sides[0].box;
    kdr_box_add(&out->box, &sides[1].box);
    double area = area_of(r, cell, &out->box);
    out->cost = area * (double)plan->cost_traversal + sides[0].cost + sides[1].cost;
    merge(&sides[0], &sides[1], out);
    double as_leaf = area * (double)kdr_plan_leaf_cost(plan, out->count);
    if (out->count > MOST || out->count > plan->leaf_limit || as_leaf > out->cost)
        return;
    forget(r, node);
    if (become_leaf(r, node, out))
        out->cost = as_leaf;
}

void kdr_build_retract(kdr_build_state *state, const kdr_box *bounds) {
    retracting r = {state, &state->shop->workers[0]};
    subtree whole;
    retract(&r, 0, bounds, &whole);
}
