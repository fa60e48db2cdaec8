/* One block of a picture: rays, hits, shadow rays, colours. */
#ifndef KDR_RENDER_BLOCK_H
#define KDR_RENDER_BLOCK_H

#include "render/light.h"
#include "render/material.h"
#include "render/rays.h"
#include "render/sample.h"
#include "render/tile.h"

/* What is the same for every block of a picture. Read by all workers. */
typedef struct kdr_scenery {
    const kdr_scene *scene;
    kdr_stage stage;
    kdr_view view;
    kdr_light lights[KDR_MAX_LIGHTS];
    uint32_t light_count;
    kdr_strata strata;
    uint64_t seed;
    kdr_vector background;
} kdr_scenery;

/* One worker's room for a block, and what it counted. About a megabyte. */
typedef struct kdr_painter {
    uint64_t primary_rays, hits, shadow_rays, occluded;
    double sums[KDR_BLOCK_PIXELS][3]; /* by row and column of the block */
    kdr_ray_hit rays[KDR_BLOCK_PIXELS];
    uint16_t ray_pixels[KDR_BLOCK_PIXELS]; /* where in sums ray i belongs */
    kdr_surface surfaces[KDR_BLOCK_PIXELS];
    kdr_ray shadow_rays_of_light[KDR_BLOCK_PIXELS];
    uint8_t hidden[KDR_BLOCK_PIXELS];
} kdr_painter;

/* Renders all samples of a block into the image. Stops early when the source says that the picture was cancelled. */
void kdr_block_paint(kdr_painter *painter, const kdr_scenery *scenery, const kdr_block *block, kdr_tile_source *source,
                     kdr_image *image);

#endif
