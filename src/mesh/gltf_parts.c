/* The triangles of a glTF scene, their materials and the numbers behind their vertices, each checked here, so that a
 * pose is computed without a check. */
#include "mesh/gltf_parts.h"

#include "mesh/mesh.h"
#include "mesh/mesh_memory.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define MODE_TRIANGLES 4
#define MODE_STRIP 5
#define MODE_FAN 6

/* Primitives of all nodes together: few bytes of JSON could ask for the product of both. */
#define MOST_PARTS ((size_t)1 << 20)

/* Parts on their way into one mesh. */
typedef struct gathering {
    kdr_gltf_asset *asset;
    const kdr_gltf_nodes *nodes;
    kdr_gltf_parts *parts;
    kdr_mesh *mesh;
    uint32_t *material_numbers; /* of the file's materials and of none, KDR_INVALID_ID until one is used */
    bool is_default_alone;      /* nothing but the material of primitives without one */
} gathering;

static kdr_status fail_status(const gathering *in, kdr_status status) {
    return kdr_source_fail_status(in->asset->gltf.source, status);
}

/* A material as kdr_mesh_read gives it: its base colour, white where it has none. */
static kdr_status find_material(gathering *in, uint32_t number, uint32_t *out) {
    const kdr_gltf_asset *asset = in->asset;
    size_t count = asset->gltf.counts[KDR_GLTF_MATERIALS];
    uint32_t *place = &in->material_numbers[number == KDR_INVALID_ID ? count : number];
    if (*place == KDR_INVALID_ID) {
        static const double white[4] = {1, 1, 1, 1};
        double color[4] = {1, 1, 1, 1};
        kdr_word word = {"DefaultMaterial", 15};
        if (number != KDR_INVALID_ID) {
            const kdr_json_value *object = asset->objects[KDR_GLTF_MATERIALS][number];
            const kdr_json_value *name = kdr_gltf_find(asset, object, "name");
            const kdr_json_value *surface = kdr_gltf_find(asset, object, "pbrMetallicRoughness");
            kdr_status status = kdr_gltf_read_numbers(asset, surface, "baseColorFactor", 4, white, color);
            if (status != KDR_OK)
                return status;
            word = name && name->kind == KDR_JSON_STRING ? name->text : (kdr_word){"", 0};
            in->is_default_alone = false;
        }
        float diffuse[3];
        for (int i = 0; i < 3; i++)
            diffuse[i] = (float)fmin(fmax(color[i], 0), 1);
        kdr_status status = kdr_mesh_add_material(in->mesh, word.start, word.length, diffuse, place);
        if (status != KDR_OK)
            return fail_status(in, status);
    }
    *out = *place;
    return KDR_OK;
}

/* The accessor of an attribute, opened; KDR_INVALID_ID where there is none. */
static kdr_status open_attribute(gathering *in, const kdr_json_value *attributes, const char *name, uint32_t *out) {
    kdr_status status = kdr_gltf_read_reference(&in->asset->gltf, attributes, name, KDR_GLTF_ACCESSORS, out);
    if (status == KDR_OK && *out != KDR_INVALID_ID)
        status = kdr_gltf_open_values(in->asset, *out);
    return status;
}

static kdr_status read_targets(gathering *in, const kdr_json_value *primitive, kdr_gltf_part *part) {
    const kdr_json *json = &in->asset->gltf.json;
    const kdr_json_value *targets = kdr_gltf_find(in->asset, primitive, "targets");
    if (!targets || targets->count == 0)
        return KDR_OK;
    part->targets = kdr_gltf_take(&in->asset->store, targets->count, sizeof *part->targets);
    if (!part->targets)
        return fail_status(in, KDR_ERROR_OUT_OF_MEMORY);
    for (const kdr_json_value *one = kdr_json_first(json, targets); one; one = kdr_json_next(json, one)) {
        kdr_gltf_target *target = &part->targets[part->target_count++];
        kdr_status status = open_attribute(in, one, "POSITION", &target->positions);
        if (status == KDR_OK)
            status = open_attribute(in, one, "NORMAL", &target->normals);
        if (status != KDR_OK)
            return status;
    }
    if (part->target_count > in->parts->most_targets)
        in->parts->most_targets = part->target_count;
    return KDR_OK;
}

static kdr_status check_joints(const gathering *in, const kdr_json_value *attributes, const kdr_gltf_part *part,
                               size_t set) {
    const kdr_gltf *gltf = &in->asset->gltf;
    const kdr_gltf_values *joints = &in->asset->values[part->joints[set]];
    const kdr_gltf_values *weights = &in->asset->values[part->weights[set]];
    size_t joint_count = in->parts->skins[part->skin].count;
    for (size_t i = 0; i < part->vertex_count; i++)
        for (uint32_t k = 0; k < 4; k++) {
            uint32_t joint = kdr_gltf_whole(joints, i, k);
            float weight = kdr_gltf_number(weights, i, k);
            if (joint >= joint_count)
                return kdr_source_fail_byte(gltf->source, attributes->byte,
                                            "vertex %zu: expected a joint below %zu, found %u", i, joint_count, joint);
            if (weight < 0)
                return kdr_source_fail_byte(gltf->source, attributes->byte,
                                            "vertex %zu: expected a weight of at least 0, found %g", i, (double)weight);
        }
    return KDR_OK;
}

static kdr_status read_joints(gathering *in, const kdr_json_value *attributes, kdr_gltf_part *part) {
    for (size_t set = 0; set < KDR_GLTF_JOINT_SETS; set++) {
        char joints[16], weights[16];
        snprintf(joints, sizeof joints, "JOINTS_%zu", set);
        snprintf(weights, sizeof weights, "WEIGHTS_%zu", set);
        kdr_status status = open_attribute(in, attributes, joints, &part->joints[set]);
        if (status == KDR_OK)
            status = open_attribute(in, attributes, weights, &part->weights[set]);
        if (status != KDR_OK || part->joints[set] == KDR_INVALID_ID || part->weights[set] == KDR_INVALID_ID)
            return status;
        kdr_gltf_values *values = &in->asset->values[part->weights[set]];
        values->is_normalized = values->component != KDR_GLTF_FLOAT; // the only way that weights can be whole
        status = check_joints(in, attributes, part, set);
        if (status != KDR_OK)
            return status;
        part->joint_sets++;
    }
    return KDR_OK;
}

/* Appends the triangles of a list, a strip or a fan of `count` corners. */
static kdr_status add_triangles(gathering *in, const kdr_json_value *primitive, const kdr_gltf_part *part,
                                uint64_t mode, bool is_mirrored, uint32_t material) {
    kdr_mesh *mesh = in->mesh;
    uint32_t accessor;
    kdr_status status = open_attribute(in, primitive, "indices", &accessor);
    if (status != KDR_OK)
        return status;
    const kdr_gltf_values *indices = accessor == KDR_INVALID_ID ? NULL : &in->asset->values[accessor];
    size_t corner_count = indices ? indices->count : part->vertex_count, first = mesh->triangle_count;
    size_t count = mode == MODE_TRIANGLES ? corner_count / 3 : corner_count - 2;
    status = kdr_mesh_resize_triangles(mesh, first + count);
    if (status != KDR_OK)
        return fail_status(in, status);
    for (size_t i = 0; i < count; i++) {
        const size_t listed[3] = {3 * i, 3 * i + 1, 3 * i + 2}, fanned[3] = {i + 1, i + 2, 0};
        const size_t stripped[3] = {i, i + 1 + i % 2, i + 2 - i % 2};
        const size_t *corners = mode == MODE_TRIANGLES ? listed : mode == MODE_STRIP ? stripped : fanned;
        for (size_t k = 0; k < 3; k++) {
            size_t corner = corners[is_mirrored ? 2 - k : k];
            uint32_t number = indices ? kdr_gltf_whole(indices, corner, 0) : (uint32_t)corner;
            if (number >= part->vertex_count) {
                mesh->triangle_count = first;
                return kdr_source_fail_byte(in->asset->gltf.source, primitive->byte,
                                            "expected vertex numbers below %zu, found %u", part->vertex_count, number);
            }
            mesh->indices[3 * (first + i) + k] = (uint32_t)part->first_vertex + number;
        }
        mesh->triangle_materials[first + i] = material;
    }
    return KDR_OK;
}

static bool mirrors(const double m[12]) {
    return m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) +
               m[2] * (m[4] * m[9] - m[5] * m[8]) <
           0;
}

static kdr_status add_part(gathering *in, const kdr_json_value *primitive, uint32_t node_number) {
    const kdr_gltf_node *node = &in->nodes->nodes[node_number];
    uint64_t mode;
    kdr_status status = kdr_gltf_read_whole(&in->asset->gltf, primitive, "mode", MODE_FAN, MODE_TRIANGLES, &mode);
    if (status != KDR_OK || mode < MODE_TRIANGLES)
        return status;
    const kdr_json_value *attributes = kdr_gltf_find(in->asset, primitive, "attributes");
    kdr_gltf_part *part = &in->parts->parts[in->parts->count++];
    *part = (kdr_gltf_part){.node = node_number, .skin = node->skin, .first_vertex = in->mesh->vertex_count};
    status = open_attribute(in, attributes, "POSITION", &part->positions);
    if (status == KDR_OK)
        status = open_attribute(in, attributes, "NORMAL", &part->normals);
    if (status != KDR_OK)
        return status;
    part->vertex_count = in->asset->values[part->positions].count;
    status = read_targets(in, primitive, part);
    if (status == KDR_OK && part->skin != KDR_INVALID_ID)
        status = read_joints(in, attributes, part);
    if (status != KDR_OK)
        return status;
    if (part->joint_sets == 0)
        part->skin = KDR_INVALID_ID;

    uint32_t material;
    status = kdr_mesh_resize_vertices(in->mesh, part->first_vertex + part->vertex_count);
    if (status != KDR_OK)
        return fail_status(in, status);
    status = kdr_gltf_read_reference(&in->asset->gltf, primitive, "material", KDR_GLTF_MATERIALS, &material);
    if (status == KDR_OK)
        status = find_material(in, material, &material);
    bool is_mirrored = part->skin == KDR_INVALID_ID && mirrors(node->world);
    return status == KDR_OK ? add_triangles(in, primitive, part, mode, is_mirrored, material) : status;
}

static const kdr_json_value *primitives_of(const kdr_gltf_asset *asset, const kdr_gltf_node *node) {
    return node->mesh == KDR_INVALID_ID
               ? NULL
               : kdr_gltf_find(asset, asset->objects[KDR_GLTF_MESHES][node->mesh], "primitives");
}

static kdr_status add_parts(gathering *in) {
    const kdr_gltf_nodes *nodes = in->nodes;
    size_t count = 0;
    for (size_t i = 0; i < nodes->shown_count; i++) {
        const kdr_json_value *primitives = primitives_of(in->asset, &nodes->nodes[nodes->order[i]]);
        count += primitives ? primitives->count : 0;
    }
    if (count > MOST_PARTS)
        return kdr_source_fail(in->asset->gltf.source, KDR_ERROR_LIMIT,
                               "expected at most %zu primitives in all nodes, found %zu", MOST_PARTS, count);
    in->parts->parts = kdr_gltf_take(&in->asset->store, count, sizeof *in->parts->parts);
    if (!in->parts->parts)
        return fail_status(in, KDR_ERROR_OUT_OF_MEMORY);
    for (size_t i = 0; i < nodes->shown_count; i++) {
        uint32_t number = nodes->order[i];
        const kdr_json *json = &in->asset->gltf.json;
        const kdr_json_value *one = kdr_json_first(json, primitives_of(in->asset, &nodes->nodes[number]));
        for (; one; one = kdr_json_next(json, one)) {
            kdr_status status = add_part(in, one, number);
            if (status != KDR_OK)
                return status;
        }
    }
    return KDR_OK;
}

static kdr_status gather(gathering *in) {
    size_t count = in->asset->gltf.counts[KDR_GLTF_MATERIALS] + 1;
    in->material_numbers = kdr_gltf_take(&in->asset->store, count, sizeof(uint32_t));
    if (!in->material_numbers)
        return fail_status(in, KDR_ERROR_OUT_OF_MEMORY);
    memset(in->material_numbers, 0xff, count * sizeof(uint32_t));
    kdr_status status = add_parts(in);
    if (status != KDR_OK)
        return status;
    if (in->is_default_alone)
        kdr_mesh_drop_materials(in->mesh);
    bool has_normals = false;
    for (size_t i = 0; i < in->parts->count; i++)
        has_normals |= in->parts->parts[i].normals != KDR_INVALID_ID;
    if (has_normals)
        status = kdr_mesh_add_parts(in->mesh, KDR_MESH_NORMALS);
    return fail_status(in, status);
}

kdr_status kdr_gltf_parts_open(kdr_gltf_asset *asset, const kdr_gltf_nodes *nodes, kdr_gltf_parts *out,
                               kdr_mesh **mesh) {
    *out = (kdr_gltf_parts){0};
    gathering in = {.asset = asset, .nodes = nodes, .parts = out, .is_default_alone = true};
    *mesh = NULL;
    kdr_status status = kdr_gltf_read_skins(asset, out);
    if (status != KDR_OK)
        return status;
    const char *format = kdr_source_is_glb(asset->gltf.source) ? "GLB" : "GLTF";
    status = kdr_mesh_create(0, 0, KDR_MESH_MATERIALS, format, &in.mesh);
    if (status != KDR_OK)
        return fail_status(&in, status);
    status = gather(&in);
    if (status == KDR_OK)
        *mesh = in.mesh;
    else
        kdr_mesh_destroy(in.mesh);
    return status;
}
