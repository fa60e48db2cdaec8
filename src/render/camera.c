/* Cameras made for a model, or read from a file. */
#include "kdray/render.h"

#include "mesh/report.h"

#include <errno.h>
#include <fcntl.h>
#include <float.h>
#include <locale.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- three quarters from above */

typedef struct model_frame {
    double centre[3];
    double diagonal; /* > 0, and large enough beside the centre to move a float */
} model_frame;

static model_frame frame_of(const float bounds[6]) {
    model_frame frame = {{0, 0, 0}, 0};
    double magnitude = 0;
    for (int k = 0; k < 3; k++) {
        double lo = bounds[k], hi = bounds[k + 3];
        // No model: a unit cube's worth of room around the origin.
        if (!(lo <= hi) || !isfinite(lo) || !isfinite(hi))
            return (model_frame){{0, 0, 0}, 1};
        frame.centre[k] = (lo + hi) / 2;
        frame.diagonal += (hi - lo) * (hi - lo);
        magnitude = fmax(magnitude, fmax(fabs(lo), fabs(hi)));
    }
    frame.diagonal = fmax(sqrt(frame.diagonal), magnitude * 1e-5);
    if (!(frame.diagonal > FLT_MIN))
        frame.diagonal = 1;
    return frame;
}

static float to_float(double value) { return (float)fmin(fmax(value, -(double)FLT_MAX), (double)FLT_MAX); }

kdr_camera kdr_camera_for_bounds(const float bounds[6]) {
    static const double way[3] = {0.35, 0.25, 0.9};
    double length = sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2]);
    model_frame frame = frame_of(bounds);
    kdr_camera camera = {.up = {0, 1, 0}, .fov = 45};
    for (int k = 0; k < 3; k++) {
        camera.eye[k] = to_float(frame.centre[k] + 0.95 * frame.diagonal * way[k] / length);
        camera.target[k] = to_float(frame.centre[k]);
    }
    return camera;
}

void kdr_light_for_bounds(const float bounds[6], float light[3]) {
    static const double way[3] = {0.8, 1.5, 0.8};
    model_frame frame = frame_of(bounds);
    for (int k = 0; k < 3; k++)
        light[k] = to_float(frame.centre[k] + frame.diagonal * way[k]);
}

/* ---- camera files */

#define NUMBER_COUNT 13
#define FILE_LIMIT 4096 /* bytes; 13 numbers need far less */

static const char *const number_names[NUMBER_COUNT] = {"eye x", "eye y", "eye z", "target x", "target y", "target z",
                                                       "up x", "up y", "up z", "field of view", "light x", "light y",
                                                       "light z"};

/* Reads at most `limit` bytes and ends them with a zero byte. Their count, or -1 and errno. */
static ssize_t read_text(const char *path, char *text, size_t limit) {
    int file = open(path, O_RDONLY | O_CLOEXEC);
    if (file < 0)
        return -1;
    size_t size = 0;
    ssize_t count = 0;
    while (size < limit) {
        count = read(file, text + size, limit - size);
        if (count < 0 && errno == EINTR)
            continue;
        if (count <= 0)
            break;
        size += (size_t)count;
    }
    int number = errno;
    close(file);
    errno = number;
    text[size] = 0;
    return count < 0 ? -1 : (ssize_t)size;
}

static const char *skip_space(const char *at) { return at + strspn(at, " \t\r\n"); }

/* The first characters of a word, for a sentence; bytes that do not print become question marks. */
static void quote(const char *at, char out[20]) {
    size_t length = strcspn(at, " \t\r\n");
    if (length == 0) {
        strcpy(out, "the end");
        return;
    }
    length = length < 16 ? length : 16;
    out[0] = '"';
    for (size_t i = 0; i < length; i++)
        out[i + 1] = at[i] >= ' ' && at[i] <= '~' ? at[i] : '?';
    out[length + 1] = '"';
    out[length + 2] = 0;
}

static kdr_status parse(const char *path, const char *text, const kdr_logger *logger, float numbers[NUMBER_COUNT]) {
    locale_t plain = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (!plain)
        return KDR_ERROR_OUT_OF_MEMORY;
    const char *at = text;
    char found[20];
    kdr_status status = KDR_OK;
    for (int i = 0; i < NUMBER_COUNT && status == KDR_OK; i++) {
        at = skip_space(at);
        char *end;
        numbers[i] = strtof_l(at, &end, plain);
        if (end == at || !isfinite(numbers[i]) || (*end && !strchr(" \t\r\n", *end))) {
            quote(at, found);
            status = kdr_report(logger, KDR_ERROR_INVALID_DATA,
                                "%s: expected a finite number for %s (number %d of %d), found %s", path,
                                number_names[i], i + 1, NUMBER_COUNT, found);
        }
        at = end;
    }
    freelocale(plain);
    if (status != KDR_OK)
        return status;
    at = skip_space(at);
    if (*at) {
        quote(at, found);
        return kdr_report(logger, KDR_ERROR_INVALID_DATA, "%s: expected the end after %d numbers, found %s", path,
                          NUMBER_COUNT, found);
    }
    if (!(numbers[9] > 0 && numbers[9] < 180))
        return kdr_report(logger, KDR_ERROR_INVALID_DATA,
                          "%s: expected a field of view between 0 and 180 degrees (number 10 of %d), found %g", path,
                          NUMBER_COUNT, (double)numbers[9]);
    return KDR_OK;
}

kdr_status kdr_camera_read(const char *path, const kdr_logger *logger, kdr_camera *camera, float light[3]) {
    if (!path || !camera || !light)
        return kdr_report(logger, KDR_ERROR_INVALID_ARGUMENT,
                          "reading a camera needs a file name and room for a camera and a light");
    char text[FILE_LIMIT + 1];
    ssize_t size = read_text(path, text, FILE_LIMIT);
    if (size < 0) {
        char words[128];
        return kdr_report(logger, KDR_ERROR_IO, "%s: %s", path, strerror_r(errno, words, sizeof(words)));
    }
    if (size == FILE_LIMIT || memchr(text, 0, (size_t)size))
        return kdr_report(logger, KDR_ERROR_INVALID_DATA, "%s: expected one line of %d numbers, found other data", path,
                          NUMBER_COUNT);

    float numbers[NUMBER_COUNT];
    kdr_status status = parse(path, text, logger, numbers);
    if (status != KDR_OK)
        return status;
    memcpy(camera->eye, numbers, sizeof(camera->eye));
    memcpy(camera->target, numbers + 3, sizeof(camera->target));
    memcpy(camera->up, numbers + 6, sizeof(camera->up));
    camera->fov = numbers[9];
    memcpy(light, numbers + 10, 3 * sizeof(float));
    return KDR_OK;
}
