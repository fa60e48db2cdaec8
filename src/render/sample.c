#include "render/sample.h"

kdr_strata kdr_strata_make(uint32_t count) {
    uint32_t rows = 1;
    while ((uint64_t)(rows + 1) * (rows + 1) <= count)
        rows++;
    return (kdr_strata){.count = count, .rows = rows, .columns = count / rows, .longer_rows = count % rows};
}

/* A counter-based generator: the finishing step of a 64-bit multiplicative hash, applied over the key's words.
 * Source: G. Steele, D. Lea, C. Flood, "Fast Splittable Pseudorandom Number Generators", 2014 (the mixing function). */
static uint64_t mix(uint64_t value) {
    value += 0x9e3779b97f4a7c15u;
    value = (value ^ value >> 30) * 0xbf58476d1ce4e5b9u;
    value = (value ^ value >> 27) * 0x94d049bb133111ebu;
    return value ^ value >> 31;
}

/* 24 bits to [0, 1): every value is a float, and 1 is none of them. */
static float unit_float(uint32_t bits) { return (float)(bits >> 8) * 0x1p-24f; }

static float below_one(float value) { return value < 0x1.fffffep-1f ? value : 0x1.fffffep-1f; }

void kdr_strata_place(const kdr_strata *strata, uint64_t seed, uint32_t pixel_x, uint32_t pixel_y, uint32_t sample,
                      float *x, float *y) {
    if (strata->count == 1) {
        *x = *y = 0.5f;
        return;
    }

    // Find the row that holds the sample, the samples before that row, and the row's columns.
    uint32_t columns = strata->columns + 1, in_longer = strata->longer_rows * columns, before = 0;
    uint32_t rest = sample;
    if (sample >= in_longer) {
        columns = strata->columns;
        before = in_longer;
        rest = sample - in_longer;
    }
    uint32_t column = rest % columns;
    before += rest - column;

    uint64_t bits = mix(mix(mix(seed) ^ ((uint64_t)pixel_y << 32 | pixel_x)) ^ sample);
    float jitter_x = unit_float((uint32_t)bits), jitter_y = unit_float((uint32_t)(bits >> 32));
    *x = below_one(((float)column + jitter_x) / (float)columns);
    *y = below_one(((float)before + jitter_y * (float)columns) / (float)strata->count);
}
