/* Min-max binning.
 *
 * Each primitive counts twice on each axis: in the bin where its box begins and in the bin where it ends. The begins
 * below a bin boundary are the primitives that reach to its left, the ends above it those that reach to its right,
 * whatever their size. Large nodes count every l-th primitive only, l = floor(log10 N).
 *
 * Source: M. Shevtsov, A. Soupikov, A. Kapustin, "Highly Parallel Fast KD-tree Construction for Interactive Ray Tracing
 * of Dynamic Scenes", 2007, sections 3.1 to 3.4.
 * Choosing among the bin boundaries is in kernels_lanes.c. Beyond the paper: bins cover the bounds of the primitives
 * instead of the cell, and the two faces of the bounds are candidates of their own, which cut off empty space. Cost:
 * six counter updates a counted primitive, 99 cost evaluations a node. */
#include "build/bins.h"

#include <math.h>
#include <string.h>

kdr_bin_grid kdr_bin_grid_of(const kdr_box *box) {
    kdr_bin_grid grid;
    for (int k = 0; k < 3; k++) {
        float extent = box->hi[k] - box->lo[k];
        /* Outside this range bin numbers are not to be trusted. */
        bool usable = extent >= 0x1p-100f && extent <= 0x1p100f && fabsf(box->lo[k]) <= 0x1p100f;
        grid.lo[k] = usable ? box->lo[k] : 0; /* finite - 0 times 0 is bin 0, whatever the numbers */
        grid.scale[k] = usable ? (float)KDR_BIN_COUNT / extent : 0;
        grid.width[k] = usable ? extent / (float)KDR_BIN_COUNT : 0;
    }
    return grid;
}

static inline uint32_t bin_of(float x, float lo, float scale) {
    int32_t bin = (int32_t)((x - lo) * scale);
    return (uint32_t)(bin < KDR_BIN_COUNT - 1 ? bin : KDR_BIN_COUNT - 1);
}

void kdr_bins_add(kdr_bins *bins, const kdr_bin_grid *grid, const kdr_references *r, uint32_t begin, uint32_t end,
                  uint32_t step) {
    for (uint32_t i = begin; i < end; i += step) {
        for (int k = 0; k < 3; k++) {
            bins->begins[k][bin_of(r->lo[k][i], grid->lo[k], grid->scale[k])]++;
            bins->ends[k][bin_of(r->hi[k][i], grid->lo[k], grid->scale[k])]++;
        }
    }
}

void kdr_bins_merge(kdr_bins *bins, const kdr_bins *other) {
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < KDR_BIN_COUNT; i++) {
            bins->begins[k][i] += other->begins[k][i];
            bins->ends[k][i] += other->ends[k][i];
        }
    }
}

uint32_t kdr_bins_step(uint32_t count) {
    uint32_t step = 0;
    for (; count >= 10; count /= 10)
        step++;
    return step > 0 ? step : 1;
}
