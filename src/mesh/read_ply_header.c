/* PLY headers.
 *
 * Source: G. Turk, "The PLY Polygon File Format", 1994. A header is lines of words: `ply`, `format`, then elements,
 * each with its properties, until `end_header`; comments anywhere. Both families of type names are in use. */
#include "mesh/ply.h"

#include <string.h>

static const struct {
    const char *name, *sized_name;
    size_t bytes;
} types[] = {
    [KDR_PLY_INT8] = {"char", "int8", 1},        [KDR_PLY_UINT8] = {"uchar", "uint8", 1},
    [KDR_PLY_INT16] = {"short", "int16", 2},     [KDR_PLY_UINT16] = {"ushort", "uint16", 2},
    [KDR_PLY_INT32] = {"int", "int32", 4},       [KDR_PLY_UINT32] = {"uint", "uint32", 4},
    [KDR_PLY_FLOAT32] = {"float", "float32", 4}, [KDR_PLY_FLOAT64] = {"double", "float64", 8},
};

size_t kdr_ply_type_bytes(kdr_ply_type type) { return types[type].bytes; }

size_t kdr_ply_find_property(const kdr_ply_element *element, const char *name) {
    size_t i = 0;
    while (i < element->property_count && !kdr_word_is(element->properties[i].name, name))
        i++;
    return i;
}

/* Names that are printed are cut to this. */
static int print_length(kdr_word word) { return word.length < 40 ? (int)word.length : 40; }

static kdr_status read_type(const kdr_source *source, kdr_text *text, bool is_count, kdr_ply_type *out) {
    kdr_word word = kdr_text_take_word(text);
    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++) {
        if (!kdr_word_is(word, types[i].name) && !kdr_word_is(word, types[i].sized_name))
            continue;
        *out = (kdr_ply_type)i;
        if (is_count && *out >= KDR_PLY_FLOAT32)
            return kdr_source_fail_line(source, text->line, "expected a whole type for a list's count, found '%s'",
                                        types[i].name);
        return KDR_OK;
    }
    text->p = word.start;
    char found[KDR_TEXT_FOUND_BYTES];
    return kdr_source_fail_line(source, text->line,
                                "expected a type (char, uchar, short, ushort, int, uint, float, double), found %s",
                                kdr_text_found(text, found));
}

static kdr_status read_format(const kdr_source *source, kdr_text *text, kdr_ply_header *header) {
    char found[KDR_TEXT_FOUND_BYTES];
    kdr_word word = kdr_text_take_word(text);
    header->is_ascii = kdr_word_is(word, "ascii");
    header->is_big_endian = kdr_word_is(word, "binary_big_endian");
    if (!header->is_ascii && !header->is_big_endian && !kdr_word_is(word, "binary_little_endian")) {
        text->p = word.start;
        return kdr_source_fail_line(source, text->line,
                                    "expected ascii, binary_little_endian or binary_big_endian, found %s",
                                    kdr_text_found(text, found));
    }
    word = kdr_text_take_word(text);
    if (kdr_word_is(word, "1.0"))
        return KDR_OK;
    text->p = word.start;
    return kdr_source_fail(source, KDR_ERROR_UNSUPPORTED, "line %zu: expected PLY version 1.0, found %s", text->line,
                           kdr_text_found(text, found));
}

static kdr_status read_element(const kdr_source *source, kdr_text *text, kdr_ply_header *header) {
    if (header->element_count == KDR_PLY_MAX_ELEMENTS)
        return kdr_source_fail(source, KDR_ERROR_LIMIT, "line %zu: more than %d elements", text->line,
                               KDR_PLY_MAX_ELEMENTS);
    kdr_ply_element *element = &header->elements[header->element_count];
    *element = (kdr_ply_element){.line = text->line, .properties = header->properties + header->property_count};
    element->name = kdr_text_take_word(text);
    int64_t count;
    if (!kdr_text_take_int(text, &count) || count < 0) {
        char found[KDR_TEXT_FOUND_BYTES];
        return kdr_source_fail_line(source, text->line, "expected an element's name and count, found %s",
                                    kdr_text_found(text, found));
    }
    for (size_t i = 0; i < header->element_count; i++)
        if (header->elements[i].name.length == element->name.length &&
            memcmp(header->elements[i].name.start, element->name.start, element->name.length) == 0)
            return kdr_source_fail_line(source, text->line, "expected another element, '%.*s' stands on line %zu",
                                        print_length(element->name), element->name.start, header->elements[i].line);
    element->count = (uint64_t)count;
    header->element_count++;
    return KDR_OK;
}

static kdr_status read_property(const kdr_source *source, kdr_text *text, kdr_ply_header *header) {
    if (header->element_count == 0)
        return kdr_source_fail_line(source, text->line, "expected an element before its properties");
    if (header->property_count == KDR_PLY_MAX_PROPERTIES)
        return kdr_source_fail(source, KDR_ERROR_LIMIT, "line %zu: more than %d properties", text->line,
                               KDR_PLY_MAX_PROPERTIES);
    kdr_ply_element *element = &header->elements[header->element_count - 1];
    kdr_ply_property *property = &header->properties[header->property_count];
    *property = (kdr_ply_property){0};

    kdr_text ahead = *text;
    property->is_list = kdr_word_is(kdr_text_take_word(&ahead), "list");
    kdr_status status = KDR_OK;
    if (property->is_list) {
        *text = ahead;
        status = read_type(source, text, true, &property->count_type);
    }
    if (status == KDR_OK)
        status = read_type(source, text, false, &property->type);
    if (status != KDR_OK)
        return status;
    property->name = kdr_text_take_word(text);
    if (property->name.length == 0)
        return kdr_source_fail_line(source, text->line, "expected a property's name, found the end of the line");

    header->property_count++;
    element->property_count++;
    element->list_count += property->is_list;
    element->least_bytes += kdr_ply_type_bytes(property->is_list ? property->count_type : property->type);
    return KDR_OK;
}

kdr_status kdr_ply_read_header(const kdr_source *source, kdr_ply_header *header) {
    header->element_count = header->property_count = 0;
    const char *start = (const char *)source->bytes;
    kdr_text text = {start, start + source->length, 1, false};
    char found[KDR_TEXT_FOUND_BYTES];
    if (!kdr_word_is(kdr_text_take_word(&text), "ply"))
        return kdr_source_fail_line(source, 1, "expected 'ply' as the first word of a PLY file");

    // The first line shows how lines end: a binary body may begin with the byte of a line feed.
    bool ends_with_cr_alone = text.end - text.p > 1 && text.p[0] == '\r' && text.p[1] != '\n';
    bool has_format = false;
    for (;;) {
        if (!kdr_text_at_line_end(&text))
            return kdr_source_fail_line(source, text.line, "expected the end of the line, found %s",
                                        kdr_text_found(&text, found));
        if (!kdr_text_next_line(&text) || !kdr_text_skip_blank_lines(&text))
            return kdr_source_fail_line(source, text.line, "expected 'end_header', the file ends");

        kdr_word word = kdr_text_take_word(&text);
        kdr_status status = KDR_OK;
        if (kdr_word_is(word, "comment") || kdr_word_is(word, "obj_info")) {
            kdr_text_skip_rest(&text);
        } else if (kdr_word_is(word, "format")) {
            has_format = true;
            status = read_format(source, &text, header);
        } else if (kdr_word_is(word, "element")) {
            status = read_element(source, &text, header);
        } else if (kdr_word_is(word, "property")) {
            status = read_property(source, &text, header);
        } else if (kdr_word_is(word, "end_header")) {
            break;
        } else {
            text.p = word.start;
            status = kdr_source_fail_line(source, text.line,
                                          "expected comment, format, element, property or end_header, found %s",
                                          kdr_text_found(&text, found));
        }
        if (status != KDR_OK)
            return status;
    }
    if (!has_format)
        return kdr_source_fail_line(source, text.line, "expected a line 'format' before the end of the header");

    // The body begins right after the end of this line.
    kdr_text_skip_blanks(&text);
    if (text.p < text.end && !kdr_is_line_end(*text.p))
        return kdr_source_fail_line(source, text.line, "expected the end of the line after 'end_header', found %s",
                                    kdr_text_found(&text, found));
    if (text.p < text.end && ends_with_cr_alone) {
        text.p++;
        text.line++;
    } else {
        kdr_text_next_line(&text);
    }
    header->body = (size_t)(text.p - start);
    header->body_line = text.line;
    return KDR_OK;
}
