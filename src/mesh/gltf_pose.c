/* Vertices in the world for one state of the nodes: the deltas of morph targets are added first, then joints or the
 * node move the vertex. A skinned vertex goes through the sum of its joints' matrices, each times its weight; its
 * node's own transform is without effect. Normals go through the cofactors of the same matrix.
 *
 * Source: Khronos Group, "glTF 2.0 Specification", chapters 3.7.2 (morph targets) and 3.7.3 (skins).
 * Cost: linear in vertices, times the targets that have a weight. */
#include "mesh/gltf_parts.h"

#include <math.h>
#include <string.h>

/* The inverse transposed up to a positive factor, which normals do not feel. */
static void find_normal_matrix(const float m[12], float out[9]) {
    for (int row = 0; row < 3; row++) {
        const float *r = m + 4 * ((row + 1) % 3), *s = m + 4 * ((row + 2) % 3);
        for (int column = 0; column < 3; column++) {
            int u = (column + 1) % 3, v = (column + 2) % 3;
            out[3 * row + column] = r[u] * s[v] - r[v] * s[u];
        }
    }
    if (m[0] * out[0] + m[1] * out[1] + m[2] * out[2] < 0)
        for (int i = 0; i < 9; i++)
            out[i] = -out[i];
}

/* The sum of the matrices of a vertex's joints; weights count by their share, all 0: the first joint alone. */
static void blend_joints(const kdr_gltf_asset *asset, const kdr_gltf_part *part, const kdr_gltf_skin *skin,
                         size_t vertex, float out[12]) {
    float weights[4 * KDR_GLTF_JOINT_SETS], sum = 0;
    for (size_t i = 0; i < 4 * part->joint_sets; i++) {
        weights[i] = kdr_gltf_number(&asset->values[part->weights[i / 4]], vertex, (uint32_t)i % 4);
        sum += weights[i];
    }
    if (!(sum > 0)) {
        weights[0] = 1;
        sum = 1;
    }
    memset(out, 0, 12 * sizeof *out);
    for (size_t i = 0; i < 4 * part->joint_sets; i++) {
        if (weights[i] <= 0)
            continue;
        const float *m = skin->transforms[kdr_gltf_whole(&asset->values[part->joints[i / 4]], vertex, (uint32_t)i % 4)];
        float share = weights[i] / sum;
        for (int k = 0; k < 12; k++)
            out[k] += share * m[k];
    }
}

static void add_targets(const kdr_gltf_asset *asset, const kdr_gltf_part *part, const double *weights,
                        const size_t *moved, size_t moved_count, size_t vertex, float position[3], float normal[3]) {
    for (size_t i = 0; i < moved_count; i++) {
        const kdr_gltf_target *target = &part->targets[moved[i]];
        float weight = (float)weights[moved[i]], delta[3];
        if (target->positions != KDR_INVALID_ID) {
            kdr_gltf_vector(&asset->values[target->positions], vertex, delta);
            for (int axis = 0; axis < 3; axis++)
                position[axis] += weight * delta[axis];
        }
        if (target->normals != KDR_INVALID_ID && part->normals != KDR_INVALID_ID) {
            kdr_gltf_vector(&asset->values[target->normals], vertex, delta);
            for (int axis = 0; axis < 3; axis++)
                normal[axis] += weight * delta[axis];
        }
    }
}

/* False for a direction that has no length. */
static bool make_unit(float v[3]) {
    double x = (double)v[0], y = (double)v[1], z = (double)v[2], length = sqrt(x * x + y * y + z * z);
    if (!(length > 0) || !isfinite(length))
        return false;
    v[0] = (float)(x / length);
    v[1] = (float)(y / length);
    v[2] = (float)(z / length);
    return true;
}

static void pose_part(const kdr_gltf_asset *asset, const kdr_gltf_nodes *nodes, const kdr_gltf_parts *parts,
                      const kdr_gltf_part *part, bool *is_missing, size_t *moved, kdr_mesh *mesh) {
    const kdr_gltf_node *node = &nodes->nodes[part->node];
    const kdr_gltf_skin *skin = part->skin == KDR_INVALID_ID ? NULL : &parts->skins[part->skin];
    size_t moved_count = 0;
    for (size_t i = 0; i < part->target_count; i++)
        if (node->weights[i] != 0)
            moved[moved_count++] = i;
    float transform[12], normal_matrix[9];
    for (int k = 0; k < 12; k++)
        transform[k] = (float)node->world[k];
    find_normal_matrix(transform, normal_matrix);
    for (size_t i = 0; i < part->vertex_count; i++) {
        float p[3], n[3] = {0, 0, 0};
        size_t to = part->first_vertex + i;
        kdr_gltf_vector(&asset->values[part->positions], i, p);
        if (part->normals != KDR_INVALID_ID)
            kdr_gltf_vector(&asset->values[part->normals], i, n);
        add_targets(asset, part, node->weights, moved, moved_count, i, p, n);
        if (skin) {
            blend_joints(asset, part, skin, i, transform);
            if (mesh->normals)
                find_normal_matrix(transform, normal_matrix);
        }
        for (int row = 0; row < 3; row++) {
            const float *m = transform + 4 * row;
            mesh->positions[3 * to + (size_t)row] = m[0] * p[0] + m[1] * p[1] + m[2] * p[2] + m[3];
        }
        if (!mesh->normals)
            continue;
        float *normal = mesh->normals + 3 * to;
        for (int row = 0; row < 3; row++) {
            const float *m = normal_matrix + 3 * row;
            normal[row] = m[0] * n[0] + m[1] * n[1] + m[2] * n[2];
        }
        is_missing[to] = !make_unit(normal);
    }
}

/* Normals that are missing become the mean of those of the triangles around, weighted by area. */
static void fill_normals(const bool *is_missing, kdr_mesh *mesh) {
    for (size_t i = 0; i < mesh->vertex_count; i++)
        if (is_missing[i])
            memset(mesh->normals + 3 * i, 0, 3 * sizeof(float));
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        const uint32_t *corners = mesh->indices + 3 * i;
        if (!is_missing[corners[0]] && !is_missing[corners[1]] && !is_missing[corners[2]])
            continue;
        const float *a = mesh->positions + 3 * (size_t)corners[0], *b = mesh->positions + 3 * (size_t)corners[1];
        const float *c = mesh->positions + 3 * (size_t)corners[2];
        float e[3], f[3];
        for (int axis = 0; axis < 3; axis++) {
            e[axis] = b[axis] - a[axis];
            f[axis] = c[axis] - a[axis];
        }
        for (int corner = 0; corner < 3; corner++) {
            if (!is_missing[corners[corner]])
                continue;
            float *sum = mesh->normals + 3 * (size_t)corners[corner];
            sum[0] += e[1] * f[2] - e[2] * f[1];
            sum[1] += e[2] * f[0] - e[0] * f[2];
            sum[2] += e[0] * f[1] - e[1] * f[0];
        }
    }
    for (size_t i = 0; i < mesh->vertex_count; i++) {
        float *normal = mesh->normals + 3 * i;
        if (!is_missing[i] || make_unit(normal))
            continue;
        normal[0] = normal[1] = 0; // no triangle with an area: any direction serves
        normal[2] = 1;
    }
}

static void place_joints(const kdr_gltf_nodes *nodes, const kdr_gltf_parts *parts) {
    for (size_t i = 0; i < parts->skin_count; i++) {
        const kdr_gltf_skin *skin = &parts->skins[i];
        for (size_t joint = 0; joint < skin->count; joint++) {
            double transform[12];
            kdr_gltf_multiply(nodes->nodes[skin->joints[joint]].world, skin->binds[joint], transform);
            for (int k = 0; k < 12; k++)
                skin->transforms[joint][k] = (float)transform[k];
        }
    }
}

bool kdr_gltf_pose(const kdr_gltf_asset *asset, const kdr_gltf_nodes *nodes, const kdr_gltf_parts *parts,
                   bool *is_missing, size_t *moved_targets, kdr_mesh *mesh) {
    place_joints(nodes, parts);
    for (size_t i = 0; i < parts->count; i++)
        pose_part(asset, nodes, parts, &parts->parts[i], is_missing, moved_targets, mesh);
    bool is_finite = true;
    for (size_t i = 0; i < mesh->vertex_count; i++) {
        float *p = mesh->positions + 3 * i;
        if (isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]))
            continue;
        p[0] = p[1] = p[2] = 0;
        is_finite = false;
    }
    if (mesh->normals)
        fill_normals(is_missing, mesh);
    return is_finite;
}
