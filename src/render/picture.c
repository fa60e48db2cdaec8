/* From a mesh and a wish to an image: scene, commit, blocks on all workers. */
#include "base/cpu.h"
#include "mesh/report.h"
#include "render/block.h"
#include "render/memory.h"

#include <string.h>

#define SIDE_LIMIT 65536u
#define SAMPLE_LIMIT 65536u

kdr_picture_def kdr_default_picture_def(void) {
    return (kdr_picture_def){
        .size = sizeof(kdr_picture_def),
        .width = 1024,
        .height = 1024,
        .camera = {.eye = {0, 0, 1}, .up = {0, 1, 0}, .fov = 45},
        .lights = {{1, 2, 1}},
        .light_count = 1,
        .samples = 1,
        .background = {0.55f, 0.63f, 0.72f},
    };
}

/* Everything that a render makes on its way. */
typedef struct rendering {
    kdr_device *device;
    const kdr_logger *logger;
    kdr_scene *scene;
    kdr_image *image;
    kdr_image *texture;
    kdr_painter *painters; /* one a worker */
    uint32_t painter_count;
    kdr_room room;
    kdr_scenery scenery;
    kdr_tile_source source;
} rendering;

/* ---- what was asked for */

static const char *find_fault(const kdr_device *device, const kdr_mesh *mesh, const kdr_picture_def *def) {
    if (!device || !mesh || !def)
        return "rendering needs a device, a mesh and a picture def";
    if (def->size != sizeof(kdr_picture_def))
        return "the picture def was not made by kdr_default_picture_def";
    if (def->width == 0 || def->height == 0 || def->width > SIDE_LIMIT || def->height > SIDE_LIMIT)
        return "a picture has 1 to 65,536 pixels a side";
    if (def->samples == 0 || def->samples > SAMPLE_LIMIT)
        return "a pixel has 1 to 65,536 samples";
    if (def->light_count == 0 || def->light_count > KDR_MAX_LIGHTS)
        return "a picture has 1 to 16 lights";
    for (uint32_t i = 0; i < def->light_count; i++)
        for (int k = 0; k < 3; k++)
            if (!isfinite(def->lights[i][k]))
                return "a light has a coordinate that is not finite";
    for (int k = 0; k < 3; k++)
        if (!(def->background[k] >= 0) || !isfinite(def->background[k]))
            return "the background's colour is negative or not finite";
    return NULL;
}

static kdr_status check_wish(rendering *picture, const kdr_mesh *mesh, const kdr_picture_def *def) {
    const char *fault = find_fault(picture->device, mesh, def);
    if (fault)
        return kdr_report(picture->logger, KDR_ERROR_INVALID_ARGUMENT, "%s", fault);
    fault = kdr_view_make(&def->camera, def->width, def->height, &picture->scenery.view);
    if (fault)
        return kdr_report(picture->logger, KDR_ERROR_INVALID_ARGUMENT, "the camera %s", fault);
    return KDR_OK;
}

/* ---- what is in the picture */

static kdr_status add_arrays(rendering *picture, const float *vertices, size_t vertex_count, const uint32_t *indices,
                             size_t triangle_count) {
    kdr_triangles_def def = kdr_default_triangles_def();
    def.vertices = vertices;
    def.vertex_count = vertex_count;
    def.indices = indices;
    def.triangle_count = triangle_count;
    return kdr_scene_add_triangles(picture->scene, &def, NULL);
}

static kdr_status make_scene(rendering *picture, const kdr_mesh *mesh, const kdr_picture_def *def,
                             const kdr_build_def *build) {
    kdr_status status = kdr_scene_create(picture->device, &picture->scene);
    if (status == KDR_OK)
        status = add_arrays(picture, mesh->positions, mesh->vertex_count, mesh->indices, mesh->triangle_count);
    float bounds[6];
    kdr_mesh_bounds(mesh, bounds);
    if (status == KDR_OK && def->box && kdr_room_make(bounds, def->camera.up, &picture->room)) {
        picture->scenery.stage.room = &picture->room;
        status = add_arrays(picture, picture->room.vertices[0], KDR_BOX_VERTICES, picture->room.indices[0],
                            KDR_BOX_TRIANGLES);
    }
    if (status == KDR_OK)
        status = kdr_scene_commit(picture->scene, build);
    if (status != KDR_OK)
        kdr_report(picture->logger, status, "the tree was not built: %s", kdr_status_text(status));
    return status;
}

static kdr_status make_scenery(rendering *picture, const kdr_mesh *mesh, const kdr_picture_def *def) {
    kdr_scenery *scenery = &picture->scenery;
    if (def->box && def->texture) {
        kdr_status status = kdr_image_read_png(def->texture, picture->logger, &picture->texture);
        if (status != KDR_OK)
            return status;
    }
    scenery->stage.mesh = mesh;
    scenery->stage.texture.image = picture->texture;
    scenery->light_count = def->light_count;
    kdr_lights_make(def, scenery->lights);
    scenery->strata = kdr_strata_make(def->samples);
    scenery->seed = def->seed;
    scenery->background = kdr_vector_of(def->background);
    return KDR_OK;
}

static kdr_status make_room_for_pixels(rendering *picture, const kdr_picture_def *def) {
    kdr_tile_source_init(&picture->source, def);
    kdr_status status = kdr_image_create(def->width, def->height, &picture->image);
    uint32_t workers = kdr_device_worker_count(picture->device);
    picture->painter_count = workers < picture->source.block_count ? workers : picture->source.block_count;
    if (status == KDR_OK) {
        picture->painters = kdr_render_get(picture->painter_count, sizeof(kdr_painter));
        status = picture->painters ? KDR_OK : KDR_ERROR_OUT_OF_MEMORY;
    }
    if (status != KDR_OK)
        return kdr_report(picture->logger, status, "out of memory for a picture of %u x %u pixels", def->width,
                          def->height);
    for (uint32_t i = 0; i < picture->painter_count; i++) {
        kdr_painter *painter = &picture->painters[i];
        painter->primary_rays = painter->hits = painter->shadow_rays = painter->occluded = 0;
    }
    return KDR_OK;
}

/* ---- rendering */

static void paint_blocks(void *context, uint32_t index) {
    rendering *picture = context;
    kdr_block block;
    while (kdr_tile_source_next(&picture->source, &block))
        kdr_block_paint(&picture->painters[index], &picture->scenery, &block, &picture->source, picture->image);
}

static kdr_status paint(rendering *picture, kdr_picture_stats *stats) {
    picture->scenery.scene = picture->scene;
    double begin = kdr_cpu_seconds();
    kdr_device_run(picture->device, paint_blocks, picture, picture->painter_count);
    stats->trace_seconds = kdr_cpu_seconds() - begin;
    for (uint32_t i = 0; i < picture->painter_count; i++) {
        stats->primary_rays += picture->painters[i].primary_rays;
        stats->hits += picture->painters[i].hits;
        stats->shadow_rays += picture->painters[i].shadow_rays;
        stats->occluded += picture->painters[i].occluded;
    }
    if (!kdr_tile_source_close(&picture->source))
        return kdr_report(picture->logger, KDR_ERROR_CANCELLED, "the picture was cancelled");
    return KDR_OK;
}

static void release(rendering *picture) {
    kdr_scene_destroy(picture->scene);
    kdr_image_destroy(picture->texture);
    kdr_image_destroy(picture->image);
    kdr_render_release(picture->painters, picture->painter_count * sizeof(kdr_painter));
    kdr_render_release(picture, sizeof(*picture));
}

kdr_status kdr_picture_render(kdr_device *device, const kdr_mesh *mesh, const kdr_picture_def *def,
                              const kdr_build_def *build, const kdr_logger *logger, kdr_image **image,
                              kdr_picture_stats *stats) {
    if (!image)
        return kdr_report(logger, KDR_ERROR_INVALID_ARGUMENT, "rendering needs room for an image");
    *image = NULL;
    rendering *picture = kdr_render_get(1, sizeof(*picture));
    if (!picture)
        return kdr_report(logger, KDR_ERROR_OUT_OF_MEMORY, "out of memory before rendering");
    memset(picture, 0, sizeof(*picture));
    picture->device = device;
    picture->logger = logger;

    kdr_picture_stats counted = {0};
    kdr_status status = check_wish(picture, mesh, def);
    if (status == KDR_OK)
        status = make_scenery(picture, mesh, def);
    if (status == KDR_OK)
        status = make_room_for_pixels(picture, def);
    double begin = kdr_cpu_seconds();
    if (status == KDR_OK)
        status = make_scene(picture, mesh, def, build);
    counted.build_seconds = kdr_cpu_seconds() - begin;
    if (status == KDR_OK)
        status = paint(picture, &counted);
    if (status == KDR_OK && stats)
        status = kdr_scene_stats(picture->scene, &counted.tree);
    if (status == KDR_OK) {
        *image = picture->image;
        picture->image = NULL;
        if (stats)
            *stats = counted;
    }
    release(picture);
    return status;
}
