#include "mesh/mesh.h"

#include "base/check.h"
#include "mesh/mesh_memory.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* A mesh as it is allocated: the public struct first, then how much its arrays really hold. Sizes given back are those
 * taken, whatever became of the public counts. */
typedef struct owned_mesh {
    kdr_mesh mesh;
    size_t vertex_capacity;
    size_t triangle_capacity;
    size_t material_capacity;
    uint32_t parts; /* arrays that the mesh has, or will have when it has a capacity */
} owned_mesh;

static owned_mesh *own(kdr_mesh *mesh) { return (owned_mesh *)mesh; }
static const owned_mesh *own_const(const kdr_mesh *mesh) { return (const owned_mesh *)mesh; }

#define VERTEX_BYTES (3 * sizeof(float))
#define TRIANGLE_BYTES (3 * sizeof(uint32_t))

static void *take(size_t count, size_t size) {
    return kdr_alloc_array(kdr_mesh_memory(), count, size, KDR_MESH_ALIGNMENT);
}

static void give(void *memory, size_t count, size_t size) {
    if (memory)
        kdr_alloc_release(kdr_mesh_memory(), memory, count * size);
}

/* Two arrays of one length that move to another capacity together, or not at all. size 0: no such array. */
typedef struct move {
    void *old[2];
    size_t size[2]; /* bytes of one */
    void *fresh[2];
} move;

static kdr_status move_arrays(move *arrays, size_t kept, size_t old_capacity, size_t new_capacity) {
    for (int i = 0; i < 2; i++) {
        bool wanted = arrays->size[i] && new_capacity;
        arrays->fresh[i] = wanted ? take(new_capacity, arrays->size[i]) : NULL;
        if (wanted && !arrays->fresh[i]) {
            if (i == 1)
                give(arrays->fresh[0], new_capacity, arrays->size[0]);
            return KDR_ERROR_OUT_OF_MEMORY;
        }
    }
    for (int i = 0; i < 2; i++) {
        if (arrays->fresh[i] && arrays->old[i] && kept)
            memcpy(arrays->fresh[i], arrays->old[i], kept * arrays->size[i]);
        give(arrays->old[i], old_capacity, arrays->size[i]);
    }
    return KDR_OK;
}

static kdr_status set_vertex_capacity(kdr_mesh *mesh, size_t capacity) {
    owned_mesh *owned = own(mesh);
    move arrays = {{mesh->positions, mesh->normals},
                   {VERTEX_BYTES, owned->parts & KDR_MESH_NORMALS ? VERTEX_BYTES : 0},
                   {NULL, NULL}};
    kdr_status status = move_arrays(&arrays, mesh->vertex_count, owned->vertex_capacity, capacity);
    if (status == KDR_OK) {
        mesh->positions = arrays.fresh[0];
        mesh->normals = arrays.fresh[1];
        owned->vertex_capacity = capacity;
    }
    return status;
}

static kdr_status set_triangle_capacity(kdr_mesh *mesh, size_t capacity) {
    owned_mesh *owned = own(mesh);
    move arrays = {{mesh->indices, mesh->triangle_materials},
                   {TRIANGLE_BYTES, owned->parts & KDR_MESH_MATERIALS ? sizeof(uint32_t) : 0},
                   {NULL, NULL}};
    kdr_status status = move_arrays(&arrays, mesh->triangle_count, owned->triangle_capacity, capacity);
    if (status == KDR_OK) {
        mesh->indices = arrays.fresh[0];
        mesh->triangle_materials = arrays.fresh[1];
        owned->triangle_capacity = capacity;
    }
    return status;
}

static size_t grown(size_t capacity, size_t wanted) {
    size_t larger = capacity + capacity / 2;
    return larger > wanted ? larger : wanted;
}

kdr_status kdr_mesh_create(size_t vertex_count, size_t triangle_count, uint32_t parts, const char *format,
                           kdr_mesh **out) {
    *out = NULL;
    owned_mesh *owned = take(1, sizeof *owned);
    if (!owned)
        return KDR_ERROR_OUT_OF_MEMORY;
    *owned = (owned_mesh){0};
    snprintf(owned->mesh.format, sizeof owned->mesh.format, "%s", format);

    owned->parts = parts;
    kdr_status status = kdr_mesh_resize_vertices(&owned->mesh, vertex_count);
    if (status == KDR_OK)
        status = kdr_mesh_resize_triangles(&owned->mesh, triangle_count);
    if (status != KDR_OK) {
        kdr_mesh_destroy(&owned->mesh);
        return status;
    }
    *out = &owned->mesh;
    return KDR_OK;
}

void kdr_mesh_destroy(kdr_mesh *mesh) {
    if (!mesh)
        return;
    owned_mesh *owned = own(mesh);
    give(mesh->positions, owned->vertex_capacity, VERTEX_BYTES);
    give(mesh->normals, owned->vertex_capacity, VERTEX_BYTES);
    give(mesh->indices, owned->triangle_capacity, TRIANGLE_BYTES);
    kdr_mesh_drop_materials(mesh);
    give(owned, 1, sizeof *owned);
}

kdr_status kdr_mesh_reserve_vertices(kdr_mesh *mesh, size_t count) {
    if (count > KDR_MESH_LIMIT)
        return KDR_ERROR_LIMIT;
    return count > own(mesh)->vertex_capacity ? set_vertex_capacity(mesh, grown(own(mesh)->vertex_capacity, count))
                                              : KDR_OK;
}

kdr_status kdr_mesh_reserve_triangles(kdr_mesh *mesh, size_t count) {
    if (count > KDR_MESH_LIMIT)
        return KDR_ERROR_LIMIT;
    return count > own(mesh)->triangle_capacity
               ? set_triangle_capacity(mesh, grown(own(mesh)->triangle_capacity, count))
               : KDR_OK;
}

kdr_status kdr_mesh_resize_vertices(kdr_mesh *mesh, size_t count) {
    kdr_status status = kdr_mesh_reserve_vertices(mesh, count);
    if (status == KDR_OK)
        mesh->vertex_count = count;
    return status;
}

kdr_status kdr_mesh_resize_triangles(kdr_mesh *mesh, size_t count) {
    kdr_status status = kdr_mesh_reserve_triangles(mesh, count);
    if (status == KDR_OK)
        mesh->triangle_count = count;
    return status;
}

size_t kdr_mesh_vertex_capacity(const kdr_mesh *mesh) { return own_const(mesh)->vertex_capacity; }

size_t kdr_mesh_triangle_capacity(const kdr_mesh *mesh) { return own_const(mesh)->triangle_capacity; }

kdr_status kdr_mesh_add_parts(kdr_mesh *mesh, uint32_t parts) {
    owned_mesh *owned = own(mesh);
    uint32_t missing = parts & ~owned->parts;
    bool want_normals = (missing & KDR_MESH_NORMALS) && owned->vertex_capacity;
    bool want_materials = (missing & KDR_MESH_MATERIALS) && owned->triangle_capacity;
    float *normals = want_normals ? take(owned->vertex_capacity, VERTEX_BYTES) : NULL;
    uint32_t *materials = want_materials ? take(owned->triangle_capacity, sizeof(uint32_t)) : NULL;
    if ((want_normals && !normals) || (want_materials && !materials)) {
        give(normals, owned->vertex_capacity, VERTEX_BYTES);
        give(materials, owned->triangle_capacity, sizeof(uint32_t));
        return KDR_ERROR_OUT_OF_MEMORY;
    }
    if (normals)
        mesh->normals = normals;
    if (materials)
        mesh->triangle_materials = materials;
    owned->parts |= parts;
    return KDR_OK;
}

kdr_status kdr_mesh_add_material(kdr_mesh *mesh, const char *name, size_t name_length, const float diffuse[3],
                                 uint32_t *index) {
    owned_mesh *owned = own(mesh);
    if (mesh->material_count >= KDR_MESH_LIMIT)
        return KDR_ERROR_LIMIT;
    if (mesh->material_count == owned->material_capacity) {
        size_t capacity = grown(owned->material_capacity, mesh->material_count + 8);
        move arrays = {{mesh->materials, NULL}, {sizeof(kdr_mesh_material), 0}, {NULL, NULL}};
        kdr_status status = move_arrays(&arrays, mesh->material_count, owned->material_capacity, capacity);
        if (status != KDR_OK)
            return status;
        mesh->materials = arrays.fresh[0];
        owned->material_capacity = capacity;
    }
    size_t length = strnlen(name, name_length);
    char *copy = take(length + 1, 1);
    if (!copy)
        return KDR_ERROR_OUT_OF_MEMORY;
    memcpy(copy, name, length);
    copy[length] = '\0';

    kdr_mesh_material *material = &mesh->materials[mesh->material_count];
    *material = (kdr_mesh_material){copy, {diffuse[0], diffuse[1], diffuse[2]}};
    if (index)
        *index = (uint32_t)mesh->material_count;
    mesh->material_count++;
    return KDR_OK;
}

void kdr_mesh_drop_materials(kdr_mesh *mesh) {
    owned_mesh *owned = own(mesh);
    give(mesh->triangle_materials, owned->triangle_capacity, sizeof(uint32_t));
    for (size_t i = 0; i < mesh->material_count; i++)
        give(mesh->materials[i].name, strlen(mesh->materials[i].name) + 1, 1);
    give(mesh->materials, owned->material_capacity, sizeof(kdr_mesh_material));
    mesh->triangle_materials = NULL;
    mesh->materials = NULL;
    mesh->material_count = owned->material_capacity = 0;
    owned->parts &= ~(uint32_t)KDR_MESH_MATERIALS;
}

/* More than a quarter unused is worth a copy. */
static bool is_loose(size_t capacity, size_t count) { return capacity - count > count / 4; }

void kdr_mesh_trim(kdr_mesh *mesh) {
    if (is_loose(own(mesh)->vertex_capacity, mesh->vertex_count))
        (void)set_vertex_capacity(mesh, mesh->vertex_count);
    if (is_loose(own(mesh)->triangle_capacity, mesh->triangle_count))
        (void)set_triangle_capacity(mesh, mesh->triangle_count);
}

void kdr_mesh_bounds(const kdr_mesh *mesh, float bounds[6]) {
    float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (size_t i = 0; i < 3 * mesh->triangle_count; i++) {
        const float *p = mesh->positions + 3 * (size_t)mesh->indices[i];
        for (int axis = 0; axis < 3; axis++) {
            low[axis] = p[axis] < low[axis] ? p[axis] : low[axis];
            high[axis] = p[axis] > high[axis] ? p[axis] : high[axis];
        }
    }
    memcpy(bounds, low, sizeof low);
    memcpy(bounds + 3, high, sizeof high);
}
