/* glTF and all formats that kdray does not read itself, through assimp.
 *
 * assimp gives a tree of nodes with transforms and meshes; a mesh here is one list of triangles in the world. Its
 * results are not trusted: every index is compared with its count, matrices and vertices may hold NaN. Skinned meshes
 * come as they are stored, in their bind pose. Materials are taken when a mesh uses them, so that the default one that
 * assimp adds stays out. */
#include "mesh/source.h"

#include <string.h>

#ifdef KDR_WITH_ASSIMP

#include "mesh/assimp_files.h"
#include "mesh/glb_frame.h"
#include "mesh/gltf_check.h"
#include "mesh/mesh.h"
#include "mesh/mesh_memory.h"

#include <assimp/cimport.h>
#include <assimp/config.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>

#define MAX_ENDING 15

/* The name's ending with its dot, `.gz` put aside; false when there is none. */
static bool find_ending(const kdr_source *source, char ending[MAX_ENDING + 1]) {
    size_t length = strlen(source->name);
    if (length > 3 && strcmp(source->name + length - 3, ".gz") == 0)
        length -= 3;
    size_t start = length;
    while (start > 0 && source->name[start - 1] != '.' && source->name[start - 1] != '/')
        start--;
    if (start == 0 || source->name[start - 1] != '.' || length - start + 1 > MAX_ENDING || length == start)
        return false;
    memcpy(ending, source->name + start - 1, length - start + 1);
    ending[length - start + 1] = '\0';
    return true;
}

bool kdr_read_assimp_is_built(void) { return true; }

bool kdr_read_assimp_knows(const kdr_source *source) {
    char ending[MAX_ENDING + 1];
    return find_ending(source, ending) && aiIsExtensionSupported(ending);
}

/* A scene on its way into a mesh. */
typedef struct import {
    const kdr_source *source;
    const struct aiScene *scene;
    kdr_mesh *mesh;
    kdr_buffer stack;           /* placed_node */
    uint32_t *material_numbers; /* of assimp's materials, KDR_INVALID_ID until one is used */
    bool has_normals;
} import;

/* A node whose turn is still to come, and the transform of its parent. */
typedef struct placed_node {
    const struct aiNode *node;
    float parent[12]; /* 3 rows of 4; the fourth row is 0, 0, 0, 1 */
} placed_node;

static void multiply(const float a[12], const struct aiMatrix4x4 *m, float out[12]) {
    const float b[16] = {m->a1, m->a2, m->a3, m->a4, m->b1, m->b2, m->b3, m->b4,
                         m->c1, m->c2, m->c3, m->c4, 0,     0,     0,     1};
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 4; column++)
            out[4 * row + column] = a[4 * row] * b[column] + a[4 * row + 1] * b[4 + column] +
                                    a[4 * row + 2] * b[8 + column] + a[4 * row + 3] * b[12 + column];
}

/* The matrix of normals: cofactors, which are the inverse transposed times the determinant. Gives that determinant. */
static float cofactors(const float m[12], float out[9]) {
    for (int row = 0; row < 3; row++) {
        const float *r = m + 4 * ((row + 1) % 3), *s = m + 4 * ((row + 2) % 3);
        for (int column = 0; column < 3; column++) {
            int u = (column + 1) % 3, v = (column + 2) % 3;
            out[3 * row + column] = r[u] * s[v] - r[v] * s[u];
        }
    }
    return m[0] * out[0] + m[1] * out[1] + m[2] * out[2];
}

static void place_vertices(const import *in, const struct aiMesh *from, const float transform[12], size_t first) {
    float normal_matrix[9];
    float sign = cofactors(transform, normal_matrix) < 0 ? -1.0f : 1.0f;
    for (size_t i = 0; i < from->mNumVertices; i++) {
        const struct aiVector3D *p = &from->mVertices[i];
        float *to = in->mesh->positions + 3 * (first + i);
        for (int row = 0; row < 3; row++) {
            const float *m = transform + 4 * row;
            to[row] = m[0] * p->x + m[1] * p->y + m[2] * p->z + m[3];
        }
    }
    for (size_t i = 0; i < from->mNumVertices && in->has_normals; i++) {
        float *to = in->mesh->normals + 3 * (first + i);
        if (!from->mNormals) {
            to[0] = to[1] = to[2] = NAN; // to be made from the triangles
            continue;
        }
        const struct aiVector3D *n = &from->mNormals[i];
        for (int row = 0; row < 3; row++) {
            const float *m = normal_matrix + 3 * row;
            to[row] = sign * (m[0] * n->x + m[1] * n->y + m[2] * n->z);
        }
    }
}

/* Appends the triangles; points and lines are no part of a mesh. A mirroring transform turns them round again. */
static kdr_status place_triangles(const import *in, const struct aiMesh *from, const float transform[12], size_t first,
                                  uint32_t material) {
    kdr_mesh *mesh = in->mesh;
    float unused[9];
    bool is_mirrored = cofactors(transform, unused) < 0;
    size_t triangle = mesh->triangle_count;
    kdr_status status = kdr_mesh_reserve_triangles(mesh, triangle + from->mNumFaces);
    if (status != KDR_OK)
        return kdr_source_fail_status(in->source, status);
    for (size_t i = 0; i < from->mNumFaces; i++) {
        const struct aiFace *face = &from->mFaces[i];
        if (face->mNumIndices != 3)
            continue;
        for (int corner = 0; corner < 3; corner++) {
            unsigned number = face->mIndices[is_mirrored ? 2 - corner : corner];
            if (number >= from->mNumVertices)
                return kdr_source_fail(in->source, KDR_ERROR_INVALID_DATA,
                                       "mesh '%.100s', face %zu: expected a vertex number below %u, found %u",
                                       from->mName.data, i, from->mNumVertices, number);
            mesh->indices[3 * triangle + (size_t)corner] = (uint32_t)first + number;
        }
        mesh->triangle_materials[triangle++] = material;
    }
    mesh->triangle_count = triangle;
    return KDR_OK;
}

static kdr_status find_material(import *in, unsigned number, uint32_t *out) {
    if (number >= in->scene->mNumMaterials)
        return kdr_source_fail(in->source, KDR_ERROR_INVALID_DATA, "expected a material number below %u, found %u",
                               in->scene->mNumMaterials, number);
    kdr_status status = KDR_OK;
    if (in->material_numbers[number] == KDR_INVALID_ID) {
        const struct aiMaterial *material = in->scene->mMaterials[number];
        struct aiString name = {0};
        struct aiColor4D color;
        float diffuse[3] = {0.8f, 0.8f, 0.8f};
        if (aiGetMaterialString(material, AI_MATKEY_NAME, &name) != aiReturn_SUCCESS)
            name.length = 0;
        if (aiGetMaterialColor(material, AI_MATKEY_BASE_COLOR, &color) == aiReturn_SUCCESS ||
            aiGetMaterialColor(material, AI_MATKEY_COLOR_DIFFUSE, &color) == aiReturn_SUCCESS) {
            const float rgb[3] = {color.r, color.g, color.b};
            for (int i = 0; i < 3; i++)
                if (isfinite(rgb[i]))
                    diffuse[i] = fminf(fmaxf(rgb[i], 0), 1);
        }
        status = kdr_mesh_add_material(in->mesh, name.data, name.length, diffuse, &in->material_numbers[number]);
    }
    *out = in->material_numbers[number];
    return kdr_source_fail_status(in->source, status);
}

static kdr_status place_mesh(import *in, unsigned number, const float transform[12]) {
    if (number >= in->scene->mNumMeshes)
        return kdr_source_fail(in->source, KDR_ERROR_INVALID_DATA, "expected a mesh number below %u, found %u",
                               in->scene->mNumMeshes, number);
    const struct aiMesh *from = in->scene->mMeshes[number];
    if (from->mNumVertices == 0 || !from->mVertices || !(from->mPrimitiveTypes & aiPrimitiveType_TRIANGLE))
        return KDR_OK;
    size_t first = in->mesh->vertex_count;
    kdr_status status = kdr_mesh_resize_vertices(in->mesh, first + from->mNumVertices);
    if (status != KDR_OK)
        return kdr_source_fail_status(in->source, status);
    place_vertices(in, from, transform, first);
    uint32_t material = 0;
    status = find_material(in, from->mMaterialIndex, &material);
    return status == KDR_OK ? place_triangles(in, from, transform, first, material) : status;
}

/* Walks the nodes from a stack of our own: their depth is the file's to choose. */
static kdr_status place_nodes(import *in) {
    size_t count = 0;
    if (!kdr_mesh_buffer_grow(&in->stack, 0, sizeof(placed_node)))
        return kdr_source_fail_status(in->source, KDR_ERROR_OUT_OF_MEMORY);
    placed_node *stack = in->stack.memory;
    stack[count++] = (placed_node){in->scene->mRootNode, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}};
    while (count) {
        placed_node placed = stack[--count];
        float transform[12];
        multiply(placed.parent, &placed.node->mTransformation, transform);
        for (unsigned i = 0; i < placed.node->mNumMeshes; i++) {
            kdr_status status = place_mesh(in, placed.node->mMeshes[i], transform);
            if (status != KDR_OK)
                return status;
        }
        size_t children = placed.node->mNumChildren;
        if (!kdr_mesh_buffer_grow(&in->stack, count * sizeof *stack, (count + children) * sizeof *stack))
            return kdr_source_fail_status(in->source, KDR_ERROR_OUT_OF_MEMORY);
        stack = in->stack.memory;
        for (size_t i = children; i-- > 0;) {
            stack[count].node = placed.node->mChildren[i];
            memcpy(stack[count++].parent, transform, sizeof transform);
        }
    }
    return KDR_OK;
}

/* Formats without materials get assimp's default one: a mesh that knows no other has none. */
static void drop_default_material(kdr_mesh *mesh) {
    if (mesh->material_count == 1 && strcmp(mesh->materials[0].name, AI_DEFAULT_MATERIAL_NAME) == 0)
        kdr_mesh_drop_materials(mesh);
}

static kdr_status import_scene(const kdr_source *source, const struct aiScene *scene, const char *format,
                               kdr_mesh **out) {
    if (!scene->mRootNode)
        return kdr_source_fail(source, KDR_ERROR_INVALID_DATA, "expected a scene with a root node");
import in = {.source = source, .scene = scene };
    for (unsigned i = 0; i < scene->mNumMeshes; i++)
        in.has_normals |= scene->mMeshes[i]->mNormals != NULL;
    kdr_status status =
        kdr_mesh_create(0, 0, (in.has_normals ? KDR_MESH_NORMALS : 0) | KDR_MESH_MATERIALS, format, &in.mesh);
    if (status != KDR_OK)
        return kdr_source_fail_status(source, status);

    size_t material_bytes = scene->mNumMaterials * sizeof(uint32_t);
    if (material_bytes) {
        in.material_numbers = kdr_alloc_get(kdr_mesh_memory(), material_bytes, KDR_MESH_ALIGNMENT);
        if (in.material_numbers)
            memset(in.material_numbers, 0xff, material_bytes);
        else
            status = kdr_source_fail_status(source, KDR_ERROR_OUT_OF_MEMORY);
    }
    if (status == KDR_OK)
        status = place_nodes(&in);
    kdr_alloc_release(kdr_mesh_memory(), in.material_numbers, material_bytes);
    kdr_buffer_release(kdr_mesh_memory(), &in.stack);
    if (status != KDR_OK) {
        kdr_mesh_destroy(in.mesh);
        return status;
    }
    drop_default_material(in.mesh);
    *out = in.mesh;
    return KDR_OK;
}

/* glTF is checked through and through. Where it does not even look like glTF, assimp would try all of its formats. */
static kdr_status check_content(const kdr_source *source) {
    kdr_glb_frame frame = {.json_end = source->length};
    if (kdr_source_is_glb(source)) {
        kdr_status status = kdr_glb_read_frame(source, &frame);
        return status == KDR_OK ? kdr_gltf_check(source, &frame) : status;
    }
    if (kdr_source_has_ending(source, "glb"))
        return kdr_source_fail_byte(source, 0, "expected 'glTF' as the first four bytes of a GLB");
    return kdr_source_has_ending(source, "gltf") ? kdr_gltf_check(source, &frame) : KDR_OK;
}

/* keyframe: of an MD2 file, which one to show. */
static const struct aiScene *import_file(const char *name, struct aiFileIO *io, uint32_t keyframe) {
    struct aiPropertyStore *properties = aiCreatePropertyStore();
    aiSetImportPropertyInteger(properties, AI_CONFIG_IMPORT_MD2_KEYFRAME, (int)keyframe);
    const struct aiScene *scene =
        aiImportFileExWithProperties(name, aiProcess_Triangulate | aiProcess_SortByPType, io, properties);
    aiReleasePropertyStore(properties);
    return scene;
}

kdr_status kdr_read_assimp(const kdr_source *source, kdr_mesh **out) {
    return kdr_read_assimp_keyframe(source, 0, out);
}

kdr_status kdr_read_assimp_keyframe(const kdr_source *source, uint32_t keyframe, kdr_mesh **out) {
    *out = NULL;
    char ending[MAX_ENDING + 1], name[PATH_MAX], format[32];
    kdr_status status = check_content(source);
    if (status != KDR_OK)
        return status;
    if (kdr_source_is_glb(source) || !find_ending(source, ending))
        snprintf(ending, sizeof ending, ".glb");
    size_t folder = 0;
    for (size_t i = 0; source->name[i]; i++)
        folder = source->name[i] == '/' ? i + 1 : folder;
    // assimp chooses by the ending, which the file's own name need not have; the folder is where siblings lie.
    if (folder + sizeof ending + 8 > sizeof name)
        return kdr_source_fail(source, KDR_ERROR_UNSUPPORTED, "expected a shorter path");
    snprintf(name, sizeof name, "%.*smesh%s", (int)folder, source->name, ending);
    snprintf(format, sizeof format, "%s", ending + 1);
    for (char *c = format; *c; c++)
        *c = (char)(*c >= 'a' && *c <= 'z' ? *c - 32 : *c);

    kdr_assimp_files files = {source, name};
    struct aiFileIO io;
    kdr_assimp_files_begin(&files, &io);
    const struct aiScene *scene = import_file(name, &io, keyframe);
    if (!scene)
        return kdr_source_fail(source, KDR_ERROR_INVALID_DATA, "expected a file that assimp reads: %s",
                               aiGetErrorString());
    status = import_scene(source, scene, format, out);
    aiReleaseImport(scene);
    return status;
}

#else

bool kdr_read_assimp_is_built(void) { return false; }

bool kdr_read_assimp_knows(const kdr_source *source) {
    (void)source;
    return false;
}

kdr_status kdr_read_assimp(const kdr_source *source, kdr_mesh **out) {
    *out = NULL;
    return kdr_source_fail(source, KDR_ERROR_UNSUPPORTED, "is glTF, which this build of kdray does not read");
}

kdr_status kdr_read_assimp_keyframe(const kdr_source *source, uint32_t keyframe, kdr_mesh **out) {
    (void)keyframe;
    return kdr_read_assimp(source, out);
}

#endif
