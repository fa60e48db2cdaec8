/* STL files, binary and ascii.
 *
 * Source: 3D Systems, "StereoLithography Interface Specification", 1988. Binary: 80 bytes of text, a count, then 50
 * bytes a triangle: normal, three vertices, two bytes of attributes. Ascii: facets of three vertices between `solid`
 * and `endsolid`. The normals are those of the triangles themselves and are not kept. Binary files that begin with
 * "solid" exist: the count and the length of the file decide, and only then the words.
 *
 * Vertices that are equal bit for bit become one: the file repeats each about six times. */
#include "mesh/merge.h"
#include "mesh/mesh.h"
#include "mesh/mesh_memory.h"
#include "mesh/source.h"
#include "mesh/text.h"

#include <string.h>

#define HEADER_BYTES 84
#define COUNT_BYTE 80
#define FACET_BYTES 50
#define NORMAL_BYTES 12

static uint32_t little_endian_word(const unsigned char *p) {
    return (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

/* The length is exactly what the count asks for. */
static bool is_exactly_binary(const kdr_source *source) {
    return source->length >= HEADER_BYTES &&
           source->length - HEADER_BYTES == (uint64_t)FACET_BYTES * little_endian_word(source->bytes + COUNT_BYTE);
}

/* Begins with "solid" and goes on with a name and "facet" or "endsolid", without a byte that no text holds. */
static bool is_ascii(const kdr_source *source) {
    const char *start = (const char *)source->bytes;
    kdr_text text = {start, start + source->length, 1, false};
    if (!kdr_text_skip_blank_lines(&text) || !kdr_word_is_any_case(kdr_text_take_word(&text), "solid"))
        return false;
    kdr_word name = kdr_text_take_rest(&text);
    if (memchr(name.start, '\0', name.length))
        return false;
    if (!kdr_text_skip_blank_lines(&text))
        return true;
    kdr_word word = kdr_text_take_word(&text);
    return kdr_word_is_any_case(word, "facet") || kdr_word_is_any_case(word, "endsolid");
}

bool kdr_source_is_stl(const kdr_source *source) { return is_exactly_binary(source) || is_ascii(source); }

static kdr_status read_binary(const kdr_source *source, kdr_mesh **out) {
    size_t length = source->length;
    if (length < HEADER_BYTES)
        return kdr_source_fail_byte(source, length, "expected the %d bytes that begin a binary STL, or 'solid'",
                                    HEADER_BYTES);
    size_t count = little_endian_word(source->bytes + COUNT_BYTE), room = (length - HEADER_BYTES) / FACET_BYTES;
    if (count > room)
        return kdr_source_fail_byte(source, COUNT_BYTE,
                                    "expected at most %zu triangles of %d bytes in a file of %zu bytes, found %zu",
                                    room, FACET_BYTES, length, count);
    if (length - HEADER_BYTES > count * FACET_BYTES)
        kdr_source_warn(source, "%zu bytes after the last triangle are passed over",
                        length - HEADER_BYTES - count * FACET_BYTES);
    kdr_status status =
        count <= KDR_MESH_LIMIT / 3 ? kdr_mesh_create(3 * count, count, 0, "STL binary", out) : KDR_ERROR_LIMIT;
    if (status != KDR_OK)
        return kdr_source_fail_status(source, status);

    const unsigned char *p = source->bytes + HEADER_BYTES + NORMAL_BYTES;
    float *positions = (*out)->positions;
    for (size_t i = 0; i < count; i++, p += FACET_BYTES) {
        for (size_t j = 0; j < 9; j++) {
            uint32_t bits = little_endian_word(p + 4 * j);
            memcpy(positions + 9 * i + j, &bits, sizeof bits);
        }
    }
    return KDR_OK;
}

static kdr_status expect_word(const kdr_source *source, kdr_text *text, const char *word) {
    if (kdr_text_skip_blank_lines(text)) {
        kdr_word found = kdr_text_take_word(text);
        if (kdr_word_is_any_case(found, word))
            return KDR_OK;
        text->p = found.start;
    }
    char found[KDR_TEXT_FOUND_BYTES];
    return kdr_source_fail_line(source, text->line, "expected '%s', found %s", word, kdr_text_found(text, found));
}

static kdr_status read_vertex(const kdr_source *source, kdr_text *text, kdr_mesh *mesh) {
    size_t vertex = mesh->vertex_count;
    kdr_status status = expect_word(source, text, "vertex");
    if (status != KDR_OK)
        return status;
    status = kdr_mesh_resize_vertices(mesh, vertex + 1);
    if (status != KDR_OK)
        return kdr_source_fail_status(source, status);
    for (size_t axis = 0; axis < 3; axis++) {
        double value;
        if (!kdr_text_take_double(text, &value)) {
            char found[KDR_TEXT_FOUND_BYTES];
            return kdr_source_fail_line(source, text->line, "expected three numbers of a vertex, found %s",
                                        kdr_text_found(text, found));
        }
        mesh->positions[3 * vertex + axis] = (float)value;
    }
    return KDR_OK;
}

/* A facet after its first word. */
static kdr_status read_facet(const kdr_source *source, kdr_text *text, kdr_mesh *mesh) {
    kdr_text_skip_rest(text);
    kdr_status status = expect_word(source, text, "outer");
    if (status == KDR_OK)
        status = expect_word(source, text, "loop");
    for (int corner = 0; corner < 3 && status == KDR_OK; corner++)
        status = read_vertex(source, text, mesh);
    if (status == KDR_OK)
        status = expect_word(source, text, "endloop");
    if (status == KDR_OK)
        status = expect_word(source, text, "endfacet");
    return status;
}

/* One solid after another; a file has at least one. */
static kdr_status read_ascii(const kdr_source *source, kdr_mesh **out) {
    const char *start = (const char *)source->bytes;
    kdr_text text = {start, start + source->length, 1, false};
    kdr_status status = kdr_mesh_create(0, 0, 0, "STL ascii", out);
    if (status != KDR_OK)
        return kdr_source_fail_status(source, status);
    do {
        status = expect_word(source, &text, "solid");
        kdr_text_skip_rest(&text);
        bool is_open = true;
        while (status == KDR_OK && is_open) {
            kdr_text ahead = text;
            is_open = kdr_text_skip_blank_lines(&ahead) && kdr_word_is_any_case(kdr_text_take_word(&ahead), "facet");
            if (is_open) {
                text = ahead;
                status = read_facet(source, &text, *out);
            }
        }
        if (status == KDR_OK)
            status = expect_word(source, &text, "endsolid");
        kdr_text_skip_rest(&text);
    } while (status == KDR_OK && kdr_text_skip_blank_lines(&text));
    if (status == KDR_OK)
        status = kdr_source_fail_status(source, kdr_mesh_resize_triangles(*out, (*out)->vertex_count / 3));
    return status;
}

/* Numbers equal vertices alike, in the order of the file, and moves them together. */
static kdr_status merge_vertices(kdr_mesh *mesh) {
    size_t count = mesh->vertex_count, unique_count;
    if (count == 0)
        return KDR_OK;
    kdr_status status =
        kdr_merge_keys((const uint32_t *)(const void *)mesh->positions, 3, count, mesh->indices, &unique_count);
    if (status != KDR_OK)
        return status;
    uint32_t next = 0;
    for (size_t i = 0; i < count; i++) {
        if (mesh->indices[i] != next)
            continue;
        memmove(mesh->positions + 3 * (size_t)next, mesh->positions + 3 * i, 3 * sizeof(float));
        next++;
    }
    mesh->vertex_count = unique_count;
    return KDR_OK;
}

kdr_status kdr_read_stl(const kdr_source *source, kdr_mesh **out) {
    *out = NULL;
    bool ascii = !is_exactly_binary(source) && is_ascii(source);
    kdr_status status = ascii ? read_ascii(source, out) : read_binary(source, out);
    if (status == KDR_OK)
        status = kdr_source_fail_status(source, merge_vertices(*out));
    if (status != KDR_OK) {
        kdr_mesh_destroy(*out);
        *out = NULL;
    }
    return status;
}
