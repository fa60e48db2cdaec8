#include "json.h"
#include "utf8.h"

#include <inttypes.h>
#include <math.h>

static void put_text(FILE *file, const char *given) {
    const unsigned char *text = (const unsigned char *)given;
    fputc('"', file);
    while (*text) {
        int length = kdr_utf8_length(text);
        if (length == 0) {
            fputs("\\ufffd", file);
            text++;
        } else if (length > 1) {
            fwrite(text, 1, (size_t)length, file);
            text += length;
        } else {
            if (*text == '"' || *text == '\\')
                fprintf(file, "\\%c", *text);
            else if (*text < 0x20 || *text == 0x7f)
                fprintf(file, "\\u%04x", *text);
            else
                fputc(*text, file);
            text++;
        }
    }
    fputc('"', file);
}

/* Goes to where the next member begins, and names it. */
static void put_name(kdr_json *json, const char *name) {
    if (!json->first)
        fputc(',', json->file);
    json->first = false;
    fprintf(json->file, "\n%*s", 2 * json->depth, "");
    if (name) {
        put_text(json->file, name);
        fputs(": ", json->file);
    }
}

static void open_bracket(kdr_json *json, char bracket) {
    fputc(bracket, json->file);
    json->depth++;
    json->first = true;
}

kdr_json kdr_json_begin(FILE *file) {
    kdr_json json = {.file = file};
    open_bracket(&json, '{');
    return json;
}

void kdr_json_end(kdr_json *json) {
    kdr_json_close(json, '}');
    fputc('\n', json->file);
}

kdr_json kdr_json_begin_list(FILE *file) {
    kdr_json json = {.file = file};
    open_bracket(&json, '[');
    return json;
}

void kdr_json_end_list(kdr_json *json) {
    kdr_json_close(json, ']');
    fputc('\n', json->file);
}

void kdr_json_object(kdr_json *json, const char *name) {
    put_name(json, name);
    open_bracket(json, '{');
}

void kdr_json_array(kdr_json *json, const char *name) {
    put_name(json, name);
    open_bracket(json, '[');
}

void kdr_json_close(kdr_json *json, char bracket) {
    json->depth--;
    if (!json->first)
        fprintf(json->file, "\n%*s", 2 * json->depth, "");
    fputc(bracket, json->file);
    json->first = false;
}

void kdr_json_text(kdr_json *json, const char *name, const char *text) {
    put_name(json, name);
    if (text)
        put_text(json->file, text);
    else
        fputs("null", json->file);
}

void kdr_json_whole(kdr_json *json, const char *name, uint64_t value) {
    put_name(json, name);
    fprintf(json->file, "%" PRIu64, value);
}

static void put_real(FILE *file, double value, int digits) {
    if (isfinite(value))
        fprintf(file, "%.*g", digits, value);
    else
        fputs("null", file);
}

void kdr_json_real(kdr_json *json, const char *name, double value) {
    put_name(json, name);
    put_real(json->file, value, 10);
}

void kdr_json_wholes(kdr_json *json, const char *name, const uint64_t *values, size_t count) {
    put_name(json, name);
    fputc('[', json->file);
    for (size_t i = 0; i < count; i++)
        fprintf(json->file, "%s%" PRIu64, i ? ", " : "", values[i]);
    fputc(']', json->file);
}

void kdr_json_floats(kdr_json *json, const char *name, const float *values, size_t count) {
    put_name(json, name);
    fputc('[', json->file);
    for (size_t i = 0; i < count; i++) {
        fputs(i ? ", " : "", json->file);
        put_real(json->file, (double)values[i], 9); // enough to read the same float back
    }
    fputc(']', json->file);
}
