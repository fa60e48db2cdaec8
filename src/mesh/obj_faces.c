/* The lines `f` of an OBJ file: corners "v", "v/vt", "v//vn" or "v/vt/vn" with any number left out but the first. */
#include "mesh/mesh.h"
#include "mesh/mesh_memory.h"
#include "mesh/obj.h"
#include "mesh/triangulate.h"

#include <string.h>

/* Turns a number of the file into one from 0 on, or tells what is wrong. */
static kdr_status resolve(kdr_obj *obj, int kind, int64_t number, uint32_t *out) {
    size_t count = obj->counts[kind];
    if (number > 0 && (uint64_t)number <= KDR_MESH_LIMIT) {
        if ((size_t)number > count && (size_t)number > obj->forward[kind].number)
            obj->forward[kind] = (kdr_obj_forward){(size_t)number, obj->text.line};
        *out = (uint32_t)(number - 1);
        return KDR_OK;
    }
    if (number < 0 && number >= -(int64_t)count) {
        *out = (uint32_t)((int64_t)count + number);
        return KDR_OK;
    }
    return kdr_source_fail_line(obj->source, obj->text.line,
                                "expected the number of a %s (1 and up, or -1 and down), %zu came before, found %lld",
                                kdr_obj_kind_names[kind], count, (long long)number);
}

/* One corner; numbers that are left out are KDR_INVALID_ID. */
static kdr_status read_corner(kdr_obj *obj, uint32_t numbers[KDR_OBJ_KINDS]) {
    kdr_text *text = &obj->text;
    const char *p = text->p;
    numbers[KDR_OBJ_TEXTURE] = numbers[KDR_OBJ_NORMAL] = KDR_INVALID_ID;
    for (int kind = 0; kind < KDR_OBJ_KINDS; kind++) {
        int64_t number;
        if (kdr_number_read_index(&p, text->end, &number)) {
            kdr_status status = resolve(obj, kind, number, &numbers[kind]);
            if (status != KDR_OK)
                return status;
        } else if (kind == KDR_OBJ_POSITION) {
            break;
        }
        if (p == text->end || *p != '/') {
            if (p < text->end && !kdr_is_blank(*p) && !kdr_is_line_end(*p) && *p != '\\')
                break;
            text->p = p;
            return KDR_OK;
        }
        p++;
    }
    char found[KDR_TEXT_FOUND_BYTES];
    return kdr_source_fail_line(obj->source, text->line, "expected a corner (v, v/vt, v//vn or v/vt/vn), found %s",
                                kdr_text_found(text, found));
}

/* From the first corner with a normal on, every index has a number of a normal beside it. */
static kdr_status begin_corner_normals(kdr_obj *obj) {
    size_t bytes = 3 * obj->mesh->triangle_count * sizeof(uint32_t);
    if (!kdr_mesh_buffer_grow(&obj->corner_normals, 0, bytes + 3 * sizeof(uint32_t)))
        return KDR_ERROR_OUT_OF_MEMORY;
    memset(obj->corner_normals.memory, 0xff, bytes);
    obj->has_corner_normals = true;
    return KDR_OK;
}

/* Cuts the polygon into the mesh's next triangles, given as places in the polygon. */
static void cut_polygon(const kdr_obj *obj, const uint32_t *positions, size_t count, uint32_t *triangles) {
    // A vertex that is yet to come has no place to judge the shape by: the polygon is then cut as a fan.
    bool is_known = count > 3;
    for (size_t i = 0; i < count && is_known; i++)
        is_known &= positions[i] < obj->mesh->vertex_count;
    if (is_known) {
        kdr_triangulate(obj->mesh->positions, positions, count, triangles);
        return;
    }
    for (uint32_t i = 2; i < count; i++, triangles += 3) {
        triangles[0] = 0;
        triangles[1] = i - 1;
        triangles[2] = i;
    }
}

static kdr_status store_polygon(kdr_obj *obj, size_t count) {
    if (count < 3) {
        obj->skipped_count++;
        return KDR_OK;
    }
    kdr_mesh *mesh = obj->mesh;
    size_t first = mesh->triangle_count, added = count - 2;
    if (obj->has_corner_normals && !kdr_mesh_buffer_grow(&obj->corner_normals, 3 * first * sizeof(uint32_t),
                                                         3 * (first + added) * sizeof(uint32_t)))
        return KDR_ERROR_OUT_OF_MEMORY;
    kdr_status status = kdr_mesh_resize_triangles(mesh, first + added);
    if (status != KDR_OK)
        return status;

    // The polygon holds all positions, then all normals.
    const uint32_t *positions = obj->polygon.memory, *normals = positions + count;
    uint32_t *indices = mesh->indices + 3 * first;
    cut_polygon(obj, positions, count, indices);
    uint32_t *corner_normals = obj->corner_normals.memory;
    for (size_t i = 0; i < 3 * added; i++) {
        uint32_t corner = indices[i];
        indices[i] = positions[corner];
        if (obj->has_corner_normals)
            corner_normals[3 * first + i] = normals[corner];
    }
    for (size_t i = 0; i < added && mesh->triangle_materials; i++)
        mesh->triangle_materials[first + i] = obj->material;
    return KDR_OK;
}

/* Puts the normals, which stand between the positions, behind them. */
static kdr_status separate(kdr_obj *obj, size_t count) {
    size_t pairs = 2 * count * sizeof(uint32_t);
    if (!kdr_mesh_buffer_grow(&obj->polygon, pairs, 2 * pairs))
        return KDR_ERROR_OUT_OF_MEMORY;
    uint32_t *polygon = obj->polygon.memory, *normals = polygon + 2 * count;
    for (size_t i = 0; i < count; i++) {
        normals[i] = polygon[2 * i + 1];
        polygon[i] = polygon[2 * i];
    }
    memmove(polygon + count, normals, count * sizeof(uint32_t));
    return KDR_OK;
}

kdr_status kdr_obj_read_face(kdr_obj *obj) {
    kdr_text *text = &obj->text;
    size_t count = 0;
    bool has_normal = false;
    while (!kdr_text_at_line_end(text) && *text->p != '#') {
        uint32_t numbers[KDR_OBJ_KINDS];
        kdr_status status = read_corner(obj, numbers);
        if (status != KDR_OK)
            return status;
        size_t kept = 2 * count * sizeof(uint32_t);
        if (!kdr_mesh_buffer_grow(&obj->polygon, kept, kept + 2 * sizeof(uint32_t)))
            return kdr_source_fail_status(obj->source, KDR_ERROR_OUT_OF_MEMORY);
        uint32_t *polygon = obj->polygon.memory;
        polygon[2 * count] = numbers[KDR_OBJ_POSITION];
        polygon[2 * count + 1] = numbers[KDR_OBJ_NORMAL];
        has_normal |= numbers[KDR_OBJ_NORMAL] != KDR_INVALID_ID;
        count++;
    }
    kdr_status status = has_normal && !obj->has_corner_normals ? begin_corner_normals(obj) : KDR_OK;
    if (status == KDR_OK && count)
        status = separate(obj, count);
    if (status == KDR_OK)
        status = store_polygon(obj, count);
    return kdr_source_fail_status(obj->source, status);
}
