/* What `kdray render` is asked for. */
#ifndef KDR_APPS_KDRAY_RENDER_OPTIONS_H
#define KDR_APPS_KDRAY_RENDER_OPTIONS_H

#include "output.h"
#include "picture_options.h"
#include "tree_options.h"

typedef struct kdr_render_options {
    const char *file;
    const char *output;  /* NULL: no picture is written */
    const char *compare; /* NULL: nothing */
    double threshold;
    bool time_given;
    double time; /* seconds into a file's animation */
    bool stats, quiet;
    kdr_picture_options picture;
    kdr_tree_options tree;
} kdr_render_options;

/* Reads the command line; wrong usage and --help end the program. Names in options are those in argv. */
void kdr_render_options_parse(int argc, char **argv, kdr_render_options *options);

#endif
