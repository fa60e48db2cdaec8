/* A mesh file that moves, as it is at a moment. */
#include "mesh/file_bytes.h"
#include "mesh/gltf_animation.h"
#include "mesh/report.h"

#include <math.h>

static bool is_gltf(const char *path) {
    kdr_source source = {.name = path};
    return kdr_source_has_ending(&source, "gltf") || kdr_source_has_ending(&source, "glb");
}

kdr_status kdr_mesh_read_at(const char *path, double seconds, const kdr_logger *logger, kdr_mesh **out) {
    if (!out)
        return kdr_report(logger, KDR_ERROR_INVALID_ARGUMENT, "expected a place for the mesh, found NULL");
    *out = NULL;
    if (!path || !isfinite(seconds))
        return kdr_report(logger, KDR_ERROR_INVALID_ARGUMENT, "expected a path and a time, found %s",
                          path ? "a time that is not finite" : "NULL");
    if (!is_gltf(path))
        return kdr_report(logger, KDR_ERROR_UNSUPPORTED,
                          "%s: expected a glTF or GLB file, which has a time (a built-in scene has it in its name, "
                          "builtin:NAME:TRIANGLES:SECONDS)",
                          path);
    kdr_animation_source source;
    kdr_status status = kdr_gltf_animation_open(path, logger, &source);
    if (status != KDR_OK)
        return status;
    status = source.sample(source.state, seconds, logger, out);
    source.destroy(source.state);
    if (status != KDR_OK) {
        kdr_mesh_destroy(*out);
        *out = NULL;
    }
    return status;
}
