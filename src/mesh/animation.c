/* Things that move, of every kind behind one handle. */
#include "mesh/builtin.h"
#include "mesh/gltf_animation.h"
#include "mesh/md2_animation.h"
#include "mesh/mesh_memory.h"
#include "mesh/report.h"
#include "mesh/sequence.h"

#include <math.h>
#include <string.h>
#include <strings.h>

struct kdr_animation {
    kdr_animation_source source;
};

/* ---- a built-in scene */

static void destroy_builtin(void *state) { kdr_alloc_release(kdr_mesh_memory(), state, sizeof(kdr_builtin)); }

static kdr_status sample_builtin(void *state, double seconds, const kdr_logger *logger, kdr_mesh **mesh) {
    const kdr_builtin *of = state;
    kdr_mesh *made;
    kdr_status status = kdr_mesh_make(of->name, of->triangle_count, of->time + fmax(seconds, 0), logger, &made);
    if (status != KDR_OK)
        return status;
    kdr_mesh_destroy(*mesh);
    *mesh = made;
    return KDR_OK;
}

static bool moves(const char *name) {
    for (size_t i = 0; kdr_mesh_builtin_name(i); i++)
        if (strcmp(kdr_mesh_builtin_name(i), name) == 0)
            return kdr_mesh_builtin_moves(i);
    return false;
}

static kdr_status open_builtin(const char *path, const kdr_logger *logger, kdr_animation_source *out) {
    kdr_builtin parsed;
    kdr_status status = kdr_builtin_parse(path, logger, &parsed);
    if (status != KDR_OK)
        return status;
    /* A name or a size that is wrong is found now, in the smallest scene that tells. */
    kdr_mesh *mesh;
    size_t count = parsed.triangle_count < 1000 || parsed.triangle_count > 10000000 ? parsed.triangle_count : 1000;
    status = kdr_mesh_make(parsed.name, count == 0 ? 1000 : count, parsed.time, logger, &mesh);
    if (status != KDR_OK)
        return status;
    kdr_mesh_destroy(mesh);
    kdr_builtin *of = kdr_alloc_get(kdr_mesh_memory(), sizeof *of, KDR_MESH_ALIGNMENT);
    if (!of)
        return kdr_report(logger, KDR_ERROR_OUT_OF_MEMORY, "%s: out of memory", path);
    *of = parsed;
    *out = (kdr_animation_source){of, moves(of->name) ? INFINITY : 0, sample_builtin, destroy_builtin};
    return KDR_OK;
}

/* ---- a mesh that stands still */

typedef struct still {
    size_t size; /* of all this */
    char path[];
} still;

static void destroy_still(void *state) { kdr_alloc_release(kdr_mesh_memory(), state, ((still *)state)->size); }

static kdr_status sample_still(void *state, double seconds, const kdr_logger *logger, kdr_mesh **mesh) {
    (void)seconds;
    const still *of = state;
    return *mesh ? KDR_OK : kdr_mesh_read(of->path, logger, mesh);
}

static kdr_status open_still(const char *path, const kdr_logger *logger, kdr_animation_source *out) {
    size_t size = sizeof(still) + strlen(path) + 1;
    still *of = kdr_alloc_get(kdr_mesh_memory(), size, KDR_MESH_ALIGNMENT);
    if (!of)
        return kdr_report(logger, KDR_ERROR_OUT_OF_MEMORY, "%s: out of memory", path);
    of->size = size;
    memcpy(of->path, path, strlen(path) + 1);
    *out = (kdr_animation_source){of, 0, sample_still, destroy_still};
    return KDR_OK;
}

/* ---- any of them */

static bool is_gltf(const char *path) {
    kdr_source source = {.name = path};
    return kdr_source_has_ending(&source, "gltf") || kdr_source_has_ending(&source, "glb");
}

/* Unpacked, and where there is assimp, which reads its frames. */
static bool is_md2(const char *path) {
    size_t length = strlen(path);
    return kdr_read_assimp_is_built() && length > 4 && strcasecmp(path + length - 4, ".md2") == 0;
}

static kdr_status open_source(const char *path, double rate, const kdr_logger *logger, kdr_animation_source *out) {
    if (kdr_builtin_is_meant(path))
        return open_builtin(path, logger, out);
    if (kdr_sequence_is_meant(path))
        return kdr_sequence_open(path, rate, logger, out);
    if (is_md2(path))
        return kdr_md2_animation_open(path, logger, out);
    return is_gltf(path) ? kdr_gltf_animation_open(path, logger, out) : open_still(path, logger, out);
}

kdr_status kdr_animation_open(const char *path, double rate, const kdr_logger *logger, kdr_animation **out) {
    if (!out)
        return kdr_report(logger, KDR_ERROR_INVALID_ARGUMENT, "expected a place for the animation, found NULL");
    *out = NULL;
    if (!path || !(rate > 0) || !isfinite(rate))
        return kdr_report(logger, KDR_ERROR_INVALID_ARGUMENT, "expected a path and a rate above 0, found %s",
                          path ? "another rate" : "NULL");
    kdr_animation *animation = kdr_alloc_get(kdr_mesh_memory(), sizeof *animation, KDR_MESH_ALIGNMENT);
    if (!animation)
        return kdr_report(logger, KDR_ERROR_OUT_OF_MEMORY, "%s: out of memory", path);
    kdr_status status = open_source(path, rate, logger, &animation->source);
    if (status == KDR_OK)
        *out = animation;
    else
        kdr_alloc_release(kdr_mesh_memory(), animation, sizeof *animation);
    return status;
}

double kdr_animation_duration(const kdr_animation *animation) { return animation->source.duration; }

kdr_status kdr_animation_sample(kdr_animation *animation, double seconds, const kdr_logger *logger, kdr_mesh **mesh) {
    if (!animation || !mesh || !isfinite(seconds))
        return kdr_report(logger, KDR_ERROR_INVALID_ARGUMENT, "expected an animation, a time and a place, found %s",
                          animation && mesh ? "a time that is not finite" : "NULL");
    return animation->source.sample(animation->source.state, seconds, logger, mesh);
}

void kdr_animation_destroy(kdr_animation *animation) {
    if (!animation)
        return;
    animation->source.destroy(animation->source.state);
    kdr_alloc_release(kdr_mesh_memory(), animation, sizeof *animation);
}
