/* The faces of a PLY body.
 *
 * Nearly all files hold rows that are one list of a byte and 32-bit numbers, nearly all lists are triangles: a run of
 * such rows is read without a look at types. The first row that is otherwise is read value by value, then the next run
 * begins. Invariant: every number that is stored was compared with the count of vertices. */
#include "mesh/mesh.h"
#include "mesh/mesh_memory.h"
#include "mesh/ply_body.h"
#include "mesh/triangulate.h"

#include <string.h>

typedef struct face_layout {
    const kdr_ply_element *element;
    size_t list;         /* the property with vertex numbers */
    size_t vertex_count; /* every number is below */
    bool is_strips;
    bool is_simple;      /* one list, of a byte and 32-bit integers in this machine's order, among scalars */
    size_t list_offset;  /* bytes of a simple row before its list */
    size_t triangle_row; /* bytes of a simple row of three corners */
} face_layout;

static kdr_status find_layout(const kdr_ply_body *body, const kdr_ply_element *element, face_layout *layout) {
    layout->list = kdr_ply_find_property(element, "vertex_indices");
    if (layout->list == element->property_count)
        layout->list = kdr_ply_find_property(element, "vertex_index");
    if (layout->list == element->property_count || !element->properties[layout->list].is_list)
        return kdr_source_fail_line(body->source, element->line,
                                    "expected '%.*s' to have a list 'vertex_indices' or 'vertex_index'",
                                    (int)element->name.length, element->name.start);
    const kdr_ply_property *list = &element->properties[layout->list];
    bool is_byte = list->count_type == KDR_PLY_UINT8 || list->count_type == KDR_PLY_INT8;
    bool is_word = list->type == KDR_PLY_INT32 || list->type == KDR_PLY_UINT32;
    layout->is_simple =
        !body->header->is_ascii && !body->swaps && !layout->is_strips && element->list_count == 1 && is_byte && is_word;
    layout->list_offset = 0;
    for (size_t i = 0; i < layout->list; i++)
        layout->list_offset += kdr_ply_type_bytes(element->properties[i].type);
    layout->triangle_row = element->least_bytes + 3 * sizeof(uint32_t);
    return KDR_OK;
}

/* Room for as many triangles as there are faces, or as the rest of the file can hold. */
static kdr_status reserve(kdr_ply_body *body, const face_layout *layout) {
    const kdr_ply_property *list = &layout->element->properties[layout->list];
    size_t least = body->header->is_ascii ? 2 * (layout->element->property_count + 3)
                                          : layout->element->least_bytes + 3 * kdr_ply_type_bytes(list->type);
    size_t most = kdr_ply_bytes_left(body) / least + 1;
    size_t count = layout->element->count < most ? (size_t)layout->element->count : most;
    return kdr_mesh_reserve_triangles(body->mesh, body->mesh->triangle_count + count);
}

/* Stores the triangles of simple rows until one has not three corners, is cut off, or is wrong. Gives the rows read. */
static uint64_t read_simple_run(kdr_ply_body *body, const face_layout *layout, uint64_t most) {
    kdr_mesh *mesh = body->mesh;
    size_t row_bytes = layout->triangle_row, vertex_count = layout->vertex_count;
    size_t room = kdr_mesh_triangle_capacity(mesh) - mesh->triangle_count;
    size_t whole = (size_t)(body->end - body->p) / row_bytes;
    most = most < room ? most : room;
    most = most < whole ? most : whole;
    if (most == 0)
        return 0;
    const unsigned char *p = body->p;
    uint32_t *indices = mesh->indices + 3 * mesh->triangle_count;
    uint64_t rows = 0;
    for (; rows < most; rows++, p += row_bytes, indices += 3) {
        if (p[layout->list_offset] != 3)
            break;
        uint32_t corners[3];
        memcpy(corners, p + layout->list_offset + 1, sizeof corners);
        if (corners[0] >= vertex_count || corners[1] >= vertex_count || corners[2] >= vertex_count)
            break;
        memcpy(indices, corners, sizeof corners);
    }
    body->p = p;
    mesh->triangle_count += (size_t)rows;
    return rows;
}

/* Appends the triangles of a polygon whose numbers are checked. */
static kdr_status store_polygon(kdr_ply_body *body, const uint32_t *corners, size_t count) {
    if (count < 3) {
        body->skipped_count++;
        return KDR_OK;
    }
    kdr_mesh *mesh = body->mesh;
    size_t first = mesh->triangle_count;
    kdr_status status = kdr_mesh_resize_triangles(mesh, first + count - 2);
    if (status != KDR_OK)
        return kdr_source_fail_status(body->source, status);
    uint32_t *indices = mesh->indices + 3 * first;
    kdr_triangulate(mesh->positions, corners, count, indices);
    for (size_t i = 0; i < 3 * (count - 2); i++)
        indices[i] = corners[indices[i]];
    return KDR_OK;
}

/* Appends the triangles of strips; every other one is turned, so that all face the same side. */
static kdr_status store_strips(kdr_ply_body *body, const uint32_t *corners, size_t count) {
    kdr_mesh *mesh = body->mesh;
    size_t triangle = mesh->triangle_count, length = 0;
    kdr_status status = kdr_mesh_reserve_triangles(mesh, triangle + count);
    if (status != KDR_OK)
        return kdr_source_fail_status(body->source, status);
    for (size_t i = 0; i < count; i++) {
        length = corners[i] == KDR_INVALID_ID ? 0 : length + 1;
        if (length < 3)
            continue;
        size_t turned = length % 2 == 0;
        uint32_t *indices = mesh->indices + 3 * triangle++;
        indices[0] = corners[i - 2 + turned];
        indices[1] = corners[i - 1 - turned];
        indices[2] = corners[i];
    }
    mesh->triangle_count = triangle;
    return KDR_OK;
}

/* Reads and checks the vertex numbers of the list at the cursor. */
static kdr_status read_list(kdr_ply_body *body, const face_layout *layout, size_t *out_count) {
    const kdr_ply_property *list = &layout->element->properties[layout->list];
    size_t count;
    kdr_status status = kdr_ply_read_count(body, list, &count);
    if (status != KDR_OK)
        return status;
    if (!kdr_buffer_reserve(kdr_mesh_memory(), &body->polygon, (count + 1) * sizeof(uint32_t)))
        return kdr_source_fail_status(body->source, KDR_ERROR_OUT_OF_MEMORY);
    uint32_t *corners = body->polygon.memory;
    for (size_t i = 0; i < count; i++) {
        const unsigned char *p = body->p;
        double number;
        status = kdr_ply_read_value(body, list->type, &number);
        if (status != KDR_OK)
            return status;
        if (number >= 0 && number < (double)layout->vertex_count && number == (double)(uint32_t)number) {
            corners[i] = (uint32_t)number;
        } else if (layout->is_strips && number == -1) {
            corners[i] = KDR_INVALID_ID;
        } else {
            body->p = p;
            return kdr_ply_fail(body, "expected a vertex number below %zu, found %.10g", layout->vertex_count, number);
        }
    }
    *out_count = count;
    return KDR_OK;
}

static kdr_status read_row(kdr_ply_body *body, const face_layout *layout, uint64_t row) {
    const kdr_ply_element *element = layout->element;
    size_t count = 0;
    kdr_status status = kdr_ply_begin_row(body, element, row);
    for (size_t i = 0; i < element->property_count && status == KDR_OK; i++)
        status =
            i == layout->list ? read_list(body, layout, &count) : kdr_ply_skip_property(body, &element->properties[i]);
    if (status == KDR_OK)
        status = kdr_ply_end_row(body);
    if (status != KDR_OK)
        return status;
    return layout->is_strips ? store_strips(body, body->polygon.memory, count)
                             : store_polygon(body, body->polygon.memory, count);
}

kdr_status kdr_ply_read_faces(kdr_ply_body *body, const kdr_ply_element *element, bool is_strips) {
    if (element->count == 0)
        return KDR_OK;
    face_layout layout = {.element = element, .is_strips = is_strips, .vertex_count = body->mesh->vertex_count};
    kdr_status status = find_layout(body, element, &layout);
    if (status == KDR_OK)
        status = kdr_ply_check_room(body, element);
    if (status != KDR_OK)
        return status;
    status = reserve(body, &layout);
    if (status != KDR_OK)
        return kdr_source_fail_status(body->source, status);

    for (uint64_t row = 0; row < element->count && status == KDR_OK;) {
        if (layout.is_simple)
            row += read_simple_run(body, &layout, element->count - row);
        if (row < element->count)
            status = read_row(body, &layout, row++);
    }
    return status;
}
