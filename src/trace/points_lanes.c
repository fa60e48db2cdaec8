/* Searches about a point: the closest primitive, and all within a distance (SPEC T11).
 *
 * Source: J. H. Friedman, J. L. Bentley, R. A. Finkel, "An Algorithm for Finding Best Matches in Logarithmic Expected
 * Time", 1977, for the search down to the query point's leaf and back through the cells that are near enough. That
 * primitives lie in several leaves, and who reports them, is our own.
 *
 * Invariant: a cell is left out only if its square is more than the one searched for. The closest point of a primitive
 * lies in its box, and the primitive is in every leaf whose cell holds points of its box, so some leaf that holds both
 * has a square that is no larger than the primitive's, in the numbers as computed: see triangle_point.h.
 * Cost: a step a node; for each vector of a leaf's primitives some 20 operations, and the exact point of those whose
 * box is near enough. */
#include "trace/points.h"

#include "trace/near_lanes.h"
#include "tree/closed.h"

/* Makes *nearest the closest of itself and triangle i of a block. */
static __attribute__((noinline)) void take(kdr_block block, size_t i, const float query[3], kdr_nearest *nearest,
                                           near_limit *limit) {
    uint32_t primitive = kdr_block_primitive(block, i);
    if (primitive == UINT32_MAX || primitive == nearest->primitive)
        return;
    float corner[3][3];
    kdr_block_triangle(block, i, corner);
    kdr_surface_point point = kdr_triangle_point(query, (const float(*)[3])corner);
    if (point.square < nearest->point.square ||
        (point.square == nearest->point.square && primitive < nearest->primitive)) {
        *nearest = (kdr_nearest){point, primitive};
        near_limit_set(limit, point.square);
    }
}

/* The same for all of a block: one that is left alone, or those of several that planes leave, the nearest first. */
KDR_LANES_INLINE void block_closest(kdr_block block, const float query[3], kdr_nearest *nearest, near_limit *limit) {
    for (size_t first = 0; first < block.shown; first += KDR_LANES) {
        kdr_lane_bits left = near_boxes(block, first, NULL, query, limit);
        if (!limit->has_plane || (left & (left - 1)) == 0) {
            for (; left; left &= left - 1)
                take(block, first + (uint32_t)__builtin_ctz(left), query, nearest, limit);
            continue;
        }
        kdr_lanes_f squares = near_planes(block, first, query);
        float square[KDR_LANES];
        kdr_lanes_store(square, squares);
        while (left &= near_within(squares, limit)) {
            uint32_t lane = (uint32_t)__builtin_ctz(left);
            for (kdr_lane_bits others = left & (left - 1); others; others &= others - 1) {
                uint32_t other = (uint32_t)__builtin_ctz(others);
                lane = square[other] < square[lane] ? other : lane;
            }
            left ^= 1u << lane;
            take(block, first + lane, query, nearest, limit);
        }
    }
}

/* Cells that wait, with their squares axis by axis. */
typedef struct waiting_cell {
    uint32_t node;
    double square[3];
} waiting_cell;

/* Through the cells of the tree. */
KDR_LANES_INLINE void cells_closest(const kdr_tree *tree, const float query[3], kdr_nearest *nearest) {
    waiting_cell stack[KDR_MAX_DEPTH + 1], at = {.node = 0};
    uint32_t top = 0;
    near_limit limit;
    near_limit_begin(&limit, tree, query, nearest->point.square);
    for (int k = 0; k < 3; k++)
        at.square[k] = kdr_interval_square(query[k], tree->bounds.lo[k], tree->bounds.hi[k]);
    for (;;) {
        if ((at.square[0] + at.square[1]) + at.square[2] <= nearest->point.square) {
            /* Go down to a leaf, on the query point's side of each plane; the other side waits. */
            kdr_node node = kdr_tree_node(tree, at.node);
            while (!kdr_node_is_leaf(node)) {
                uint32_t axis = kdr_node_axis(node);
                double beyond = (double)query[axis] - kdr_node_plane(node);
                at.node = kdr_node_child(node) + (beyond >= 0);
                stack[top] = at;
                stack[top].node ^= 1;
                stack[top++].square[axis] = beyond * beyond;
                node = kdr_tree_node(tree, at.node);
            }
            block_closest(kdr_block_of(tree->blocks, node), query, nearest, &limit);
        }
        if (top == 0)
            return;
        at = stack[--top];
    }
}

/* Children of wide nodes that wait, the nearest on top but for those of nodes above. */
typedef struct waiting_child {
    float square; /* of the distance to its box, about */
    uint32_t child;
} waiting_child;

/* Puts the children of a node that are near enough on the stack; returns its new length. */
KDR_LANES_INLINE uint32_t open_wide(const kdr_wide_node *node, const float query[3], float limit, waiting_child *stack,
                                    uint32_t top) {
    float squares[KDR_WIDE];
    uint32_t near = 0, bottom = top;
    for (uint32_t i = 0; i < KDR_WIDE; i += KDR_LANES) {
        kdr_lanes_f square = kdr_lanes_all(0), lo, hi;
        for (size_t k = 0; k < 3; k++) {
            lo = kdr_lanes_load(node->face[2 * k] + i);
            hi = kdr_lanes_load(node->face[2 * k + 1] + i);
            square = near_add_axis(square, lo, hi, query[k]);
        }
        kdr_lanes_store(squares + i, square);
        near |= (KDR_LANE_BITS_ALL & ~(kdr_lanes_less(kdr_lanes_all(limit), square) | kdr_lanes_less(hi, lo))) << i;
    }
    for (; near; near &= near - 1) {
        uint32_t place = (uint32_t)__builtin_ctz(near), at = top++;
        for (; at > bottom && stack[at - 1].square < squares[place]; at--)
            stack[at] = stack[at - 1];
        stack[at] = (waiting_child){squares[place], node->child[place]};
    }
    return top;
}

/* Through the boxes of the wide tree, which are tight. */
KDR_LANES_INLINE void boxes_closest(const kdr_tree *tree, const float query[3], kdr_nearest *nearest) {
    waiting_child stack[KDR_MAX_DEPTH * (KDR_WIDE - 1) + 1];
    near_limit limit;
    near_limit_begin(&limit, tree, query, nearest->point.square);
    uint32_t top = open_wide(tree->wide, query, limit.square, stack, 0);
    while (top > 0) {
        waiting_child at = stack[--top];
        if (at.square > limit.square)
            continue;
        if (at.child & KDR_WIDE_LEAF)
            at.child = kdr_wide_settle(tree, at.child);
        if (at.child & KDR_WIDE_LEAF)
            block_closest(kdr_wide_block(tree, at.child), query, nearest, &limit);
        else
            top = open_wide(&tree->wide[at.child], query, limit.square, stack, top);
    }
}

static void closest(const kdr_tree *tree, const float query[3], kdr_nearest *nearest) {
    if (tree->wide)
        boxes_closest(tree, query, nearest);
    else if (!kdr_box_is_empty(&tree->bounds))
        cells_closest(tree, query, nearest);
    kdr_lanes_leave();
}

/* True if this leaf, of those that hold the triangle, is the one to report it: the one whose cell has its closest
 * point. A point in a split plane belongs to the right side, unless the triangle is on the left one only. One that lies
 * in the plane is on one side, or, where it is on both, belongs to the left one. */
static inline bool owns(const kdr_tree *tree, const kdr_box *cell, const float corner[3][3], const double at[3]) {
    for (int k = 0; k < 3; k++) {
        float lo = fminf(fminf(corner[0][k], corner[1][k]), corner[2][k]);
        float hi = fmaxf(fmaxf(corner[0][k], corner[1][k]), corner[2][k]);
        bool in_plane = tree->flat_in_both && lo == hi && lo == cell->lo[k] && lo > tree->bounds.lo[k];
        if (at[k] < cell->lo[k] || (at[k] >= cell->hi[k] && hi > cell->hi[k]) || in_plane)
            return false;
    }
    return true;
}

typedef struct waiting_box {
    uint32_t node;
    kdr_box cell;
    double square[3];
} waiting_box;

static bool block_within(const kdr_tree *tree, kdr_block block, const kdr_box *cell, const float query[3],
                         double square, const near_limit *limit, kdr_near_fn *visit, void *context) {
    for (size_t first = 0; first < block.shown; first += KDR_LANES) {
        kdr_lane_bits left = near_boxes(block, first, cell, query, limit);
        if (limit->has_plane && (left & (left - 1)) != 0)
            left &= near_within(near_planes(block, first, query), limit);
        for (; left; left &= left - 1) {
            size_t i = first + (uint32_t)__builtin_ctz(left);
            kdr_nearest found = {.primitive = kdr_block_primitive(block, i)};
            if (found.primitive == UINT32_MAX)
                continue;
            float corner[3][3];
            kdr_block_triangle(block, i, corner);
            found.point = kdr_triangle_point(query, (const float(*)[3])corner);
            if (found.point.square > square || !owns(tree, cell, (const float(*)[3])corner, found.point.at))
                continue;
            kdr_lanes_leave();
            if (!visit(&found, context))
                return false;
        }
    }
    return true;
}

static bool within(const kdr_tree *tree, const float query[3], double square, kdr_near_fn *visit, void *context) {
    waiting_box stack[KDR_MAX_DEPTH + 1], at = {0, tree->bounds, {0}};
    uint32_t top = 0;
    if (kdr_box_is_empty(&tree->bounds) || kdr_box_square(query, tree->bounds.lo, tree->bounds.hi) > square)
        return true;
    near_limit limit;
    near_limit_begin(&limit, tree, query, square);
    for (int k = 0; k < 3; k++)
        at.square[k] = kdr_interval_square(query[k], tree->bounds.lo[k], tree->bounds.hi[k]);
    for (;;) {
        /* Go down to a leaf; cells beyond a plane wait if they are near enough. */
        kdr_node node = kdr_tree_node(tree, at.node);
        while (!kdr_node_is_leaf(node)) {
            uint32_t axis = kdr_node_axis(node);
            float plane = kdr_node_plane(node);
            double beyond = (double)query[axis] - plane, there = beyond * beyond;
            waiting_box *other = &stack[top];
            *other = at;
            other->square[axis] = there;
            bool right = beyond >= 0;
            at.node = kdr_node_child(node) + right;
            other->node = at.node ^ 1;
            *(right ? &at.cell.lo[axis] : &at.cell.hi[axis]) = plane;
            *(right ? &other->cell.hi[axis] : &other->cell.lo[axis]) = plane;
            top += (other->square[0] + other->square[1]) + other->square[2] <= square;
            node = kdr_tree_node(tree, at.node);
        }
        if (!block_within(tree, kdr_block_of(tree->blocks, node), &at.cell, query, square, &limit, visit, context))
            return false;
        if (top == 0)
            break;
        at = stack[--top];
    }
    kdr_lanes_leave();
    return true;
}

extern const kdr_point_searches KDR_LANES_SYMBOL(kdr_point_searches);
const kdr_point_searches KDR_LANES_SYMBOL(kdr_point_searches) = {.closest = closest, .within = within};
