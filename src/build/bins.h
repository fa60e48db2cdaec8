/* Min-max bins and the split they choose (SPEC B1): see bins.c. */
#ifndef KDR_BUILD_BINS_H
#define KDR_BUILD_BINS_H

#include "build/split.h"

#define KDR_BIN_COUNT 32

/* Counters on three axes over one box: where primitives begin and where they end. */
typedef struct kdr_bins {
    uint32_t begins[3][KDR_BIN_COUNT], ends[3][KDR_BIN_COUNT];
} kdr_bins;

/* Where the bins of a box lie; scale 0: the axis has no bins. */
typedef struct kdr_bin_grid {
    float lo[3], scale[3], width[3];
} kdr_bin_grid;

kdr_bin_grid kdr_bin_grid_of(const kdr_box *box);

/* Counts references begin, begin + step ... below end. */
void kdr_bins_add(kdr_bins *bins, const kdr_bin_grid *grid, const kdr_references *references, uint32_t begin,
                  uint32_t end, uint32_t step);
void kdr_bins_merge(kdr_bins *bins, const kdr_bins *other);

/* Of `count` primitives every how many are counted: floor(log10 count), at least 1. */
uint32_t kdr_bins_step(uint32_t count);

#endif
