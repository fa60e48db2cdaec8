#include "render/block.h"

#include "render/shade.h"

#include <string.h>

/* Primary rays of a block in tile order; returns their number. */
static uint32_t make_rays(kdr_painter *painter, const kdr_scenery *scenery, const kdr_block *block, uint32_t sample) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < KDR_BLOCK_PIXELS; i++) {
        uint32_t x, y;
        kdr_block_pixel(i, &x, &y);
        if (x >= block->width || y >= block->height)
            continue;
        float inside_x, inside_y;
        kdr_strata_place(&scenery->strata, scenery->seed, block->x + x, block->y + y, sample, &inside_x, &inside_y);
        kdr_ray *ray = &painter->rays[count].ray;
        *ray = kdr_view_ray(&scenery->view, (float)(block->x + x) + inside_x, (float)(block->y + y) + inside_y);
        if (scenery->stage.room)
            kdr_room_enter(scenery->stage.room, ray);
        painter->ray_pixels[count++] = (uint16_t)(y * KDR_BLOCK_SIDE + x);
    }
    painter->primary_rays += count;
    return count;
}

static void add(kdr_painter *painter, uint32_t pixel, kdr_vector colour) {
    painter->sums[pixel][0] += colour.x;
    painter->sums[pixel][1] += colour.y;
    painter->sums[pixel][2] += colour.z;
}

/* Turns hits into surfaces, side by side, and adds what needs no light; returns the number of surfaces. */
static uint32_t make_surfaces(kdr_painter *painter, const kdr_scenery *scenery, uint32_t ray_count) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < ray_count; i++) {
        const kdr_ray_hit *ray_hit = &painter->rays[i];
        if (ray_hit->hit.geometry == KDR_INVALID_ID) {
            add(painter, painter->ray_pixels[i], scenery->background);
            continue;
        }
        kdr_surface *surface = &painter->surfaces[count++];
        kdr_surface_at(&scenery->stage, ray_hit, surface);
        surface->pixel = painter->ray_pixels[i];
        add(painter, surface->pixel, kdr_shade_ambient(surface));
    }
    painter->hits += count;
    return count;
}

static void add_light(kdr_painter *painter, const kdr_scenery *scenery, const kdr_light *light, uint32_t count,
                      const kdr_trace_def *coherent) {
    for (uint32_t i = 0; i < count; i++)
        painter->shadow_rays_of_light[i] = kdr_light_shadow_ray(light, &painter->surfaces[i], scenery->stage.room);
    kdr_occluded_n(scenery->scene, coherent, painter->shadow_rays_of_light, painter->hidden, count);
    painter->shadow_rays += count;
    for (uint32_t i = 0; i < count; i++) {
        if (painter->hidden[i])
            painter->occluded++;
        else
            add(painter, painter->surfaces[i].pixel, kdr_shade_light(&painter->surfaces[i], light));
    }
}

static void store(const kdr_painter *painter, const kdr_block *block, uint32_t samples, kdr_image *image) {
    for (uint32_t y = 0; y < block->height; y++) {
        float *rgb = image->rgb + ((size_t)(block->y + y) * image->width + block->x) * 3;
        for (uint32_t x = 0; x < block->width; x++)
            for (int k = 0; k < 3; k++)
                *rgb++ = (float)(painter->sums[y * KDR_BLOCK_SIDE + x][k] / samples);
    }
}

void kdr_block_paint(kdr_painter *painter, const kdr_scenery *scenery, const kdr_block *block, kdr_tile_source *source,
                     kdr_image *image) {
    kdr_trace_def coherent = kdr_default_trace_def();
    coherent.coherence = KDR_COHERENCE_COHERENT;
    memset(painter->sums, 0, sizeof(painter->sums));
    for (uint32_t sample = 0; sample < scenery->strata.count; sample++) {
        uint32_t ray_count = make_rays(painter, scenery, block, sample);
        kdr_intersect_n(scenery->scene, &coherent, painter->rays, ray_count);
        uint32_t surface_count = make_surfaces(painter, scenery, ray_count);
        for (uint32_t i = 0; i < scenery->light_count; i++)
            add_light(painter, scenery, &scenery->lights[i], surface_count, &coherent);
        if (!kdr_tile_source_finish(source))
            return;
    }
    store(painter, block, scenery->strata.count, image);
}
