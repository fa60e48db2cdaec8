/* Closed meshes: whoever stands inside sees a triangle in every direction. */
#ifndef KDR_TESTS_SUPPORT_CLOSED_MESH_H
#define KDR_TESTS_SUPPORT_CLOSED_MESH_H

#include "kdray/kdray.h"

typedef struct closed_mesh {
    float *vertices;
    uint32_t *indices;
    size_t vertex_count;
    size_t triangle_count;
} closed_mesh;

/* An icosahedron with every face cut in steps * steps, its vertices at distance 1 from the origin. */
closed_mesh closed_mesh_sphere(uint32_t steps);

/* Around the z axis, the tube's middle at distance 1, its radius 0.4. */
closed_mesh closed_mesh_torus(uint32_t around, uint32_t across);

/* The sphere with its vertices moved along their directions by smooth waves: radius 0.4 to 1.6, seen whole from the
 * origin. */
closed_mesh closed_mesh_blob(uint32_t steps);

/* Moves every vertex to the nearest multiple of `step`. */
void closed_mesh_snap(closed_mesh *mesh, float step);

void closed_mesh_destroy(closed_mesh *mesh);

kdr_triangles_def closed_mesh_def(const closed_mesh *mesh);

#endif
