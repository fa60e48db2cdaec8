#include "view_picture.h"

#include "memory.h"
#include "progress.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

/* Work shared by the workers. */
typedef struct tracing {
    kdr_view_picture *picture;
    const kdr_view_look *look;
    const kdr_camera_frame *frame;
    uint32_t columns, tiles;
    _Atomic uint32_t next;
    bool colours; /* else values are to be coloured */
    uint32_t scale[256];
} tracing;

static void make_codes(uint8_t codes[KDR_VIEW_CODES + 1]) {
    for (int i = 0; i <= KDR_VIEW_CODES; i++) {
        double light = (double)i / KDR_VIEW_CODES;
        double code = light <= 0.0031308 ? 12.92 * light : 1.055 * pow(light, 1 / 2.4) - 0.055;
        codes[i] = (uint8_t)(255 * code + 0.5);
    }
}

static uint32_t colour_of(const tracing *work, const float sum[3], float part) {
    uint32_t colour = 0;
    for (int k = 0; k < 3; k++) {
        float light = fminf(fmaxf(sum[k] * part, 0), 1);
        colour = colour << 8 | work->picture->codes[(int)(light * KDR_VIEW_CODES + 0.5f)];
    }
    return colour;
}

static void trace_tiles(void *context, uint32_t index) {
    tracing *work = context;
    kdr_view_picture *picture = work->picture;
    const kdr_view_raster *raster = &picture->raster;
    float part = 1 / (float)(raster->sample + 1);
    for (;;) {
        uint32_t tile = atomic_fetch_add(&work->next, 1);
        if (tile >= work->tiles)
            return;
        uint32_t x = tile % work->columns * KDR_TILE_SIDE, y = tile / work->columns * KDR_TILE_SIDE;
        kdr_view_tile_trace(&picture->painters[index], work->look, work->frame, raster, x, y, picture->sums,
                            picture->depth);
        uint32_t right = x + KDR_TILE_SIDE < raster->width ? x + KDR_TILE_SIDE : raster->width;
        uint32_t bottom = y + KDR_TILE_SIDE < raster->height ? y + KDR_TILE_SIDE : raster->height;
        for (; y < bottom; y++)
            for (uint32_t i = x; i < right; i++) {
                size_t p = (size_t)y * raster->width + i;
                if (work->colours)
                    picture->colours[p] = colour_of(work, picture->sums[p], part);
                else
                    picture->values[p] = picture->sums[p][0];
            }
    }
}

/* Depth goes from the nearest to the farthest hit, costs from 0. */
static void find_scale(kdr_view_picture *picture, kdr_view_show show, size_t count) {
    picture->low = 0;
    if (show != KDR_SHOW_DEPTH) {
        picture->high = (float)kdr_view_show_end(picture->values, count);
        return;
    }
    picture->low = INFINITY;
    picture->high = 0;
    for (size_t i = 0; i < count; i++) {
        float value = picture->values[i];
        picture->low = value >= 0 ? fminf(picture->low, value) : picture->low;
        picture->high = fmaxf(picture->high, value);
    }
    if (!(picture->low < picture->high))
        picture->low = 0;
}

static void colour_values(tracing *work, size_t count) {
    kdr_view_picture *picture = work->picture;
    kdr_view_show show = work->look->show;
    find_scale(picture, show, count);
    for (uint32_t i = 0; i < 256; i++)
        work->scale[i] = kdr_view_show_colour(show, i / 255.0);
    float range = picture->high - picture->low;
    for (size_t i = 0; i < count; i++) {
        float part = range > 0 ? (picture->values[i] - picture->low) / range : 0;
        picture->colours[i] =
            picture->values[i] < 0 ? 0x101418 : work->scale[(int)(255 * fminf(fmaxf(part, 0), 1) + 0.5f)];
    }
}

static void make_room(kdr_view_picture *picture, uint32_t workers) {
    size_t count = (size_t)picture->raster.width * picture->raster.height;
    if (count > picture->capacity) {
        kdr_memory_release(picture->sums);
        kdr_memory_release(picture->depth);
        kdr_memory_release(picture->values);
        kdr_memory_release(picture->colours);
        picture->sums = kdr_memory_get(count, sizeof *picture->sums);
        picture->depth = kdr_memory_get(count, sizeof *picture->depth);
        picture->values = kdr_memory_get(count, sizeof *picture->values);
        picture->colours = kdr_memory_get(count, sizeof *picture->colours);
        picture->capacity = count;
    }
    if (picture->painter_count == 0)
        make_codes(picture->codes);
    if (picture->painter_count < workers) {
        kdr_memory_release(picture->painters);
        picture->painters = kdr_memory_get(workers, sizeof *picture->painters);
        picture->painter_count = workers;
    }
}

void kdr_view_picture_trace(kdr_view_picture *picture, kdr_device *device, const kdr_view_look *look,
                            const kdr_camera_frame *frame, kdr_view_raster raster) {
    raster.width = (raster.window_width + raster.scale - 1) / raster.scale;
    raster.height = (raster.window_height + raster.scale - 1) / raster.scale;
    picture->raster = raster;
    uint32_t workers = kdr_device_worker_count(device);
    make_room(picture, workers);

    double begin = kdr_seconds();
    tracing work = {.picture = picture, .look = look, .frame = frame};
    work.colours = !kdr_view_show_is_value(look->show);
    work.columns = (raster.width + KDR_TILE_SIDE - 1) / KDR_TILE_SIDE;
    work.tiles = work.columns * ((raster.height + KDR_TILE_SIDE - 1) / KDR_TILE_SIDE);
    for (uint32_t i = 0; i < workers; i++)
        picture->painters[i].rays = 0;
    kdr_device_run(device, trace_tiles, &work, workers);
    if (!work.colours)
        colour_values(&work, (size_t)raster.width * raster.height);
    picture->seconds = kdr_seconds() - begin;
    picture->rays = 0;
    for (uint32_t i = 0; i < workers; i++)
        picture->rays += picture->painters[i].rays;
}

void kdr_view_picture_copy(const kdr_view_picture *picture, kdr_canvas *canvas) {
    uint32_t scale = picture->raster.scale;
    size_t width = (size_t)canvas->width;
    for (uint32_t y = 0; y < (uint32_t)canvas->height; y++) {
        uint32_t *out = canvas->pixels + y * width;
        const uint32_t *row = picture->colours + (size_t)(y / scale) * picture->raster.width;
        if (y % scale > 0)
            memcpy(out, out - width, width * sizeof *out);
        else if (scale == 1)
            memcpy(out, row, width * sizeof *out);
        else
            for (uint32_t x = 0, end = 0; x < width; row++)
                for (end = x + scale < width ? x + scale : (uint32_t)width; x < end; x++)
                    out[x] = *row;
    }
}

void kdr_view_picture_release(kdr_view_picture *picture) {
    kdr_memory_release(picture->sums);
    kdr_memory_release(picture->depth);
    kdr_memory_release(picture->values);
    kdr_memory_release(picture->colours);
    kdr_memory_release(picture->painters);
    *picture = (kdr_view_picture){0};
}
