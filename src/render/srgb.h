/* Between linear light and the 8-bit sRGB of files (IEC 61966-2-1). */
#ifndef KDR_RENDER_SRGB_H
#define KDR_RENDER_SRGB_H

#include <stdint.h>

/* Linear values of the 256 codes, and where rounding goes from one code to the next. */
typedef struct kdr_srgb_tables {
    float linear[256];
    float threshold[257]; /* least linear value whose code is i or more; [0] is 0, [256] infinite */
    uint8_t start[4097];  /* code of the linear value i / 4096 */
} kdr_srgb_tables;

/* Made on the first call. Thread safe. */
const kdr_srgb_tables *kdr_srgb_get_tables(void);

/* Linear value of a code in [0, 1]. */
float kdr_srgb_to_linear(float code);

/* Nearest code; values outside [0, 1] are clamped, NaN gives 0. */
static inline uint8_t kdr_srgb_from_linear(const kdr_srgb_tables *tables, float linear) {
    float value = linear > 0 ? (linear < 1 ? linear : 1) : 0;
    unsigned code = tables->start[(unsigned)(value * 4096)];
    // Thresholds are at least 1 / 3295 apart: no more than one lies within a step of the table.
    return (uint8_t)(code + (value >= tables->threshold[code + 1]));
}

#endif
