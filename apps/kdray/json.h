/* JSON, written as it comes: objects and arrays of members, indented, with commas where they belong. Text is escaped to
 * ASCII-safe JSON: bytes that are not UTF-8 become U+FFFD; numbers that are not finite become null. Errors stay with
 * the file: ask ferror. */
#ifndef KDR_APPS_KDRAY_JSON_H
#define KDR_APPS_KDRAY_JSON_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

typedef struct kdr_json {
    FILE *file;
    int depth;
    bool first; /* nothing stands yet in the innermost object or array */
} kdr_json;

/* Opens the outermost object; kdr_json_end closes it. */
kdr_json kdr_json_begin(FILE *file);
void kdr_json_end(kdr_json *json);

/* The same for a list. */
kdr_json kdr_json_begin_list(FILE *file);
void kdr_json_end_list(kdr_json *json);

/* A member of the innermost object, or, with name NULL, of the innermost array. */
void kdr_json_object(kdr_json *json, const char *name);
void kdr_json_array(kdr_json *json, const char *name);
void kdr_json_close(kdr_json *json, char bracket);                      /* '}' or ']' */
void kdr_json_text(kdr_json *json, const char *name, const char *text); /* text NULL: null */
void kdr_json_whole(kdr_json *json, const char *name, uint64_t value);
void kdr_json_real(kdr_json *json, const char *name, double value);
void kdr_json_wholes(kdr_json *json, const char *name, const uint64_t *values, size_t count);
void kdr_json_floats(kdr_json *json, const char *name, const float *values, size_t count);

#endif
