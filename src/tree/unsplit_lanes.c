/* The two passes of unsplit.h over KDR_LANES triangles at a time. */
#include "tree/unsplit.h"

#include "geometry/lanes.h"

/* How much the box of a leaf may grow by all that it claims, as a ratio of areas. Measured: up to 1.4 scanned models
 * gain a little more, from 1.3 on closed rooms lose up to a fifth. */
#define GROWTH 1.25

/* Boxes of the triangles of a block, and their union so far. */
typedef struct bounds {
    float lo[3][KDR_UNSPLIT_LIMIT + KDR_LANES], hi[3][KDR_UNSPLIT_LIMIT + KDR_LANES];
} bounds;

typedef struct lane_box {
    kdr_lanes_f lo[3], hi[3];
} lane_box;

/* Loads from one of a block's rows 6 to 8, with `left` floats to its end. Vectors of more than two groups could reach
 * over the end of a block of one group into the next, which another thread may be filling. */
KDR_LANES_INLINE kdr_lanes_f load_last(const float *row, size_t left) {
#if KDR_LANES > 2 * KDR_BLOCK_GROUP
    return kdr_lanes_load_some(row, kdr_lanes_first((uint32_t)left));
#else
    (void)left;
    return kdr_lanes_load(row);
#endif
}

KDR_LANES_INLINE lane_box boxes_at(kdr_block block, size_t first) {
    lane_box b;
    size_t left = block.length - first;
    for (size_t k = 0; k < 3; k++) {
        const float *row = block.rows + k * block.length + first;
        kdr_lanes_f x = kdr_lanes_load(row), y = kdr_lanes_load(row + 3 * block.length),
                    z = load_last(row + 6 * block.length, left);
        b.lo[k] = kdr_lanes_min(kdr_lanes_min(x, y), z);
        b.hi[k] = kdr_lanes_max(kdr_lanes_max(x, y), z);
    }
    return b;
}

KDR_LANES_INLINE lane_box no_boxes(void) {
    lane_box b;
    for (int k = 0; k < 3; k++) {
        b.lo[k] = kdr_lanes_all(INFINITY);
        b.hi[k] = kdr_lanes_all(-INFINITY);
    }
    return b;
}

/* Widens the lanes of *to that `bits` names by the boxes `from`, those of `uncut` as they are, others cut to the cell.
 */
KDR_LANES_INLINE void widen(lane_box *to, kdr_lane_bits bits, kdr_lane_bits uncut, const lane_box *from,
                            const kdr_box *cell) {
    for (int k = 0; k < 3; k++) {
        kdr_lanes_f lo = kdr_lanes_max(from->lo[k], kdr_lanes_all(cell->lo[k]));
        kdr_lanes_f hi = kdr_lanes_min(from->hi[k], kdr_lanes_all(cell->hi[k]));
        lo = kdr_lanes_min(to->lo[k], kdr_lanes_choose(uncut, from->lo[k], lo));
        hi = kdr_lanes_max(to->hi[k], kdr_lanes_choose(uncut, from->hi[k], hi));
        to->lo[k] = kdr_lanes_choose(bits, lo, to->lo[k]);
        to->hi[k] = kdr_lanes_choose(bits, hi, to->hi[k]);
    }
}

KDR_LANES_INLINE kdr_box union_of(const lane_box *b) {
    kdr_box box;
    for (int k = 0; k < 3; k++) {
        box.lo[k] = kdr_lanes_least(b->lo[k]);
        box.hi[k] = kdr_lanes_most(b->hi[k]);
    }
    return box;
}

/* Lanes whose box reaches out of the cell. */
KDR_LANES_INLINE kdr_lane_bits reach_out(const lane_box *b, const kdr_box *cell) {
    kdr_lane_bits out = 0;
    for (int k = 0; k < 3; k++)
        out |=
            kdr_lanes_less(b->lo[k], kdr_lanes_all(cell->lo[k])) | kdr_lanes_less(kdr_lanes_all(cell->hi[k]), b->hi[k]);
    return out;
}

/* Lanes for which the cell is where their box's descent ends, if at planes that cut the box it follows the centre. At a
 * plane in which a box lies flat it may end on both sides, so nobody owns that one. */
KDR_LANES_INLINE kdr_lane_bits owned(const lane_box *b, const kdr_box *cell) {
    kdr_lane_bits others = 0;
    for (int k = 0; k < 3; k++) {
        kdr_lanes_f least = kdr_lanes_all(cell->lo[k]), most = kdr_lanes_all(cell->hi[k]);
        kdr_lanes_f centre = 0.5f * b->lo[k] + 0.5f * b->hi[k];
        kdr_lane_bits below = kdr_lanes_less(centre, least) & kdr_lanes_less(b->lo[k], least);
        kdr_lane_bits above = ~kdr_lanes_less(centre, most) & kdr_lanes_less(most, b->hi[k]);
        kdr_lane_bits extends = kdr_lanes_less(b->lo[k], b->hi[k]);
        kdr_lane_bits apart = kdr_lanes_less(least, b->lo[k]) & kdr_lanes_less(b->hi[k], most);
        others |= below | above | (~extends & ~apart);
    }
    return ~others;
}

static void claim(const float *blocks, kdr_node leaf, const kdr_box *cell, uint8_t *whole, kdr_shown *shown) {
    uint32_t count = kdr_node_count(leaf);
    kdr_block block = kdr_block_of(blocks, leaf);
    bool takes_part = count <= KDR_UNSPLIT_LIMIT;
    uint64_t shared = 0, candidates = 0;
    bounds each;
    lane_box all = no_boxes();
    for (uint32_t first = 0; first < count; first += KDR_LANES) {
        lane_box b = boxes_at(block, first);
        kdr_lane_bits held = kdr_lanes_first(count - first);
        widen(&all, held, 0, &b, cell);
        if (!takes_part)
            continue;
        kdr_lane_bits out = reach_out(&b, cell) & held;
        shared |= (uint64_t)out << first;
        candidates |= (uint64_t)(out & owned(&b, cell)) << first;
        for (int k = 0; k < 3; k++) {
            kdr_lanes_store(&each.lo[k][first], b.lo[k]);
            kdr_lanes_store(&each.hi[k][first], b.hi[k]);
        }
    }
    *shown = (kdr_shown){.box = union_of(&all), .groups = kdr_block_groups(count), .shared = shared};

    /* Claim, the lowest first, while the box grows little. */
    kdr_box grown = shown->box;
    double most = GROWTH * kdr_box_area(&grown);
    for (; candidates; candidates &= candidates - 1) {
        uint32_t i = (uint32_t)__builtin_ctzll(candidates);
        kdr_box with = {{each.lo[0][i], each.lo[1][i], each.lo[2][i]}, {each.hi[0][i], each.hi[1][i], each.hi[2][i]}};
        kdr_box_add(&with, &grown);
        if (kdr_box_area(&with) > most)
            continue;
        grown = with;
        shown->claimed |= (uint64_t)1 << i;
        whole[kdr_block_primitive(block, i)] = 1;
    }
    kdr_lanes_leave();
}

/* Moves triangles so that place i holds what was in place from[i]. */
static void move(float *rows, size_t length, uint32_t count, const uint8_t from[KDR_UNSPLIT_LIMIT]) {
    for (uint32_t row = 0; row < KDR_BLOCK_ROWS; row++) {
        uint32_t before[KDR_UNSPLIT_LIMIT]; /* primitives are no floats */
        float *at = rows + row * length;
        memcpy(before, at, count * sizeof *before);
        for (uint32_t i = 0; i < count; i++)
            memcpy(&at[i], &before[from[i]], sizeof *at);
    }
}

static void sort(float *blocks, kdr_node leaf, const kdr_box *cell, const uint8_t *whole, kdr_shown *shown) {
    uint32_t count = kdr_node_count(leaf);
    kdr_block block = kdr_block_of(blocks, leaf);
    uint64_t hidden = 0, claimed = shown->claimed;
    for (uint64_t shared = shown->shared & ~claimed; shared; shared &= shared - 1) {
        uint32_t i = (uint32_t)__builtin_ctzll(shared);
        hidden |= (uint64_t)whole[kdr_block_primitive(block, i)] << i;
    }
    if ((hidden | claimed) == 0)
        return;

    /* The box of what is shown. */
    lane_box all = no_boxes();
    for (uint32_t first = 0; first < count; first += KDR_LANES) {
        lane_box b = boxes_at(block, first);
        kdr_lane_bits shows = kdr_lanes_first(count - first) & ~(kdr_lane_bits)(hidden >> first);
        widen(&all, shows, (kdr_lane_bits)(claimed >> first) & KDR_LANE_BITS_ALL, &b, cell);
    }
    shown->box = union_of(&all);
    kdr_lanes_leave();

    /* What is shown comes first; both parts keep their order. */
    if (hidden == 0)
        return;
    uint8_t from[KDR_UNSPLIT_LIMIT];
    uint32_t first = 0, last = count - (uint32_t)__builtin_popcountll(hidden);
    shown->groups = kdr_block_groups(last);
    for (uint32_t i = 0; i < count; i++) {
        bool hides = hidden >> i & 1;
        from[hides ? last : first] = (uint8_t)i;
        first += !hides;
        last += hides;
    }
    move(kdr_block_start(blocks, leaf), block.length, count, from);
    kdr_block_pad(blocks, leaf);
}

extern const kdr_unsplit KDR_LANES_SYMBOL(kdr_unsplit);
const kdr_unsplit KDR_LANES_SYMBOL(kdr_unsplit) = {.claim = claim, .sort = sort};
