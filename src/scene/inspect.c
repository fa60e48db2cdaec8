/* What a committed scene tells about itself. */
#include "scene/scene.h"
#include "tree/verify.h"

#include <string.h>

void kdr_scene_bounds(const kdr_scene *scene, float bounds[6]) {
    memcpy(bounds, scene->tree.bounds.lo, 3 * sizeof *bounds);
    memcpy(bounds + 3, scene->tree.bounds.hi, 3 * sizeof *bounds);
}

kdr_status kdr_scene_stats(const kdr_scene *scene, kdr_tree_stats *out) {
    if (!scene || !out)
        return KDR_ERROR_INVALID_ARGUMENT;
    kdr_tree_count(&scene->tree, out);
    out->build_seconds = scene->build_seconds;
    return KDR_OK;
}

uint64_t kdr_scene_hash(const kdr_scene *scene) { return scene->committed ? kdr_tree_hash(&scene->tree) : 0; }

kdr_status kdr_scene_verify(const kdr_scene *scene) {
    if (!scene)
        return KDR_ERROR_INVALID_ARGUMENT;
    const char *wrong = kdr_tree_verify(&scene->tree);
    if (wrong)
        return kdr_device_fail(scene->device, KDR_ERROR_INVALID_DATA, "%s", wrong);
    return KDR_OK;
}
