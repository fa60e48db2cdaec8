/* Pixels in memory: made, released, compared. */
#include "kdray/render.h"

#include "render/memory.h"
#include "render/srgb.h"

#include <math.h>
#include <string.h>

#define SIDE_LIMIT 65536u

static size_t rgb_bytes(uint32_t width, uint32_t height) { return (size_t)width * height * 3 * sizeof(float); }

kdr_status kdr_image_create(uint32_t width, uint32_t height, kdr_image **out) {
    if (!out)
        return KDR_ERROR_INVALID_ARGUMENT;
    *out = NULL;
    if (width == 0 || height == 0 || width > SIDE_LIMIT || height > SIDE_LIMIT)
        return KDR_ERROR_INVALID_ARGUMENT;

    kdr_image *image = kdr_render_get(1, sizeof(kdr_image));
    if (!image)
        return KDR_ERROR_OUT_OF_MEMORY;
    float *rgb = kdr_render_get(rgb_bytes(width, height), 1);
    if (!rgb) {
        kdr_render_release(image, sizeof(kdr_image));
        return KDR_ERROR_OUT_OF_MEMORY;
    }
    memset(rgb, 0, rgb_bytes(width, height));
    *image = (kdr_image){.width = width, .height = height, .rgb = rgb};
    *out = image;
    return KDR_OK;
}

void kdr_image_destroy(kdr_image *image) {
    if (!image)
        return;
    kdr_render_release(image->rgb, rgb_bytes(image->width, image->height));
    kdr_render_release(image, sizeof(kdr_image));
}

void kdr_image_bytes(const kdr_image *image, uint8_t *bytes) {
    const kdr_srgb_tables *srgb = kdr_srgb_get_tables();
    size_t count = (size_t)image->width * image->height * 3;
    for (size_t i = 0; i < count; i++)
        bytes[i] = kdr_srgb_from_linear(srgb, image->rgb[i]);
}

kdr_status kdr_image_compare(const kdr_image *a, const kdr_image *b, double *difference) {
    if (!a || !b || !difference || a->width != b->width || a->height != b->height)
        return KDR_ERROR_INVALID_ARGUMENT;
    const kdr_srgb_tables *srgb = kdr_srgb_get_tables();
    size_t count = (size_t)a->width * a->height * 3;
    uint64_t sum = 0;
    for (size_t i = 0; i < count; i++) {
        int distance = kdr_srgb_from_linear(srgb, a->rgb[i]) - kdr_srgb_from_linear(srgb, b->rgb[i]);
        sum += (uint64_t)(distance * distance);
    }
    *difference = sqrt((double)sum / (double)count);
    return KDR_OK;
}
