#include "mesh/gltf_asset.h"

#include <math.h>
#include <string.h>

/* Copies of sparse accessors may take this many times the bytes of the file and its buffers, and a little more. */
#define MOST_DENSE_TIMES 16
#define MOST_DENSE_BYTES ((uint64_t)1 << 20)

static kdr_status out_of_memory(const kdr_gltf_asset *asset) {
    return kdr_source_fail_status(asset->gltf.source, KDR_ERROR_OUT_OF_MEMORY);
}

static kdr_status list_objects(kdr_gltf_asset *asset) {
    const kdr_gltf *gltf = &asset->gltf;
    for (int list = 0; list < KDR_GLTF_LISTS; list++) {
        const kdr_json_value **objects = kdr_gltf_take(&asset->store, gltf->counts[list], sizeof(void *));
        if (!objects)
            return out_of_memory(asset);
        asset->objects[list] = objects;
        const kdr_json_value *one = kdr_json_first(&gltf->json, gltf->lists[list]);
        for (; one; one = kdr_json_next(&gltf->json, one))
            *objects++ = one;
    }
    return KDR_OK;
}

kdr_status kdr_gltf_asset_open(const kdr_source *source, kdr_gltf_asset *out) {
    *out = (kdr_gltf_asset){.gltf = {.source = source}};
    kdr_glb_frame frame = {.json_end = source->length};
    kdr_status status = kdr_source_is_glb(source) ? kdr_glb_read_frame(source, &frame) : KDR_OK;
    if (status == KDR_OK)
        status = kdr_gltf_open(source, &frame, &out->gltf);
    if (status == KDR_OK)
        status = list_objects(out);
    if (status != KDR_OK)
        return status;
    out->values = kdr_gltf_take(&out->store, out->gltf.counts[KDR_GLTF_ACCESSORS], sizeof *out->values);
    return out->values ? kdr_gltf_read_buffers(out) : out_of_memory(out);
}

void kdr_gltf_asset_forget_file(kdr_gltf_asset *asset) {
    kdr_gltf_close(&asset->gltf);
    asset->gltf = (kdr_gltf){0};
}

void kdr_gltf_asset_release(kdr_gltf_asset *asset) {
    kdr_gltf_close(&asset->gltf);
    kdr_gltf_store_release(&asset->store);
    *asset = (kdr_gltf_asset){0};
}

static uint32_t bytes_of(uint32_t component) {
    return component == KDR_GLTF_FLOAT || component == KDR_GLTF_UINT     ? 4
           : component == KDR_GLTF_USHORT || component == KDR_GLTF_SHORT ? 2
                                                                         : 1;
}

uint32_t kdr_gltf_whole(const kdr_gltf_values *values, size_t element, uint32_t component) {
    uint32_t bytes = bytes_of(values->component), whole = 0;
    const unsigned char *p = values->bytes + element * values->stride + (size_t)component * bytes;
    for (uint32_t k = 0; k < bytes; k++)
        whole |= (uint32_t)p[k] << 8 * k;
    return whole;
}

static float float_at(const unsigned char *p) {
    uint32_t bits = (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

float kdr_gltf_number(const kdr_gltf_values *values, size_t element, uint32_t component) {
    if (values->component == KDR_GLTF_FLOAT)
        return float_at(values->bytes + element * values->stride + 4 * (size_t)component);
    uint32_t whole = kdr_gltf_whole(values, element, component);
    float most = 1, number = (float)whole;
    switch (values->component) {
    case KDR_GLTF_UBYTE: most = 255; break;
    case KDR_GLTF_USHORT: most = 65535; break;
    case KDR_GLTF_BYTE:
        number = (float)(int8_t)whole;
        most = 127;
        break;
    case KDR_GLTF_SHORT:
        number = (float)(int16_t)whole;
        most = 32767;
        break;
    default: break;
    }
    return values->is_normalized ? fmaxf(number / most, -1) : number;
}

void kdr_gltf_vector(const kdr_gltf_values *values, size_t element, float out[3]) {
    if (values->component == KDR_GLTF_FLOAT) {
        const unsigned char *p = values->bytes + element * values->stride;
        for (int axis = 0; axis < 3; axis++)
            out[axis] = float_at(p + 4 * axis);
        return;
    }
    for (uint32_t axis = 0; axis < 3; axis++)
        out[axis] = kdr_gltf_number(values, element, axis);
}

/* A dense copy: the view's values or zeros, and the sparse ones over them. */
static kdr_status merge_sparse(kdr_gltf_asset *asset, const kdr_json_value *sparse, kdr_gltf_values *values) {
    const kdr_gltf *gltf = &asset->gltf;
    size_t bytes = (size_t)bytes_of(values->component) * (values->width == 5 ? 4 : values->width);
    uint64_t wanted = values->count * (uint64_t)bytes;
    asset->dense_bytes += wanted;
    if (asset->dense_bytes > MOST_DENSE_TIMES * (gltf->source->length + asset->buffer_bytes) + MOST_DENSE_BYTES)
        return kdr_source_fail(gltf->source, KDR_ERROR_LIMIT,
                               "byte %zu: expected sparse accessors of a size that suits the file", sparse->byte);
    unsigned char *dense = kdr_gltf_take(&asset->store, values->count, bytes);
    if (!dense)
        return out_of_memory(asset);
    for (size_t i = 0; values->bytes && i < values->count; i++)
        memcpy(dense + i * bytes, values->bytes + i * values->stride, bytes);

    // Places and sizes were checked with the accessor: what is left to check are the indices themselves.
    const kdr_json_value *parts[2] = {kdr_gltf_find(asset, sparse, "indices"), kdr_gltf_find(asset, sparse, "values")};
    const unsigned char *starts[2];
    size_t strides[2];
    uint64_t count = 0, component = 0;
    kdr_status status = kdr_gltf_read_whole(gltf, sparse, "count", UINT32_MAX, 0, &count);
    if (status == KDR_OK)
        status = kdr_gltf_read_whole(gltf, parts[0], "componentType", UINT32_MAX, 0, &component);
    for (int i = 0; i < 2 && status == KDR_OK; i++) {
        uint32_t number = 0;
        uint64_t offset = 0;
        status = kdr_gltf_read_reference(gltf, parts[i], "bufferView", KDR_GLTF_VIEWS, &number);
        if (status == KDR_OK)
            status = kdr_gltf_read_whole(gltf, parts[i], "byteOffset", UINT32_MAX, 0, &offset);
        if (status != KDR_OK)
            break;
        const kdr_gltf_view *view = &gltf->views[number];
        starts[i] = asset->buffers[view->buffer] + view->offset + offset;
        strides[i] = view->stride ? view->stride : i ? bytes : bytes_of((uint32_t)component);
    }
    if (status != KDR_OK)
        return status;
    const kdr_gltf_values indices = {starts[0], count, strides[0], (uint32_t)component, 1, false};
    for (size_t i = 0; i < count; i++) {
        uint32_t to = kdr_gltf_whole(&indices, i, 0);
        if (to >= values->count)
            return kdr_gltf_fail(gltf, sparse, "sparse indices below the accessor's count");
        memcpy(dense + to * bytes, starts[1] + i * strides[1], bytes);
    }
    values->bytes = dense;
    values->stride = bytes;
    return KDR_OK;
}

static bool are_finite(const kdr_gltf_values *values) {
    for (size_t i = 0; i < values->count; i++)
        for (uint32_t k = 0; k < (values->width == 5 ? 4 : values->width); k++)
            if (!isfinite(kdr_gltf_number(values, i, k)))
                return false;
    return true;
}

kdr_status kdr_gltf_open_values(kdr_gltf_asset *asset, uint32_t accessor) {
    if (asset->values[accessor].bytes)
        return KDR_OK;
    const kdr_gltf_accessor *from = &asset->gltf.accessors[accessor];
    const kdr_json_value *object = asset->objects[KDR_GLTF_ACCESSORS][accessor];
    const kdr_json_value *flag = kdr_gltf_find(asset, object, "normalized");
    kdr_gltf_values values = {NULL, from->count, from->stride, from->component, from->width, false};
    values.is_normalized = flag && flag->kind == KDR_JSON_BOOL && asset->gltf.source->bytes[flag->byte] == 't';
    if (from->view != KDR_INVALID_ID) {
        const kdr_gltf_view *view = &asset->gltf.views[from->view];
        values.bytes = asset->buffers[view->buffer] + view->offset + from->offset;
    }
    const kdr_json_value *sparse = kdr_gltf_find(asset, object, "sparse");
    kdr_status status = sparse ? merge_sparse(asset, sparse, &values) : KDR_OK;
    if (status == KDR_OK && values.component == KDR_GLTF_FLOAT && !are_finite(&values))
        status = kdr_gltf_fail(&asset->gltf, object, "an accessor of finite numbers, found one that is not");
    if (status == KDR_OK)
        asset->values[accessor] = values;
    return status;
}

kdr_status kdr_gltf_read_numbers(const kdr_gltf_asset *asset, const kdr_json_value *object, const char *key,
                                 size_t count, const double *otherwise, double *out) {
    const kdr_json_value *array = kdr_gltf_find(asset, object, key);
    if (!array) {
        for (size_t i = 0; i < count; i++)
            out[i] = otherwise[i];
        return KDR_OK;
    }
    if (array->kind != KDR_JSON_ARRAY || array->count != count)
        return kdr_source_fail_byte(asset->gltf.source, array->byte, "expected '%s' to be %zu numbers", key, count);
    const kdr_json_value *one = kdr_json_first(&asset->gltf.json, array);
    for (; one; one = kdr_json_next(&asset->gltf.json, one)) {
        if (one->kind != KDR_JSON_NUMBER || !isfinite((float)one->number))
            return kdr_source_fail_byte(asset->gltf.source, one->byte, "expected a finite number in '%s'", key);
        *out++ = one->number;
    }
    return KDR_OK;
}
