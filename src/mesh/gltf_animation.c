#include "mesh/gltf_animation.h"

#include "mesh/file_bytes.h"
#include "mesh/gltf_motion.h"
#include "mesh/gltf_parts.h"
#include "mesh/mesh.h"
#include "mesh/mesh_memory.h"
#include "mesh/report.h"

#include <math.h>
#include <string.h>

typedef struct animation {
    kdr_gltf_asset asset;
    kdr_gltf_nodes nodes;
    kdr_gltf_motion motion;
    kdr_gltf_parts parts;
    kdr_mesh *model; /* triangles and materials of every sample */
    bool *is_missing;
    size_t *moved_targets;
    char *name;
} animation;

static void destroy(void *state) {
    animation *of = state;
    if (!of)
        return;
    kdr_mesh_destroy(of->model);
    kdr_gltf_asset_release(&of->asset);
    kdr_alloc_release(kdr_mesh_memory(), of, sizeof *of);
}

/* A mesh like the model, positions and normals undefined. */
static kdr_status copy_model(const kdr_mesh *model, kdr_mesh **out) {
    uint32_t parts = (model->normals ? KDR_MESH_NORMALS : 0) | (model->triangle_materials ? KDR_MESH_MATERIALS : 0);
    kdr_mesh *mesh;
    kdr_status status = kdr_mesh_create(model->vertex_count, model->triangle_count, parts, model->format, &mesh);
    if (status != KDR_OK)
        return status;
    if (model->triangle_count) {
        memcpy(mesh->indices, model->indices, 3 * model->triangle_count * sizeof(uint32_t));
        if (model->triangle_materials)
            memcpy(mesh->triangle_materials, model->triangle_materials, model->triangle_count * sizeof(uint32_t));
    }
    for (size_t i = 0; i < model->material_count && status == KDR_OK; i++) {
        const kdr_mesh_material *material = &model->materials[i];
        status = kdr_mesh_add_material(mesh, material->name, strlen(material->name), material->diffuse, NULL);
    }
    if (status == KDR_OK)
        *out = mesh;
    else
        kdr_mesh_destroy(mesh);
    return status;
}

static kdr_status sample(void *state, double seconds, const kdr_logger *logger, kdr_mesh **mesh) {
    animation *of = state;
    if (isnan(seconds))
        return kdr_report(logger, KDR_ERROR_INVALID_ARGUMENT, "%s: expected a time, found NaN", of->name);
    if (!*mesh) {
        kdr_status status = copy_model(of->model, mesh);
        if (status != KDR_OK)
            return kdr_report(logger, status, "%s: out of memory for a mesh of %zu triangles", of->name,
                              of->model->triangle_count);
    }
    kdr_gltf_motion_apply(&of->motion, &of->asset, seconds, &of->nodes);
    kdr_gltf_nodes_place(&of->nodes);
    if (kdr_gltf_pose(&of->asset, &of->nodes, &of->parts, of->is_missing, of->moved_targets, *mesh))
        return KDR_OK;
    return kdr_report(logger, KDR_ERROR_INVALID_DATA,
                      "%s: expected vertices that stay finite, found one that does not at %g s", of->name, seconds);
}

static kdr_status open_parts(animation *of, const kdr_source *source) {
    kdr_status status = kdr_gltf_asset_open(source, &of->asset);
    if (status == KDR_OK)
        status = kdr_gltf_nodes_open(&of->asset, &of->nodes);
    if (status == KDR_OK)
        status = kdr_gltf_motion_open(&of->asset, &of->nodes, &of->motion);
    if (status != KDR_OK)
        return status;
    kdr_gltf_motion_apply(&of->motion, &of->asset, 0, &of->nodes);
    kdr_gltf_nodes_place(&of->nodes);
    status = kdr_gltf_parts_open(&of->asset, &of->nodes, &of->parts, &of->model);
    if (status != KDR_OK)
        return status;
    kdr_gltf_store *store = &of->asset.store;
    size_t name_bytes = strlen(source->name) + 1;
    of->is_missing = kdr_gltf_take(store, of->model->vertex_count, sizeof *of->is_missing);
    of->moved_targets = kdr_gltf_take(store, of->parts.most_targets, sizeof *of->moved_targets);
    of->name = kdr_gltf_take(store, name_bytes, 1);
    if (!of->is_missing || !of->moved_targets || !of->name)
        return kdr_source_fail_status(source, KDR_ERROR_OUT_OF_MEMORY);
    memcpy(of->name, source->name, name_bytes);
    kdr_gltf_asset_forget_file(&of->asset);
    return KDR_OK;
}

kdr_status kdr_gltf_animation_open_source(const kdr_source *source, kdr_animation_source *out) {
    *out = (kdr_animation_source){0};
    if (source->length == 0)
        return kdr_source_fail_byte(source, 0, "expected a glTF file, found an empty one");
    animation *of = kdr_alloc_get(kdr_mesh_memory(), sizeof *of, KDR_MESH_ALIGNMENT);
    if (!of)
        return kdr_source_fail_status(source, KDR_ERROR_OUT_OF_MEMORY);
    *of = (animation){0};
    kdr_status status = open_parts(of, source);
    if (status == KDR_OK)
        *out = (kdr_animation_source){of, of->motion.duration, sample, destroy};
    else
        destroy(of);
    return status;
}

kdr_status kdr_gltf_animation_open(const char *path, const kdr_logger *logger, kdr_animation_source *out) {
    *out = (kdr_animation_source){0};
    kdr_file_bytes file, unpacked = {0};
    kdr_status status = kdr_file_bytes_open(path, logger, &file);
    if (status != KDR_OK)
        return status;
    kdr_source source = {path, file.bytes, file.length, true, logger};
    if (kdr_bytes_are_gzip(file.bytes, file.length)) {
        status = kdr_bytes_unpack(path, file.bytes, file.length, logger, &unpacked);
        source.bytes = unpacked.bytes;
        source.length = unpacked.length;
    }
    if (status == KDR_OK)
        status = kdr_gltf_animation_open_source(&source, out);
    kdr_file_bytes_release(&unpacked);
    kdr_file_bytes_release(&file);
    return status;
}
