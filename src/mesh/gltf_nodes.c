/* Source: Khronos Group, "glTF 2.0 Specification", chapter 3.5 (scenes): a node's transform is a matrix, or
 * translation * rotation * scale; its world transform is its parent's times its own. */
#include "mesh/gltf_nodes.h"

#include <math.h>

/* Morph weights of all nodes together. */
#define MOST_WEIGHTS ((size_t)1 << 24)

void kdr_gltf_multiply(const double a[12], const double b[12], double out[12]) {
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 4; column++)
            out[4 * row + column] = a[4 * row] * b[column] + a[4 * row + 1] * b[4 + column] +
                                    a[4 * row + 2] * b[8 + column] + (column == 3 ? a[4 * row + 3] : 0);
}

void kdr_gltf_transpose(const double columns[16], double rows[12]) {
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 4; column++)
            rows[4 * row + column] = columns[4 * column + row];
}

static void compose(const kdr_gltf_node *node, double out[12]) {
    const double *q = node->rotation, *s = node->scale;
    double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    bool is_sound = length > 0 && isfinite(length);
    double x = is_sound ? q[0] / length : 0, y = is_sound ? q[1] / length : 0;
    double z = is_sound ? q[2] / length : 0, w = is_sound ? q[3] / length : 1;
    const double rotation[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - z * w),     2 * (x * z + y * w),
                                2 * (x * y + z * w),     1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
                                2 * (x * z - y * w),     2 * (y * z + x * w),     1 - 2 * (x * x + y * y)};
    for (int row = 0; row < 3; row++) {
        for (int column = 0; column < 3; column++)
            out[4 * row + column] = rotation[3 * row + column] * s[column];
        out[4 * row + 3] = node->translation[row];
    }
}

void kdr_gltf_nodes_place(kdr_gltf_nodes *nodes) {
    static const double identity[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    for (size_t i = 0; i < nodes->count; i++) {
        kdr_gltf_node *node = &nodes->nodes[nodes->order[i]];
        double composed[12];
        compose(node, composed);
        kdr_gltf_multiply(node->parent == KDR_INVALID_ID ? identity : nodes->nodes[node->parent].world,
                          node->has_matrix ? node->matrix : composed, node->world);
    }
}

static size_t count_targets(const kdr_gltf_asset *asset, const kdr_json_value *mesh) {
    size_t most = 0;
    const kdr_json_value *primitive = kdr_json_first(&asset->gltf.json, kdr_gltf_find(asset, mesh, "primitives"));
    for (; primitive; primitive = kdr_json_next(&asset->gltf.json, primitive)) {
        const kdr_json_value *targets = kdr_gltf_find(asset, primitive, "targets");
        most = targets && targets->count > most ? targets->count : most;
    }
    return most;
}

/* Morph targets: of each mesh, and of the nodes that were read. */
typedef struct target_counts {
    size_t *of_mesh;
    size_t total;
} target_counts;

static kdr_status read_weights(kdr_gltf_asset *asset, const kdr_json_value *object, target_counts *counts,
                               kdr_gltf_node *node) {
    const kdr_json_value *mesh = asset->objects[KDR_GLTF_MESHES][node->mesh];
    node->weight_count = counts->of_mesh[node->mesh];
    counts->total += node->weight_count;
    if (counts->total > MOST_WEIGHTS)
        return kdr_source_fail(asset->gltf.source, KDR_ERROR_LIMIT,
                               "byte %zu: expected at most %zu morph targets in all nodes", object->byte, MOST_WEIGHTS);
    if (node->weight_count == 0)
        return KDR_OK;
    node->weights = kdr_gltf_take(&asset->store, node->weight_count, sizeof *node->weights);
    if (!node->weights)
        return kdr_source_fail_status(asset->gltf.source, KDR_ERROR_OUT_OF_MEMORY);
    kdr_status status = kdr_gltf_read_numbers(asset, mesh, "weights", node->weight_count, node->weights, node->weights);
    if (status != KDR_OK)
        return status;
    return kdr_gltf_read_numbers(asset, object, "weights", node->weight_count, node->weights, node->weights);
}

static kdr_status read_node(kdr_gltf_asset *asset, const kdr_json_value *object, target_counts *counts,
                            kdr_gltf_node *node) {
    static const double zeros[3] = {0}, ones[3] = {1, 1, 1}, at_rest[4] = {0, 0, 0, 1};
    double columns[16];
    kdr_status status = kdr_gltf_read_reference(&asset->gltf, object, "mesh", KDR_GLTF_MESHES, &node->mesh);
    if (status == KDR_OK)
        status = kdr_gltf_read_reference(&asset->gltf, object, "skin", KDR_GLTF_SKINS, &node->skin);
    if (status == KDR_OK)
        status = kdr_gltf_read_numbers(asset, object, "translation", 3, zeros, node->translation);
    if (status == KDR_OK)
        status = kdr_gltf_read_numbers(asset, object, "rotation", 4, at_rest, node->rotation);
    if (status == KDR_OK)
        status = kdr_gltf_read_numbers(asset, object, "scale", 3, ones, node->scale);
    node->has_matrix = kdr_gltf_find(asset, object, "matrix") != NULL;
    if (status == KDR_OK && node->has_matrix) {
        status = kdr_gltf_read_numbers(asset, object, "matrix", 16, NULL, columns);
        if (status == KDR_OK)
            kdr_gltf_transpose(columns, node->matrix);
    }
    if (status == KDR_OK && node->mesh != KDR_INVALID_ID)
        status = read_weights(asset, object, counts, node);
    return status;
}

static void name_parents(const kdr_gltf_asset *asset, kdr_gltf_nodes *nodes) {
    for (size_t i = 0; i < nodes->count; i++)
        nodes->nodes[i].parent = KDR_INVALID_ID;
    for (size_t i = 0; i < nodes->count; i++) {
        const kdr_json_value *children = kdr_gltf_find(asset, asset->objects[KDR_GLTF_NODES][i], "children");
        const kdr_json_value *child = kdr_json_first(&asset->gltf.json, children);
        for (; child; child = kdr_json_next(&asset->gltf.json, child))
            nodes->nodes[(size_t)child->number].parent = (uint32_t)i;
    }
}

/* Appends a root and all below it, parents first and children in their order. */
static void walk(const kdr_gltf_asset *asset, uint32_t root, uint32_t *stack, bool *is_met, kdr_gltf_nodes *nodes,
                 size_t *met_count) {
    size_t count = 0;
    if (!is_met[root])
        stack[count++] = root;
    while (count) {
        uint32_t number = stack[--count];
        is_met[number] = true;
        nodes->order[(*met_count)++] = number;
        const kdr_json_value *children = kdr_gltf_find(asset, asset->objects[KDR_GLTF_NODES][number], "children");
        const kdr_json_value *child = kdr_json_first(&asset->gltf.json, children);
        size_t first = count;
        for (; child; child = kdr_json_next(&asset->gltf.json, child))
            stack[count++] = (uint32_t)child->number;
        for (size_t low = first, high = count; low + 1 < high; low++) { // the last one in is the first one out
            uint32_t kept = stack[low];
            stack[low] = stack[--high];
            stack[high] = kept;
        }
    }
}

static kdr_status order_nodes(kdr_gltf_asset *asset, kdr_gltf_nodes *nodes) {
    uint32_t *stack = kdr_gltf_take(&asset->store, nodes->count, sizeof *stack);
    bool *is_met = kdr_gltf_take(&asset->store, nodes->count, sizeof *is_met);
    if (!stack || !is_met)
        return kdr_source_fail_status(asset->gltf.source, KDR_ERROR_OUT_OF_MEMORY);
    uint32_t number;
    kdr_status status = kdr_gltf_read_reference(&asset->gltf, asset->gltf.root, "scene", KDR_GLTF_SCENES, &number);
    if (status != KDR_OK)
        return status;
    size_t met_count = 0, scene_count = asset->gltf.counts[KDR_GLTF_SCENES];
    if (scene_count) {
        const kdr_json_value *scene = asset->objects[KDR_GLTF_SCENES][number == KDR_INVALID_ID ? 0 : number];
        const kdr_json_value *root = kdr_json_first(&asset->gltf.json, kdr_gltf_find(asset, scene, "nodes"));
        for (; root; root = kdr_json_next(&asset->gltf.json, root))
            walk(asset, (uint32_t)root->number, stack, is_met, nodes, &met_count);
        nodes->shown_count = met_count;
    }
    for (size_t i = 0; i < nodes->count; i++)
        if (nodes->nodes[i].parent == KDR_INVALID_ID)
            walk(asset, (uint32_t)i, stack, is_met, nodes, &met_count);
    if (!scene_count)
        nodes->shown_count = met_count;
    return KDR_OK;
}

kdr_status kdr_gltf_nodes_open(kdr_gltf_asset *asset, kdr_gltf_nodes *out) {
    size_t count = asset->gltf.counts[KDR_GLTF_NODES], mesh_count = asset->gltf.counts[KDR_GLTF_MESHES];
    target_counts counts = {kdr_gltf_take(&asset->store, mesh_count, sizeof(size_t)), 0};
    *out = (kdr_gltf_nodes){.count = count};
    out->nodes = kdr_gltf_take(&asset->store, count, sizeof *out->nodes);
    out->order = kdr_gltf_take(&asset->store, count, sizeof *out->order);
    if (!out->nodes || !out->order || !counts.of_mesh)
        return kdr_source_fail_status(asset->gltf.source, KDR_ERROR_OUT_OF_MEMORY);
    for (size_t i = 0; i < mesh_count; i++)
        counts.of_mesh[i] = count_targets(asset, asset->objects[KDR_GLTF_MESHES][i]);
    name_parents(asset, out);
    for (size_t i = 0; i < count; i++) {
        kdr_status status = read_node(asset, asset->objects[KDR_GLTF_NODES][i], &counts, &out->nodes[i]);
        if (status != KDR_OK)
            return status;
    }
    return order_nodes(asset, out);
}
