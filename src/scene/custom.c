#include "scene/scene.h"

kdr_custom_def kdr_default_custom_def(void) { return (kdr_custom_def){.size = sizeof(kdr_custom_def)}; }

/* A sentence about what is wrong with a def, or NULL. */
static const char *def_problem(const kdr_custom_def *def) {
    if (!def || def->size != sizeof(kdr_custom_def))
        return "the custom def was not made by kdr_default_custom_def";
    if (!def->bounds || !def->intersect)
        return "custom primitives need bounds and intersect";
    return NULL;
}

kdr_status kdr_scene_add_custom(kdr_scene *scene, const kdr_custom_def *def, uint32_t *geometry) {
    if (!scene)
        return KDR_ERROR_INVALID_ARGUMENT;
    const char *problem = def_problem(def);
    if (problem)
        return kdr_device_fail(scene->device, KDR_ERROR_INVALID_ARGUMENT, "%s", problem);
    kdr_triangles_def none = kdr_default_triangles_def();
    return kdr_scene_add(scene, &none, def, geometry);
}

kdr_status kdr_scene_set_custom(kdr_scene *scene, uint32_t geometry, const kdr_custom_def *def) {
    if (!scene)
        return KDR_ERROR_INVALID_ARGUMENT;
    const char *problem = def_problem(def);
    if (problem)
        return kdr_device_fail(scene->device, KDR_ERROR_INVALID_ARGUMENT, "%s", problem);
    if (geometry >= scene->geometry_count)
        return kdr_device_fail(scene->device, KDR_ERROR_INVALID_ARGUMENT, "the scene has no geometry %u", geometry);
    if (!kdr_scene_is_custom(scene, geometry) || kdr_scene_is_instance(scene, geometry))
        return kdr_device_fail(scene->device, KDR_ERROR_INVALID_ARGUMENT, "geometry %u has no custom primitives",
                               geometry);
    scene->custom_defs[geometry] = *def;
    scene->dynamic_changed = true;
    return KDR_OK;
}
