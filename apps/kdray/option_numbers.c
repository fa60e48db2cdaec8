#include "option_numbers.h"

#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define WORD_SIZE 64 /* bytes of the longest number that is read, with its end */

/* Reads digits, and nothing else, up to `end`. */
static bool read_whole(const char *text, const char *end, uint64_t *out) {
    if (text == end)
        return false;
    uint64_t value = 0;
    for (; text < end; text++) {
        if (*text < '0' || *text > '9' || __builtin_mul_overflow(value, 10u, &value) ||
            __builtin_add_overflow(value, (uint64_t)(*text - '0'), &value))
            return false;
    }
    *out = value;
    return true;
}

/* Reads a decimal number, and nothing else, up to `end`. The program keeps the C locale, so the point is a point. */
static bool read_real(const char *text, const char *end, double *out) {
    size_t length = (size_t)(end - text);
    char word[WORD_SIZE];
    if (length == 0 || length >= sizeof(word) || strspn(text, "0123456789+-.eE") < length)
        return false;
    memcpy(word, text, length);
    word[length] = 0;
    char *stop;
    *out = strtod(word, &stop);
    return *stop == 0 && isfinite(*out);
}

static bool read_float(const char *text, const char *end, float *out) {
    double value;
    if (!read_real(text, end, &value) || fabs(value) > FLT_MAX)
        return false;
    *out = (float)value;
    return true;
}

static const char *end_of(const char *text) { return text + strlen(text); }

uint64_t kdr_option_whole(struct argp_state *state, const char *option, const char *text, uint64_t min, uint64_t max) {
    uint64_t value = 0;
    if (!read_whole(text, end_of(text), &value) || value < min || value > max)
        argp_error(state, "%s: expected a whole number from %" PRIu64 " to %" PRIu64 ", found \"%.40s\"", option, min,
                   max, text);
    return value;
}

double kdr_option_between(struct argp_state *state, const char *option, const char *text, double min, double max) {
    double value = 0;
    if (!read_real(text, end_of(text), &value) || value < min || value > max)
        argp_error(state, "%s: expected a number from %g to %g, found \"%.40s\"", option, min, max, text);
    return value;
}

double kdr_option_inside(struct argp_state *state, const char *option, const char *text, double min, double max) {
    double value = 0;
    if (!read_real(text, end_of(text), &value) || !((float)value > min && (float)value < max))
        argp_error(state, "%s: expected a number above %g and below %g, found \"%.40s\"", option, min, max, text);
    return value;
}

float kdr_option_positive(struct argp_state *state, const char *option, const char *text, float max) {
    float value = 0;
    if (!read_float(text, end_of(text), &value) || value < FLT_MIN || value > max)
        argp_error(state, "%s: expected a number above 0 and at most %g, found \"%.40s\"", option, (double)max, text);
    return value;
}

void kdr_option_triple(struct argp_state *state, const char *option, const char *text, float out[3]) {
    const char *at = text;
    for (int k = 0; k < 3; k++) {
        const char *end = k < 2 ? strchr(at, ',') : end_of(at);
        if (!end || !read_float(at, end, &out[k])) {
            argp_error(state, "%s: expected three finite numbers X,Y,Z, found \"%.40s\"", option, text);
            return;
        }
        at = end + 1;
    }
}

void kdr_option_size(struct argp_state *state, const char *option, const char *text, uint32_t limit, uint32_t *width,
                     uint32_t *height) {
    const char *cross = strchr(text, 'x');
    uint64_t sides[2];
    if (!cross || !read_whole(text, cross, &sides[0]) || !read_whole(cross + 1, end_of(cross), &sides[1]) ||
        sides[0] < 1 || sides[0] > limit || sides[1] < 1 || sides[1] > limit) {
        argp_error(state, "%s: expected WIDTHxHEIGHT, each from 1 to %" PRIu32 ", found \"%.40s\"", option, limit,
                   text);
        return;
    }
    *width = (uint32_t)sides[0];
    *height = (uint32_t)sides[1];
}

void kdr_option_position(struct argp_state *state, const char *option, const char *text, uint32_t *axis, double *value,
                         bool *percent) {
    bool named = text[0] >= 'x' && text[0] <= 'z' && text[1] == '=';
    const char *number = named ? text + 2 : text, *end = end_of(number);
    *percent = end > number && end[-1] == '%';
    if (*percent)
        end--;
    if (!named || !read_real(number, end, value) || (*percent && (*value < 0 || *value > 100))) {
        argp_error(state,
                   "%s: expected AXIS=POSITION, such as x=2.5, or z=50%% for the middle of the box, found \"%.40s\"",
                   option, text);
        return;
    }
    *axis = (uint32_t)(text[0] - 'x');
}
