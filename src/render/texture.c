#include "render/texture.h"

#define CHECKER_SQUARES 16

static const kdr_vector checker_light = {0.62f, 0.58f, 0.50f};
static const kdr_vector checker_dark = {0.20f, 0.23f, 0.26f};

static kdr_vector checker_at(float u, float v) {
    float column = floorf(u * CHECKER_SQUARES), row = floorf(v * CHECKER_SQUARES);
    float sum = column + row;
    return sum - 2 * floorf(sum / 2) < 1 ? checker_light : checker_dark;
}

/* Where a coordinate falls between two pixels of a row that repeats. */
typedef struct span {
    uint32_t first, second;
    float weight; /* of the second */
} span;

static span span_at(float coordinate, uint32_t count) {
    float position = (coordinate - floorf(coordinate)) * (float)count - 0.5f;
    float below = floorf(position);
    uint32_t first = below < 0 ? count - 1 : (uint32_t)below;
    first = first < count ? first : count - 1;
    return (span){.first = first, .second = first + 1 < count ? first + 1 : 0, .weight = position - below};
}

static kdr_vector pixel(const kdr_image *image, uint32_t x, uint32_t y) {
    return kdr_vector_of(image->rgb + ((size_t)y * image->width + x) * 3);
}

kdr_vector kdr_texture_at(const kdr_texture *texture, float u, float v) {
    if (!isfinite(u) || !isfinite(v))
        return checker_light;
    if (!texture->image)
        return checker_at(u, v);
    const kdr_image *image = texture->image;
    span x = span_at(u, image->width), y = span_at(v, image->height);
    kdr_vector above = kdr_vector_mix(pixel(image, x.first, y.first), pixel(image, x.second, y.first), x.weight);
    kdr_vector below = kdr_vector_mix(pixel(image, x.first, y.second), pixel(image, x.second, y.second), x.weight);
    return kdr_vector_mix(above, below, y.weight);
}
