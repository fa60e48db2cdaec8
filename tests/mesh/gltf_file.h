/* Small GLBs put together by tests: each array is an accessor with a view of its own. */
#ifndef KDR_TESTS_MESH_GLTF_FILE_H
#define KDR_TESTS_MESH_GLTF_FILE_H

#include "mesh/gltf_animation.h"
#include "mesh/gltf_check.h"
#include "mesh/reading.h"

typedef struct gltf_file {
    byte_list binary;
    char accessors[1600], views[1200];
    int count; /* accessors and views */
} gltf_file;

/* Appends `count` elements of `width` numbers; gives the accessor's number. */
static inline int add_array(gltf_file *file, int component, size_t width, size_t count, const float *numbers) {
    static const char *const types[] = {[1] = "SCALAR", [3] = "VEC3", [4] = "VEC4", [16] = "MAT4"};
    size_t begin = file->binary.length, used = strlen(file->accessors), used_views = strlen(file->views);
    for (size_t i = 0; i < width * count; i++) {
        if (component == KDR_GLTF_FLOAT)
            put_f32(&file->binary, numbers[i], false);
        else if (component == KDR_GLTF_USHORT)
            put_u16(&file->binary, (uint16_t)numbers[i], false);
        else
            put_u8(&file->binary, (uint8_t)numbers[i]);
    }
    int length = snprintf(file->accessors + used, sizeof file->accessors - used,
                          "%s{\"bufferView\":%d,\"componentType\":%d,\"count\":%zu,\"type\":\"%s\"}", used ? "," : "",
                          file->count, component, count, types[width]);
    assert_in_range(length, 1, sizeof file->accessors - used - 1);
    length = snprintf(file->views + used_views, sizeof file->views - used_views,
                      "%s{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%zu}", used_views ? "," : "", begin,
                      file->binary.length - begin);
    assert_in_range(length, 1, sizeof file->views - used_views - 1);
    while (file->binary.length % 4)
        put_u8(&file->binary, 0);
    return file->count++;
}

static inline int add_floats(gltf_file *file, size_t width, size_t count, const float *numbers) {
    return add_array(file, KDR_GLTF_FLOAT, width, count, numbers);
}

/* The whole file; `rest` holds nodes, meshes and what else there is. */
static inline void assemble(const gltf_file *file, const char *rest, byte_list *out) {
    char json[4000];
    int length = snprintf(json, sizeof json,
                          "{\"asset\":{\"version\":\"2.0\"},%s,\"accessors\":[%s],\"bufferViews\":[%s],"
                          "\"buffers\":[{\"byteLength\":%zu}]}",
                          rest, file->accessors, file->views, file->binary.length);
    assert_in_range(length, 1, sizeof json - 4);
    while (length % 4)
        json[length++] = ' ';
    out->length = 0;
    put_text(out, "glTF");
    put_u32(out, 2, false);
    put_u32(out, (uint32_t)(28 + (size_t)length + file->binary.length), false);
    put_u32(out, (uint32_t)length, false);
    put_text(out, "JSON");
    put(out, json, (size_t)length);
    put_u32(out, (uint32_t)file->binary.length, false);
    put(out, "BIN", 4);
    put(out, file->binary.bytes, file->binary.length);
}

static inline kdr_status try_animation(const char *name, const void *bytes, size_t length, kdr_animation_source *out) {
    unsigned char *copy = malloc(length ? length : 1); // exact: a read past the end is seen by the sanitizers
    assert_non_null(copy);
    if (length)
        memcpy(copy, bytes, length);
    heard = (told){0};
    kdr_source source = {name, copy, length, false, &hearing};
    kdr_status status = kdr_gltf_animation_open_source(&source, out);
    free(copy);
    return status;
}

static inline kdr_animation_source open_animation(const byte_list *bytes) {
    kdr_animation_source source;
    if (try_animation("t.glb", bytes->bytes, bytes->length, &source) != KDR_OK)
        fail_msg("%s", heard.error);
    return source;
}

static inline kdr_animation_source open_file(const gltf_file *file, const char *rest) {
    byte_list bytes;
    assemble(file, rest, &bytes);
    return open_animation(&bytes);
}

static inline void sample_at(const kdr_animation_source *source, double seconds, kdr_mesh **mesh) {
    if (source->sample(source->state, seconds, &hearing, mesh) != KDR_OK)
        fail_msg("%s", heard.error);
    check_promise(*mesh);
}

/* One vertex at a time, within rounding. */
static inline void assert_vertex(const kdr_animation_source *source, double seconds, size_t vertex, float x, float y,
                                 float z, kdr_mesh **mesh) {
    sample_at(source, seconds, mesh);
    const float wanted[3] = {x, y, z}, *found = (*mesh)->positions + 3 * vertex;
    for (int axis = 0; axis < 3; axis++)
        if (!(fabsf(found[axis] - wanted[axis]) <= 1e-5f))
            fail_msg("vertex %zu at %g s: expected %g %g %g, found %g %g %g", vertex, seconds, (double)x, (double)y,
                     (double)z, (double)found[0], (double)found[1], (double)found[2]);
}

static inline void close_animation(kdr_animation_source *source, kdr_mesh *mesh) {
    source->destroy(source->state);
    close_mesh(mesh);
}

/* A file is refused with one sentence that holds `part`. */
static inline void assert_animation_refused(const gltf_file *file, const char *rest, const char *part) {
    byte_list bytes;
    assemble(file, rest, &bytes);
    kdr_animation_source source;
    kdr_status status = try_animation("t.glb", bytes.bytes, bytes.length, &source);
    if (status == KDR_OK || !strstr(heard.error, part))
        fail_msg("expected '%s', got %s: '%s'", part, kdr_status_text(status), heard.error);
    assert_null(source.state);
    assert_int_equal(heard.errors, 1);
    assert_memory_equal(heard.error, "t.glb", 5);
    assert_int_equal(kdr_render_bytes(), 0);
}

static const float triangle_positions[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};

#define TRIANGLE_MESH "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]"

/* A bent and morphed sample of everything: two joints, two targets, three shapes of tracks. */
static inline void sample_animation(byte_list *out) {
    static const float joints[12] = {0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0};
    static const float weights[12] = {255, 0, 0, 0, 255, 0, 0, 0, 128, 128, 0, 0};
    static const float binds[32] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0,  0, 0, 1,
                                    1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1};
    static const float normals[9] = {0, 0, 1, 0, 0, 1, 0, 0, 1}, deltas[9] = {0, 0, 1, 0, 0, 2, 0, 0, 3};
    static const float times[2] = {0, 2}, turns[8] = {0, 0, 0, 1, 0, 0, 0.70710678f, 0.70710678f};
    static const float moves[18] = {0, 0, 0, 0, 0, 0, 1, 0, 0, 3, 0, 0, 4, 0, 0, 0, 0, 0};
    static const float shares[4] = {0, 0, 1, 0.5f};
    gltf_file file = {0};
    add_floats(&file, 3, 3, triangle_positions);
    add_floats(&file, 3, 3, normals);
    add_array(&file, KDR_GLTF_UBYTE, 4, 3, joints);
    add_array(&file, KDR_GLTF_UBYTE, 4, 3, weights);
    add_floats(&file, 16, 2, binds);
    add_floats(&file, 3, 3, deltas);
    add_floats(&file, 1, 2, times);
    add_floats(&file, 4, 2, turns);
    add_floats(&file, 3, 6, moves);
    add_floats(&file, 1, 4, shares);
    assemble(&file,
             "\"scene\":0,\"scenes\":[{\"nodes\":[0,1]}],\"nodes\":[{\"mesh\":0,\"skin\":0,\"translation\":[5,5,5]},"
             "{\"children\":[2]},{\"translation\":[1,0,0]}],\"skins\":[{\"joints\":[1,2],\"inverseBindMatrices\":4}],"
             "\"meshes\":[{\"weights\":[0,0],\"primitives\":[{\"attributes\":{\"POSITION\":0,\"NORMAL\":1,"
             "\"JOINTS_0\":2,\"WEIGHTS_0\":3},\"targets\":[{\"POSITION\":5},{\"POSITION\":5,\"NORMAL\":5}]}]}],"
             "\"animations\":[{\"samplers\":[{\"input\":6,\"output\":7},{\"input\":6,\"output\":8,"
             "\"interpolation\":\"CUBICSPLINE\"},{\"input\":6,\"output\":9,\"interpolation\":\"STEP\"}],\"channels\":["
             "{\"sampler\":0,\"target\":{\"node\":2,\"path\":\"rotation\"}},"
             "{\"sampler\":1,\"target\":{\"node\":1,\"path\":\"translation\"}},"
             "{\"sampler\":2,\"target\":{\"node\":0,\"path\":\"weights\"}}]}]",
             out);
}

#endif
