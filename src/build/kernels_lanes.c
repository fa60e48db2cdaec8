/* Inner loops of the builder over KDR_LANES references at a time: counting and dividing at a plane, and the exact
 * surface area heuristic of small nodes by bit masks. */
#include "build/kernels.h"

#include "build/chop_lanes.h"

/* A face of the bounds as a plane that cuts off empty space. */
static void consider_face(kdr_split *best, float face, float rim, const kdr_box *cell, uint32_t axis, float plane,
                          bool lower, uint32_t count, const kdr_plan *plan) {
    if (!(plane > cell->lo[axis] && plane < cell->hi[axis]))
        return;
    float extent = lower ? cell->hi[axis] - plane : plane - cell->lo[axis];
    float cost = plan->cost_traversal + (face + rim * extent) * (float)count * plan->empty_bonus;
    if (cost < best->cost)
        *best = (kdr_split){.axis = axis, .plane = plane, .flat_left = !lower, .cost = cost};
}

/* Makes planes cheaper that leave one side empty. */
KDR_LANES_INLINE kdr_lanes_f reward_empty(kdr_lanes_f cost, kdr_lanes_f n_left, kdr_lanes_f n_right, float bonus) {
    if (bonus == 1)
        return cost;
    kdr_lanes_f one = kdr_lanes_all(1);
    return kdr_lanes_choose(kdr_lanes_less(n_left, one) | kdr_lanes_less(n_right, one), cost * bonus, cost);
}

static kdr_split choose_binned(const kdr_bins *bins, const kdr_bin_grid *grid, uint32_t count, const kdr_box *box,
                               const kdr_box *cell, const kdr_plan *plan, uint32_t axes) {
    kdr_split best = {.cost = INFINITY};
    kdr_fractions fractions = kdr_fractions_of(cell);
    for (uint32_t k = 0; k < 3; k++) {
        if (!(axes >> k & 1))
            continue;
        const float face = (float)(fractions.face[k] * fractions.inverse_area) * plan->cost_intersection;
        const float rim = (float)(fractions.rim[k] * fractions.inverse_area) * plan->cost_intersection;
        consider_face(&best, face, rim, cell, k, box->lo[k], true, count, plan);
        consider_face(&best, face, rim, cell, k, box->hi[k], false, count, plan);
        if (grid->scale[k] == 0)
            continue;

        /* Primitives that reach to the left and to the right of each boundary; boundary 0 is the lower face. */
        uint32_t left[KDR_BIN_COUNT], right[KDR_BIN_COUNT], begun = 0, ended = 0;
        for (int i = 0; i < KDR_BIN_COUNT; i++) {
            left[i] = begun;
            right[i] = ended;
            begun += bins->begins[k][i];
            ended += bins->ends[k][i];
        }

        /* Cost of each boundary, with counts scaled back from the sample. */
        float costs[KDR_BIN_COUNT], planes[KDR_BIN_COUNT];
        const float weight = (float)count / (float)begun;
        const kdr_lanes_f lo = kdr_lanes_all(cell->lo[k]), hi = kdr_lanes_all(cell->hi[k]);
        for (uint32_t i = 0; i < KDR_BIN_COUNT; i += KDR_LANES) {
            kdr_lanes_f number;
            for (uint32_t j = 0; j < KDR_LANES; j++)
                number[j] = (float)(i + j);
            kdr_lanes_f plane = grid->lo[k] + grid->width[k] * number;
            kdr_lanes_f n_left = __builtin_convertvector((kdr_lanes_i)kdr_lanes_load_u(left + i), kdr_lanes_f);
            kdr_lanes_f n_right =
                __builtin_convertvector((kdr_lanes_i)(begun - kdr_lanes_load_u(right + i)), kdr_lanes_f);
            kdr_lanes_f cost = (face + rim * (plane - lo)) * n_left + (face + rim * (hi - plane)) * n_right;
            cost = reward_empty(cost, n_left, n_right, plan->empty_bonus);
            kdr_lane_bits inside = kdr_lanes_less(lo, plane) & kdr_lanes_less(plane, hi);
            kdr_lanes_store(costs + i,
                            kdr_lanes_choose(inside, plan->cost_traversal + weight * cost, kdr_lanes_all(INFINITY)));
            kdr_lanes_store(planes + i, plane);
        }
        for (uint32_t i = 1; i < KDR_BIN_COUNT; i++)
            if (costs[i] < best.cost)
                best = (kdr_split){.axis = k, .plane = planes[i], .flat_left = true, .cost = costs[i]};
    }
    return best;
}

/* What lies near a plane: begins and ends of boxes inside a window, and how many boxes begin before it or end behind.
 */
typedef struct vicinity {
    float begins[KDR_SNAP_LIMIT + KDR_LANES], ends[KDR_SNAP_LIMIT + KDR_LANES];
    uint32_t begin_count, end_count, before, behind;
} vicinity;

/* False if there is more than there is room for. */
static bool look_around(const kdr_references *from, uint32_t axis, float least, float most, vicinity *v) {
    const float *lo = from->lo[axis], *hi = from->hi[axis];
    const kdr_lanes_f low = kdr_lanes_all(least), high = kdr_lanes_all(most);
    v->begin_count = v->end_count = v->before = v->behind = 0;
    for (uint32_t i = 0; i < from->count; i += KDR_LANES) {
        kdr_lane_bits valid = kdr_lanes_first(from->count - i);
        kdr_lanes_f begin = kdr_lanes_load_first(lo + i, from->count - i);
        kdr_lanes_f end = kdr_lanes_load_first(hi + i, from->count - i);
        kdr_lane_bits before = ~kdr_lanes_less(low, begin) & valid, behind = ~kdr_lanes_less(end, high) & valid;
        kdr_lane_bits begins = ~before & kdr_lanes_less(begin, high) & valid;
        kdr_lane_bits ends = ~behind & kdr_lanes_less(low, end) & valid;
        uint32_t begin_count = v->begin_count + (uint32_t)__builtin_popcount(begins);
        uint32_t end_count = v->end_count + (uint32_t)__builtin_popcount(ends);
        if (begin_count > KDR_SNAP_LIMIT || end_count > KDR_SNAP_LIMIT)
            return false;
        kdr_lanes_compress(v->begins + v->begin_count, begins, begin);
        kdr_lanes_compress(v->ends + v->end_count, ends, end);
        v->begin_count = begin_count;
        v->end_count = end_count;
        v->before += (uint32_t)__builtin_popcount(before);
        v->behind += (uint32_t)__builtin_popcount(behind);
    }
    kdr_lanes_store(v->begins + v->begin_count, kdr_lanes_all(INFINITY));
    kdr_lanes_store(v->ends + v->end_count, kdr_lanes_all(-INFINITY));
    return true;
}

static kdr_split snap(const kdr_references *from, const kdr_split *split, float reach, const kdr_box *cell,
                      const kdr_plan *plan) {
    const uint32_t axis = split->axis;
    float least = split->plane - reach, most = split->plane + reach;
    least = least > cell->lo[axis] ? least : cell->lo[axis];
    most = most < cell->hi[axis] ? most : cell->hi[axis];
    vicinity v;
    if (!look_around(from, axis, least, most, &v))
        return *split;

    /* Weigh each. What lies in a plane goes right if the plane is a begin, left if it is an end. */
    kdr_fractions fractions = kdr_fractions_of(cell);
    const float face = (float)(fractions.face[axis] * fractions.inverse_area) * plan->cost_intersection;
    const float rim = (float)(fractions.rim[axis] * fractions.inverse_area) * plan->cost_intersection;
    kdr_split best = {.axis = axis, .cost = INFINITY};
    for (uint32_t c = 0; c < v.begin_count + v.end_count; c++) {
        bool is_end = c >= v.begin_count;
        float plane = is_end ? v.ends[c - v.begin_count] : v.begins[c];
        const kdr_lanes_f at = kdr_lanes_all(plane);
        uint32_t left = v.before, right = v.behind;
        for (uint32_t i = 0; i < v.begin_count; i += KDR_LANES)
            left += (uint32_t)__builtin_popcount(kdr_lanes_less(kdr_lanes_load(v.begins + i), at));
        for (uint32_t i = 0; i < v.end_count; i += KDR_LANES)
            right += (uint32_t)__builtin_popcount(kdr_lanes_less(at, kdr_lanes_load(v.ends + i)));
        float cost = (face + rim * (plane - cell->lo[axis])) * (float)left +
                     (face + rim * (cell->hi[axis] - plane)) * (float)right;
        cost = plan->cost_traversal + cost * (left == 0 || right == 0 ? plan->empty_bonus : 1);
        if (cost < best.cost || (cost == best.cost && plane < best.plane))
            best = (kdr_split){.axis = axis, .plane = plane, .flat_left = is_end, .cost = cost};
    }
    return best.cost < INFINITY ? best : *split;
}

/* Which of the lanes go left and right. A primitive on both sides of the plane goes both ways; one that only touches it
 * goes one way; one that lies in it goes where the split says. */
KDR_LANES_INLINE void sides(kdr_lanes_f lo, kdr_lanes_f hi, const kdr_split *split, kdr_lane_bits valid,
                            kdr_lane_bits *left, kdr_lane_bits *right) {
    kdr_lanes_f plane = kdr_lanes_all(split->plane);
    kdr_lane_bits below = kdr_lanes_less(lo, plane), above = kdr_lanes_less(plane, hi);
    kdr_lane_bits flat = ~(below | above);
    *left = (below | (split->flat_left ? flat : 0)) & valid;
    *right = (above | (split->flat_left ? 0 : flat)) & valid;
}

static void count(const kdr_references *from, uint32_t begin, uint32_t end, const kdr_split *split, uint32_t *left,
                  uint32_t *right) {
    const float *lo = from->lo[split->axis], *hi = from->hi[split->axis];
    uint32_t n_left = 0, n_right = 0, i = begin;
    kdr_lane_bits l, r;
    for (; i + KDR_LANES <= end; i += KDR_LANES) {
        sides(kdr_lanes_load(lo + i), kdr_lanes_load(hi + i), split, KDR_LANE_BITS_ALL, &l, &r);
        n_left += (uint32_t)__builtin_popcount(l);
        n_right += (uint32_t)__builtin_popcount(r);
    }
    for (; i < end; i++) {
        bool flat = !(lo[i] < split->plane) && !(hi[i] > split->plane);
        n_left += lo[i] < split->plane || (flat && split->flat_left);
        n_right += hi[i] > split->plane || (flat && !split->flat_left);
    }
    *left = n_left;
    *right = n_right;
}

/* Bounds of one side, a vector for each face of the box. */
typedef struct bounds {
    kdr_lanes_f lo[3], hi[3];
} bounds;

KDR_LANES_INLINE void bounds_clear(bounds *b) {
    for (int k = 0; k < 3; k++) {
        b->lo[k] = kdr_lanes_all(INFINITY);
        b->hi[k] = kdr_lanes_all(-INFINITY);
    }
}

KDR_LANES_INLINE void bounds_to_box(const bounds *b, kdr_box *box) {
    for (int k = 0; k < 3; k++) {
        float lo = kdr_lanes_least(b->lo[k]), hi = kdr_lanes_most(b->hi[k]);
        box->lo[k] = lo < box->lo[k] ? lo : box->lo[k];
        box->hi[k] = hi > box->hi[k] ? hi : box->hi[k];
    }
}

KDR_LANES_INLINE void append(const kdr_references *to, uint32_t at, kdr_lane_bits bits, const kdr_lanes_f lo[3],
                             const kdr_lanes_f hi[3], kdr_lanes_u primitive, bounds *b) {
    const kdr_lanes_f most = kdr_lanes_all(INFINITY), least = kdr_lanes_all(-INFINITY);
    for (int k = 0; k < 3; k++) {
        kdr_lanes_compress(to->lo[k] + at, bits, lo[k]);
        kdr_lanes_compress(to->hi[k] + at, bits, hi[k]);
        b->lo[k] = kdr_lanes_min(b->lo[k], kdr_lanes_choose(bits, lo[k], most));
        b->hi[k] = kdr_lanes_max(b->hi[k], kdr_lanes_choose(bits, hi[k], least));
    }
    kdr_lanes_compress_u(to->primitive + at, bits, primitive);
}

static void divide(const kdr_references *from, uint32_t begin, uint32_t end, const kdr_split *split,
                   const float *corners, const kdr_references *left, uint32_t left_at, const kdr_references *right,
                   uint32_t right_at, kdr_box *left_box, kdr_box *right_box) {
    const uint32_t axis = split->axis, axes[3] = {axis, (axis + 1) % 3, (axis + 2) % 3};
    const kdr_lanes_f plane = kdr_lanes_all(split->plane);
    bounds left_bounds, right_bounds;
    bounds_clear(&left_bounds);
    bounds_clear(&right_bounds);
    for (uint32_t i = begin; i < end; i += KDR_LANES) {
        /* Load a vector; behind the end its lanes are copies that no bit selects. */
        kdr_lanes_f lo[3], hi[3];
        kdr_lanes_u primitive;
        kdr_lane_bits valid = kdr_lanes_first(end - i), l, r;
        if (__builtin_expect(end - i >= KDR_LANES, 1)) {
            for (int k = 0; k < 3; k++) {
                lo[k] = kdr_lanes_load(from->lo[k] + i);
                hi[k] = kdr_lanes_load(from->hi[k] + i);
            }
            primitive = kdr_lanes_load_u(from->primitive + i);
        } else {
            float rest[6][KDR_LANES];
            uint32_t rest_primitive[KDR_LANES];
            for (uint32_t j = 0; j < KDR_LANES; j++) {
                uint32_t source = i + j < end ? i + j : i;
                for (int k = 0; k < 3; k++) {
                    rest[k][j] = from->lo[k][source];
                    rest[3 + k][j] = from->hi[k][source];
                }
                rest_primitive[j] = from->primitive[source];
            }
            for (int k = 0; k < 3; k++) {
                lo[k] = kdr_lanes_load(rest[k]);
                hi[k] = kdr_lanes_load(rest[3 + k]);
            }
            primitive = kdr_lanes_load_u(rest_primitive);
        }

        /* Send each lane left, right or both ways, clipped to the plane. */
        sides(lo[axis], hi[axis], split, valid, &l, &r);
        if (corners && (l & r)) {
            chop_boxes below = {{lo[0], lo[1], lo[2]}, {hi[0], hi[1], hi[2]}}, above = below;
            chop_triangles triangles = chop_gather(corners, primitive, l & r, axes);
            chop(&triangles, axes, split->plane, true, &below);
            chop(&triangles, axes, split->plane, false, &above);
            below.hi[axis] = kdr_lanes_min(hi[axis], plane);
            above.lo[axis] = kdr_lanes_max(lo[axis], plane);
            append(left, left_at, l, below.lo, below.hi, primitive, &left_bounds);
            append(right, right_at, r, above.lo, above.hi, primitive, &right_bounds);
            left_at += (uint32_t)__builtin_popcount(l);
            right_at += (uint32_t)__builtin_popcount(r);
            continue;
        }
        if (l) {
            kdr_lanes_f whole = hi[axis];
            hi[axis] = kdr_lanes_min(whole, plane);
            append(left, left_at, l, lo, hi, primitive, &left_bounds);
            left_at += (uint32_t)__builtin_popcount(l);
            hi[axis] = whole;
        }
        if (r) {
            lo[axis] = kdr_lanes_max(lo[axis], plane);
            append(right, right_at, r, lo, hi, primitive, &right_bounds);
            right_at += (uint32_t)__builtin_popcount(r);
        }
    }
    bounds_to_box(&left_bounds, left_box);
    bounds_to_box(&right_bounds, right_box);
}

static void masks(const kdr_references *references, kdr_mask_table *table) {
    /* Pad the boxes to whole vectors with copies of the first one: same planes, and bits that no set contains. */
    uint32_t n = references->count, padded = (2 * n + 15) / 16 * 16;
    table->count = padded;
    for (int k = 0; k < 3; k++) {
        float lo[KDR_MASK_LIMIT], hi[KDR_MASK_LIMIT];
        for (uint32_t i = 0; i < KDR_MASK_LIMIT; i++) {
            lo[i] = references->lo[k][i < n ? i : 0];
            hi[i] = references->hi[k][i < n ? i : 0];
        }
        for (uint32_t p = 0; p < padded; p++) {
            float at = p < n ? lo[p] : p < 2 * n ? hi[p - n] : NAN;
            kdr_lanes_f plane = kdr_lanes_all(at);
            uint32_t below = 0, above = 0;
            for (uint32_t i = 0; i < KDR_MASK_LIMIT; i += KDR_LANES) {
                below |= kdr_lanes_less(kdr_lanes_load(lo + i), plane) << i;
                above |= kdr_lanes_less(plane, kdr_lanes_load(hi + i)) << i;
            }
            /* A plane through a begin sends what lies in it right, one through an end sends it left. */
            uint32_t flat = ~(below | above);
            table->plane[k][p] = at;
            table->left[k][p] = p < n ? below : below | flat;
            table->right[k][p] = p < n ? above | flat : above;
        }
    }
}

/* Set bits of each lane. */
KDR_LANES_INLINE kdr_lanes_f population(kdr_lanes_u x) {
    x = x - ((x >> 1) & 0x55555555u);
    x = (x & 0x33333333u) + ((x >> 2) & 0x33333333u);
    x = (x + (x >> 4)) & 0x0f0f0f0fu;
    x = (x * 0x01010101u) >> 24;
    return __builtin_convertvector((kdr_lanes_i)x, kdr_lanes_f);
}

static kdr_split choose_masked(const kdr_mask_table *table, uint32_t set, const kdr_box *cell, const kdr_plan *plan,
                               uint32_t axes, uint32_t *left, uint32_t *right) {
    kdr_fractions fractions = kdr_fractions_of(cell);
    kdr_split best = {.cost = INFINITY};
    uint32_t best_index = 0;
    for (uint32_t k = 0; k < 3; k++) {
        if (!(axes >> k & 1))
            continue;
        const kdr_lanes_f lo = kdr_lanes_all(cell->lo[k]), hi = kdr_lanes_all(cell->hi[k]);
        const float face = (float)(fractions.face[k] * fractions.inverse_area) * plan->cost_intersection;
        const float rim = (float)(fractions.rim[k] * fractions.inverse_area) * plan->cost_intersection;
        for (uint32_t p = 0; p < table->count; p += KDR_LANES) {
            /* cost = traversal + sum over both sides of (face + rim x extent) x primitives */
            kdr_lanes_f plane = kdr_lanes_load(table->plane[k] + p);
            kdr_lanes_f n_left = population(kdr_lanes_load_u(table->left[k] + p) & set);
            kdr_lanes_f n_right = population(kdr_lanes_load_u(table->right[k] + p) & set);
            kdr_lanes_f cost = (face + rim * (plane - lo)) * n_left + (face + rim * (hi - plane)) * n_right;
            cost = reward_empty(cost, n_left, n_right, plan->empty_bonus);
            kdr_lane_bits inside = kdr_lanes_less(lo, plane) & kdr_lanes_less(plane, hi);
            kdr_lane_bits better = inside & kdr_lanes_less(cost, kdr_lanes_all(best.cost));
            if (!better)
                continue;

            /* Take the first of the cheapest, so that the width of lanes does not show. */
            float costs[KDR_LANES];
            kdr_lanes_store(costs, cost);
            for (; better; better &= better - 1) {
                uint32_t lane = (uint32_t)__builtin_ctz(better);
                if (costs[lane] < best.cost) {
                    best.cost = costs[lane];
                    best.axis = k;
                    best_index = p + lane;
                }
            }
        }
    }
    if (best.cost < INFINITY) {
        best.plane = table->plane[best.axis][best_index];
        best.cost += plan->cost_traversal;
        *left = table->left[best.axis][best_index] & set;
        *right = table->right[best.axis][best_index] & set;
    }
    return best;
}

extern const kdr_build_kernels KDR_LANES_SYMBOL(kdr_build_kernels);
const kdr_build_kernels KDR_LANES_SYMBOL(kdr_build_kernels) = {.choose_binned = choose_binned,
                                                               .count = count,
                                                               .divide = divide,
                                                               .snap = snap,
                                                               .masks = masks,
                                                               .choose_masked = choose_masked};
