/* Rays of a packet at a leaf: one triangle against KDR_LANES rays, and the exact distances of what was hit.
 *
 * The filter is that of block_lanes.h with roles exchanged: rays are in lanes, and a triangle's corners in all of them.
 * Where it is not sure, or two hits cannot be told apart, the ray decides exactly, as a lone one does. */
#ifndef KDR_TRACE_PACKET_LEAF_LANES_H
#define KDR_TRACE_PACKET_LEAF_LANES_H

#include "trace/packet_rays_lanes.h"

/* What exact decisions need of a ray. */
typedef struct packet_line {
    float origin[3], direction[3], tmin, tmax;
} packet_line;

KDR_LANES_INLINE packet_line packet_line_of(const packet *p, uint32_t i) {
    packet_line line = {.tmin = p->rays->tmin[i], .tmax = p->rays->tmax[i]};
    for (int k = 0; k < 3; k++) {
        line.origin[k] = p->rays->origin[k][i];
        line.direction[k] = p->rays->direction[k][i];
    }
    return line;
}

/* Gives a closest hit that the filter was sure of its exact distance. */
static __attribute__((noinline, unused)) void packet_settle_one(packet *p, uint32_t i) {
    packet_line ray = packet_line_of(p, i);
    kdr_triangle_hit *hit = &p->hit[i];
    kdr_corners corners = {p->tree->blocks + p->corner.of[i], p->length.of[i]};
    kdr_triangle_measure(ray.origin, ray.direction, corners, hit);
    p->sure &= ~((packet_bits)1 << i);
    p->least.of[i] = p->t.of[i] = hit->t;
}

/* Decides exactly whether a triangle is the closest hit so far of ray i. */
static __attribute__((noinline, unused)) void packet_decide(packet *p, uint32_t i, kdr_block block, size_t place,
                                                            uint32_t primitive) {
    KDR_COUNT(exact, 1);
    packet_line ray = packet_line_of(p, i);
    kdr_triangle_hit hit;
    if (!kdr_triangle_meet(ray.origin, ray.direction, kdr_block_corners(block, place), &hit) || hit.t <= ray.tmin)
        return;
    if (p->sure >> i & 1)
        packet_settle_one(p, i);
    if (hit.t < p->t.of[i] || (hit.t == p->t.of[i] && primitive < p->primitive.of[i])) {
        p->least.of[i] = p->t.of[i] = hit.t;
        p->primitive.of[i] = primitive;
        p->hit[i] = hit;
    }
}

static __attribute__((noinline, unused)) bool packet_decide_any(const packet *p, uint32_t i, kdr_block block,
                                                                size_t place) {
    KDR_COUNT(exact, 1);
    packet_line ray = packet_line_of(p, i);
    kdr_triangle_hit hit;
    kdr_corners corners = kdr_block_corners(block, place);
    return !kdr_triangle_is_behind(ray.origin, ray.direction, corners, ray.tmin) &&
           kdr_triangle_meet(ray.origin, ray.direction, corners, &hit) && hit.t > ray.tmin && hit.t <= ray.tmax;
}

/* A triangle's corners along the axes of the shear. */
typedef struct packet_corners {
    float x[3], y[3], z[3];
} packet_corners;

KDR_LANES_INLINE packet_corners packet_corners_of(const packet *p, kdr_block block, size_t place) {
    packet_corners c;
    for (uint32_t i = 0; i < 3; i++) {
        c.x[i] = block.rows[(3 * i + p->axis[0]) * block.length + place];
        c.y[i] = block.rows[(3 * i + p->axis[1]) * block.length + place];
        c.z[i] = block.rows[(3 * i + p->axis[2]) * block.length + place];
    }
    return c;
}

/* Lanes of a vector of rays whose line is not proven to miss. */
KDR_LANES_INLINE kdr_lane_bits packet_meet_triangle(const packet *p, uint32_t v, const packet_corners *c,
                                                    kdr_block_edges *e) {
    kdr_lanes_f shear_x = p->shear_x.lanes[v], shear_y = p->shear_y.lanes[v];
    kdr_lanes_f origin_x = p->origin[p->axis[0]].lanes[v], origin_y = p->origin[p->axis[1]].lanes[v];
    kdr_lanes_f origin_z = p->origin[p->axis[2]].lanes[v];
    kdr_lanes_f x[3], y[3];
    for (int i = 0; i < 3; i++) {
        e->z[i] = origin_z - kdr_lanes_all(c->z[i]);
        x[i] = kdr_lanes_less_product(origin_x - kdr_lanes_all(c->x[i]), shear_x, e->z[i]);
        y[i] = kdr_lanes_less_product(origin_y - kdr_lanes_all(c->y[i]), shear_y, e->z[i]);
    }
    kdr_block_edges_set(e, x, y, p->doubt_least.lanes[v], p->doubt.lanes[v]);
    return ~kdr_block_outside(e);
}

/* x in the chosen lanes. */
KDR_LANES_INLINE void packet_put(packet_row_u *row, uint32_t v, kdr_lane_bits lanes, uint32_t x) {
    kdr_lanes_u all = x - (kdr_lanes_u){0};
    row->lanes[v] = (kdr_lanes_u)kdr_lanes_choose(lanes, (kdr_lanes_f)all, (kdr_lanes_f)row->lanes[v]);
}

/* Lanes of a vector of rays that may meet a triangle keep the closest of it and what they have. */
KDR_LANES_INLINE void packet_keep_closest(packet *p, uint32_t v, kdr_lane_bits left, kdr_block block, size_t place) {
    const uint32_t primitive = kdr_block_primitive(block, place);
    const packet_corners corners = packet_corners_of(p, block, place);
    kdr_block_edges e;
    packet_meet_triangle(p, v, &corners, &e);
    kdr_block_span span = kdr_block_span_of(&e, p->reciprocal[p->axis[2]].lanes[v]);
    kdr_lanes_f least = p->least.lanes[v], t = p->t.lanes[v], tmin = p->tmin.lanes[v];
    left &= ~(kdr_lanes_less(span.to, tmin) | kdr_lanes_less(t, span.from));
    kdr_lane_bits taken =
        left & kdr_block_inside(&e) & kdr_lanes_less(tmin, span.from) & kdr_lanes_less(span.to, least);
    p->least.lanes[v] = kdr_lanes_choose(taken, span.from, least);
    p->t.lanes[v] = kdr_lanes_choose(taken, span.to, t);
    packet_put(&p->primitive, v, taken, primitive);
    packet_put(&p->corner, v, taken, (uint32_t)(block.rows + place - p->tree->blocks));
    packet_put(&p->length, v, taken, (uint32_t)block.length);
    p->sure |= packet_bits_of(taken, v);
    for (left &= ~taken; __builtin_expect(left != 0, 0); left &= left - 1) {
        uint32_t i = v * KDR_LANES + (uint32_t)__builtin_ctz(left);
        if (p->primitive.of[i] != primitive)
            packet_decide(p, i, block, place, primitive);
    }
}

/* Lanes of a vector of rays that may meet a triangle; returns those that hit it. */
KDR_LANES_INLINE kdr_lane_bits packet_keep_any(packet *p, uint32_t v, kdr_lane_bits left, kdr_block block,
                                               size_t place) {
    const packet_corners corners = packet_corners_of(p, block, place);
    kdr_block_edges e;
    packet_meet_triangle(p, v, &corners, &e);
    kdr_block_span span = kdr_block_span_of(&e, p->reciprocal[p->axis[2]].lanes[v]);
    kdr_lanes_f tmin = p->tmin.lanes[v], tmax = p->t.lanes[v];
    kdr_lane_bits hit = left & kdr_block_inside(&e) & kdr_lanes_less(tmin, span.from) & kdr_lanes_less(span.to, tmax);
    left &= ~(hit | kdr_lanes_less(span.to, tmin) | kdr_lanes_less(tmax, span.from));
    for (; __builtin_expect(left != 0, 0); left &= left - 1) {
        uint32_t lane = (uint32_t)__builtin_ctz(left);
        hit |= (kdr_lane_bits)packet_decide_any(p, v * KDR_LANES + lane, block, place) << lane;
    }
    p->t.lanes[v] = kdr_lanes_choose(hit, kdr_lanes_all(-INFINITY), tmax);
    return hit;
}

/* Which rays may meet which of KDR_LANES triangles: lanes of vector v for triangle i at v * KDR_LANES + i, whose bit in
 * `set` says that there are any. */
typedef struct packet_meets {
    packet_bits set;
    kdr_lane_bits lanes[KDR_PACKET_RAYS];
} packet_meets;

/* Fills in *meets one triangle after the other. No step waits for another, and no branch depends on an answer. */
KDR_LANES_INLINE void packet_meet_by_triangles(const packet *p, packet_bits rays, kdr_block block,
                                               kdr_lane_bits triangles, packet_meets *meets) {
    for (; triangles; triangles &= triangles - 1) {
        uint32_t i = (uint32_t)__builtin_ctz(triangles);
        const packet_corners corners = packet_corners_of(p, block, i);
        for (uint32_t v = 0; v < p->vectors; v++) {
            kdr_lane_bits lanes = packet_lanes_of(rays, v);
            if (lanes == 0)
                continue;
            kdr_block_count_step(lanes);
            kdr_block_edges e;
            lanes &= packet_meet_triangle(p, v, &corners, &e);
            meets->lanes[v * KDR_LANES + i] = lanes;
            meets->set |= (packet_bits)(lanes != 0) << (v * KDR_LANES + i);
        }
    }
}

/* The same one ray after the other, with triangles in lanes. */
KDR_LANES_INLINE void packet_meet_by_rays(const packet *p, packet_bits rays, kdr_block block, packet_meets *meets) {
    const size_t length = block.length;
    kdr_lanes_f x[3], y[3], z[3];
    for (size_t k = 0; k < 3; k++) {
        x[k] = kdr_lanes_load(block.rows + (3 * k + p->axis[0]) * length);
        y[k] = kdr_lanes_load(block.rows + (3 * k + p->axis[1]) * length);
        z[k] = kdr_lanes_load(block.rows + (3 * k + p->axis[2]) * length);
    }
    uint8_t number[KDR_PACKET_RAYS];
    kdr_lane_bits triangles[KDR_PACKET_RAYS];
    uint32_t count = 0;
    for (; rays; rays &= rays - 1) {
        uint32_t i = (uint32_t)__builtin_ctzll(rays);
        kdr_block_count_step(kdr_lanes_first((uint32_t)block.shown));
        kdr_lanes_f shear_x = kdr_lanes_all(p->shear_x.of[i]), shear_y = kdr_lanes_all(p->shear_y.of[i]);
        kdr_lanes_f origin_x = kdr_lanes_all(p->origin[p->axis[0]].of[i]);
        kdr_lanes_f origin_y = kdr_lanes_all(p->origin[p->axis[1]].of[i]);
        kdr_lanes_f origin_z = kdr_lanes_all(p->origin[p->axis[2]].of[i]);
        kdr_block_edges e;
        kdr_lanes_f sheared_x[3], sheared_y[3];
        for (int k = 0; k < 3; k++) {
            e.z[k] = origin_z - z[k];
            sheared_x[k] = kdr_lanes_less_product(origin_x - x[k], shear_x, e.z[k]);
            sheared_y[k] = kdr_lanes_less_product(origin_y - y[k], shear_y, e.z[k]);
        }
        kdr_block_edges_set(&e, sheared_x, sheared_y, kdr_lanes_all(p->doubt_least.of[i]),
                            kdr_lanes_all(p->doubt.of[i]));
        number[count] = (uint8_t)i;
        triangles[count] = kdr_lanes_first((uint32_t)block.shown) & ~kdr_block_outside(&e);
        count += triangles[count] != 0;
    }
    memset(meets->lanes, 0, sizeof meets->lanes);
    for (uint32_t k = 0; k < count; k++) {
        uint32_t v = number[k] / KDR_LANES;
        for (kdr_lane_bits left = triangles[k]; left; left &= left - 1) {
            uint32_t at = v * KDR_LANES + (uint32_t)__builtin_ctz(left);
            meets->lanes[at] |= (kdr_lane_bits)1 << number[k] % KDR_LANES;
            meets->set |= (packet_bits)1 << at;
        }
    }
}

/* Looks into what may meet. Returns the rays whose search for any hit ends. */
KDR_LANES_INLINE packet_bits packet_look(packet *p, const packet_meets *meets, kdr_block block, const bool any) {
    packet_bits found = 0;
    for (packet_bits left = meets->set; left; left &= left - 1) {
        uint32_t at = (uint32_t)__builtin_ctzll(left), v = at / KDR_LANES, i = at % KDR_LANES;
        if (kdr_block_primitive(block, i) == UINT32_MAX)
            continue;
        if (any)
            found |= packet_bits_of(packet_keep_any(p, v, meets->lanes[at] & ~packet_lanes_of(found, v), block, i), v);
        else
            packet_keep_closest(p, v, meets->lanes[at], block, i);
    }
    return found;
}

typedef double packet_eight __attribute__((vector_size(64)));
typedef int64_t packet_eight_i __attribute__((vector_size(64)));

KDR_LANES_INLINE packet_eight packet_eight_abs(packet_eight q) { return (packet_eight)((packet_eight_i)q & INT64_MAX); }

KDR_LANES_INLINE packet_eight packet_eight_choose(packet_eight_i chosen, packet_eight a, packet_eight b) {
    return (packet_eight)(((packet_eight_i)a & chosen) | ((packet_eight_i)b & ~chosen));
}

typedef float packet_eight_f __attribute__((vector_size(32)));

KDR_LANES_INLINE void packet_eight_store(float *to, packet_eight q) {
    packet_eight_f f = __builtin_convertvector(q, packet_eight_f);
    memcpy(to, &f, sizeof f);
}

/* Number `row` of eight blocks, of the triangles that begin at `at`. */
KDR_LANES_INLINE packet_eight_f packet_eight_gather(const float *blocks, const size_t at[8], const size_t length[8],
                                                    size_t row) {
#if defined(__AVX512F__)
    __m512i step = _mm512_mullo_epi64(_mm512_set1_epi64((long long)row), _mm512_loadu_si512(length));
    return _mm512_i64gather_ps(_mm512_add_epi64(_mm512_loadu_si512(at), step), blocks, sizeof(float));
#else
    packet_eight_f v;
    for (int i = 0; i < 8; i++)
        v[i] = blocks[at[i] + row * length[i]];
    return v;
#endif
}

/* kdr_triangle_measure for eight rays from `first` on whose hits the filter was sure of: the same operations in the
 * same order on the same numbers, so the same bits. Lanes of other rays have no meaning. */
KDR_LANES_INLINE void packet_measure(const packet *p, uint32_t first, uint32_t rays, kdr_packet_found *found) {
    packet_eight e[3], f[3], s[3], d[3], n[3], r[3];
    size_t at[8], length[8];
    for (uint32_t i = 0; i < 8; i++) {
        at[i] = p->corner.of[first + i];
        length[i] = p->length.of[first + i];
    }
    for (uint32_t k = 0; k < 3; k++) {
        packet_eight_f a, b, c, o, direction;
        a = packet_eight_gather(p->tree->blocks, at, length, k);
        b = packet_eight_gather(p->tree->blocks, at, length, k + 3);
        c = packet_eight_gather(p->tree->blocks, at, length, k + 6);
        memcpy(&o, &p->rays->origin[k][first], sizeof o);
        memcpy(&direction, &p->rays->direction[k][first], sizeof direction);
        packet_eight from = __builtin_convertvector(a, packet_eight);
        e[k] = __builtin_convertvector(b, packet_eight) - from;
        f[k] = __builtin_convertvector(c, packet_eight) - from;
        s[k] = __builtin_convertvector(o, packet_eight) - from;
        d[k] = __builtin_convertvector(direction, packet_eight);
    }
    for (int k = 0; k < 3; k++) {
        int l = (k + 1) % 3, m = (k + 2) % 3;
        n[k] = e[l] * f[m] - e[m] * f[l];
        r[k] = s[l] * d[m] - s[m] * d[l];
    }
    packet_eight den = n[0] * d[0] + n[1] * d[1] + n[2] * d[2], ru = r[0] * f[0] + r[1] * f[1] + r[2] * f[2];
    packet_eight num = -(n[0] * s[0] + n[1] * s[1] + n[2] * s[2]), rv = r[0] * e[0] + r[1] * e[1] + r[2] * e[2];
    packet_eight inverse = 1 / den, quotient = num * inverse;

    packet_eight size_e = packet_eight_abs(e[0]) + packet_eight_abs(e[1]) + packet_eight_abs(e[2]);
    packet_eight size_f = packet_eight_abs(f[0]) + packet_eight_abs(f[1]) + packet_eight_abs(f[2]);
    packet_eight size_s = packet_eight_abs(s[0]) + packet_eight_abs(s[1]) + packet_eight_abs(s[2]);
    packet_eight size_d = packet_eight_abs(d[0]) + packet_eight_abs(d[1]) + packet_eight_abs(d[2]);
    packet_eight size_n = KDR_TRIANGLE_ERROR * size_e * size_f, size = packet_eight_abs(quotient);
    packet_eight_i rest = ((packet_eight_i)quotient & 0x1fffffff) - (0x10000000 - 0x80000);
    packet_eight_i good = (0x1p36 * size_n * size_s < packet_eight_abs(num)) &
                          (0x1p36 * size_n * size_d < packet_eight_abs(den)) & ((rest < 0) | (rest > 2 * 0x80000)) &
                          (size > 0x1p-125) & (size < 0x1p127);

    packet_eight u = -ru * inverse, v = rv * inverse, zero = {0}, one = zero + 1;
    u = packet_eight_choose(u > 0, packet_eight_choose(u < 1, u, one), zero);
    v = packet_eight_choose(v > 0, packet_eight_choose(v < 1, v, one), zero);
    packet_eight_store(&found->t[first], quotient);
    packet_eight_store(&found->u[first], u);
    packet_eight_store(&found->v[first], v);
    for (uint32_t k = 0; k < 3; k++)
        packet_eight_store(&found->normal[k][first], n[k]);
    for (; rays; rays &= rays - 1) {
        uint32_t i = (uint32_t)__builtin_ctz(rays);
        if (__builtin_expect(good[i] != 0, 1))
            continue;
        packet_line ray = packet_line_of(p, first + i);
        kdr_corners corners = {p->tree->blocks + p->corner.of[first + i], p->length.of[first + i]};
        found->t[first + i] =
            kdr_corners_distance(ray.origin, ray.direction, corners, num[i], den[i], size_n[i], size_s[i], size_d[i]);
    }
}

/* Hands over the closest hits of some rays. */
KDR_LANES_INLINE void packet_report(const packet *p, packet_bits rays, kdr_packet_found *found) {
    packet_bits hits = 0;
    for (packet_bits left = rays; left; left &= left - 1) {
        uint32_t i = (uint32_t)__builtin_ctzll(left);
        found->primitive[i] = p->primitive.of[i];
        hits |= (packet_bits)(p->primitive.of[i] != UINT32_MAX) << i;
    }
    for (uint32_t first = 0; first < KDR_PACKET_RAYS; first += 8) {
        uint32_t eight = (uint32_t)((hits & p->sure) >> first) & 0xff;
        if (eight)
            packet_measure(p, first, eight, found);
    }
    for (packet_bits left = hits & ~p->sure; left; left &= left - 1) {
        uint32_t i = (uint32_t)__builtin_ctzll(left);
        const kdr_triangle_hit *hit = &p->hit[i];
        found->t[i] = hit->t;
        found->u[i] = hit->u;
        found->v[i] = hit->v;
        for (int k = 0; k < 3; k++)
            found->normal[k][i] = hit->normal[k];
    }
}

#endif
