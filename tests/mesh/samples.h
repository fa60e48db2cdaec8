/* The same tetrahedron in every format: four vertices, four triangles. */
#ifndef KDR_TESTS_MESH_SAMPLES_H
#define KDR_TESTS_MESH_SAMPLES_H

#include "mesh/reading.h"

static const float tetrahedron_positions[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
static const uint32_t tetrahedron_indices[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

static inline void sample_ply_ascii(byte_list *out) {
    put_text(out, "ply\nformat ascii 1.0\ncomment a tetrahedron\nelement vertex 4\nproperty float x\nproperty float y\n"
                  "property float z\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n"
                  "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n");
}

static inline void sample_ply_binary(byte_list *out, bool big) {
    put_text(out, big ? "ply\nformat binary_big_endian 1.0\n" : "ply\nformat binary_little_endian 1.0\n");
    put_text(out, "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
                  "element face 4\nproperty list uchar int vertex_indices\nend_header\n");
    for (int i = 0; i < 12; i++)
        put_f32(out, tetrahedron_positions[i / 3][i % 3], big);
    for (int i = 0; i < 4; i++) {
        put_u8(out, 3);
        for (int corner = 0; corner < 3; corner++)
            put_u32(out, tetrahedron_indices[i][corner], big);
    }
}

static inline void sample_obj(byte_list *out) {
    put_text(out, "# a tetrahedron\no tetrahedron\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
                  "vn 0 0 -1\nvn 0 -1 0\nvn -1 0 0\nvn 1 1 1\nusemtl red\n"
                  "f 1//1 3//1 2//1\nf 1//2 2//2 4//2\nusemtl blue\nf 1//3 4//3 3//3\nf -3//-1 -2//-1 -1//-1\n");
}

static inline void sample_stl_binary(byte_list *out) {
    char text[80] = "solid by its first word only";
    put(out, text, sizeof text);
    put_u32(out, 4, false);
    for (int i = 0; i < 4; i++) {
        for (int k = 0; k < 3; k++)
            put_f32(out, 0, false);
        for (int k = 0; k < 9; k++)
            put_f32(out, tetrahedron_positions[tetrahedron_indices[i][k / 3]][k % 3], false);
        put_u16(out, 0, false);
    }
}

static inline void sample_stl_ascii(byte_list *out) {
    put_text(out, "solid tetrahedron of facets\n");
    for (int i = 0; i < 4; i++) {
        put_text(out, "facet normal 0 0 0\nouter loop\n");
        for (int k = 0; k < 3; k++) {
            const float *p = tetrahedron_positions[tetrahedron_indices[i][k]];
            char line[80];
            snprintf(line, sizeof line, "vertex %.1f %.1e %g\n", (double)p[0], (double)p[1], (double)p[2]);
            put_text(out, line);
        }
        put_text(out, "endloop\nendfacet\n");
    }
    put_text(out, "endsolid tetrahedron of facets\n");
}

/* A node's JSON around the one mesh may carry a transform: "\"scale\":[2,2,2]," or "". Without it no mesh is placed. */
static inline void sample_glb(byte_list *out, const char *transform) {
    char json[1200];
    int length = snprintf(
        json, sizeof json,
        "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],"
        "\"nodes\":[{\"name\":\"root\",%s\"mesh\":0}],"
        "\"materials\":[{\"name\":\"green\",\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.25,0.5,0.125,1]}}],"
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1,\"material\":0}]}],"
        "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\",\"min\":[0,0,0],"
        "\"max\":[1,1,1]},{\"bufferView\":1,\"componentType\":5123,\"count\":12,\"type\":\"SCALAR\"}],"
        "\"bufferViews\":[{\"buffer\":0,\"byteOffset\":0,\"byteLength\":48},"
        "{\"buffer\":0,\"byteOffset\":48,\"byteLength\":24}],\"buffers\":[{\"byteLength\":72}]}",
        transform);
    assert_in_range(length, 1, (int)sizeof json - 4);
    while (length % 4)
        json[length++] = ' ';
    put_text(out, "glTF");
    put_u32(out, 2, false);
    put_u32(out, (uint32_t)(12 + 8 + length + 8 + 72), false);
    put_u32(out, (uint32_t)length, false);
    put_text(out, "JSON");
    put(out, json, (size_t)length);
    put_u32(out, 72, false);
    put(out, "BIN", 4);
    for (int i = 0; i < 12; i++)
        put_f32(out, tetrahedron_positions[i / 3][i % 3], false);
    for (int i = 0; i < 12; i++)
        put_u16(out, (uint16_t)tetrahedron_indices[i / 3][i % 3], false);
}

#endif
