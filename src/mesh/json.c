/* Source: T. Bray, "The JavaScript Object Notation (JSON) Data Interchange Format", RFC 8259, 2017. One pass, with the
 * open arrays and objects on a stack of fixed depth. */
#include "mesh/json.h"

#include "mesh/mesh_memory.h"

#include <string.h>

typedef struct reading {
    const kdr_source *source;
    kdr_json *json;
    const char *p, *end;
    uint32_t open[KDR_JSON_MAX_DEPTH]; /* arrays and objects around p */
    uint32_t last[KDR_JSON_MAX_DEPTH]; /* the newest value in each; 0: none */
    size_t depth;
} reading;

static size_t byte_at(const reading *in) { return (size_t)(in->p - (const char *)in->source->bytes); }

static kdr_status fail(const reading *in, const char *expected) {
    const kdr_text text = {in->p, in->end, 0, false};
    char found[KDR_TEXT_FOUND_BYTES];
    return kdr_source_fail_byte(in->source, byte_at(in), "expected %s, found %s", expected,
                                kdr_text_found(&text, found));
}

static void skip_blanks(reading *in) {
    while (in->p < in->end && (*in->p == ' ' || *in->p == '\t' || *in->p == '\n' || *in->p == '\r'))
        in->p++;
}

static bool take(reading *in, char c) {
    skip_blanks(in);
    if (in->p == in->end || *in->p != c)
        return false;
    in->p++;
    return true;
}

static bool take_name(reading *in, const char *name) {
    size_t length = strlen(name);
    if ((size_t)(in->end - in->p) < length || memcmp(in->p, name, length) != 0)
        return false;
    in->p += length;
    return true;
}

static kdr_status read_string(reading *in, kdr_word *out) {
    if (!take(in, '"'))
        return fail(in, "a string");
    const char *start = in->p;
    while (in->p < in->end && *in->p != '"') {
        if ((unsigned char)*in->p < 0x20)
            return fail(in, "a string without control characters");
        in->p += *in->p == '\\' && in->end - in->p > 1 ? 2 : 1;
    }
    if (in->p >= in->end) {
        in->p = in->end;
        return fail(in, "the end of a string");
    }
    *out = (kdr_word){start, (size_t)(in->p - start)};
    in->p++;
    return KDR_OK;
}

/* Appends a value to what is open and links it there. */
static kdr_status add_value(reading *in, kdr_word key, uint32_t *out) {
    kdr_json *json = in->json;
    size_t kept = json->count * sizeof(kdr_json_value);
    if (json->count >= UINT32_MAX || !kdr_mesh_buffer_grow(&json->memory, kept, kept + sizeof(kdr_json_value)))
        return kdr_source_fail_status(in->source, KDR_ERROR_OUT_OF_MEMORY);
    json->values = json->memory.memory;
    uint32_t number = (uint32_t)json->count++;
    json->values[number] = (kdr_json_value){.key = key, .byte = byte_at(in)};
    if (in->depth) {
        uint32_t *last = &in->last[in->depth - 1];
        kdr_json_value *around = &json->values[in->open[in->depth - 1]];
        *(*last ? &json->values[*last].next : &around->first) = number;
        around->count++;
        *last = number;
    }
    *out = number;
    return KDR_OK;
}

/* A value up to its end, or up to the beginning of its contents if it is an array or object. */
static kdr_status read_value(reading *in, kdr_word key) {
    skip_blanks(in);
    uint32_t number = 0;
    kdr_status status = add_value(in, key, &number);
    if (status != KDR_OK)
        return status;
    kdr_json_value *value = &in->json->values[number];
    char c = in->p < in->end ? *in->p : '\0';
    if (c == '{' || c == '[') {
        if (in->depth == KDR_JSON_MAX_DEPTH)
            return kdr_source_fail(in->source, KDR_ERROR_LIMIT, "byte %zu: JSON is more than %d levels deep",
                                   byte_at(in), KDR_JSON_MAX_DEPTH);
        value->kind = c == '{' ? KDR_JSON_OBJECT : KDR_JSON_ARRAY;
        in->p++;
        in->open[in->depth] = number;
        in->last[in->depth++] = 0;
    } else if (c == '"') {
        value->kind = KDR_JSON_STRING;
        return read_string(in, &value->text);
    } else if (c == '-' || (c >= '0' && c <= '9')) {
        value->kind = KDR_JSON_NUMBER;
        if (!kdr_number_read_double(&in->p, in->end, &value->number))
            return fail(in, "a number");
    } else if (take_name(in, "true") || take_name(in, "false")) {
        value->kind = KDR_JSON_BOOL;
    } else if (!take_name(in, "null")) {
        return fail(in, "a JSON value");
    }
    return KDR_OK;
}

/* Closes what ends at p; true when a further value must follow inside what is open. */
static kdr_status close_open(reading *in, bool *has_more) {
    bool is_first = in->depth && !in->last[in->depth - 1];
    for (;;) {
        *has_more = false;
        if (in->depth == 0)
            return KDR_OK;
        bool is_object = in->json->values[in->open[in->depth - 1]].kind == KDR_JSON_OBJECT;
        if (!take(in, is_object ? '}' : ']')) {
            *has_more = true;
            if (is_first || take(in, ','))
                return KDR_OK;
            return fail(in, is_object ? "',' or '}'" : "',' or ']'");
        }
        in->depth--;
        is_first = false;
    }
}

kdr_status kdr_json_read(const kdr_source *source, size_t begin, size_t end, kdr_json *out) {
    *out = (kdr_json){0};
    const char *start = (const char *)source->bytes;
    reading in = {.source = source, .json = out, .p = start + begin, .end = start + end};
    bool has_more = true;
    kdr_status status = KDR_OK;
    while (status == KDR_OK && has_more) {
        kdr_word key = {NULL, 0};
        if (in.depth && out->values[in.open[in.depth - 1]].kind == KDR_JSON_OBJECT) {
            status = read_string(&in, &key);
            if (status == KDR_OK && key.length && memmem(key.start, key.length, "\\u", 2))
                status = fail(&in, "a name without \\u before this"); // it could spell a name that is looked for
            if (status == KDR_OK && !take(&in, ':'))
                status = fail(&in, "':'");
        }
        if (status == KDR_OK)
            status = read_value(&in, key);
        if (status == KDR_OK)
            status = close_open(&in, &has_more);
    }
    skip_blanks(&in);
    if (status == KDR_OK && in.p < in.end && *in.p != '\0')
        status = fail(&in, "the end of the JSON");
    return status;
}

void kdr_json_release(kdr_json *json) {
    kdr_buffer_release(kdr_mesh_memory(), &json->memory);
    *json = (kdr_json){0};
}

const kdr_json_value *kdr_json_first(const kdr_json *json, const kdr_json_value *value) {
    return value && value->first ? &json->values[value->first] : NULL;
}

const kdr_json_value *kdr_json_next(const kdr_json *json, const kdr_json_value *value) {
    return value && value->next ? &json->values[value->next] : NULL;
}

const kdr_json_value *kdr_json_find(const kdr_json *json, const kdr_json_value *object, const char *key) {
    if (!object || object->kind != KDR_JSON_OBJECT)
        return NULL;
    const kdr_json_value *value = kdr_json_first(json, object);
    while (value && !kdr_word_is(value->key, key))
        value = kdr_json_next(json, value);
    return value;
}
