/* PLY files: the header, then the elements in the file's order; those that are no part of a mesh are passed over.
 *
 * Faces are cut into triangles where the vertices lie, so faces that stand before the vertices are read last. */
#include "mesh/ply_body.h"

#include "mesh/mesh.h"
#include "mesh/mesh_memory.h"

#include <string.h>

bool kdr_source_is_ply(const kdr_source *source) {
    return source->length >= 4 && memcmp(source->bytes, "ply", 3) == 0 &&
           (kdr_is_line_end((char)source->bytes[3]) || kdr_is_blank((char)source->bytes[3]));
}

/* The slots of a vertex: position and normal. */
static const char *const slot_names[6] = {"x", "y", "z", "nx", "ny", "nz"};

typedef struct vertex_layout {
    size_t properties[6]; /* of each slot */
    size_t slot_count;    /* 3, or 6 with normals */
} vertex_layout;

static kdr_status find_layout(const kdr_ply_body *body, const kdr_ply_element *element, vertex_layout *layout) {
    layout->slot_count = 6;
    for (size_t slot = 0; slot < 6; slot++) {
        size_t property = kdr_ply_find_property(element, slot_names[slot]);
        layout->properties[slot] = property;
        bool found = property < element->property_count && !element->properties[property].is_list;
        if (!found && slot < 3)
            return kdr_source_fail_line(body->source, element->line, "expected vertices to have a number '%s'",
                                        slot_names[slot]);
        if (!found)
            layout->slot_count = 3;
    }
    return KDR_OK;
}

static void store_slot(kdr_mesh *mesh, size_t vertex, size_t slot, double value) {
    if (slot < 3)
        mesh->positions[3 * vertex + slot] = (float)value;
    else
        mesh->normals[3 * vertex + slot - 3] = (float)value;
}

/* Rows of one size: a stride and an offset for each slot. */
static void read_fixed_rows(kdr_ply_body *body, const kdr_ply_element *element, const vertex_layout *layout) {
    kdr_mesh *mesh = body->mesh;
    const unsigned char *rows = body->p;
    size_t stride = element->least_bytes, count = (size_t)element->count;
    size_t offsets[6] = {0};
    bool is_plain = !body->swaps;
    for (size_t slot = 0; slot < layout->slot_count; slot++) {
        for (size_t i = 0; i < layout->properties[slot]; i++)
            offsets[slot] += kdr_ply_type_bytes(element->properties[i].type);
        is_plain &= element->properties[layout->properties[slot]].type == KDR_PLY_FLOAT32;
        is_plain &= slot % 3 == 0 || offsets[slot] == offsets[slot - 1] + sizeof(float);
    }
    body->p += count * stride;

    // Three floats side by side, the usual case, are copied.
    if (is_plain && layout->slot_count == 3 && stride == 3 * sizeof(float)) {
        memcpy(mesh->positions, rows, count * stride);
    } else if (is_plain) {
        for (size_t i = 0; i < count; i++)
            memcpy(mesh->positions + 3 * i, rows + i * stride + offsets[0], 3 * sizeof(float));
        for (size_t i = 0; i < count && layout->slot_count == 6; i++)
            memcpy(mesh->normals + 3 * i, rows + i * stride + offsets[3], 3 * sizeof(float));
    } else {
        for (size_t i = 0; i < count; i++)
            for (size_t slot = 0; slot < layout->slot_count; slot++)
                store_slot(mesh, i, slot,
                           kdr_ply_decode(rows + i * stride + offsets[slot],
                                          element->properties[layout->properties[slot]].type, body->swaps));
    }
}

/* Text, or rows with lists: value by value. */
static kdr_status read_rows(kdr_ply_body *body, const kdr_ply_element *element, const vertex_layout *layout) {
    uint8_t slots[KDR_PLY_MAX_PROPERTIES];
    memset(slots, 6, element->property_count);
    for (size_t slot = 0; slot < layout->slot_count; slot++)
        slots[layout->properties[slot]] = (uint8_t)slot;

    kdr_status status = KDR_OK;
    for (uint64_t row = 0; row < element->count && status == KDR_OK; row++) {
        status = kdr_ply_begin_row(body, element, row);
        for (size_t i = 0; i < element->property_count && status == KDR_OK; i++) {
            if (slots[i] == 6) {
                status = kdr_ply_skip_property(body, &element->properties[i]);
                continue;
            }
            double value;
            status = kdr_ply_read_value(body, element->properties[i].type, &value);
            if (status == KDR_OK)
                store_slot(body->mesh, (size_t)row, slots[i], value);
        }
        if (status == KDR_OK)
            status = kdr_ply_end_row(body);
    }
    return status;
}

kdr_status kdr_ply_read_vertices(kdr_ply_body *body, const kdr_ply_element *element) {
    if (element->count == 0)
        return KDR_OK;
    vertex_layout layout;
    kdr_status status = find_layout(body, element, &layout);
    if (status == KDR_OK)
        status = kdr_ply_check_room(body, element);
    if (status != KDR_OK)
        return status;
    if (layout.slot_count == 6)
        status = kdr_mesh_add_parts(body->mesh, KDR_MESH_NORMALS);
    if (status == KDR_OK)
        status = kdr_mesh_resize_vertices(body->mesh, element->count);
    if (status != KDR_OK)
        return kdr_source_fail_status(body->source, status);

    if (body->header->is_ascii || element->list_count)
        return read_rows(body, element, &layout);
    read_fixed_rows(body, element, &layout);
    return KDR_OK;
}

static bool is_strips(const kdr_ply_element *element) { return kdr_word_is(element->name, "tristrips"); }

static bool has_triangles(const kdr_ply_element *element) {
    return kdr_word_is(element->name, "face") || is_strips(element);
}

static kdr_status read_elements(kdr_ply_body *body) {
    const kdr_ply_header *header = body->header;
    size_t vertex_element = 0;
    while (vertex_element < header->element_count && !kdr_word_is(header->elements[vertex_element].name, "vertex"))
        vertex_element++;

    // Faces before the vertices are passed over: where the body begins is kept for them.
    const kdr_ply_body start = *body;
    bool is_face_early = false;
    kdr_status status = KDR_OK;
    for (size_t i = 0; i < header->element_count && status == KDR_OK; i++) {
        const kdr_ply_element *element = &header->elements[i];
        bool is_early = i < vertex_element && vertex_element < header->element_count;
        is_face_early |= is_early && has_triangles(element);
        if (i == vertex_element)
            status = kdr_ply_read_vertices(body, element);
        else if (has_triangles(element) && !is_early)
            status = kdr_ply_read_faces(body, element, is_strips(element));
        else
            status = kdr_ply_skip_element(body, element);
    }
    if (status != KDR_OK)
        return status;
    if (body->header->is_ascii ? kdr_text_skip_blank_lines(&body->text) : body->p < body->end)
        kdr_source_warn(body->source, "%zu bytes after the last element are passed over", kdr_ply_bytes_left(body));

    if (is_face_early) {
        body->p = start.p;
        body->text = start.text;
    }
    for (size_t i = 0; i < vertex_element && is_face_early && status == KDR_OK; i++) {
        const kdr_ply_element *element = &header->elements[i];
        status = has_triangles(element) ? kdr_ply_read_faces(body, element, is_strips(element))
                                        : kdr_ply_skip_element(body, element);
    }
    return status;
}

kdr_status kdr_read_ply(const kdr_source *source, kdr_mesh **out) {
    *out = NULL;
    kdr_ply_header header = {0};
    kdr_status status = kdr_ply_read_header(source, &header);
    if (status != KDR_OK)
        return status;
    const char *format = header.is_ascii        ? "PLY ascii"
                         : header.is_big_endian ? "PLY binary big endian"
                                                : "PLY binary little endian";
    kdr_mesh *mesh;
    status = kdr_mesh_create(0, 0, 0, format, &mesh);
    if (status != KDR_OK)
        return kdr_source_fail_status(source, status);

    const char *text = (const char *)source->bytes;
    kdr_ply_body body = {.source = source,
                         .header = &header,
                         .p = source->bytes + header.body,
                         .end = source->bytes + source->length,
                         .text = {text + header.body, text + source->length, header.body_line, false},
                         .swaps = header.is_big_endian != (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__),
                         .mesh = mesh};
    status = read_elements(&body);
    kdr_buffer_release(kdr_mesh_memory(), &body.polygon);
    if (status != KDR_OK) {
        kdr_mesh_destroy(mesh);
        return status;
    }
    if (body.skipped_count)
        kdr_source_warn(source, "%zu faces of fewer than three corners were passed over", body.skipped_count);
    *out = mesh;
    return KDR_OK;
}
