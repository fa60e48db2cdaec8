/* Buffers, views and accessors: what is read must lie in what is there.
 *
 * Source: Khronos Group, "glTF 2.0 Specification", chapters 3.6 (binary data storage) and 5 (properties). assimp 5.2
 * follows numbers out of their lists, past the ends of buffers and round in circles; a file that passes here has none
 * such. Buffers in other files are believed: assimp fails cleanly where they are shorter. */
#include "mesh/gltf_check.h"

#include "mesh/mesh_memory.h"

#include <string.h>

static const char *const list_names[KDR_GLTF_LISTS] = {"buffers",  "bufferViews", "accessors", "images",
                                                       "samplers", "textures",    "materials", "meshes",
                                                       "skins",    "cameras",     "nodes",     "scenes"};

kdr_status kdr_gltf_fail(const kdr_gltf *gltf, const kdr_json_value *value, const char *expected) {
    return kdr_source_fail_byte(gltf->source, value->byte, "expected %s", expected);
}

static bool is_whole(const kdr_json_value *value, uint64_t most, uint64_t *out) {
    if (value->kind != KDR_JSON_NUMBER || !(value->number >= 0) || value->number > (double)most)
        return false;
    *out = (uint64_t)value->number;
    return (double)*out == value->number;
}

kdr_status kdr_gltf_read_whole(const kdr_gltf *gltf, const kdr_json_value *object, const char *key, uint64_t most,
                               uint64_t otherwise, uint64_t *out) {
    const kdr_json_value *value = kdr_json_find(&gltf->json, object, key);
    *out = otherwise;
    if (!value || is_whole(value, most, out))
        return KDR_OK;
    return kdr_source_fail_byte(gltf->source, value->byte, "expected '%s' to be a whole number up to %llu", key,
                                (unsigned long long)most);
}

kdr_status kdr_gltf_check_reference(const kdr_gltf *gltf, const kdr_json_value *value, kdr_gltf_list list,
                                    uint32_t *out) {
    uint64_t number;
    if (!is_whole(value, UINT32_MAX, &number) || number >= gltf->counts[list])
        return kdr_source_fail_byte(gltf->source, value->byte, "expected a number into '%s', of which there are %zu",
                                    list_names[list], gltf->counts[list]);
    *out = (uint32_t)number;
    return KDR_OK;
}

kdr_status kdr_gltf_read_reference(const kdr_gltf *gltf, const kdr_json_value *object, const char *key,
                                   kdr_gltf_list list, uint32_t *out) {
    const kdr_json_value *value = kdr_json_find(&gltf->json, object, key);
    *out = KDR_INVALID_ID;
    return value ? kdr_gltf_check_reference(gltf, value, list, out) : KDR_OK;
}

static kdr_status find_lists(kdr_gltf *gltf) {
    for (int list = 0; list < KDR_GLTF_LISTS; list++) {
        const kdr_json_value *value = kdr_json_find(&gltf->json, gltf->root, list_names[list]);
        if (value && value->kind != KDR_JSON_ARRAY)
            return kdr_gltf_fail(gltf, value, "an array");
        gltf->lists[list] = value;
        gltf->counts[list] = value ? value->count : 0;
        for (const kdr_json_value *one = kdr_json_first(&gltf->json, value); one; one = kdr_json_next(&gltf->json, one))
            if (one->kind != KDR_JSON_OBJECT)
                return kdr_gltf_fail(gltf, one, "an object");
    }
    return KDR_OK;
}

static kdr_status take_tables(kdr_gltf *gltf) {
    size_t accessors = gltf->counts[KDR_GLTF_ACCESSORS] * sizeof(kdr_gltf_accessor);
    size_t views = gltf->counts[KDR_GLTF_VIEWS] * sizeof(kdr_gltf_view);
    size_t buffers = gltf->counts[KDR_GLTF_BUFFERS] * sizeof(uint64_t);
    if (!kdr_mesh_buffer_grow(&gltf->memory, 0, accessors + views + buffers + 1))
        return kdr_source_fail_status(gltf->source, KDR_ERROR_OUT_OF_MEMORY);
    unsigned char *memory = gltf->memory.memory;
    gltf->accessors = (kdr_gltf_accessor *)(void *)memory;
    gltf->views = (kdr_gltf_view *)(void *)(memory + accessors);
    gltf->buffers = (uint64_t *)(void *)(memory + accessors + views);
    return KDR_OK;
}

static kdr_status check_buffer(kdr_gltf *gltf, const kdr_json_value *object, size_t number) {
    uint64_t length;
    kdr_status status = kdr_gltf_read_whole(gltf, object, "byteLength", UINT32_MAX, 0, &length);
    if (status != KDR_OK)
        return status;
    const kdr_json_value *uri = kdr_json_find(&gltf->json, object, "uri");
    uint64_t most = UINT32_MAX;
    if (!uri)
        most = number == 0 ? gltf->binary_length : 0;
    else if (uri->kind != KDR_JSON_STRING)
        return kdr_gltf_fail(gltf, uri, "a string");
    else if (uri->text.length > 5 && memcmp(uri->text.start, "data:", 5) == 0)
        most = uri->text.length;
    if (length == 0 || length > most)
        return kdr_source_fail_byte(gltf->source, object->byte,
                                    "expected a buffer of 1 to %llu bytes, which is what the file holds, found %llu",
                                    (unsigned long long)most, (unsigned long long)length);
    gltf->buffers[number] = length;
    return KDR_OK;
}

static kdr_status check_view(kdr_gltf *gltf, const kdr_json_value *object, size_t number) {
    uint32_t buffer;
    uint64_t offset, length, stride;
    kdr_status status = kdr_gltf_read_reference(gltf, object, "buffer", KDR_GLTF_BUFFERS, &buffer);
    if (status == KDR_OK)
        status = kdr_gltf_read_whole(gltf, object, "byteOffset", UINT32_MAX, 0, &offset);
    if (status == KDR_OK)
        status = kdr_gltf_read_whole(gltf, object, "byteLength", UINT32_MAX, 0, &length);
    if (status == KDR_OK)
        status = kdr_gltf_read_whole(gltf, object, "byteStride", 252, 0, &stride);
    if (status != KDR_OK)
        return status;
    if (buffer == KDR_INVALID_ID || length == 0 || offset + length > gltf->buffers[buffer])
        return kdr_gltf_fail(gltf, object, "a view of at least one byte that lies in its buffer");
    bool is_here = buffer == 0 && !kdr_json_find(&gltf->json, kdr_json_first(&gltf->json, gltf->lists[0]), "uri");
    gltf->views[number] = (kdr_gltf_view){length, stride, is_here ? gltf->binary_begin + offset : 0, offset, buffer};
    return KDR_OK;
}

static uint32_t component_bytes(uint64_t component) {
    switch (component) {
    case KDR_GLTF_BYTE:
    case KDR_GLTF_UBYTE: return 1;
    case KDR_GLTF_SHORT:
    case KDR_GLTF_USHORT: return 2;
    case KDR_GLTF_UINT:
    case KDR_GLTF_FLOAT: return 4;
    default: return 0;
    }
}

/* Whether `count` values of `bytes` bytes lie in a view from `offset` on. */
static bool fits(const kdr_gltf_view *view, uint64_t offset, uint64_t count, uint64_t bytes) {
    uint64_t stride = view->stride ? view->stride : bytes;
    return stride >= bytes && offset + (count - 1) * stride + bytes <= view->length;
}

/* One of the two tables of a sparse accessor. */
static kdr_status check_sparse_part(const kdr_gltf *gltf, const kdr_json_value *part, uint64_t count, uint64_t bytes) {
    uint32_t view;
    uint64_t offset;
    kdr_status status = kdr_gltf_read_reference(gltf, part, "bufferView", KDR_GLTF_VIEWS, &view);
    if (status == KDR_OK)
        status = kdr_gltf_read_whole(gltf, part, "byteOffset", UINT32_MAX, 0, &offset);
    if (status != KDR_OK)
        return status;
    if (view == KDR_INVALID_ID || bytes == 0 || !fits(&gltf->views[view], offset, count, bytes))
        return kdr_gltf_fail(gltf, part, "sparse values that lie in their view");
    return KDR_OK;
}

static kdr_status check_sparse(const kdr_gltf *gltf, const kdr_json_value *sparse, uint64_t most, uint64_t bytes) {
    const kdr_json_value *indices = kdr_json_find(&gltf->json, sparse, "indices");
    const kdr_json_value *values = kdr_json_find(&gltf->json, sparse, "values");
    uint64_t count, component;
    if (!indices || !values)
        return kdr_gltf_fail(gltf, sparse, "'indices' and 'values'");
    kdr_status status = kdr_gltf_read_whole(gltf, sparse, "count", most, 0, &count);
    if (status == KDR_OK)
        status = kdr_gltf_read_whole(gltf, indices, "componentType", UINT32_MAX, 0, &component);
    if (status != KDR_OK)
        return status;
    if (count == 0)
        return kdr_gltf_fail(gltf, sparse, "at least one sparse value");
    status = check_sparse_part(gltf, indices, count, component == KDR_GLTF_FLOAT ? 0 : component_bytes(component));
    return status == KDR_OK ? check_sparse_part(gltf, values, count, bytes) : status;
}

static uint32_t find_width(const kdr_json_value *type) {
    static const struct {
        const char *name;
        uint32_t width;
    } types[] = {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT2", 5}, {"MAT3", 9}, {"MAT4", 16}};
    for (size_t i = 0; type && type->kind == KDR_JSON_STRING && i < sizeof types / sizeof types[0]; i++)
        if (kdr_word_is(type->text, types[i].name))
            return types[i].width;
    return 0;
}

static kdr_status check_accessor(kdr_gltf *gltf, const kdr_json_value *object, size_t number) {
    uint64_t count, component, offset;
    uint32_t view;
    kdr_status status = kdr_gltf_read_reference(gltf, object, "bufferView", KDR_GLTF_VIEWS, &view);
    if (status == KDR_OK)
        status = kdr_gltf_read_whole(gltf, object, "byteOffset", UINT32_MAX, 0, &offset);
    if (status == KDR_OK)
        status = kdr_gltf_read_whole(gltf, object, "componentType", UINT32_MAX, 0, &component);
    if (status == KDR_OK)
        status = kdr_gltf_read_whole(gltf, object, "count", UINT32_MAX - 1, 0, &count);
    if (status != KDR_OK)
        return status;
    uint32_t width = find_width(kdr_json_find(&gltf->json, object, "type"));
    uint64_t bytes = (uint64_t)component_bytes(component) * (width == 5 ? 4 : width);
    if (bytes == 0 || count == 0)
        return kdr_gltf_fail(gltf, object, "an accessor with componentType, type and a count of at least 1");
    const kdr_json_value *sparse = kdr_json_find(&gltf->json, object, "sparse");
    if (view == KDR_INVALID_ID && !(gltf->is_own && sparse && count <= gltf->source->length))
        return kdr_source_fail(gltf->source, KDR_ERROR_UNSUPPORTED, "byte %zu: expected an accessor with a view",
                               object->byte);
    const kdr_gltf_view *from = view == KDR_INVALID_ID ? NULL : &gltf->views[view];
    if (from && !fits(from, offset, count, bytes))
        return kdr_gltf_fail(gltf, object, "an accessor whose values lie in its view");
    gltf->accessors[number] = (kdr_gltf_accessor){.count = count,
                                                  .begin = from && from->begin && !sparse ? from->begin + offset : 0,
                                                  .stride = from && from->stride ? from->stride : bytes,
                                                  .component = (uint32_t)component,
                                                  .width = width,
                                                  .view = view,
                                                  .offset = offset};
    return sparse ? check_sparse(gltf, sparse, count, bytes) : KDR_OK;
}

typedef kdr_status check_one(kdr_gltf *gltf, const kdr_json_value *object, size_t number);

static kdr_status check_list(kdr_gltf *gltf, kdr_gltf_list list, check_one *check) {
    size_t number = 0;
    kdr_status status = KDR_OK;
    const kdr_json_value *value = kdr_json_first(&gltf->json, gltf->lists[list]);
    for (; value && status == KDR_OK; value = kdr_json_next(&gltf->json, value))
        status = check(gltf, value, number++);
    return status;
}

static kdr_status check_version(const kdr_gltf *gltf) {
    const kdr_json_value *asset = kdr_json_find(&gltf->json, gltf->root, "asset");
    const kdr_json_value *version = kdr_json_find(&gltf->json, asset, "version");
    if (!version || version->kind != KDR_JSON_STRING)
        return kdr_gltf_fail(gltf, gltf->root, "an asset with a version");
    if (version->text.length == 3 && memcmp(version->text.start, "2.", 2) == 0)
        return KDR_OK;
    return kdr_source_fail(gltf->source, KDR_ERROR_UNSUPPORTED, "byte %zu: expected glTF version 2", version->byte);
}

static kdr_status check_all(kdr_gltf *gltf) {
    kdr_status status = check_version(gltf);
    if (status == KDR_OK)
        status = find_lists(gltf);
    if (status == KDR_OK)
        status = take_tables(gltf);
    if (status == KDR_OK)
        status = check_list(gltf, KDR_GLTF_BUFFERS, check_buffer);
    if (status == KDR_OK)
        status = check_list(gltf, KDR_GLTF_VIEWS, check_view);
    if (status == KDR_OK)
        status = check_list(gltf, KDR_GLTF_ACCESSORS, check_accessor);
    if (status == KDR_OK)
        status = kdr_gltf_check_meshes(gltf);
    if (status == KDR_OK)
        status = kdr_gltf_check_nodes(gltf);
    if (status == KDR_OK)
        status = kdr_gltf_check_motion(gltf);
    return status;
}

static kdr_status read_and_check(kdr_gltf *gltf, const kdr_glb_frame *frame) {
    gltf->binary_begin = frame->binary_begin;
    gltf->binary_length = frame->binary_length;
    kdr_status status = kdr_json_read(gltf->source, frame->json_begin, frame->json_end, &gltf->json);
    if (status == KDR_OK) {
        gltf->root = &gltf->json.values[0];
        status = check_all(gltf);
    }
    return status;
}

void kdr_gltf_close(kdr_gltf *gltf) {
    kdr_buffer_release(kdr_mesh_memory(), &gltf->memory);
    kdr_json_release(&gltf->json);
}

kdr_status kdr_gltf_check(const kdr_source *source, const kdr_glb_frame *frame) {
    kdr_gltf gltf = {.source = source};
    kdr_status status = read_and_check(&gltf, frame);
    kdr_gltf_close(&gltf);
    return status;
}

kdr_status kdr_gltf_open(const kdr_source *source, const kdr_glb_frame *frame, kdr_gltf *out) {
    *out = (kdr_gltf){.source = source, .is_own = true};
    return read_and_check(out, frame);
}
