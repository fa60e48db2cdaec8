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

/* What stays from picture to picture. */
struct kdr_renderer {
    kdr_device *device;
    kdr_scene *scene;      /* geometry 0: the mesh, geometry 1: the room, which may be without triangles */
    kdr_painter *painters; /* one a worker */
    uint32_t painter_count;
};

/* Everything that a render makes on its way. */
typedef struct rendering {
    kdr_renderer *renderer;
    const kdr_logger *logger;
    kdr_image *image;
    kdr_image *texture;
    kdr_room room;
    uint32_t painter_count; /* that have something to do */
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
    const char *fault = find_fault(picture->renderer->device, mesh, def);
    if (fault)
        return kdr_report(picture->logger, KDR_ERROR_INVALID_ARGUMENT, "%s", fault);
    fault = kdr_view_make(&def->camera, def->width, def->height, &picture->scenery.view);
    if (fault)
        return kdr_report(picture->logger, KDR_ERROR_INVALID_ARGUMENT, "the camera %s", fault);
    return KDR_OK;
}

/* ---- what is in the picture */

static kdr_status set_arrays(rendering *picture, uint32_t geometry, const float *vertices, size_t vertex_count,
                             const uint32_t *indices, size_t triangle_count) {
    kdr_triangles_def def = kdr_default_triangles_def();
    def.vertices = vertices;
    def.vertex_count = vertex_count;
    def.indices = indices;
    def.triangle_count = triangle_count;
    return kdr_scene_set_triangles(picture->renderer->scene, geometry, &def);
}

static kdr_status build_scene(rendering *picture, const kdr_mesh *mesh, const kdr_picture_def *def,
                              const kdr_build_def *build) {
    kdr_status status =
        set_arrays(picture, 0, mesh->positions, mesh->vertex_count, mesh->indices, mesh->triangle_count);
    float bounds[6];
    kdr_mesh_bounds(mesh, bounds);
    bool has_room = def->box && kdr_room_make(bounds, def->camera.up, &picture->room);
    picture->scenery.stage.room = has_room ? &picture->room : NULL;
    if (status == KDR_OK)
        status = has_room ? set_arrays(picture, 1, picture->room.vertices[0], KDR_BOX_VERTICES,
                                       picture->room.indices[0], KDR_BOX_TRIANGLES)
                          : set_arrays(picture, 1, NULL, 0, NULL, 0);
    if (status == KDR_OK)
        status = kdr_scene_commit(picture->renderer->scene, build);
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

/* Room for the pixels, the caller's if it has the size, and for what the workers need. */
static kdr_status make_room_for_pixels(rendering *picture, const kdr_picture_def *def, kdr_image **image) {
    kdr_renderer *renderer = picture->renderer;
    kdr_tile_source_init(&picture->source, def);
    uint32_t workers = kdr_device_worker_count(renderer->device);
    picture->painter_count = workers < picture->source.block_count ? workers : picture->source.block_count;
    kdr_status status = KDR_OK;
    if (!*image || (*image)->width != def->width || (*image)->height != def->height) {
        kdr_image *made;
        status = kdr_image_create(def->width, def->height, &made);
        if (status == KDR_OK) {
            kdr_image_destroy(*image);
            *image = made;
        }
    }
    if (status == KDR_OK && renderer->painter_count < picture->painter_count) {
        kdr_painter *painters = kdr_render_get(picture->painter_count, sizeof(kdr_painter));
        status = painters ? KDR_OK : KDR_ERROR_OUT_OF_MEMORY;
        if (painters) {
            kdr_render_release(renderer->painters, renderer->painter_count * sizeof(kdr_painter));
            renderer->painters = painters;
            renderer->painter_count = picture->painter_count;
        }
    }
    if (status != KDR_OK)
        return kdr_report(picture->logger, status, "out of memory for a picture of %u x %u pixels", def->width,
                          def->height);
    picture->image = *image;
    for (uint32_t i = 0; i < picture->painter_count; i++) {
        kdr_painter *painter = &renderer->painters[i];
        painter->primary_rays = painter->hits = painter->shadow_rays = painter->occluded = 0;
    }
    return KDR_OK;
}

/* ---- rendering */

static void paint_blocks(void *context, uint32_t index) {
    rendering *picture = context;
    kdr_painter *painter = &picture->renderer->painters[index];
    kdr_block block;
    while (kdr_tile_source_next(&picture->source, &block))
        kdr_block_paint(painter, &picture->scenery, &block, &picture->source, picture->image);
}

static kdr_status paint(rendering *picture, kdr_picture_stats *stats) {
    const kdr_renderer *renderer = picture->renderer;
    picture->scenery.scene = renderer->scene;
    double begin = kdr_cpu_seconds();
    kdr_device_run(renderer->device, paint_blocks, picture, picture->painter_count);
    stats->trace_seconds = kdr_cpu_seconds() - begin;
    for (uint32_t i = 0; i < picture->painter_count; i++) {
        stats->primary_rays += renderer->painters[i].primary_rays;
        stats->hits += renderer->painters[i].hits;
        stats->shadow_rays += renderer->painters[i].shadow_rays;
        stats->occluded += renderer->painters[i].occluded;
    }
    if (!kdr_tile_source_close(&picture->source))
        return kdr_report(picture->logger, KDR_ERROR_CANCELLED, "the picture was cancelled");
    return KDR_OK;
}

kdr_status kdr_renderer_create(kdr_device *device, kdr_renderer **out) {
    if (!out)
        return KDR_ERROR_INVALID_ARGUMENT;
    *out = NULL;
    if (!device)
        return KDR_ERROR_INVALID_ARGUMENT;
    kdr_renderer *renderer = kdr_render_get(1, sizeof *renderer);
    if (!renderer)
        return KDR_ERROR_OUT_OF_MEMORY;
    *renderer = (kdr_renderer){.device = device};
    kdr_status status = kdr_scene_create(device, &renderer->scene);
    const kdr_triangles_def nothing = kdr_default_triangles_def();
    for (int geometry = 0; geometry < 2 && status == KDR_OK; geometry++)
        status = kdr_scene_add_triangles(renderer->scene, &nothing, NULL);
    if (status == KDR_OK)
        *out = renderer;
    else
        kdr_renderer_destroy(renderer);
    return status;
}

void kdr_renderer_destroy(kdr_renderer *renderer) {
    if (!renderer)
        return;
    kdr_scene_destroy(renderer->scene);
    kdr_render_release(renderer->painters, renderer->painter_count * sizeof(kdr_painter));
    kdr_render_release(renderer, sizeof *renderer);
}

kdr_status kdr_renderer_render(kdr_renderer *renderer, const kdr_mesh *mesh, const kdr_picture_def *def,
                               const kdr_build_def *build, const kdr_logger *logger, kdr_image **image,
                               kdr_picture_stats *stats) {
    if (!renderer || !image)
        return kdr_report(logger, KDR_ERROR_INVALID_ARGUMENT, "rendering needs a renderer and room for an image");
    rendering *picture = kdr_render_get(1, sizeof(*picture));
    if (!picture)
        return kdr_report(logger, KDR_ERROR_OUT_OF_MEMORY, "out of memory before rendering");
    memset(picture, 0, sizeof(*picture));
    picture->renderer = renderer;
    picture->logger = logger;

    kdr_picture_stats counted = {0};
    kdr_status status = check_wish(picture, mesh, def);
    if (status == KDR_OK)
        status = make_scenery(picture, mesh, def);
    if (status == KDR_OK)
        status = make_room_for_pixels(picture, def, image);
    double begin = kdr_cpu_seconds();
    if (status == KDR_OK)
        status = build_scene(picture, mesh, def, build);
    counted.build_seconds = kdr_cpu_seconds() - begin;
    if (status == KDR_OK)
        status = paint(picture, &counted);
    if (status == KDR_OK && stats)
        *stats = counted;
    kdr_image_destroy(picture->texture);
    kdr_render_release(picture, sizeof(*picture));
    return status;
}

kdr_status kdr_picture_render(kdr_device *device, const kdr_mesh *mesh, const kdr_picture_def *def,
                              const kdr_build_def *build, const kdr_logger *logger, kdr_image **image,
                              kdr_picture_stats *stats) {
    if (!image)
        return kdr_report(logger, KDR_ERROR_INVALID_ARGUMENT, "rendering needs room for an image");
    *image = NULL;
    const char *fault = find_fault(device, mesh, def);
    if (fault)
        return kdr_report(logger, KDR_ERROR_INVALID_ARGUMENT, "%s", fault);
    kdr_renderer *renderer;
    kdr_status status = kdr_renderer_create(device, &renderer);
    if (status != KDR_OK)
        return kdr_report(logger, status, "out of memory before rendering");
    kdr_picture_stats counted;
    status = kdr_renderer_render(renderer, mesh, def, build, logger, image, &counted);
    if (status == KDR_OK && stats)
        status = kdr_scene_stats(renderer->scene, &counted.tree);
    if (status == KDR_OK && stats)
        *stats = counted;
    kdr_renderer_destroy(renderer);
    if (status != KDR_OK) {
        kdr_image_destroy(*image);
        *image = NULL;
    }
    return status;
}
