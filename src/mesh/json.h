/* JSON as a flat list of values: enough to check a file before a larger reader sees it. */
#ifndef KDR_MESH_JSON_H
#define KDR_MESH_JSON_H

#include "base/alloc.h"
#include "mesh/source.h"
#include "mesh/text.h"

/* Arrays and objects inside one another; more is refused. */
#define KDR_JSON_MAX_DEPTH 64

typedef enum kdr_json_kind {
    KDR_JSON_NULL,
    KDR_JSON_BOOL,
    KDR_JSON_NUMBER,
    KDR_JSON_STRING,
    KDR_JSON_ARRAY,
    KDR_JSON_OBJECT,
} kdr_json_kind;

typedef struct kdr_json_value {
    kdr_json_kind kind;
    uint32_t next;  /* the value after it in its array or object; 0: none */
    uint32_t first; /* of an array or object; 0: empty */
    uint32_t count; /* values in an array or object */
    kdr_word key;   /* in an object: the name as written, escapes and all */
    kdr_word text;  /* of a string, as written */
    double number;
    size_t byte; /* where it begins in the source */
} kdr_json_value;

/* Value 0 is the whole. Words point into the source. */
typedef struct kdr_json {
    kdr_json_value *values;
    size_t count;
    kdr_buffer memory;
} kdr_json;

/* Reads one value between two bytes of the source, with nothing but blanks around it. Errors: INVALID_DATA with the
 * byte, LIMIT (too deep), OUT_OF_MEMORY. Release in any case. */
kdr_status kdr_json_read(const kdr_source *source, size_t begin, size_t end, kdr_json *out);
void kdr_json_release(kdr_json *json);

/* The member of an object; NULL when there is none, or `object` is NULL or none. */
const kdr_json_value *kdr_json_find(const kdr_json *json, const kdr_json_value *object, const char *key);

/* The first value inside an array or object and the one after another; NULL: no more. value NULL is allowed. */
const kdr_json_value *kdr_json_first(const kdr_json *json, const kdr_json_value *value);
const kdr_json_value *kdr_json_next(const kdr_json *json, const kdr_json_value *value);

#endif
