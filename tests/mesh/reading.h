/* Reading meshes from memory and temporary files in tests, with the sentences that were told. */
#ifndef KDR_TESTS_MESH_READING_H
#define KDR_TESTS_MESH_READING_H

#include "mesh/mesh_memory.h"
#include "mesh/source.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

/* What the last read told. */
typedef struct told {
    int errors, warnings;
    char error[1200], warning[1200]; /* the last of each */
} told;

static told heard;

static inline void hear(kdr_log_level level, const char *message, void *user) {
    told *to = user;
    if (level == KDR_LOG_ERROR) {
        to->errors++;
        snprintf(to->error, sizeof to->error, "%s", message);
    } else {
        to->warnings++;
        snprintf(to->warning, sizeof to->warning, "%s", message);
    }
    assert_null(strchr(message, '\n'));
}

static const kdr_logger hearing = {hear, &heard};

static inline kdr_status try_bytes(const char *name, const void *bytes, size_t length, kdr_mesh **out) {
    // An exact copy on the heap: a read past the end is seen by the sanitizers.
    unsigned char *copy = malloc(length ? length : 1);
    assert_non_null(copy);
    if (length)
        memcpy(copy, bytes, length);
    heard = (told){0};
    kdr_source source = {name, copy, length, false, &hearing};
    kdr_status status = kdr_mesh_read_source(&source, out);
    free(copy);
    return status;
}

static inline kdr_mesh *read_bytes(const char *name, const void *bytes, size_t length) {
    kdr_mesh *mesh;
    kdr_status status = try_bytes(name, bytes, length, &mesh);
    if (status != KDR_OK)
        fail_msg("%s", heard.error);
    return mesh;
}

static inline kdr_mesh *read_text(const char *name, const char *text) { return read_bytes(name, text, strlen(text)); }

/* The bytes are refused with exactly one sentence, which begins with the name and holds `part`. */
static inline void assert_refused(const char *name, const void *bytes, size_t length, kdr_status wanted,
                                  const char *part) {
    kdr_mesh *mesh;
    kdr_status status = try_bytes(name, bytes, length, &mesh);
    assert_null(mesh);
    if (status != wanted || !strstr(heard.error, part))
        fail_msg("expected %s: '%s', got %s: '%s'", kdr_status_text(wanted), part, kdr_status_text(status),
                 heard.error);
    assert_int_equal(heard.errors, 1);
    assert_memory_equal(heard.error, name, strlen(name));
    assert_int_equal(kdr_render_bytes(), 0);
}

static inline void assert_text_refused(const char *name, const char *text, const char *part) {
    assert_refused(name, text, strlen(text), KDR_ERROR_INVALID_DATA, part);
}

/* The public promise of kdr_mesh. */
static inline void check_promise(const kdr_mesh *mesh) {
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++)
        assert_true(isfinite(mesh->positions[i]));
    for (size_t i = 0; i < 3 * mesh->triangle_count; i++)
        assert_true(mesh->indices[i] < mesh->vertex_count);
    for (size_t i = 0; mesh->normals && i < mesh->vertex_count; i++) {
        const float *n = mesh->normals + 3 * i;
        assert_true(fabsf(sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) - 1) < 1e-5f);
    }
    for (size_t i = 0; mesh->triangle_materials && i < mesh->triangle_count; i++)
        assert_true(mesh->triangle_materials[i] < mesh->material_count);
    for (size_t i = 0; i < mesh->material_count; i++)
        assert_non_null(mesh->materials[i].name);
}

static inline void assert_positions(const kdr_mesh *mesh, size_t count, const float (*wanted)[3]) {
    assert_int_equal(mesh->vertex_count, count);
    for (size_t i = 0; i < 3 * count; i++)
        if (mesh->positions[i] != wanted[i / 3][i % 3])
            fail_msg("vertex %zu: expected %g, got %g", i / 3, (double)wanted[i / 3][i % 3],
                     (double)mesh->positions[i]);
}

static inline void assert_indices(const kdr_mesh *mesh, size_t count, const uint32_t (*wanted)[3]) {
    assert_int_equal(mesh->triangle_count, count);
    for (size_t i = 0; i < 3 * count; i++)
        if (mesh->indices[i] != wanted[i / 3][i % 3])
            fail_msg("triangle %zu: expected %u, got %u", i / 3, wanted[i / 3][i % 3], mesh->indices[i]);
}

/* Ends a test of one mesh: the promise held, and all memory given back. */
static inline void close_mesh(kdr_mesh *mesh) {
    check_promise(mesh);
    kdr_mesh_destroy(mesh);
    assert_int_equal(kdr_render_bytes(), 0);
}

/* Bytes put together by a test. */
typedef struct byte_list {
    unsigned char bytes[4096];
    size_t length;
} byte_list;

static inline void put(byte_list *list, const void *bytes, size_t length) {
    assert_true(list->length + length <= sizeof list->bytes);
    memcpy(list->bytes + list->length, bytes, length);
    list->length += length;
}

static inline void put_text(byte_list *list, const char *text) { put(list, text, strlen(text)); }

/* A number's bytes in the order asked for; this machine is little endian or not. */
static inline void put_ordered(byte_list *list, const void *number, size_t size, bool big_endian) {
    unsigned char bytes[8];
    memcpy(bytes, number, size);
    bool swap = big_endian != (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__);
    for (size_t i = 0; swap && i < size / 2; i++) {
        unsigned char kept = bytes[i];
        bytes[i] = bytes[size - 1 - i];
        bytes[size - 1 - i] = kept;
    }
    put(list, bytes, size);
}

static inline void put_f32(byte_list *list, float value, bool big) { put_ordered(list, &value, sizeof value, big); }
static inline void put_f64(byte_list *list, double value, bool big) { put_ordered(list, &value, sizeof value, big); }
static inline void put_u32(byte_list *list, uint32_t value, bool big) { put_ordered(list, &value, sizeof value, big); }
static inline void put_u16(byte_list *list, uint16_t value, bool big) { put_ordered(list, &value, sizeof value, big); }
static inline void put_u8(byte_list *list, uint8_t value) { put(list, &value, 1); }

/* A directory of the test's own. */
static inline void make_folder(char path[64]) {
    snprintf(path, 64, "/tmp/kdr-mesh-test-XXXXXX");
    assert_non_null(mkdtemp(path));
}

static inline void write_file(const char *folder, const char *name, const void *bytes, size_t length, char path[128]) {
    snprintf(path, 128, "%.63s/%.60s", folder, name);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, length, file), length);
    assert_int_equal(fclose(file), 0);
}

#endif
