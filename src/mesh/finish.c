#include "mesh/finish.h"

#include "mesh/mesh.h"
#include "mesh/mesh_memory.h"

#include <math.h>
#include <string.h>

static bool is_finite3(const float *p) { return isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]); }

/* The exponent of infinities and NaNs is all ones; the loop has no branch, so that it runs on vectors. */
static bool all_finite(const float *values, size_t count) {
    uint32_t bad = 0;
    for (size_t i = 0; i < count; i++) {
        uint32_t bits;
        memcpy(&bits, &values[i], sizeof bits);
        bad |= (bits & 0x7f800000u) == 0x7f800000u;
    }
    return !bad;
}

static void drop_triangles(kdr_mesh *mesh) {
    size_t kept = 0;
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        const uint32_t *from = mesh->indices + 3 * i;
        if (!is_finite3(mesh->positions + 3 * (size_t)from[0]) || !is_finite3(mesh->positions + 3 * (size_t)from[1]) ||
            !is_finite3(mesh->positions + 3 * (size_t)from[2]))
            continue;
        memmove(mesh->indices + 3 * kept, from, 3 * sizeof(uint32_t));
        if (mesh->triangle_materials)
            mesh->triangle_materials[kept] = mesh->triangle_materials[i];
        kept++;
    }
    mesh->dropped_count = mesh->triangle_count - kept;
    mesh->triangle_count = kept;
}

/* A vertex of a dropped triangle is counted once: a mark in its x, a NaN of our own, says that a triangle used it. */
#define USED_MARK 0x7fc0feedu

static size_t count_used_vertices(kdr_mesh *mesh) {
    size_t count = 0;
    for (size_t i = 0; i < 3 * mesh->triangle_count; i++) {
        float *p = mesh->positions + 3 * (size_t)mesh->indices[i];
        uint32_t x, mark = USED_MARK;
        memcpy(&x, p, sizeof x);
        if (x != mark && !is_finite3(p)) {
            memcpy(p, &mark, sizeof mark);
            count++;
        }
    }
    return count;
}

static void drop_infinite(kdr_mesh *mesh, const kdr_source *source) {
    // The mark must not stand in the file's own numbers.
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++)
        if (isnan(mesh->positions[i]))
            mesh->positions[i] = INFINITY;
    mesh->dropped_vertex_count = count_used_vertices(mesh);
    drop_triangles(mesh);
    for (size_t i = 0; i < mesh->vertex_count; i++)
        if (!is_finite3(mesh->positions + 3 * i))
            memset(mesh->positions + 3 * i, 0, 3 * sizeof(float));
    if (mesh->dropped_count)
        kdr_source_warn(source, "%zu of %zu triangles were dropped: %zu of their vertices are not finite",
                        mesh->dropped_count, mesh->dropped_count + mesh->triangle_count, mesh->dropped_vertex_count);
}

/* False for a direction that has no length. */
static bool make_unit(const double from[3], float *to) {
    double length = sqrt(from[0] * from[0] + from[1] * from[1] + from[2] * from[2]);
    if (!(length > 0) || !isfinite(length))
        return false;
    for (int axis = 0; axis < 3; axis++)
        to[axis] = (float)(from[axis] / length);
    return true;
}

/* Adds to the sums of vertices without a normal the normals of the triangles around, weighted by area. */
static void sum_triangle_normals(const kdr_mesh *mesh, const uint32_t *slots, double *sums) {
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        const uint32_t *corners = mesh->indices + 3 * i;
        if (slots[corners[0]] == KDR_INVALID_ID && slots[corners[1]] == KDR_INVALID_ID &&
            slots[corners[2]] == KDR_INVALID_ID)
            continue;
        const float *a = mesh->positions + 3 * (size_t)corners[0];
        const float *b = mesh->positions + 3 * (size_t)corners[1];
        const float *c = mesh->positions + 3 * (size_t)corners[2];
        double e[3], f[3];
        for (int axis = 0; axis < 3; axis++) {
            e[axis] = (double)b[axis] - (double)a[axis];
            f[axis] = (double)c[axis] - (double)a[axis];
        }
        for (int corner = 0; corner < 3; corner++) {
            if (slots[corners[corner]] == KDR_INVALID_ID)
                continue;
            double *sum = sums + 3 * (size_t)slots[corners[corner]];
            sum[0] += e[1] * f[2] - e[2] * f[1];
            sum[1] += e[2] * f[0] - e[0] * f[2];
            sum[2] += e[0] * f[1] - e[1] * f[0];
        }
    }
}

static kdr_status fill_normals(kdr_mesh *mesh, size_t missing_count) {
    kdr_alloc *memory = kdr_mesh_memory();
    uint32_t *slots = kdr_alloc_array(memory, mesh->vertex_count, sizeof *slots, KDR_MESH_ALIGNMENT);
    double *sums = kdr_alloc_array(memory, missing_count, 3 * sizeof *sums, KDR_MESH_ALIGNMENT);
    kdr_status status = slots && sums ? KDR_OK : KDR_ERROR_OUT_OF_MEMORY;
    if (status == KDR_OK) {
        memset(sums, 0, missing_count * 3 * sizeof *sums);
        uint32_t slot = 0;
        for (size_t i = 0; i < mesh->vertex_count; i++)
            slots[i] = isnan(mesh->normals[3 * i]) ? slot++ : KDR_INVALID_ID;
        sum_triangle_normals(mesh, slots, sums);
        for (size_t i = 0; i < mesh->vertex_count; i++) {
            float *normal = mesh->normals + 3 * i;
            if (slots[i] == KDR_INVALID_ID || make_unit(sums + 3 * (size_t)slots[i], normal))
                continue;
            normal[0] = normal[1] = 0; // no triangle with an area: any direction serves
            normal[2] = 1;
        }
    }
    kdr_alloc_release(memory, slots, mesh->vertex_count * sizeof *slots);
    kdr_alloc_release(memory, sums, missing_count * 3 * sizeof *sums);
    return status;
}

static kdr_status finish_normals(kdr_mesh *mesh) {
    size_t missing_count = 0;
    for (size_t i = 0; i < mesh->vertex_count; i++) {
        float *normal = mesh->normals + 3 * i;
        double direction[3] = {(double)normal[0], (double)normal[1], (double)normal[2]};
        if (!make_unit(direction, normal)) {
            normal[0] = NAN;
            missing_count++;
        }
    }
    return missing_count ? fill_normals(mesh, missing_count) : KDR_OK;
}

kdr_status kdr_mesh_finish(kdr_mesh *mesh, const kdr_source *source) {
    if (!all_finite(mesh->positions, 3 * mesh->vertex_count))
        drop_infinite(mesh, source);
    if (mesh->normals) {
        kdr_status status = finish_normals(mesh);
        if (status != KDR_OK)
            return kdr_source_fail_status(source, status);
    }
    kdr_mesh_trim(mesh);
    return KDR_OK;
}
