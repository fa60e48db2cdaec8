/* How a mesh is made: arrays out of the shared memory of kdray-render, which can grow while a file is read.
 *
 * The caller fills the arrays and answers for the public promise of kdr_mesh (indices below their counts, finite
 * positions and normals). Contents of new arrays are undefined. Arrays of no primitives are NULL.
 * Counts are at most KDR_MESH_LIMIT. Errors of all: OUT_OF_MEMORY, LIMIT; the mesh is then unchanged. */
#ifndef KDR_MESH_MESH_H
#define KDR_MESH_MESH_H

#include "kdray/render.h"

/* Vertices or triangles of one mesh: 32-bit numbers, KDR_INVALID_ID kept apart. */
#define KDR_MESH_LIMIT ((size_t)UINT32_MAX - 1)

/* Arrays beyond positions and indices. */
enum {
    KDR_MESH_NORMALS = 1,   /* normals */
    KDR_MESH_MATERIALS = 2, /* triangle_materials; materials themselves are added one by one */
};

/* parts: KDR_MESH_NORMALS | KDR_MESH_MATERIALS or 0. format is copied, cut to its array. Release: kdr_mesh_destroy. */
kdr_status kdr_mesh_create(size_t vertex_count, size_t triangle_count, uint32_t parts, const char *format,
                           kdr_mesh **out);

/* Sets vertex_count or triangle_count, contents up to the lesser count kept. Growth is geometric: resizing by one is
 * cheap on average. Pointers into the arrays become invalid. */
kdr_status kdr_mesh_resize_vertices(kdr_mesh *mesh, size_t count);
kdr_status kdr_mesh_resize_triangles(kdr_mesh *mesh, size_t count);

/* Makes room for `count` without changing the mesh's count. */
kdr_status kdr_mesh_reserve_vertices(kdr_mesh *mesh, size_t count);
kdr_status kdr_mesh_reserve_triangles(kdr_mesh *mesh, size_t count);

/* Vertices and triangles that fit without growing. */
size_t kdr_mesh_vertex_capacity(const kdr_mesh *mesh);
size_t kdr_mesh_triangle_capacity(const kdr_mesh *mesh);

/* Adds the arrays named in `parts` that the mesh lacks; they grow with it from here on. */
kdr_status kdr_mesh_add_parts(kdr_mesh *mesh, uint32_t parts);

/* Adds a material; the name of name_length bytes is copied up to its first zero byte. *index (may be NULL) gets its
 * number. */
kdr_status kdr_mesh_add_material(kdr_mesh *mesh, const char *name, size_t name_length, const float diffuse[3],
                                 uint32_t *index);

/* Takes all materials away, triangle_materials included. */
void kdr_mesh_drop_materials(kdr_mesh *mesh);

/* Gives back room that is much larger than its contents. Keeps the mesh as it is where there is no memory to do so. */
void kdr_mesh_trim(kdr_mesh *mesh);

#endif
