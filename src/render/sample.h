/* Where in its pixel a sample lies: a pure function of (seed, pixel, sample), so that no thread needs a generator. */
#ifndef KDR_RENDER_SAMPLE_H
#define KDR_RENDER_SAMPLE_H

#include <stdint.h>

/* How `count` samples share a pixel: floor(sqrt(count)) rows, each with nearly as many columns, every cell of the same
 * area 1 / count. */
typedef struct kdr_strata {
    uint32_t count;
    uint32_t rows;
    uint32_t columns; /* of a row; the first `longer_rows` have one more */
    uint32_t longer_rows;
} kdr_strata;

kdr_strata kdr_strata_make(uint32_t count);

/* Position of a sample within its pixel, x and y in [0, 1): the centre if there is one sample only, else a random point
 * of the sample's cell. */
void kdr_strata_place(const kdr_strata *strata, uint64_t seed, uint32_t pixel_x, uint32_t pixel_y, uint32_t sample,
                      float *x, float *y);

#endif
