/* Skins: the joints that bend vertices, and the matrices that take a vertex from its mesh into a joint's own space. */
#include "mesh/gltf_parts.h"

static kdr_status read_skin(kdr_gltf_asset *asset, const kdr_json_value *object, kdr_gltf_skin *out) {
    const kdr_json *json = &asset->gltf.json;
    const kdr_json_value *joints = kdr_gltf_find(asset, object, "joints");
    uint32_t matrices;
    kdr_status status =
        kdr_gltf_read_reference(&asset->gltf, object, "inverseBindMatrices", KDR_GLTF_ACCESSORS, &matrices);
    if (status == KDR_OK && matrices != KDR_INVALID_ID)
        status = kdr_gltf_open_values(asset, matrices);
    if (status != KDR_OK)
        return status;
    out->joints = kdr_gltf_take(&asset->store, joints->count, sizeof *out->joints);
    out->binds = kdr_gltf_take(&asset->store, joints->count, sizeof *out->binds);
    out->transforms = kdr_gltf_take(&asset->store, joints->count, sizeof *out->transforms);
    if (!out->joints || !out->binds || !out->transforms)
        return kdr_source_fail_status(asset->gltf.source, KDR_ERROR_OUT_OF_MEMORY);
    const kdr_json_value *joint = kdr_json_first(json, joints);
    for (; joint; joint = kdr_json_next(json, joint)) {
        double columns[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
        for (uint32_t k = 0; matrices != KDR_INVALID_ID && k < 16; k++)
            columns[k] = (double)kdr_gltf_number(&asset->values[matrices], out->count, k);
        kdr_gltf_transpose(columns, out->binds[out->count]);
        out->joints[out->count++] = (uint32_t)joint->number;
    }
    return KDR_OK;
}

kdr_status kdr_gltf_read_skins(kdr_gltf_asset *asset, kdr_gltf_parts *out) {
    out->skin_count = asset->gltf.counts[KDR_GLTF_SKINS];
    out->skins = kdr_gltf_take(&asset->store, out->skin_count, sizeof *out->skins);
    kdr_status status = out->skins ? KDR_OK : kdr_source_fail_status(asset->gltf.source, KDR_ERROR_OUT_OF_MEMORY);
    for (size_t i = 0; i < out->skin_count && status == KDR_OK; i++)
        status = read_skin(asset, asset->objects[KDR_GLTF_SKINS][i], &out->skins[i]);
    return status;
}
