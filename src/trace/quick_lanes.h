/* Triangle tests in floats alone, KDR_LANES triangles at a time: what others use, to be compared with the filter and
 * exact decisions of block_lanes.h. Edges may leak, and distances are as good as floats give them.
 *
 * Moller-Trumbore starts from the corners: weights first, and distances only where they are those of a triangle. The
 * projection has plane and edges at hand: distances first, and weights only where that is nearer than what is known.
 * Sources: T. Moller, B. Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", 1997; I. Wald, "Realtime Ray
 * Tracing and Interactive Global Illumination", thesis, 2004, section 7.1.
 * No operation is fused, so that every instruction set gives the same bits. Cost: some 60 operations a vector, and 25
 * to 40.
 */
#ifndef KDR_TRACE_QUICK_LANES_H
#define KDR_TRACE_QUICK_LANES_H

#include "trace/trace.h"
#include "tree/block_lanes.h"

/* A vector of triangles that the ray may hit: distances, and weights of b and c. */
typedef struct quick_hits {
    kdr_lanes_f t, u, v;
} quick_hits;

/* Lanes whose distance is in (tmin, tmax]. NaN is not. */
KDR_LANES_INLINE kdr_lane_bits quick_in_range(kdr_lanes_f t, float tmin, float tmax) {
    kdr_lane_bits number = kdr_lanes_less(t, kdr_lanes_all(INFINITY));
    return number & kdr_lanes_less(kdr_lanes_all(tmin), t) & ~kdr_lanes_less(kdr_lanes_all(tmax), t);
}

/* Lanes whose weights are those of a point of the triangle; they are multiples of `one`, which is not negative. Where
 * sizes left the range of floats, one of them is infinite or NaN: a miss. */
KDR_LANES_INLINE kdr_lane_bits quick_inside(const quick_hits *h, kdr_lanes_f one) {
    const kdr_lanes_f zero = {0}, infinite = kdr_lanes_all(INFINITY), sum = h->u + h->v;
    kdr_lane_bits numbers = kdr_lanes_less(sum, infinite) & kdr_lanes_less(one, infinite);
    return numbers & ~(kdr_lanes_less(h->u, zero) | kdr_lanes_less(h->v, zero) | kdr_lanes_less(one, sum));
}

KDR_LANES_INLINE kdr_lane_bits quick_moller_trumbore(kdr_block block, size_t first, const kdr_ray_frame *f, float tmin,
                                                     float tmax, quick_hits *h) {
    kdr_lanes_f e[3], g[3], s[3], p[3], q[3], d[3];
    for (size_t k = 0; k < 3; k++) {
        kdr_lanes_f a = kdr_lanes_load(block.rows + k * block.length + first);
        e[k] = kdr_lanes_load(block.rows + (3 + k) * block.length + first) - a;
        g[k] = kdr_lanes_load(block.rows + (6 + k) * block.length + first) - a;
        s[k] = kdr_lanes_all(f->origin[k]) - a;
        d[k] = kdr_lanes_all(f->direction[k]);
    }
    for (int k = 0; k < 3; k++) {
        int l = (k + 1) % 3, m = (k + 2) % 3;
        p[k] = d[l] * g[m] - d[m] * g[l];
        q[k] = s[l] * e[m] - s[m] * e[l];
    }

    /* Weights and distance as multiples of the determinant, turned so that it is positive: what is outside is found
     * before anything is divided. */
    kdr_lanes_f determinant = e[0] * p[0] + e[1] * p[1] + e[2] * p[2];
    const kdr_lanes_u sign = (kdr_lanes_u)determinant & 0x80000000u;
    kdr_lanes_f size = kdr_lanes_abs(determinant);
    h->u = (kdr_lanes_f)((kdr_lanes_u)(s[0] * p[0] + s[1] * p[1] + s[2] * p[2]) ^ sign);
    h->v = (kdr_lanes_f)((kdr_lanes_u)(d[0] * q[0] + d[1] * q[1] + d[2] * q[2]) ^ sign);
    kdr_lane_bits lanes = quick_inside(h, size);
    if (lanes == 0)
        return 0;
    kdr_lanes_f inverse = 1 / size;
    h->t = (kdr_lanes_f)((kdr_lanes_u)(g[0] * q[0] + g[1] * q[1] + g[2] * q[2]) ^ sign) * inverse;
    h->u = h->u * inverse;
    h->v = h->v * inverse;
    return lanes & quick_in_range(h->t, tmin, tmax);
}

KDR_LANES_INLINE kdr_lane_bits quick_projection(const float *rows, size_t length, size_t first, const kdr_ray_frame *f,
                                                float tmin, float tmax, quick_hits *h) {
    kdr_lanes_f row[10];
    for (size_t i = 0; i < 10; i++)
        row[i] = kdr_lanes_load(rows + i * length + first);

    /* The ray along each lane's own axes. */
    const kdr_lane_bits is_x = kdr_lanes_less(row[9], kdr_lanes_all(0.5f));
    const kdr_lane_bits is_z = kdr_lanes_less(kdr_lanes_all(1.5f), row[9]);
    kdr_lanes_f o[3], d[3];
    for (int k = 0; k < 3; k++) {
        int y = (1 + k) % 3, z = (2 + k) % 3;
        o[k] = kdr_lanes_choose(is_x, kdr_lanes_all(f->origin[k]),
                                kdr_lanes_choose(is_z, kdr_lanes_all(f->origin[z]), kdr_lanes_all(f->origin[y])));
        d[k] = kdr_lanes_choose(is_x, kdr_lanes_all(f->direction[k]),
                                kdr_lanes_choose(is_z, kdr_lanes_all(f->direction[z]), kdr_lanes_all(f->direction[y])));
    }
    h->t = (row[2] - o[0] - row[0] * o[1] - row[1] * o[2]) / (d[0] + row[0] * d[1] + row[1] * d[2]);
    kdr_lane_bits lanes = quick_in_range(h->t, tmin, tmax);
    if (lanes == 0)
        return 0;
    kdr_lanes_f x = o[1] + h->t * d[1], y = o[2] + h->t * d[2];
    h->u = x * row[3] + y * row[4] + row[5];
    h->v = x * row[6] + y * row[7] + row[8];
    return lanes & quick_inside(h, kdr_lanes_all(1));
}

KDR_LANES_INLINE kdr_lane_bits quick_meet(const kdr_tree *tree, kdr_block block, size_t first, const kdr_ray_frame *f,
                                          float tmin, float tmax, quick_hits *h) {
    kdr_lane_bits lanes;
    if (tree->test == KDR_TEST_PROJECTION)
        lanes = quick_projection(tree->projections.rows + (block.rows - tree->blocks), block.length, first, f, tmin,
                                 tmax, h);
    else
        lanes = quick_moller_trumbore(block, first, f, tmin, tmax, h);
    return lanes & kdr_lanes_first((uint32_t)(block.shown - first));
}

/* As kdr_block_closest_new and kdr_block_any_new. Out of line, so that there is one of each for all walks. */
static __attribute__((noinline, unused)) void quick_closest(const kdr_tree *tree, kdr_block block,
                                                            const kdr_ray_frame *f, float tmin, kdr_mailbox *mailbox,
                                                            kdr_closest *closest) {
    kdr_block_count_block();
    for (size_t first = 0; first < block.shown; first += KDR_LANES) {
        kdr_lane_bits left = kdr_mailbox_new(mailbox, block, first);
        quick_hits h = {{0}, {0}, {0}};
        if (left)
            kdr_block_count_step(left & kdr_lanes_first((uint32_t)(block.shown - first)));
        if (left)
            left &= quick_meet(tree, block, first, f, tmin, closest->t, &h);
        for (; left; left &= left - 1) {
            uint32_t lane = (uint32_t)__builtin_ctz(left), primitive = kdr_block_primitive(block, first + lane);
            float t = kdr_lanes_get(h.t, lane);
            if (primitive == UINT32_MAX || t > closest->t || (t == closest->t && primitive >= closest->primitive))
                continue;
            closest->least = closest->t = t;
            closest->primitive = primitive;
            closest->hit = (kdr_triangle_hit){.t = t, .u = kdr_lanes_get(h.u, lane), .v = kdr_lanes_get(h.v, lane)};
            float corner[3][3], e[3], g[3];
            kdr_block_triangle(block, first + lane, corner);
            for (int k = 0; k < 3; k++) {
                e[k] = corner[1][k] - corner[0][k];
                g[k] = corner[2][k] - corner[0][k];
            }
            for (int k = 0; k < 3; k++)
                closest->hit.normal[k] = e[(k + 1) % 3] * g[(k + 2) % 3] - e[(k + 2) % 3] * g[(k + 1) % 3];
        }
    }
}

static __attribute__((noinline, unused)) bool quick_any(const kdr_tree *tree, kdr_block block, const kdr_ray_frame *f,
                                                        float tmin, float tmax, kdr_mailbox *mailbox) {
    kdr_block_count_block();
    for (size_t first = 0; first < block.shown; first += KDR_LANES) {
        kdr_lane_bits left = kdr_mailbox_new(mailbox, block, first);
        quick_hits h = {{0}, {0}, {0}};
        if (left)
            kdr_block_count_step(left & kdr_lanes_first((uint32_t)(block.shown - first)));
        if (left)
            left &= quick_meet(tree, block, first, f, tmin, tmax, &h);
        for (; left; left &= left - 1)
            if (kdr_block_primitive(block, first + (uint32_t)__builtin_ctz(left)) != UINT32_MAX)
                return true;
    }
    return false;
}

#endif
