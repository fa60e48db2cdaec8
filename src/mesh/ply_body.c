#include "mesh/ply_body.h"

#include "mesh/report.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

kdr_status kdr_ply_fail(const kdr_ply_body *body, const char *format, ...) {
    char text[KDR_REPORT_BYTES];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (body->header->is_ascii)
        return kdr_source_fail_line(body->source, body->text.line, "%s", text);
    return kdr_source_fail_byte(body->source, (size_t)(body->p - body->source->bytes), "%s", text);
}

size_t kdr_ply_bytes_left(const kdr_ply_body *body) {
    return body->header->is_ascii ? (size_t)(body->text.end - body->text.p) : (size_t)(body->end - body->p);
}

static int print_length(kdr_word word) { return word.length < 40 ? (int)word.length : 40; }

kdr_status kdr_ply_check_room(const kdr_ply_body *body, const kdr_ply_element *element) {
    bool is_ascii = body->header->is_ascii;
    size_t left = kdr_ply_bytes_left(body), row = is_ascii ? 2 * element->property_count : element->least_bytes;
    size_t room = is_ascii ? left + 1 : left; // the last number needs no separator
    if (row == 0 || element->count <= room / row)
        return KDR_OK;
    return kdr_ply_fail(body, "expected %llu rows of '%.*s', %zu bytes or more each; %zu bytes are left of the file",
                        (unsigned long long)element->count, print_length(element->name), element->name.start,
                        is_ascii ? row - 1 : row, left);
}

kdr_status kdr_ply_begin_row(kdr_ply_body *body, const kdr_ply_element *element, uint64_t row) {
    if (!body->header->is_ascii || kdr_text_skip_blank_lines(&body->text))
        return KDR_OK;
    return kdr_ply_fail(body, "expected row %llu of %llu of '%.*s', found the end of the file",
                        (unsigned long long)row + 1, (unsigned long long)element->count, print_length(element->name),
                        element->name.start);
}

kdr_status kdr_ply_end_row(kdr_ply_body *body) {
    if (!body->header->is_ascii)
        return KDR_OK;
    char found[KDR_TEXT_FOUND_BYTES];
    if (!kdr_text_at_line_end(&body->text))
        return kdr_ply_fail(body, "expected the end of the line, found %s", kdr_text_found(&body->text, found));
    kdr_text_next_line(&body->text);
    return KDR_OK;
}

double kdr_ply_decode(const unsigned char *p, kdr_ply_type type, bool swaps) {
    size_t bytes = kdr_ply_type_bytes(type);
    unsigned char native[8];
    if (swaps)
        for (size_t i = 0; i < bytes; i++)
            native[i] = p[bytes - 1 - i];
    else
        memcpy(native, p, bytes);

    int8_t i8;
    int16_t i16;
    uint16_t u16;
    int32_t i32;
    uint32_t u32;
    float f32;
    double f64;
    switch (type) {
    case KDR_PLY_INT8: memcpy(&i8, native, sizeof i8); return i8;
    case KDR_PLY_UINT8: return native[0];
    case KDR_PLY_INT16: memcpy(&i16, native, sizeof i16); return i16;
    case KDR_PLY_UINT16: memcpy(&u16, native, sizeof u16); return u16;
    case KDR_PLY_INT32: memcpy(&i32, native, sizeof i32); return i32;
    case KDR_PLY_UINT32: memcpy(&u32, native, sizeof u32); return u32;
    case KDR_PLY_FLOAT32: memcpy(&f32, native, sizeof f32); return (double)f32;
    case KDR_PLY_FLOAT64: memcpy(&f64, native, sizeof f64); return f64;
    }
    return 0;
}

kdr_status kdr_ply_read_value(kdr_ply_body *body, kdr_ply_type type, double *out) {
    if (body->header->is_ascii) {
        if (kdr_text_take_double(&body->text, out))
            return KDR_OK;
        char found[KDR_TEXT_FOUND_BYTES];
        return kdr_ply_fail(body, "expected a number, found %s", kdr_text_found(&body->text, found));
    }
    size_t bytes = kdr_ply_type_bytes(type);
    if ((size_t)(body->end - body->p) < bytes)
        return kdr_ply_fail(body, "expected a number of %zu bytes, found the end of the file", bytes);
    *out = kdr_ply_decode(body->p, type, body->swaps);
    body->p += bytes;
    return KDR_OK;
}

kdr_status kdr_ply_read_count(kdr_ply_body *body, const kdr_ply_property *list, size_t *out) {
    const kdr_ply_body before = *body;
    double count;
    kdr_status status = kdr_ply_read_value(body, list->count_type, &count);
    if (status != KDR_OK)
        return status;
    double most = body->header->is_ascii ? (double)kdr_ply_bytes_left(body) / 2
                                         : (double)kdr_ply_bytes_left(body) / (double)kdr_ply_type_bytes(list->type);
    bool is_whole = count >= 0 && count < 4294967296.0 && count == (double)(uint64_t)count;
    if (!is_whole)
        return kdr_ply_fail(&before, "expected the count of a list, found %g", count);
    if (count > most)
        return kdr_ply_fail(&before, "expected a list of %.0f values, %zu bytes are left of the file", count,
                            kdr_ply_bytes_left(body));
    *out = (size_t)count;
    return KDR_OK;
}

kdr_status kdr_ply_skip_property(kdr_ply_body *body, const kdr_ply_property *property) {
    double unused;
    if (!property->is_list)
        return kdr_ply_read_value(body, property->type, &unused);
    size_t count;
    kdr_status status = kdr_ply_read_count(body, property, &count);
    if (status == KDR_OK && !body->header->is_ascii) {
        body->p += count * kdr_ply_type_bytes(property->type);
        return KDR_OK;
    }
    for (size_t i = 0; i < count && status == KDR_OK; i++)
        status = kdr_ply_read_value(body, property->type, &unused);
    return status;
}

kdr_status kdr_ply_skip_element(kdr_ply_body *body, const kdr_ply_element *element) {
    kdr_status status = kdr_ply_check_room(body, element);
    if (status != KDR_OK || element->property_count == 0)
        return status;
    if (!body->header->is_ascii && element->list_count == 0) {
        body->p += element->count * element->least_bytes;
        return KDR_OK;
    }
    for (uint64_t row = 0; row < element->count && status == KDR_OK; row++) {
        status = kdr_ply_begin_row(body, element, row);
        for (size_t i = 0; i < element->property_count && status == KDR_OK; i++)
            status = kdr_ply_skip_property(body, &element->properties[i]);
        if (status == KDR_OK)
            status = kdr_ply_end_row(body);
    }
    return status;
}
