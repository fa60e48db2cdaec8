#include "scene/scene.h"

#include "build/plan.h"

#include <string.h>

kdr_triangles_def kdr_default_triangles_def(void) {
    return (kdr_triangles_def){
        .size = sizeof(kdr_triangles_def), .vertex_stride = 3 * sizeof(float), .index_stride = 3 * sizeof(uint32_t)};
}

kdr_scene_def kdr_default_scene_def(void) {
    return (kdr_scene_def){.size = sizeof(kdr_scene_def), .static_build = kdr_quality_build_def(KDR_QUALITY_BEST)};
}

kdr_status kdr_scene_create(kdr_device *device, kdr_scene **out) { return kdr_scene_create_with(device, NULL, out); }

kdr_status kdr_scene_create_with(kdr_device *device, const kdr_scene_def *given, kdr_scene **out) {
    if (!device || !out)
        return kdr_device_fail(device, KDR_ERROR_INVALID_ARGUMENT, "a scene needs a device and a place for its handle");
    *out = NULL;
    kdr_scene_def def = given ? *given : kdr_default_scene_def();
    if (def.size != sizeof def)
        return kdr_device_fail(device, KDR_ERROR_INVALID_ARGUMENT,
                               "the scene def was not made by kdr_default_scene_def");
    const char *problem = kdr_build_def_problem(&def.static_build);
    if (problem)
        return kdr_device_fail(device, KDR_ERROR_INVALID_ARGUMENT, "static_build: %s", problem);
    kdr_scene *scene = kdr_alloc_get(&device->alloc, sizeof *scene, 64);
    kdr_readers *readers = def.double_buffered ? kdr_alloc_get(&device->alloc, sizeof *readers, 64) : NULL;
    kdr_part *nothing = kdr_part_create_empty(device);
    if (!scene || !nothing || (def.double_buffered && !readers)) {
        kdr_part_leave(nothing, device);
        kdr_alloc_release(&device->alloc, readers, sizeof *readers);
        kdr_alloc_release(&device->alloc, scene, sizeof *scene);
        return kdr_device_fail(device, KDR_ERROR_OUT_OF_MEMORY, "out of memory for a scene");
    }
    *scene = (kdr_scene){.device = device,
                         .serial = device->scene_count++,
                         .dynamic_changed = true,
                         .static_changed = true,
                         .static_plan = kdr_plan_of(&def.static_build),
                         .places = {{.dynamic_part = nothing}},
                         .readers = readers};
    for (uint32_t i = 0; readers && i < 2 * KDR_READER_STRIPES; i++)
        atomic_init(&readers->of[i / KDR_READER_STRIPES][i % KDR_READER_STRIPES].in, 0);
    atomic_init(&scene->shown, &scene->places[0]);
    *out = scene;
    return KDR_OK;
}

/* ---- what is shown */

kdr_visit kdr_scene_count_in(const kdr_scene *scene) {
    const uint32_t stripe = kdr_reader_stripe();
    for (;;) {
        const kdr_committed *seen = atomic_load(&scene->shown);
        _Atomic uint32_t *counted = &scene->readers->of[seen - scene->places][stripe].in;
        atomic_fetch_add(counted, 1);
        if (atomic_load(&scene->shown) == seen)
            return (kdr_visit){seen, counted};
        atomic_fetch_sub(counted, 1);
    }
}

void kdr_scene_empty_place(kdr_scene *scene, kdr_committed *place) {
    kdr_part_leave(place->dynamic_part, scene->device);
    kdr_part_leave(place->static_part, scene->device);
    kdr_customs_destroy(place->customs, scene->device);
    *place = (kdr_committed){0};
}

kdr_committed *kdr_scene_other_place(kdr_scene *scene) {
    uint32_t other = atomic_load(&scene->shown) == &scene->places[0];
    if (scene->readers)
        kdr_readers_wait(scene->readers, other);
    kdr_scene_empty_place(scene, &scene->places[other]);
    return &scene->places[other];
}

void kdr_scene_destroy(kdr_scene *scene) {
    if (!scene)
        return;
    kdr_alloc *alloc = &scene->device->alloc;
    for (int i = 0; i < 2; i++)
        kdr_scene_empty_place(scene, &scene->places[i]);
    for (uint32_t g = 0; scene->custom_defs && g < scene->geometry_count; g++)
        if (kdr_scene_is_instance(scene, g))
            kdr_alloc_release(alloc, scene->custom_defs[g].user, sizeof(kdr_instance_def));
    kdr_alloc_release(alloc, scene->geometries, scene->geometry_capacity * sizeof *scene->geometries);
    kdr_alloc_release(alloc, scene->custom_defs, scene->geometry_capacity * sizeof *scene->custom_defs);
    kdr_alloc_release(alloc, scene->readers, sizeof *scene->readers);
    kdr_alloc_release(alloc, scene, sizeof *scene);
}

/* ---- geometries of triangles */

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

/* Notes that the tree that a geometry belongs to is out of date. */
static void mark(kdr_scene *scene, uint32_t geometry) {
    if (scene->geometries[geometry].is_static)
        scene->static_changed = true;
    else
        scene->dynamic_changed = true;
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
    scene->geometries[scene->geometry_count] = *triangles;
    mark(scene, scene->geometry_count++);
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
    mark(scene, geometry);
    scene->geometries[geometry] = *def;
    mark(scene, geometry);
    return KDR_OK;
}

kdr_status kdr_scene_touch(kdr_scene *scene, uint32_t geometry) {
    if (!scene)
        return KDR_ERROR_INVALID_ARGUMENT;
    if (geometry >= scene->geometry_count)
        return kdr_device_fail(scene->device, KDR_ERROR_INVALID_ARGUMENT, "the scene has no geometry %u", geometry);
    mark(scene, geometry);
    return KDR_OK;
}

kdr_status kdr_scene_set_progress(kdr_scene *scene, kdr_progress_fn *fn, void *user) {
    if (!scene)
        return KDR_ERROR_INVALID_ARGUMENT;
    scene->tell = fn;
    scene->tell_user = user;
    return KDR_OK;
}
