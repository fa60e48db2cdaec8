/* Cameras made for a model, or read from a file. */
#include "kdray/render.h"

#include "mesh/file_bytes.h"
#include "mesh/report.h"
#include "mesh/text.h"

#include <float.h>
#include <math.h>
#include <string.h>

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
#define FIELD_OF_VIEW 9

static const char *const number_names[NUMBER_COUNT] = {"eye x",    "eye y",   "eye z",  "target x", "target y",
                                                       "target z", "up x",    "up y",   "up z",     "field of view",
                                                       "light x",  "light y", "light z"};

/* Numbers may stand on several lines. */
static kdr_status parse(const char *path, kdr_text text, const kdr_logger *logger, float numbers[NUMBER_COUNT]) {
    char found[KDR_TEXT_FOUND_BYTES];
    for (int i = 0; i < NUMBER_COUNT; i++) {
        kdr_text_skip_blank_lines(&text);
        kdr_text before = text;
        double number;
        if (!kdr_text_take_double(&text, &number) || !isfinite((float)number))
            return kdr_report(logger, KDR_ERROR_INVALID_DATA,
                              "%s: expected a finite number for %s (number %d of %d), found %s", path, number_names[i],
                              i + 1, NUMBER_COUNT, kdr_text_found(&before, found));
        numbers[i] = (float)number;
    }
    if (kdr_text_skip_blank_lines(&text))
        return kdr_report(logger, KDR_ERROR_INVALID_DATA, "%s: expected the end after %d numbers, found %s", path,
                          NUMBER_COUNT, kdr_text_found(&text, found));
    if (!(numbers[FIELD_OF_VIEW] > 0 && numbers[FIELD_OF_VIEW] < 180))
        return kdr_report(logger, KDR_ERROR_INVALID_DATA,
                          "%s: expected a field of view between 0 and 180 degrees (number %d of %d), found %g", path,
                          FIELD_OF_VIEW + 1, NUMBER_COUNT, (double)numbers[FIELD_OF_VIEW]);
    return KDR_OK;
}

kdr_status kdr_camera_read(const char *path, const kdr_logger *logger, kdr_camera *camera, float light[3]) {
    if (!path || !camera || !light)
        return kdr_report(logger, KDR_ERROR_INVALID_ARGUMENT,
                          "reading a camera needs a file name and room for a camera and a light");
    kdr_file_bytes file;
    kdr_status status = kdr_file_bytes_open(path, logger, &file);
    if (status != KDR_OK)
        return status;
    const char *start = (const char *)file.bytes;
    float numbers[NUMBER_COUNT];
    status = parse(path, (kdr_text){.p = start, .end = start + file.length, .line = 1}, logger, numbers);
    kdr_file_bytes_release(&file);
    if (status != KDR_OK)
        return status;
    memcpy(camera->eye, numbers, sizeof(camera->eye));
    memcpy(camera->target, numbers + 3, sizeof(camera->target));
    memcpy(camera->up, numbers + 6, sizeof(camera->up));
    camera->fov = numbers[FIELD_OF_VIEW];
    memcpy(light, numbers + 10, 3 * sizeof(float));
    return KDR_OK;
}
