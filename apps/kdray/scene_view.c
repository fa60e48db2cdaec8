#include "scene_view.h"

#include "memory.h"

#include <string.h>
#include <unistd.h>

static bool is_builtin(const char *path) { return strncmp(path, "builtin:", 8) == 0; }

/* Bytes of a file's name without its ending. */
static size_t stem_length(const char *path) {
    const char *slash = strrchr(path, '/'), *dot = strrchr(path, '.');
    const char *name = slash ? slash + 1 : path;
    return dot && dot > name ? (size_t)(dot - path) : strlen(path);
}

void kdr_scene_name(const char *path, char name[KDR_BENCH_SCENE_SIZE]) {
    const char *slash = is_builtin(path) ? NULL : strrchr(path, '/');
    size_t length = is_builtin(path) ? strlen(path) : stem_length(path);
    const char *begin = slash ? slash + 1 : path;
    snprintf(name, KDR_BENCH_SCENE_SIZE, "%.*s", (int)(length - (size_t)(begin - path)), begin);
}

bool kdr_scene_view(const char *path, kdr_bench_scene *scene, kdr_messages *messages, const kdr_logger *logger) {
    scene->camera = kdr_camera_for_bounds(scene->bounds);
    kdr_light_for_bounds(scene->bounds, scene->light);
    if (is_builtin(path))
        return true;

    size_t stem = stem_length(path);
    char *beside = kdr_memory_get(stem + sizeof(".cam"), 1);
    memcpy(beside, path, stem);
    memcpy(beside + stem, ".cam", sizeof(".cam"));
    kdr_status status = KDR_OK;
    if (access(beside, F_OK) == 0)
        status = kdr_camera_read(beside, logger, &scene->camera, scene->light);
    if (status != KDR_OK)
        kdr_messages_fail_status(messages, beside, status);
    kdr_memory_release(beside);
    return status == KDR_OK;
}
