/* Options of every command that makes pictures: their size, the view, lights and the box. A window has those of the
 * camera: view and lights. */
#ifndef KDR_APPS_KDRAY_PICTURE_OPTIONS_H
#define KDR_APPS_KDRAY_PICTURE_OPTIONS_H

#include "messages.h"

#include <argp.h>
#include <kdray/render.h>

typedef struct kdr_picture_options {
    uint32_t width, height;
    bool size_given;
    kdr_camera camera; /* the parts that are given */
    bool eye_given, target_given, up_given, fov_given;
    const char *view; /* NULL: the model's own */
    float lights[KDR_MAX_LIGHTS][3];
    uint32_t light_count; /* 0: the view's or the model's */
    bool box;
    const char *texture; /* NULL: a checkerboard */
    uint32_t samples;
    uint64_t seed;
} kdr_picture_options;

/* Child parsers for argp; their input is a kdr_picture_options. The camera's options, and all of them. */
extern const struct argp kdr_camera_argp;
extern const struct argp kdr_picture_argp;

kdr_picture_options kdr_default_picture_options(void);

/* The picture that is asked for, camera and lights aside but for those of --view. False after a sentence: a file that
 * is named cannot be read. Names in it are those in options. */
bool kdr_picture_options_prepare(const kdr_picture_options *options, kdr_messages *messages, kdr_picture_def *picture);

/* Sets camera and lights for a model with that box {min x, y, z, max x, y, z}: its own or the view's, and each option
 * replaces its own part. */
void kdr_picture_options_look(const kdr_picture_options *options, const float bounds[6], kdr_picture_def *picture);

#endif
