/* Instances as they are described: a def for each geometry of them, which the scene keeps. */
#include "scene/instances.h"
#include "scene/scene.h"

kdr_instance_def kdr_default_instance_def(void) {
    return (kdr_instance_def){.size = sizeof(kdr_instance_def), .transform_stride = 12 * sizeof(float), .count = 1};
}

/* A sentence about what is wrong with a def, or NULL. */
static const char *def_problem(const kdr_scene *scene, const kdr_instance_def *def) {
    if (!def || def->size != sizeof(kdr_instance_def))
        return "the instance def was not made by kdr_default_instance_def";
    if (!def->scene)
        return "instances need a scene that they show";
    if (def->scene->device != scene->device)
        return "instances show a scene of the same device";
    if (def->scene->serial >= scene->serial)
        return "instances show a scene that was created before the one they are in";
    if (!def->transforms && def->count > 0)
        return "transforms is NULL but count is not 0";
    if (def->transform_stride < 12 * sizeof(float) || def->transform_stride % sizeof(float) != 0)
        return "transform_stride must be a multiple of 4 and at least 48";
    return NULL;
}

/* The marker that stands among the custom primitives, with a def of its own. NULL: no memory. */
static kdr_instance_def *keep(kdr_scene *scene, const kdr_instance_def *def, kdr_custom_def *custom) {
    kdr_instance_def *kept = kdr_alloc_get(&scene->device->alloc, sizeof *kept, 64);
    if (!kept)
        return NULL;
    *kept = *def;
    *custom = (kdr_custom_def){
        .size = sizeof *custom, .primitive_count = def->count, .bounds = kdr_instances_bounds, .user = kept};
    return kept;
}

kdr_status kdr_scene_add_instance(kdr_scene *scene, const kdr_instance_def *def, uint32_t *geometry) {
    if (!scene)
        return KDR_ERROR_INVALID_ARGUMENT;
    const char *problem = def_problem(scene, def);
    if (problem)
        return kdr_device_fail(scene->device, KDR_ERROR_INVALID_ARGUMENT, "%s", problem);
    kdr_custom_def custom;
    kdr_instance_def *kept = keep(scene, def, &custom);
    if (!kept)
        return kdr_device_fail(scene->device, KDR_ERROR_OUT_OF_MEMORY, "out of memory for instances");
    kdr_triangles_def none = kdr_default_triangles_def();
    kdr_status status = kdr_scene_add(scene, &none, &custom, geometry);
    if (status != KDR_OK)
        kdr_alloc_release(&scene->device->alloc, kept, sizeof *kept);
    return status;
}

kdr_status kdr_scene_set_instance(kdr_scene *scene, uint32_t geometry, const kdr_instance_def *def) {
    if (!scene)
        return KDR_ERROR_INVALID_ARGUMENT;
    const char *problem = def_problem(scene, def);
    if (problem)
        return kdr_device_fail(scene->device, KDR_ERROR_INVALID_ARGUMENT, "%s", problem);
    if (geometry >= scene->geometry_count)
        return kdr_device_fail(scene->device, KDR_ERROR_INVALID_ARGUMENT, "the scene has no geometry %u", geometry);
    if (!kdr_scene_is_instance(scene, geometry))
        return kdr_device_fail(scene->device, KDR_ERROR_INVALID_ARGUMENT, "geometry %u has no instances", geometry);
    *(kdr_instance_def *)scene->custom_defs[geometry].user = *def;
    scene->custom_defs[geometry].primitive_count = def->count;
    scene->dynamic_changed = true;
    return KDR_OK;
}
