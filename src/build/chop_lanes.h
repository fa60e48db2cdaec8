/* Triangles on both sides of a plane are cut there, KDR_LANES at a time: each side gets the bounds of the part that
 * reaches into it, within the box that the reference had.
 *
 * A triangle is cut at this plane alone, not at the cell's other faces: what it lost there is already in its box. For a
 * needle that is as good as a polygon, at a tenth of its cost.
 * Source: M. Stich, H. Friedrich, A. Dietrich, "Spatial Splits in Bounding Volume Hierarchies", 2009: split boxes.
 * Invariant: a part's box holds what the triangle has on that side, and 2^-17 of its longest extent more; the roundings
 * are fewer than 16 of the largest coordinate, and as many are added. Where nothing is left inside the box, the box
 * stays as it is: the number of references is known before they are cut. No fused operations, so that every instruction
 * set makes the same tree. Cost: some 150 operations a vector, and 9 floats gathered for each triangle. */
#ifndef KDR_BUILD_CHOP_LANES_H
#define KDR_BUILD_CHOP_LANES_H

#include "geometry/lanes.h"

#define CHOP_LARGEST 0x1p60f /* coordinates beyond are not cut */

typedef struct chop_boxes {
    kdr_lanes_f lo[3], hi[3];
} chop_boxes;

/* Corners of the chosen lanes' triangles. */
typedef struct chop_triangles {
    kdr_lanes_f along[3];     /* on the axis of the plane */
    kdr_lanes_f across[2][3]; /* on the other two */
    kdr_lanes_f margin;
    kdr_lane_bits lanes; /* those that can be cut */
} chop_triangles;

KDR_LANES_INLINE chop_triangles chop_gather(const float *corners, kdr_lanes_u primitive, kdr_lane_bits lanes,
                                            const uint32_t axes[3]) {
    chop_triangles t;
    float all[9][KDR_LANES];
    memset(all, 0, sizeof all);
    uint32_t numbers[KDR_LANES];
    memcpy(numbers, &primitive, sizeof numbers);
    for (kdr_lane_bits left = lanes; left; left &= left - 1) {
        uint32_t lane = (uint32_t)__builtin_ctz(left);
        const float *from = corners + (size_t)9 * numbers[lane];
        for (uint32_t i = 0; i < 9; i++)
            all[i][lane] = from[i];
    }
    kdr_lanes_f extent = {0}, largest = {0};
    for (uint32_t k = 0; k < 3; k++) {
        kdr_lanes_f *row = k == 0 ? t.along : t.across[k - 1];
        for (uint32_t i = 0; i < 3; i++) {
            row[i] = kdr_lanes_load(all[3 * i + axes[k]]);
            largest = kdr_lanes_max(largest, kdr_lanes_abs(row[i]));
        }
        kdr_lanes_f lo = kdr_lanes_min(kdr_lanes_min(row[0], row[1]), row[2]);
        kdr_lanes_f hi = kdr_lanes_max(kdr_lanes_max(row[0], row[1]), row[2]);
        extent = kdr_lanes_max(extent, hi - lo);
    }
    t.margin = extent * 0x1p-17f + largest * 0x1p-20f;
    t.lanes = lanes & kdr_lanes_less(largest, kdr_lanes_all(CHOP_LARGEST));
    return t;
}

/* Narrows boxes to the parts below the plane, or above it. */
KDR_LANES_INLINE void chop(const chop_triangles *t, const uint32_t axes[3], float plane, bool below, chop_boxes *box) {
    kdr_lanes_f at = below ? plane + t->margin : plane - t->margin;
    kdr_lane_bits inside[3];
    for (int i = 0; i < 3; i++)
        inside[i] = ~(below ? kdr_lanes_less(at, t->along[i]) : kdr_lanes_less(t->along[i], at));

    /* Corners that are inside, and where edges cross the plane. */
    const kdr_lanes_f most = kdr_lanes_all(INFINITY), least = kdr_lanes_all(-INFINITY);
    kdr_lanes_f lo[2] = {most, most}, hi[2] = {least, least};
    for (int i = 0; i < 3; i++) {
        int j = i < 2 ? i + 1 : 0;
        kdr_lane_bits crosses = inside[i] ^ inside[j];
        kdr_lanes_f part = (at - t->along[i]) / (t->along[j] - t->along[i]);
        for (int k = 0; k < 2; k++) {
            kdr_lanes_f corner = t->across[k][i], on_edge = corner + part * (t->across[k][j] - corner);
            lo[k] = kdr_lanes_min(lo[k], kdr_lanes_choose(inside[i], corner, most));
            hi[k] = kdr_lanes_max(hi[k], kdr_lanes_choose(inside[i], corner, least));
            lo[k] = kdr_lanes_min(lo[k], kdr_lanes_choose(crosses, on_edge, most));
            hi[k] = kdr_lanes_max(hi[k], kdr_lanes_choose(crosses, on_edge, least));
        }
    }

    kdr_lane_bits cut = t->lanes;
    for (int k = 0; k < 2; k++) {
        lo[k] = kdr_lanes_max(lo[k] - t->margin, box->lo[axes[1 + k]]);
        hi[k] = kdr_lanes_min(hi[k] + t->margin, box->hi[axes[1 + k]]);
        cut &= ~kdr_lanes_less(hi[k], lo[k]);
    }
    for (int k = 0; k < 2; k++) {
        box->lo[axes[1 + k]] = kdr_lanes_choose(cut, lo[k], box->lo[axes[1 + k]]);
        box->hi[axes[1 + k]] = kdr_lanes_choose(cut, hi[k], box->hi[axes[1 + k]]);
    }
}

#endif
