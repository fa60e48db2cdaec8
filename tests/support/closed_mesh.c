#include "support/closed_mesh.h"

#include "support/soup.h"

#include <math.h>
#include <stdlib.h>

#define TURN 6.283185307179586

static closed_mesh mesh_create(size_t vertex_count, size_t triangle_count) {
    return (closed_mesh){test_allocate(3 * vertex_count, sizeof(float)),
                         test_allocate(3 * triangle_count, sizeof(uint32_t)), vertex_count, triangle_count};
}

void closed_mesh_destroy(closed_mesh *mesh) {
    free(mesh->vertices);
    free(mesh->indices);
    *mesh = (closed_mesh){0};
}

kdr_triangles_def closed_mesh_def(const closed_mesh *mesh) {
    kdr_triangles_def def = kdr_default_triangles_def();
    def.vertices = mesh->vertices;
    def.vertex_count = mesh->vertex_count;
    def.indices = mesh->indices;
    def.triangle_count = mesh->triangle_count;
    return def;
}

/* ------------------------------------------------------------------------------------------------------ sphere */

#define GOLDEN 1.618033988749895
static const double corners[12][3] = {{-1, GOLDEN, 0}, {1, GOLDEN, 0}, {-1, -GOLDEN, 0}, {1, -GOLDEN, 0},
                                      {0, -1, GOLDEN}, {0, 1, GOLDEN}, {0, -1, -GOLDEN}, {0, 1, -GOLDEN},
                                      {GOLDEN, 0, -1}, {GOLDEN, 0, 1}, {-GOLDEN, 0, -1}, {-GOLDEN, 0, 1}};
static const uint32_t faces[20][3] = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                      {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                      {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                      {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};

/* Vertex (i, j) of a face's lattice, the weights being n - i - j, i and j. A vertex of two faces gets the same floats
 * from both: the sum is taken in the order of the corners' numbers. */
static void face_vertex(const uint32_t face[3], uint32_t n, uint32_t i, uint32_t j, float out[3]) {
    double weights[12] = {0}, sum[3] = {0};
    weights[face[0]] = n - i - j;
    weights[face[1]] = i;
    weights[face[2]] = j;
    for (int corner = 0; corner < 12; corner++)
        for (int axis = 0; axis < 3; axis++)
            sum[axis] += weights[corner] * corners[corner][axis];
    double length = sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
    for (int axis = 0; axis < 3; axis++)
        out[axis] = (float)(sum[axis] / length);
}

closed_mesh closed_mesh_sphere(uint32_t steps) {
    uint32_t n = steps, lattice = (n + 1) * (n + 2) / 2;
    closed_mesh mesh = mesh_create((size_t)20 * lattice, (size_t)20 * n * n);
    uint32_t *index = mesh.indices;
    for (uint32_t face = 0; face < 20; face++) {
        uint32_t row = face * lattice;
        for (uint32_t i = 0; i <= n; i++) {
            uint32_t length = n - i + 1;
            for (uint32_t j = 0; j < length; j++) {
                face_vertex(faces[face], n, i, j, mesh.vertices + 3 * (row + j));
                if (j + 1 < length) {
                    *index++ = row + j, *index++ = row + length + j, *index++ = row + j + 1;
                }
                if (j + 2 < length) {
                    *index++ = row + j + 1, *index++ = row + length + j, *index++ = row + length + j + 1;
                }
            }
            row += length;
        }
    }
    return mesh;
}

closed_mesh closed_mesh_blob(uint32_t steps) {
    closed_mesh mesh = closed_mesh_sphere(steps);
    for (size_t i = 0; i < mesh.vertex_count; i++) {
        float *v = mesh.vertices + 3 * i;
        double wave = sin(5 * v[0] + 1) * cos(4 * v[1]) * sin(6 * v[2] + 2) + 0.5 * sin(11 * v[0] * v[1] + 3 * v[2]);
        double radius = 1 + 0.4 * wave;
        for (int axis = 0; axis < 3; axis++)
            v[axis] = (float)(v[axis] * radius);
    }
    return mesh;
}

/* ------------------------------------------------------------------------------------------------------- torus */

closed_mesh closed_mesh_torus(uint32_t around, uint32_t across) {
    closed_mesh mesh = mesh_create((size_t)around * across, (size_t)2 * around * across);
    uint32_t *index = mesh.indices;
    for (uint32_t i = 0; i < around; i++) {
        for (uint32_t j = 0; j < across; j++) {
            double a = TURN * i / around, b = TURN * j / across, distance = 1 + 0.4 * cos(b);
            float *v = mesh.vertices + 3 * ((size_t)i * across + j);
            v[0] = (float)(distance * cos(a)), v[1] = (float)(distance * sin(a)), v[2] = (float)(0.4 * sin(b));
            uint32_t next_i = (i + 1) % around, next_j = (j + 1) % across;
            uint32_t p = i * across + j, q = next_i * across + j, r = next_i * across + next_j, s = i * across + next_j;
            *index++ = p, *index++ = q, *index++ = r;
            *index++ = p, *index++ = r, *index++ = s;
        }
    }
    return mesh;
}

void closed_mesh_snap(closed_mesh *mesh, float step) {
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++)
        mesh->vertices[i] = rintf(mesh->vertices[i] / step) * step;
}
