#include "mesh/source.h"

#include "mesh/report.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

/* Formats the rest of a sentence into `text`. */
#define FORMAT_REST(text, format)                                                                                      \
    do {                                                                                                               \
        va_list arguments;                                                                                             \
        va_start(arguments, format);                                                                                   \
        vsnprintf(text, sizeof(text), format, arguments);                                                              \
        va_end(arguments);                                                                                             \
    } while (0)

kdr_status kdr_source_fail_line(const kdr_source *source, size_t line, const char *format, ...) {
    char text[KDR_REPORT_BYTES];
    FORMAT_REST(text, format);
    return kdr_report(source->logger, KDR_ERROR_INVALID_DATA, "%s: line %zu: %s", source->name, line, text);
}

kdr_status kdr_source_fail_byte(const kdr_source *source, size_t byte, const char *format, ...) {
    char text[KDR_REPORT_BYTES];
    FORMAT_REST(text, format);
    return kdr_report(source->logger, KDR_ERROR_INVALID_DATA, "%s: byte %zu: %s", source->name, byte, text);
}

kdr_status kdr_source_fail(const kdr_source *source, kdr_status status, const char *format, ...) {
    char text[KDR_REPORT_BYTES];
    FORMAT_REST(text, format);
    return kdr_report(source->logger, status, "%s: %s", source->name, text);
}

void kdr_source_warn(const kdr_source *source, const char *format, ...) {
    char text[KDR_REPORT_BYTES];
    FORMAT_REST(text, format);
    kdr_report_warning(source->logger, "%s: %s", source->name, text);
}

kdr_status kdr_source_fail_status(const kdr_source *source, kdr_status status) {
    if (status == KDR_ERROR_OUT_OF_MEMORY)
        return kdr_source_fail(source, status, "out of memory while reading");
    if (status == KDR_ERROR_LIMIT)
        return kdr_source_fail(source, status, "more than 2^32 - 2 vertices, triangles or materials");
    return status;
}

bool kdr_source_has_ending(const kdr_source *source, const char *ending) {
    size_t length = strlen(source->name), ending_length = strlen(ending);
    if (length > 3 && strncasecmp(source->name + length - 3, ".gz", 3) == 0)
        length -= 3;
    return length > ending_length && source->name[length - ending_length - 1] == '.' &&
           strncasecmp(source->name + length - ending_length, ending, ending_length) == 0;
}
