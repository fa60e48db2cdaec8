#include "tree/verify.h"

#include "geometry/clip.h"
#include "tree/boxed.h"
#include "tree/closed.h"
#include "tree/unsplit.h"
#include "tree/walk.h"

/* Invariants
 *   every plane lies within its cell; axes, indices and blocks are in range; no path is longer than the depth limit
 *   a leaf's primitives are in ascending order, or in two runs of it (unsplit.h), and each one's box meets its cell
 *   a primitive is in every leaf whose cell's inside its box meets, or, in a tree of clipped triangles, that it meets
 * itself; one that lies flat in a split plane may be on either side of it, but is on one every primitive of the tree is
 * in some leaf: their number is that of the tree */
typedef struct verifying {
    const char *wrong;
    uint64_t primitives;
} verifying;

static bool fail(verifying *v, const char *sentence) {
    v->wrong = sentence;
    return false;
}

/* A primitive that must be found. */
typedef struct wanted {
    const kdr_tree *tree;
    uint32_t primitive;
    float corners[3][3];
    kdr_box box;
    uint32_t first; /* leaf that holds it; UINT32_MAX: none yet */
} wanted;

static wanted want(const kdr_tree *tree, kdr_node leaf, uint32_t i) {
    wanted w = {.tree = tree,
                .primitive = kdr_leaf_primitive(tree, leaf, i),
                .box = kdr_leaf_box(tree, leaf, i),
                .first = UINT32_MAX};
    if (tree->clipped)
        kdr_block_triangle(kdr_block_of(tree->blocks, leaf), i, w.corners);
    return w;
}

/* True if the triangle reaches further into the cell than any margin of clipping. */
static bool surely_meets(const wanted *w, const kdr_box *cell) {
    kdr_box inner, part;
    float largest = 0;
    for (int k = 0; k < 3; k++) {
        largest = fmaxf(largest, fmaxf(fabsf(cell->lo[k]), fabsf(cell->hi[k])));
        largest = fmaxf(largest, fmaxf(fabsf(w->box.lo[k]), fabsf(w->box.hi[k])));
    }
    for (int k = 0; k < 3; k++) {
        inner.lo[k] = nextafterf(cell->lo[k] + largest * 0x1p-14f, INFINITY);
        inner.hi[k] = nextafterf(cell->hi[k] - largest * 0x1p-14f, -INFINITY);
    }
    return !kdr_box_is_empty(&inner) && kdr_triangle_clip((const float(*)[3])w->corners, &inner, &part);
}

/* Looks at all of a small leaf, whose primitives may be two runs in ascending order; searches a large one. */
static bool leaf_holds(const kdr_tree *tree, kdr_node leaf, uint32_t primitive) {
    uint32_t lo = 0, hi = kdr_node_count(leaf);
    while (hi > KDR_UNSPLIT_LIMIT && lo < hi) {
        uint32_t middle = lo + (hi - lo) / 2;
        if (kdr_leaf_primitive(tree, leaf, middle) < primitive)
            lo = middle + 1;
        else
            hi = middle;
    }
    while (lo < hi && kdr_leaf_primitive(tree, leaf, lo) != primitive)
        lo++;
    return lo < kdr_node_count(leaf) && kdr_leaf_primitive(tree, leaf, lo) == primitive;
}

/* True if the primitive is wherever it must be below this node. */
static bool reaches(wanted *w, uint32_t index, const kdr_box *cell) {
    kdr_node node = kdr_tree_node_settled(w->tree, index);
    if (kdr_node_is_leaf(node)) {
        if (!leaf_holds(w->tree, node, w->primitive))
            return w->tree->clipped && !surely_meets(w, cell);
        if (w->first == UINT32_MAX)
            w->first = index;
        return true;
    }
    uint32_t axis = kdr_node_axis(node), left = kdr_node_child(node);
    float plane = kdr_node_plane(node);
    kdr_box below = *cell, above = *cell;
    below.hi[axis] = above.lo[axis] = plane;
    if (w->box.lo[axis] == plane && w->box.hi[axis] == plane) {
        bool in_left = reaches(w, left, &below);
        return reaches(w, left + 1, &above) || in_left;
    }
    if (w->box.lo[axis] < plane && !reaches(w, left, &below))
        return false;
    return !(w->box.hi[axis] > plane) || reaches(w, left + 1, &above);
}

static bool verify_leaf(const kdr_tree *tree, const kdr_walk *at, verifying *v) {
    kdr_node node = tree->nodes[at->node];
    uint32_t count = kdr_node_count(node);
    if (count > 0 && (uint64_t)kdr_node_first(node) + kdr_block_groups(count) > tree->group_count)
        return fail(v, "a leaf's block lies outside the blocks");
    int runs = !tree->boxed && count <= KDR_UNSPLIT_LIMIT ? 2 : 1;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t primitive = kdr_leaf_primitive(tree, node, i);
        if (i > 0 && primitive <= kdr_leaf_primitive(tree, node, i - 1) && --runs == 0)
            return fail(v, "the primitives of a leaf are not in ascending order");
        wanted w = want(tree, node, i);
        for (int k = 0; k < 3; k++)
            if (!(w.box.lo[k] <= at->cell.hi[k] && w.box.hi[k] >= at->cell.lo[k]))
                return fail(v, "a leaf holds a primitive whose box does not meet its cell");
        if (!reaches(&w, 0, &tree->bounds))
            return fail(v, "a primitive is missing from a leaf whose cell it meets");
        v->primitives += w.first == at->node;
    }
    return true;
}

static bool verify_node(const kdr_tree *tree, const kdr_walk *at, void *context) {
    verifying *v = context;
    kdr_node node = tree->nodes[at->node];
    if (at->depth > tree->depth_limit)
        return fail(v, "a path is longer than the depth limit");
    if (kdr_node_is_leaf(node))
        return verify_leaf(tree, at, v);
    uint32_t axis = kdr_node_axis(node), child = kdr_node_child(node);
    float plane = kdr_node_plane(node);
    if (!(plane >= at->cell.lo[axis] && plane <= at->cell.hi[axis]))
        return fail(v, "a split plane lies outside its cell");
    if (child < 2 || child + 1 >= tree->node_count)
        return fail(v, "a child's index is out of range");
    return true;
}

const char *kdr_tree_verify(const kdr_tree *tree) {
    verifying v = {0};
    if (!kdr_tree_walk(tree, verify_node, &v))
        return v.wrong ? v.wrong : "the walk left the tree";
    if (v.primitives != tree->primitive_count)
        return "the leaves do not hold every primitive";
    return NULL;
}
