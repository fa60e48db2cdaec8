#include "mesh/builtin.h"

#include "mesh/number.h"
#include "mesh/report.h"

#include <math.h>
#include <string.h>

#define BUILTIN "builtin:"

bool kdr_builtin_is_meant(const char *path) { return strncmp(path, BUILTIN, strlen(BUILTIN)) == 0; }

kdr_status kdr_builtin_parse(const char *path, const kdr_logger *logger, kdr_builtin *out) {
    const char *text = path + strlen(BUILTIN);
    size_t length = strcspn(text, ":");
    const char *p = text + length, *end = text + strlen(text);
    int64_t triangle_count = 0;
    double time = 0;
    bool is_sound = length < KDR_BUILTIN_NAME_SIZE;
    if (is_sound && *p == ':') {
        p++;
        is_sound = kdr_number_read_int(&p, end, &triangle_count) && triangle_count >= 0;
    }
    if (is_sound && *p == ':') {
        p++;
        is_sound = kdr_number_read_double(&p, end, &time) && isfinite(time);
    }
    if (!is_sound || p != end)
        return kdr_report(logger, KDR_ERROR_INVALID_ARGUMENT,
                          "%s: expected " BUILTIN "NAME, NAME:TRIANGLES or NAME:TRIANGLES:SECONDS", path);
    *out = (kdr_builtin){.triangle_count = (size_t)triangle_count, .time = time};
    memcpy(out->name, text, length);
    return KDR_OK;
}
