#include "tree/wide.h"

#include <math.h>

/* The subtree that becomes one wide node, while it is opened: inner nodes with their axes, members below them. */
typedef struct opening {
    struct {
        uint32_t axis;
        uint32_t side[2]; /* an inner node, or MEMBER | place */
    } inner[KDR_WIDE];
    uint32_t inner_count;
    struct {
        uint32_t node;          /* of the tree */
        float area;             /* negative: a leaf */
        uint32_t parent, which; /* its place below an inner node */
    } member[KDR_WIDE];
    uint32_t member_count;
} opening;

#define MEMBER 0x80000000u
#define NOTHING UINT32_MAX

typedef struct writer {
    const kdr_tree *tree;
    const kdr_shown *shown;
    const kdr_wide_graft *graft; /* NULL: nodes and blocks stay where they are */
    kdr_bulk *bulk;
    kdr_wide_node *out; /* grows; NULL: memory ran out */
    uint32_t count, capacity;
} writer;

static void put_member(const writer *w, opening *o, uint32_t place, uint32_t node, uint32_t parent, uint32_t which) {
    bool leaf = kdr_node_is_leaf(w->tree->nodes[node]);
    o->member[place].node = node;
    o->member[place].area = leaf ? -1 : (float)kdr_box_area(&w->shown[node].box);
    o->member[place].parent = parent;
    o->member[place].which = which;
    if (parent != NOTHING)
        o->inner[parent].side[which] = MEMBER | place;
}

static bool holds_nothing(const writer *w, uint32_t node) {
    kdr_node word = w->tree->nodes[node];
    return kdr_node_is_leaf(word) && w->shown[node].groups == 0;
}

/* Replaces a member by its two children; an empty leaf takes no place. */
static void open_member(const writer *w, opening *o, uint32_t place) {
    uint32_t node = o->member[place].node, parent = o->member[place].parent, which = o->member[place].which;
    kdr_node word = w->tree->nodes[node];
    uint32_t inner = o->inner_count++, left = kdr_node_child(word);
    o->inner[inner].axis = kdr_node_axis(word);
    o->inner[inner].side[0] = o->inner[inner].side[1] = NOTHING;
    if (parent != NOTHING)
        o->inner[parent].side[which] = inner;
    bool free_place = true;
    for (uint32_t side = 0; side < 2; side++) {
        if (holds_nothing(w, left + side))
            continue;
        put_member(w, o, free_place ? place : o->member_count++, left + side, inner, side);
        free_place = false;
    }
    if (free_place) {
        /* Both were empty: close the gap with the last member. */
        uint32_t last = --o->member_count;
        if (place != last)
            put_member(w, o, place, o->member[last].node, o->member[last].parent, o->member[last].which);
    }
}

/* Opens the largest members until there are 16 or only leaves, and no more inner nodes than there is room for. */
static void open_subtree(const writer *w, opening *o, uint32_t root) {
    o->inner_count = 0;
    o->member_count = 1;
    put_member(w, o, 0, root, NOTHING, 0);
    open_member(w, o, 0);
    while (o->member_count < KDR_WIDE && o->inner_count < KDR_WIDE) {
        uint32_t largest = NOTHING;
        float area = -0.5f;
        for (uint32_t i = 0; i < o->member_count; i++) {
            if (o->member[i].area > area) {
                area = o->member[i].area;
                largest = i;
            }
        }
        if (largest == NOTHING)
            return;
        open_member(w, o, largest);
    }
}

static uint32_t members_below(const opening *o, uint32_t at) {
    if (at == NOTHING)
        return 0;
    if (at & MEMBER)
        return 1;
    return members_below(o, o->inner[at].side[0]) + members_below(o, o->inner[at].side[1]);
}

/* Ranks for all eight octants at once: four bits each. Where the ray runs down the axis, the right side comes first. */
static void rank_members(const opening *o, uint32_t at, uint32_t before, uint32_t rank[KDR_WIDE]) {
    static const uint32_t down[3] = {0xf0f0f0f0u, 0xff00ff00u, 0xffff0000u};
    if (at == NOTHING)
        return;
    if (at & MEMBER) {
        rank[at & ~MEMBER] = before;
        return;
    }
    uint32_t left = o->inner[at].side[0], right = o->inner[at].side[1], mask = down[o->inner[at].axis];
    uint32_t left_count = members_below(o, left) * 0x11111111u, right_count = members_below(o, right) * 0x11111111u;
    rank_members(o, left, before + (right_count & mask), rank);
    rank_members(o, right, before + (left_count & ~mask), rank);
}

/* Gives the members their places, the largest box first. */
static void place_members(const writer *w, const opening *o, uint32_t place[KDR_WIDE]) {
    double area[KDR_WIDE];
    for (uint32_t i = 0; i < KDR_WIDE; i++) {
        area[i] = i < o->member_count ? kdr_box_area(&w->shown[o->member[i].node].box) : -1;
        place[i] = i;
        for (uint32_t j = 0; j < i; j++) {
            bool after = area[j] >= area[i];
            place[i] -= !after;
            place[j] += !after;
        }
    }
}

/* Writes the members' places in the order of their ranks; unused places fill up the word. */
static void order_members(const opening *o, const uint32_t place[KDR_WIDE], uint64_t order[8]) {
    uint32_t rank[KDR_WIDE];
    rank_members(o, 0, 0, rank);
    for (uint32_t octant = 0; octant < 8; octant++) {
        order[octant] = 0;
        for (uint32_t i = 0; i < KDR_WIDE; i++) {
            uint32_t at = i < o->member_count ? rank[i] >> 4 * octant & 15 : i;
            order[octant] |= (uint64_t)place[i] << KDR_WIDE_ORDER_SHIFT(at);
        }
    }
}

uint32_t kdr_wide_leaf(kdr_node leaf, uint32_t index, uint32_t shown_groups) {
    uint32_t first = kdr_node_first(leaf), groups = kdr_block_groups(kdr_node_count(leaf));
    if (groups > KDR_WIDE_MAX_GROUPS || first > KDR_WIDE_MAX_BLOCK || kdr_node_is_closed(leaf))
        return KDR_WIDE_LEAF | index << KDR_WIDE_GROUP_BITS;
    return KDR_WIDE_LEAF | first << 2 * KDR_WIDE_GROUP_BITS | groups << KDR_WIDE_GROUP_BITS | shown_groups;
}

static uint32_t leaf_child(const writer *w, uint32_t node) {
    kdr_node leaf = w->tree->nodes[node];
    uint32_t groups = w->shown[node].groups;
    if (!w->graft)
        return kdr_wide_leaf(leaf, node, groups);
    leaf = kdr_node_leaf(kdr_node_count(leaf), kdr_node_first(leaf) + w->graft->first_group);
    return kdr_wide_leaf(leaf, node - 2 + w->graft->first_node, groups);
}

/* Moves the nodes written so far into memory for `capacity`. */
static void change_capacity(writer *w, uint32_t capacity) {
    size_t size = capacity * sizeof(kdr_wide_node);
    kdr_wide_node *more = kdr_bulk_get(w->bulk, &size);
    if (more && w->count > 0)
        memcpy(more, w->out, w->count * sizeof *more);
    kdr_bulk_put(w->bulk, w->out, w->capacity * sizeof *more);
    w->out = more;
    w->capacity = capacity;
}

/* Writes the wide node of a subtree and those below it; recursion is bounded by the depth limit. */
static uint32_t write_node(writer *w, uint32_t root) {
    opening o;
    open_subtree(w, &o, root);
    if (w->out && w->count == w->capacity)
        change_capacity(w, w->capacity * 2);
    if (!w->out)
        return 0;
    uint32_t index = w->count++;
    kdr_wide_node *out = &w->out[index];
    uint32_t place[KDR_WIDE];
    place_members(w, &o, place);
    for (uint32_t i = 0; i < KDR_WIDE; i++) {
        kdr_box box = i < o.member_count ? w->shown[o.member[i].node].box : kdr_box_empty();
        for (int k = 0; k < 3; k++) {
            out->face[2 * k][place[i]] = box.lo[k];
            out->face[2 * k + 1][place[i]] = box.hi[k];
        }
        out->child[place[i]] = KDR_WIDE_LEAF;
    }
    order_members(&o, place, out->order);
    for (uint32_t i = 0; i < o.member_count; i++) {
        bool leaf = o.member[i].area < 0;
        uint32_t child = leaf ? leaf_child(w, o.member[i].node) : write_node(w, o.member[i].node);
        if (!w->out)
            return 0;
        w->out[index].child[place[i]] = child;
    }
    return index;
}

/* Boxes of interior nodes from those of their children, which have higher numbers. */
static void join_boxes(const kdr_tree *tree, kdr_shown *shown) {
    for (uint32_t i = tree->node_count; i-- > 0;) {
        kdr_node node = tree->nodes[i];
        if (kdr_node_is_leaf(node))
            continue;
        shown[i].box = shown[kdr_node_child(node)].box;
        kdr_box_add(&shown[i].box, &shown[kdr_node_child(node) + 1].box);
    }
}

uint32_t kdr_wide_write_graft(const kdr_tree *tree, const kdr_wide_graft *graft, kdr_shown *shown, kdr_wide_node *to) {
    join_boxes(tree, shown);
    writer w = {.tree = tree, .shown = shown, .graft = graft, .out = to, .capacity = UINT32_MAX};
    write_node(&w, 0);
    return w.count;
}

bool kdr_tree_add_wide(kdr_tree *tree, kdr_bulk *bulk, kdr_shown *shown, uint32_t room) {
    if (kdr_node_is_leaf(tree->nodes[0]) || tree->node_count > KDR_WIDE_MAX_LEAF)
        return true;
    for (int k = 0; k < 3; k++) {
        tree->reach[k] = fmaxf(fabsf(tree->bounds.lo[k]), fabsf(tree->bounds.hi[k]));
        if (tree->reach[k] > KDR_WIDE_LARGEST)
            return true;
    }
    join_boxes(tree, shown);

    /* A node opens up to 15 interior ones, and mostly does. */
    uint32_t interiors = (tree->node_count - 2) / 2;
    writer w = {.tree = tree, .shown = shown, .bulk = bulk};
    change_capacity(&w, interiors / 8 + 16);
    if (w.out)
        write_node(&w, 0);
    tree->wide_count = w.count;
    if (w.out && (w.count < w.capacity || room > 0))
        change_capacity(&w, w.count + room);
    tree->wide = w.out;
    tree->wide_bytes = w.out ? w.capacity * sizeof *w.out : 0;
    return w.out != NULL;
}
