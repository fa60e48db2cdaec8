/* One ray through the wide tree: sixteen tight boxes a step, KDR_LANES at a time, then leaves of SIMD blocks.
 *
 * Children that the ray meets go on a stack in the order of the ray's octant, which is front to back, so nothing is
 * sorted by distance and a hit ends the search of all that begins behind it. For any hit they go in the order of their
 * places, the largest box first. On sixteen lanes no branch depends on how many are met.
 *
 * Invariant: a box is left out only if the ray misses it. A distance is plane * reciprocal - origin * reciprocal, with
 * room for its roundings put into the second term: see wide_begin. A box encloses all that its cell shows, so whatever
 * the plain traversal finds is found here. Cost: 512 bytes and about 15 operations a vector of boxes. */
#ifndef KDR_TRACE_WIDE_LANES_H
#define KDR_TRACE_WIDE_LANES_H

#include "geometry/quad.h"
#include "tree/block_lanes.h"
#include "tree/closed.h"

typedef struct wide_ray {
    float reciprocal[4];
    float near[4], far[4]; /* added to plane * reciprocal: a distance not too large, and one not too small */
    const struct wide_places *places;
    float tmin;
} wide_ray;

/* Where in a node rays of an octant find what is theirs, in bytes: faces where they enter on each axis, faces where
 * they leave, the order of the children. */
typedef struct wide_places {
    size_t near[3], far[3], order;
} wide_places;

#define WIDE_FACE(k, upper) (offsetof(kdr_wide_node, face) + (2 * (k) + (upper)) * sizeof(float[KDR_WIDE]))
#define WIDE_ORDER(octant) (offsetof(kdr_wide_node, order) + (octant) * sizeof(uint64_t))
#define WIDE_PLACES(octant, x, y, z)                                                                                   \
    {                                                                                                                  \
        {WIDE_FACE(0, x), WIDE_FACE(1, y), WIDE_FACE(2, z)},                                                           \
            {WIDE_FACE(0, !(x)), WIDE_FACE(1, !(y)), WIDE_FACE(2, !(z))}, WIDE_ORDER(octant)                           \
    }

static const wide_places wide_places_of[8] = {WIDE_PLACES(0, 0, 0, 0), WIDE_PLACES(1, 1, 0, 0), WIDE_PLACES(2, 0, 1, 0),
                                              WIDE_PLACES(3, 1, 1, 0), WIDE_PLACES(4, 0, 0, 1), WIDE_PLACES(5, 1, 0, 1),
                                              WIDE_PLACES(6, 0, 1, 1), WIDE_PLACES(7, 1, 1, 1)};

/* False if the ray is not valid or not of the usual kind: sizes out of range, tmin < 0.
 *
 * With o the origin, B the largest coordinate on the axis and r the reciprocal, a distance has roundings of its two
 * products, of r, of what is put together here and of the last sum: each at most 2^-24 of (|o| + B) |r|, eight of
 * them at most, and at most 2^-120 is lost below the smallest floats.
 * A direction is taken to be 2^-63 at least on each axis, so that a ray along an axis needs no case of its own. Where
 * it is less, distances are nearer than they are; with the largest |o| + B of all axes in the room for roundings, boxes
 * that reach the origin's side of a plane still get distances of at most 0 and at least 2^42 (|o| + B), which is more
 * than any in the scene, since the longest axis has a direction of 2^-40 at least. */
KDR_LANES_INLINE bool wide_begin(wide_ray *r, const kdr_ray *ray, const kdr_tree *tree) {
    kdr_quad origin = kdr_quad_origin(ray), direction = kdr_quad_direction(ray);
    kdr_quad size = kdr_quad_abs(direction), least = kdr_quad_all(0x1p-63f);
    kdr_quad_i usual = (kdr_quad_abs(origin) <= KDR_WIDE_LARGEST) & (size <= 0x1p60f);
    bool fits = (kdr_quad_bits(usual) & 7) == 7 && (kdr_quad_bits(size >= 0x1p-40f) & 7) != 0;

    kdr_quad_i sign = (kdr_quad_i)direction & INT32_MIN;
    kdr_quad size_reciprocal = 1 / kdr_quad_max(size, least);
    kdr_quad reciprocal = (kdr_quad)((kdr_quad_i)size_reciprocal | sign);
    kdr_quad reach = kdr_quad_abs(origin) + kdr_quad_load(tree->reach);
    if (__builtin_expect((kdr_quad_bits(size < least) & 7) != 0, 0))
        reach = kdr_quad_all(kdr_quad_most(reach));
    kdr_quad slack = reach * size_reciprocal * 0x1p-21f + 0x1p-120f, start = origin * reciprocal;
    kdr_quad_store(r->reciprocal, reciprocal);
    kdr_quad_store(r->near, -start - slack);
    kdr_quad_store(r->far, slack - start);
    r->tmin = ray->tmin;
    r->places = &wide_places_of[kdr_quad_bits(sign) & 7];
    return fits && ray->tmin >= 0 && ray->tmin < ray->tmax;
}

/* Children that wait. A path opens at most KDR_MAX_DEPTH nodes and leaves at most 15 children of each waiting; a whole
 * vector is written behind them. */
#define WIDE_STACK (KDR_MAX_DEPTH * (KDR_WIDE - 1) + 1 + KDR_WIDE)

typedef struct wide_stack {
    float enter[WIDE_STACK]; /* where the ray enters the child's box */
    uint32_t child[WIDE_STACK];
    uint32_t top;
} wide_stack;

/* Where the ray enters and leaves KDR_LANES boxes of a node from place i on, within [tmin, tmax]. */
KDR_LANES_INLINE void wide_meet(const kdr_wide_node *node, const wide_ray *r, uint32_t i, float tmax,
                                kdr_lanes_f *enter, kdr_lanes_f *leave) {
    const char *at = (const char *)node;
    kdr_lanes_f sooner[3], later[3];
    for (int k = 0; k < 3; k++) {
        const float *near = (const float *)(at + r->places->near[k]), *far = (const float *)(at + r->places->far[k]);
        kdr_lanes_f reciprocal = kdr_lanes_all(r->reciprocal[k]);
        sooner[k] = kdr_lanes_add_product(kdr_lanes_all(r->near[k]), kdr_lanes_load(near + i), reciprocal);
        later[k] = kdr_lanes_add_product(kdr_lanes_all(r->far[k]), kdr_lanes_load(far + i), reciprocal);
    }
    *enter = kdr_lanes_later(kdr_lanes_later(sooner[0], sooner[1]), kdr_lanes_later(sooner[2], kdr_lanes_all(r->tmin)));
    *leave = kdr_lanes_sooner(kdr_lanes_sooner(later[0], later[1]), kdr_lanes_sooner(later[2], kdr_lanes_all(tmax)));
}

#if KDR_LANES == KDR_WIDE

/* Opens a node: the first child that the ray meets no later than tmax, or KDR_WIDE_NOTHING; the others go on the stack,
 * the next on top. */
KDR_LANES_INLINE uint32_t wide_open(const kdr_wide_node *node, const wide_ray *r, float tmax, const bool any,
                                    wide_stack *stack) {
    KDR_COUNT(nodes, 1);
    KDR_COUNT(node_rays, 1);
    kdr_lanes_f enter, leave;
    wide_meet(node, r, 0, tmax, &enter, &leave);
    kdr_lanes_u child = kdr_lanes_load_u(node->child);
    if (!any) {
        kdr_lanes_u order = kdr_lanes_nibbles((const uint64_t *)((const char *)node + r->places->order));
        enter = kdr_lanes_permute(enter, order);
        leave = kdr_lanes_permute(leave, order);
        child = (kdr_lanes_u)kdr_lanes_permute((kdr_lanes_f)child, order);
    }
    kdr_lane_bits met = KDR_LANE_BITS_ALL & ~kdr_lanes_less(leave, enter);
    if (met == 0)
        return KDR_WIDE_NOTHING;
    enter = kdr_lanes_packed(met, enter);
    child = (kdr_lanes_u)kdr_lanes_packed(met, (kdr_lanes_f)child);

    /* Turned round, so that the first is behind the others and the next child does not wait for memory. */
    uint32_t others = (uint32_t)__builtin_popcount(met) - 1;
    kdr_lanes_u turned = others - kdr_lanes_count();
    kdr_lanes_store(&stack->enter[stack->top], kdr_lanes_permute(enter, turned));
    kdr_lanes_store((float *)&stack->child[stack->top], kdr_lanes_permute((kdr_lanes_f)child, turned));
    stack->top += others;
    return child[0];
}

#else

KDR_LANES_INLINE uint32_t wide_open(const kdr_wide_node *node, const wide_ray *r, float tmax, const bool any,
                                    wide_stack *stack) {
    KDR_COUNT(nodes, 1);
    KDR_COUNT(node_rays, 1);
    float enters[KDR_WIDE];
    uint32_t met = 0, top = stack->top;
    for (uint32_t i = 0; i < KDR_WIDE; i += KDR_LANES) {
        kdr_lanes_f enter, leave;
        wide_meet(node, r, i, tmax, &enter, &leave);
        kdr_lanes_store(enters + i, enter);
        met |= (KDR_LANE_BITS_ALL & ~kdr_lanes_less(leave, enter)) << i;
    }
    if (met == 0)
        return KDR_WIDE_NOTHING;
    uint64_t order = *(const uint64_t *)((const char *)node + r->places->order);
    for (uint32_t i = KDR_WIDE; i-- > 0;) {
        uint32_t place = any ? i : order >> KDR_WIDE_ORDER_SHIFT(i) & 15;
        stack->enter[top] = enters[place];
        stack->child[top] = node->child[place];
        top += met >> place & 1;
    }
    stack->top = top - 1;
    return stack->child[top - 1];
}

#endif

/* Asks what lies below a child, 0 being the root. r: the ray as wide_begin has made it. *f is set where the first leaf
 * is met, and *framed then. */
KDR_LANES_INLINE bool kdr_wide_walk(const kdr_tree *tree, uint32_t child, const kdr_ray *ray, const wide_ray *r,
                                    const bool any, bool *framed, kdr_ray_frame *f, kdr_closest *closest) {
    const float tmin = ray->tmin, end = ray->tmax;
    wide_stack stack;
    stack.top = 0;
    for (;;) {
        /* Go down to a leaf, always to the first child. */
        while (!(child & KDR_WIDE_LEAF))
            child = wide_open(&tree->wide[child], r, any ? end : closest->t, any, &stack);

        /* Ask its block. */
        if (child != KDR_WIDE_NOTHING) {
            child = kdr_wide_settle(tree, child);
            if (!(child & KDR_WIDE_LEAF))
                continue;
            if (!*framed) {
                *framed = true;
                kdr_ray_frame_set(f, ray, r->reciprocal, &tree->bounds);
            }
            kdr_block block = kdr_wide_block(tree, child);
            if (any && kdr_block_any(block, f, tmin, end))
                return true;
            if (!any)
                kdr_block_closest(block, f, tmin, closest);
        }

        /* Take the next child that begins no later than the closest hit. */
        do {
            if (stack.top == 0)
                return !any && closest->primitive != UINT32_MAX;
            stack.top--;
        } while (!any && stack.enter[stack.top] > closest->t);
        child = stack.child[stack.top];
    }
}

#endif
