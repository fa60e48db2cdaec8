/* What `kdray render` is asked for. */
#ifndef KDR_APPS_KDRAY_RENDER_OPTIONS_H
#define KDR_APPS_KDRAY_RENDER_OPTIONS_H

#include "output.h"
#include "tree_options.h"

typedef struct kdr_render_options {
    const char *file;
    const char *output; /* NULL: no picture is written */
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
    const char *compare; /* NULL: nothing */
    double threshold;
    bool time_given;
    double time; /* seconds into a file's animation */
    bool stats, quiet;
    kdr_tree_options tree;
} kdr_render_options;

/* Reads the command line; wrong usage and --help end the program. Names in options are those in argv. */
void kdr_render_options_parse(int argc, char **argv, kdr_render_options *options);

#endif
