#include "scene/scene.h"

#include <string.h>

kdr_triangles_def kdr_default_triangles_def(void) {
    return (kdr_triangles_def){
        .size = sizeof(kdr_triangles_def), .vertex_stride = 3 * sizeof(float), .index_stride = 3 * sizeof(uint32_t)};
}

kdr_status kdr_scene_create(kdr_device *device, kdr_scene **out) {
    if (!device || !out)
        return kdr_device_fail(device, KDR_ERROR_INVALID_ARGUMENT, "a scene needs a device and a place for its handle");
    *out = NULL;
    kdr_scene *scene = kdr_alloc_get(&device->alloc, sizeof *scene, 64);
    if (!scene)
        return kdr_device_fail(device, KDR_ERROR_OUT_OF_MEMORY, "out of memory for a scene");
    *scene = (kdr_scene){.device = device,
                         .serial = device->scene_count++,
                         .changed = true,
                         .lone = kdr_lone_for(device->isa, KDR_TRACE_AUTO, KDR_NODES_STRUCTURES, KDR_MAILBOX_NONE)};
    if (!kdr_tree_init_empty(&scene->tree, &device->bulk)) {
        kdr_alloc_release(&device->alloc, scene, sizeof *scene);
        return kdr_device_fail(device, KDR_ERROR_OUT_OF_MEMORY, "out of memory for a scene");
    }
    *out = scene;
    return KDR_OK;
}

void kdr_scene_destroy(kdr_scene *scene) {
    if (!scene)
        return;
    kdr_alloc *alloc = &scene->device->alloc;
    kdr_tree_release(&scene->tree, &scene->device->bulk);
    kdr_customs_destroy(scene->customs, scene->device);
    kdr_bulk_put(&scene->device->bulk, scene->first, ((size_t)scene->committed_count + 1) * sizeof *scene->first);
    for (uint32_t g = 0; scene->custom_defs && g < scene->geometry_count; g++)
        if (kdr_scene_is_instance(scene, g))
            kdr_alloc_release(alloc, scene->custom_defs[g].user, sizeof(kdr_instance_def));
    kdr_alloc_release(alloc, scene->geometries, scene->geometry_capacity * sizeof *scene->geometries);
    kdr_alloc_release(alloc, scene->custom_defs, scene->geometry_capacity * sizeof *scene->custom_defs);
    kdr_alloc_release(alloc, scene, sizeof *scene);
}

/* A sentence about what is wrong with a def, or NULL. */
static const char *def_problem(const kdr_triangles_def *def) {
    if (!def || def->size != sizeof(kdr_triangles_def))
        return "the triangles def was not made by kdr_default_triangles_def";
    if (def->vertex_stride < 12 || def->vertex_stride % 4 != 0)
        return "vertex_stride must be a multiple of 4 and at least 12";
    if (def->indices && (def->index_stride < 12 || def->index_stride % 4 != 0))
        return "index_stride must be a multiple of 4 and at least 12";
    if (def->vertex_count > UINT32_MAX || def->triangle_count > UINT32_MAX)
        return "there may be at most 2^32 - 1 vertices and triangles";
    if (!def->vertices && def->vertex_count > 0)
        return "vertices is NULL but vertex_count is not 0";
    return NULL;
}

/* Room for `capacity` geometries, and for what their custom primitives need if asked for. False, and nothing is
 * changed, when there is no memory. */
static bool reserve(kdr_scene *scene, size_t capacity, bool with_customs) {
    kdr_alloc *alloc = &scene->device->alloc;
    kdr_triangles_def *triangles = kdr_alloc_array(alloc, capacity, sizeof *triangles, 64);
    kdr_custom_def *customs = with_customs ? kdr_alloc_array(alloc, capacity, sizeof *customs, 64) : NULL;
    if (!triangles || (with_customs && !customs)) {
        kdr_alloc_release(alloc, triangles, capacity * sizeof *triangles);
        kdr_alloc_release(alloc, customs, capacity * sizeof *customs);
        return false;
    }
    if (customs)
        memset(customs, 0, capacity * sizeof *customs);
    if (scene->geometry_count > 0)
        memcpy(triangles, scene->geometries, scene->geometry_count * sizeof *triangles);
    if (scene->custom_defs)
        memcpy(customs, scene->custom_defs, scene->geometry_count * sizeof *customs);
    kdr_alloc_release(alloc, scene->geometries, scene->geometry_capacity * sizeof *triangles);
    kdr_alloc_release(alloc, scene->custom_defs, scene->geometry_capacity * sizeof *customs);
    scene->geometries = triangles;
    scene->custom_defs = customs;
    scene->geometry_capacity = capacity;
    return true;
}

kdr_status kdr_scene_add(kdr_scene *scene, const kdr_triangles_def *triangles, const kdr_custom_def *custom,
                         uint32_t *geometry) {
    if (scene->geometry_count == UINT32_MAX - 1)
        return kdr_device_fail(scene->device, KDR_ERROR_LIMIT, "a scene has at most 2^32 - 1 geometries");
    size_t capacity = scene->geometry_capacity;
    if (scene->geometry_count == capacity)
        capacity = capacity > 0 ? 2 * capacity : 4;
    bool with_customs = scene->custom_defs || custom;
    if ((capacity > scene->geometry_capacity || (with_customs && !scene->custom_defs)) &&
        !reserve(scene, capacity, with_customs))
        return kdr_device_fail(scene->device, KDR_ERROR_OUT_OF_MEMORY, "out of memory for %zu geometries", capacity);
    if (geometry)
        *geometry = scene->geometry_count;
    if (custom)
        scene->custom_defs[scene->geometry_count] = *custom;
    scene->geometries[scene->geometry_count++] = *triangles;
    scene->changed = true;
    return KDR_OK;
}

kdr_status kdr_scene_add_triangles(kdr_scene *scene, const kdr_triangles_def *def, uint32_t *geometry) {
    if (!scene)
        return KDR_ERROR_INVALID_ARGUMENT;
    const char *problem = def_problem(def);
    if (problem)
        return kdr_device_fail(scene->device, KDR_ERROR_INVALID_ARGUMENT, "%s", problem);
    return kdr_scene_add(scene, def, NULL, geometry);
}

kdr_status kdr_scene_set_triangles(kdr_scene *scene, uint32_t geometry, const kdr_triangles_def *def) {
    if (!scene)
        return KDR_ERROR_INVALID_ARGUMENT;
    const char *problem = def_problem(def);
    if (problem)
        return kdr_device_fail(scene->device, KDR_ERROR_INVALID_ARGUMENT, "%s", problem);
    if (geometry >= scene->geometry_count)
        return kdr_device_fail(scene->device, KDR_ERROR_INVALID_ARGUMENT, "the scene has no geometry %u", geometry);
    if (kdr_scene_is_custom(scene, geometry))
        return kdr_device_fail(scene->device, KDR_ERROR_INVALID_ARGUMENT, "geometry %u has no triangles", geometry);
    scene->geometries[geometry] = *def;
    scene->changed = true;
    return KDR_OK;
}

kdr_status kdr_scene_touch(kdr_scene *scene, uint32_t geometry) {
    if (!scene)
        return KDR_ERROR_INVALID_ARGUMENT;
    if (geometry >= scene->geometry_count)
        return kdr_device_fail(scene->device, KDR_ERROR_INVALID_ARGUMENT, "the scene has no geometry %u", geometry);
    scene->changed = true;
    return KDR_OK;
}
