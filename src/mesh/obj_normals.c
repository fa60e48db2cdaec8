/* One normal a vertex out of one a corner.
 *
 * OBJ gives each corner of a face a vertex and a normal of its own; a mesh has one normal a vertex. A vertex keeps the
 * normal that its first corner names; each other normal that it meets makes a copy of it. Normals that are equal number
 * for number count as one, however often the file repeats them. A corner without a normal counts as one more normal,
 * NaN, which is filled in when the mesh is finished. */
#include "mesh/mesh.h"
#include "mesh/mesh_memory.h"
#include "mesh/obj.h"

#include <math.h>
#include <string.h>

/* Replaces the corners' numbers by those of the first equal normal. */
static kdr_status unify_normals(kdr_obj *obj) {
    size_t count = obj->counts[KDR_OBJ_NORMAL], unique_count;
    uint32_t *numbers = kdr_alloc_array(kdr_mesh_memory(), 2 * count, sizeof *numbers, KDR_MESH_ALIGNMENT);
    if (!numbers)
        return KDR_ERROR_OUT_OF_MEMORY;
    kdr_status status = kdr_merge_keys(obj->normals.memory, 3, count, numbers, &unique_count);
    if (status == KDR_OK) {
        uint32_t *firsts = numbers + count, *corner_normals = obj->corner_normals.memory, next = 0;
        for (size_t i = 0; i < count; i++)
            if (numbers[i] == next)
                firsts[next++] = (uint32_t)i;
        for (size_t i = 0; i < 3 * obj->mesh->triangle_count; i++)
            if (corner_normals[i] != KDR_INVALID_ID)
                corner_normals[i] = firsts[numbers[corner_normals[i]]];
    }
    kdr_alloc_release(kdr_mesh_memory(), numbers, 2 * count * sizeof *numbers);
    return status;
}

static void set_normal(kdr_obj *obj, size_t vertex, uint32_t number) {
    const float *normals = obj->normals.memory;
    float *normal = obj->mesh->normals + 3 * vertex;
    if (number != KDR_INVALID_ID)
        memcpy(normal, normals + 3 * (size_t)number, 3 * sizeof(float));
    else
        normal[0] = normal[1] = normal[2] = NAN;
}

/* A mark in `first_normals` for vertices that no corner has named yet: no number of a normal, nor the lack of one. */
#define NOT_NAMED (KDR_INVALID_ID - 1)

/* Copies vertices for the `count` corners whose place in the indices stands in `corners`. */
static kdr_status copy_vertices(kdr_obj *obj, const uint32_t *keys, const size_t *corners, size_t count,
                                uint32_t *numbers) {
    size_t copies, old_count = obj->mesh->vertex_count;
    kdr_status status = kdr_merge_keys(keys, 2, count, numbers, &copies);
    if (status == KDR_OK)
        status = kdr_mesh_resize_vertices(obj->mesh, old_count + copies);
    if (status != KDR_OK)
        return status;
    kdr_mesh *mesh = obj->mesh;
    uint32_t next = 0;
    for (size_t i = 0; i < count; i++) {
        size_t copy = old_count + numbers[i];
        mesh->indices[corners[i]] = (uint32_t)copy;
        if (numbers[i] != next)
            continue;
        next++;
        memcpy(mesh->positions + 3 * copy, mesh->positions + 3 * (size_t)keys[2 * i], 3 * sizeof(float));
        set_normal(obj, copy, keys[2 * i + 1]);
    }
    return KDR_OK;
}

/* Finds the corners whose normal is not their vertex's, and has them copied. */
static kdr_status split_corners(kdr_obj *obj, const uint32_t *first_normals, size_t count) {
    kdr_alloc *memory = kdr_mesh_memory();
    uint32_t *keys = kdr_alloc_array(memory, count, 2 * sizeof *keys, KDR_MESH_ALIGNMENT);
    size_t *corners = kdr_alloc_array(memory, count, sizeof *corners, KDR_MESH_ALIGNMENT);
    uint32_t *numbers = kdr_alloc_array(memory, count, sizeof *numbers, KDR_MESH_ALIGNMENT);
    kdr_status status = KDR_ERROR_OUT_OF_MEMORY;
    if (keys && corners && numbers) {
        const uint32_t *indices = obj->mesh->indices, *corner_normals = obj->corner_normals.memory;
        size_t next = 0;
        for (size_t i = 0; i < 3 * obj->mesh->triangle_count; i++) {
            if (first_normals[indices[i]] == corner_normals[i])
                continue;
            keys[2 * next] = indices[i];
            keys[2 * next + 1] = corner_normals[i];
            corners[next++] = i;
        }
        status = copy_vertices(obj, keys, corners, count, numbers);
    }
    kdr_alloc_release(memory, keys, count * 2 * sizeof *keys);
    kdr_alloc_release(memory, corners, count * sizeof *corners);
    kdr_alloc_release(memory, numbers, count * sizeof *numbers);
    return status;
}

kdr_status kdr_obj_split_normals(kdr_obj *obj) {
    kdr_mesh *mesh = obj->mesh;
    kdr_status status = unify_normals(obj);
    if (status == KDR_OK)
        status = kdr_mesh_add_parts(mesh, KDR_MESH_NORMALS);
    size_t vertex_count = mesh->vertex_count, differing = 0;
    uint32_t *first_normals = NULL;
    if (status == KDR_OK) {
        first_normals = kdr_alloc_array(kdr_mesh_memory(), vertex_count, sizeof(uint32_t), KDR_MESH_ALIGNMENT);
        status = first_normals ? KDR_OK : KDR_ERROR_OUT_OF_MEMORY;
    }
    if (status != KDR_OK)
        return status;

    for (size_t i = 0; i < vertex_count; i++)
        first_normals[i] = NOT_NAMED;
    const uint32_t *corner_normals = obj->corner_normals.memory;
    for (size_t i = 0; i < 3 * mesh->triangle_count; i++) {
        uint32_t *first = &first_normals[mesh->indices[i]];
        if (*first == NOT_NAMED)
            *first = corner_normals[i];
        differing += *first != corner_normals[i];
    }
    for (size_t i = 0; i < vertex_count; i++)
        set_normal(obj, i, first_normals[i] == NOT_NAMED ? KDR_INVALID_ID : first_normals[i]);
    if (differing)
        status = split_corners(obj, first_normals, differing);
    kdr_alloc_release(kdr_mesh_memory(), first_normals, vertex_count * sizeof(uint32_t));
    return status;
}
