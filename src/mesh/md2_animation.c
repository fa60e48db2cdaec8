/* MD2: a model is the same triangles for every keyframe, with a position and a normal of every corner anew. assimp
 * reads one keyframe at a time; the two around a moment are kept, and what is shown lies between them. Normals turn
 * with it, made unit length again. */
#include "mesh/md2_animation.h"

#include "mesh/file_bytes.h"
#include "mesh/finish.h"
#include "mesh/mesh.h"
#include "mesh/mesh_memory.h"

#include <limits.h>
#include <math.h>
#include <string.h>

#define KEYFRAMES_A_SECOND 10.0

/* The header: 17 numbers of 32 bits, lowest byte first. */
enum header {
    MAGIC,
    VERSION,
    FRAME_SIZE = 4,
    VERTEX_COUNT = 6,
    FRAME_COUNT = 10,
    FRAME_OFFSET = 14,
    HEADER_NUMBERS = 17
};
#define MAGIC_NUMBER 0x32504449u /* "IDP2" */
#define FRAME_HEAD 40u           /* bytes: scale, translation and name; four more a vertex follow */

typedef struct md2 {
    char path[PATH_MAX];
    kdr_file_bytes file;
    uint32_t count; /* keyframes */
    struct {
        kdr_mesh *mesh; /* NULL: none yet */
        uint32_t number;
    } kept[2]; /* of even and of odd numbers */
} md2;

static void destroy(void *state) {
    md2 *of = state;
    for (int i = 0; i < 2; i++)
        kdr_mesh_destroy(of->kept[i].mesh);
    kdr_file_bytes_release(&of->file);
    kdr_alloc_release(kdr_mesh_memory(), of, sizeof *of);
}

static uint32_t number_at(const unsigned char *bytes, uint32_t i) {
    const unsigned char *b = bytes + 4 * (size_t)i;
    return b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}

/* Checks what this file relies on: that there are as many keyframes as the header says. */
static kdr_status check(const kdr_source *source, uint32_t *count) {
    if (source->length < 4 * HEADER_NUMBERS || number_at(source->bytes, MAGIC) != MAGIC_NUMBER)
        return kdr_source_fail_byte(source, 0, "expected the header of an MD2 file, 68 bytes that begin with IDP2");
    if (number_at(source->bytes, VERSION) != 8)
        return kdr_source_fail_byte(source, 4 * VERSION, "expected version 8, found %u",
                                    number_at(source->bytes, VERSION));
    uint64_t size = number_at(source->bytes, FRAME_SIZE), vertices = number_at(source->bytes, VERTEX_COUNT);
    uint64_t frames = number_at(source->bytes, FRAME_COUNT), begin = number_at(source->bytes, FRAME_OFFSET);
    if (size < FRAME_HEAD + 4 * vertices)
        return kdr_source_fail_byte(source, 4 * FRAME_SIZE, "expected frames of at least %llu bytes, found %llu",
                                    (unsigned long long)(FRAME_HEAD + 4 * vertices), (unsigned long long)size);
    if (frames == 0 || begin > source->length || frames > (source->length - begin) / size)
        return kdr_source_fail_byte(source, 4 * FRAME_COUNT,
                                    "expected at least 1 frame, and no more than the file has bytes for, found %llu",
                                    (unsigned long long)frames);
    *count = (uint32_t)frames;
    return KDR_OK;
}

static kdr_status read_keyframe(const md2 *of, uint32_t number, const kdr_logger *logger, kdr_mesh **out) {
    kdr_source source = {of->path, of->file.bytes, of->file.length, true, logger};
    kdr_status status = kdr_read_assimp_keyframe(&source, number, out);
    if (status == KDR_OK)
        status = kdr_mesh_finish(*out, &source);
    if (status != KDR_OK) {
        kdr_mesh_destroy(*out);
        *out = NULL;
    }
    return status;
}

/* The keyframe's mesh, which stays this object's. */
static kdr_status keyframe(md2 *of, uint32_t number, const kdr_logger *logger, const kdr_mesh **out) {
    kdr_mesh *read;
    if (!of->kept[number % 2].mesh || of->kept[number % 2].number != number) {
        kdr_status status = read_keyframe(of, number, logger, &read);
        if (status != KDR_OK)
            return status;
        kdr_mesh_destroy(of->kept[number % 2].mesh);
        of->kept[number % 2].mesh = read;
        of->kept[number % 2].number = number;
    }
    *out = of->kept[number % 2].mesh;
    return KDR_OK;
}

/* Positions and normals of *mesh become those a part of the way from one keyframe to the next. */
static void blend(const kdr_mesh *from, const kdr_mesh *to, float part, kdr_mesh *mesh) {
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++)
        mesh->positions[i] =
            part > 0 ? from->positions[i] + part * (to->positions[i] - from->positions[i]) : from->positions[i];
    for (size_t v = 0; mesh->normals && v < mesh->vertex_count; v++) {
        float n[3], length = 0;
        for (size_t k = 0; k < 3; k++) {
            n[k] = from->normals[3 * v + k] + part * (to->normals[3 * v + k] - from->normals[3 * v + k]);
            length += n[k] * n[k];
        }
        length = sqrtf(length);
        for (size_t k = 0; k < 3; k++)
            mesh->normals[3 * v + k] = part > 0 && length > 0 ? n[k] / length : from->normals[3 * v + k];
    }
}

static bool alike(const kdr_mesh *a, const kdr_mesh *b) {
    return a->vertex_count == b->vertex_count && a->triangle_count == b->triangle_count && !a->normals == !b->normals;
}

static kdr_status sample(void *state, double seconds, const kdr_logger *logger, kdr_mesh **mesh) {
    md2 *of = state;
    double place = fmin(fmax(seconds * KEYFRAMES_A_SECOND, 0), of->count - 1);
    uint32_t number = (uint32_t)place;
    float part = (float)(place - number);
    const kdr_mesh *from, *to;
    kdr_status status = keyframe(of, number, logger, &from);
    to = from;
    if (status == KDR_OK && part > 0)
        status = keyframe(of, number + 1, logger, &to);
    if (status == KDR_OK && !*mesh)
        status = read_keyframe(of, number, logger, mesh);
    if (status != KDR_OK)
        return status;
    if (!alike(from, to) || !alike(from, *mesh)) {
        kdr_source source = {.name = of->path, .logger = logger};
        return kdr_source_fail(&source, KDR_ERROR_INVALID_DATA,
                               "expected every frame to have the same triangles, found frames that differ about %u",
                               number);
    }
    blend(from, to, part, *mesh);
    return KDR_OK;
}

kdr_status kdr_md2_animation_open(const char *path, const kdr_logger *logger, kdr_animation_source *out) {
    kdr_source source = {.name = path, .logger = logger};
    if (strlen(path) >= PATH_MAX)
        return kdr_source_fail(&source, KDR_ERROR_UNSUPPORTED, "expected a shorter path");
    md2 *of = kdr_alloc_get(kdr_mesh_memory(), sizeof *of, KDR_MESH_ALIGNMENT);
    if (!of)
        return kdr_source_fail_status(&source, KDR_ERROR_OUT_OF_MEMORY);
    memset(of, 0, sizeof *of);
    memcpy(of->path, path, strlen(path) + 1);
    kdr_status status = kdr_file_bytes_open(path, logger, &of->file);
    if (status == KDR_OK) {
        source.bytes = of->file.bytes;
        source.length = of->file.length;
        status = check(&source, &of->count);
    }
    if (status != KDR_OK) {
        destroy(of);
        return status;
    }
    *out = (kdr_animation_source){of, (of->count - 1) / KEYFRAMES_A_SECOND, sample, destroy};
    return KDR_OK;
}
