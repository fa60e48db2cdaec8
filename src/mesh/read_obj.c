/* OBJ files.
 *
 * Source: Wavefront, "Object Files (.obj)", appendix B1 of the Advanced Visualizer manual. Lines of a keyword and its
 * values; a backslash joins lines. Read are v, vn, vt (counted, so that numbers can be checked), f, usemtl and mtllib;
 * other keywords are passed over. Numbers count from 1, negative ones back from the line's place; numbers beyond what
 * was there yet are checked at the end. */
#include "mesh/obj.h"

#include "mesh/mesh.h"
#include "mesh/mesh_memory.h"

#include <string.h>

const char *const kdr_obj_kind_names[KDR_OBJ_KINDS] = {"vertex", "texture vertex", "normal"};

/* The first line, after a byte order mark if there is one. */
static kdr_text begin_text(const kdr_source *source, size_t length) {
    const char *start = (const char *)source->bytes;
    bool has_mark = length >= 3 && memcmp(start, "\xef\xbb\xbf", 3) == 0;
    return (kdr_text){has_mark ? start + 3 : start, start + length, 1, true};
}

static kdr_status read_floats(kdr_obj *obj, float out[3], const char *what) {
    for (int axis = 0; axis < 3; axis++) {
        double value;
        if (!kdr_text_take_double(&obj->text, &value)) {
            char found[KDR_TEXT_FOUND_BYTES];
            return kdr_source_fail_line(obj->source, obj->text.line, "expected three numbers of a %s, found %s", what,
                                        kdr_text_found(&obj->text, found));
        }
        out[axis] = (float)value;
    }
    return KDR_OK;
}

static kdr_status read_vertex(kdr_obj *obj) {
    size_t vertex = obj->mesh->vertex_count;
    kdr_status status = kdr_mesh_resize_vertices(obj->mesh, vertex + 1);
    if (status != KDR_OK)
        return kdr_source_fail_status(obj->source, status);
    obj->counts[KDR_OBJ_POSITION]++;
    return read_floats(obj, obj->mesh->positions + 3 * vertex, kdr_obj_kind_names[KDR_OBJ_POSITION]);
}

static kdr_status read_normal(kdr_obj *obj) {
    size_t kept = obj->counts[KDR_OBJ_NORMAL] * 3 * sizeof(float);
    if (!kdr_mesh_buffer_grow(&obj->normals, kept, kept + 3 * sizeof(float)))
        return kdr_source_fail_status(obj->source, KDR_ERROR_OUT_OF_MEMORY);
    float *normals = obj->normals.memory;
    return read_floats(obj, normals + 3 * obj->counts[KDR_OBJ_NORMAL]++, kdr_obj_kind_names[KDR_OBJ_NORMAL]);
}

static const float grey[3] = {0.8f, 0.8f, 0.8f};

static kdr_status add_material(kdr_obj *obj, kdr_word name) {
    kdr_status status = kdr_names_add(&obj->materials, name);
    if (status == KDR_OK)
        status = kdr_mesh_add_material(obj->mesh, name.start, name.length, grey, &obj->material);
    return status;
}

/* The first line usemtl gives the mesh its materials; triangles before it get one without a name. */
static kdr_status begin_materials(kdr_obj *obj) {
    kdr_status status = kdr_mesh_add_parts(obj->mesh, KDR_MESH_MATERIALS);
    if (status == KDR_OK && obj->mesh->triangle_count) {
        status = add_material(obj, (kdr_word){"", 0});
        memset(obj->mesh->triangle_materials, 0, obj->mesh->triangle_count * sizeof(uint32_t));
    }
    return status;
}

static kdr_status read_use_material(kdr_obj *obj) {
    kdr_word name = kdr_text_take_rest(&obj->text);
    kdr_status status = obj->mesh->material_count == 0 ? begin_materials(obj) : KDR_OK;
    if (status == KDR_OK) {
        obj->material = kdr_names_find(&obj->materials, name);
        if (obj->material == KDR_INVALID_ID)
            status = add_material(obj, name);
    }
    return kdr_source_fail_status(obj->source, status);
}

static kdr_status read_library(kdr_obj *obj) {
    size_t kept = obj->library_count * sizeof(kdr_obj_library);
    if (!kdr_mesh_buffer_grow(&obj->libraries, kept, kept + sizeof(kdr_obj_library)))
        return kdr_source_fail_status(obj->source, KDR_ERROR_OUT_OF_MEMORY);
    kdr_obj_library *libraries = obj->libraries.memory;
    size_t line = obj->text.line;
    libraries[obj->library_count++] = (kdr_obj_library){kdr_text_take_rest(&obj->text), line};
    return KDR_OK;
}

/* Keywords that show an OBJ file, though nothing is read after them. */
static bool is_known(kdr_word word) {
    static const char *const known[] = {"o", "g", "s", "p", "l", "vp", "mg", "lod", "cstype"};
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
        if (kdr_word_is(word, known[i]))
            return true;
    return false;
}

static kdr_status read_lines(kdr_obj *obj) {
    kdr_text *text = &obj->text;
    size_t first_unknown = 0;
    bool has_known = false;
    while (kdr_text_skip_blank_lines(text)) {
        size_t line = text->line;
        kdr_status status = KDR_OK;
        bool known = true;
        kdr_word word = kdr_text_take_word(text);
        if (word.length == 1 && *word.start == 'v') {
            status = read_vertex(obj);
        } else if (word.length == 1 && *word.start == 'f') {
            status = kdr_obj_read_face(obj);
        } else if (kdr_word_is(word, "vn")) {
            status = read_normal(obj);
        } else if (kdr_word_is(word, "vt")) {
            obj->counts[KDR_OBJ_TEXTURE]++;
        } else if (kdr_word_is(word, "usemtl")) {
            status = read_use_material(obj);
        } else if (kdr_word_is(word, "mtllib")) {
            status = read_library(obj);
        } else {
            known = is_known(word);
            if (!known && !first_unknown && *word.start != '#')
                first_unknown = line;
        }
        if (status != KDR_OK)
            return status;
        has_known |= known;
        kdr_text_skip_rest(text);
    }
    if (first_unknown && !has_known)
        return kdr_source_fail_line(obj->source, first_unknown,
                                    "expected a keyword of an OBJ file (v, vn, vt, f, o, g, s, usemtl, mtllib)");
    return KDR_OK;
}

static kdr_status check_forward(const kdr_obj *obj) {
    for (int kind = 0; kind < KDR_OBJ_KINDS; kind++) {
        const kdr_obj_forward *forward = &obj->forward[kind];
        if (forward->number > obj->counts[kind])
            return kdr_source_fail_line(obj->source, forward->line,
                                        "expected the number of a %s, the file has %zu, found %zu",
                                        kdr_obj_kind_names[kind], obj->counts[kind], forward->number);
    }
    return KDR_OK;
}

static void release(kdr_obj *obj) {
    kdr_alloc *memory = kdr_mesh_memory();
    kdr_buffer_release(memory, &obj->normals);
    kdr_buffer_release(memory, &obj->corner_normals);
    kdr_buffer_release(memory, &obj->polygon);
    kdr_buffer_release(memory, &obj->libraries);
    kdr_names_release(&obj->materials);
}

kdr_status kdr_read_obj(const kdr_source *source, kdr_mesh **out) {
    *out = NULL;
    kdr_obj obj = {.source = source, .text = begin_text(source, source->length), .material = KDR_INVALID_ID};
    kdr_status status = kdr_mesh_create(0, 0, 0, "OBJ", &obj.mesh);
    if (status != KDR_OK)
        return kdr_source_fail_status(source, status);
    status = read_lines(&obj);
    if (status == KDR_OK)
        status = check_forward(&obj);
    if (status == KDR_OK && obj.has_corner_normals)
        status = kdr_source_fail_status(source, kdr_obj_split_normals(&obj));
    if (status == KDR_OK) {
        kdr_obj_read_libraries(&obj);
        if (obj.skipped_count)
            kdr_source_warn(source, "%zu faces of fewer than three corners were passed over", obj.skipped_count);
        *out = obj.mesh;
    } else {
        kdr_mesh_destroy(obj.mesh);
    }
    release(&obj);
    return status;
}

bool kdr_source_looks_like_obj(const kdr_source *source) {
    kdr_text text = begin_text(source, source->length < 4096 ? source->length : 4096);
    while (kdr_text_skip_blank_lines(&text)) {
        kdr_word word = kdr_text_take_word(&text);
        double unused;
        if (*word.start != '#')
            return kdr_word_is(word, "mtllib") || kdr_word_is(word, "usemtl") ||
                   ((kdr_word_is(word, "o") || kdr_word_is(word, "g")) && !kdr_text_at_line_end(&text)) ||
                   ((kdr_word_is(word, "v") || kdr_word_is(word, "vn") || kdr_word_is(word, "vt")) &&
                    kdr_text_take_double(&text, &unused));
        kdr_text_skip_rest(&text);
    }
    return false;
}
