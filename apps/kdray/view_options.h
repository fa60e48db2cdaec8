/* What `kdray view` is asked for. */
#ifndef KDR_APPS_KDRAY_VIEW_OPTIONS_H
#define KDR_APPS_KDRAY_VIEW_OPTIONS_H

#include "picture_options.h"
#include "tree_options.h"
#include "view_show.h"

typedef struct kdr_view_options {
    const char *file;
    const char *screenshot; /* of the last picture; NULL: none */
    uint64_t frames;        /* that are shown before it quits; 0: it does not */
    double rate;            /* frames a second */
    bool paused, quiet;
    kdr_view_show show;
    kdr_picture_options picture;
    kdr_tree_options tree;
} kdr_view_options;

/* Reads the command line; wrong usage and --help end the program. Names in options are those in argv. */
void kdr_view_options_parse(int argc, char **argv, kdr_view_options *options);

#endif
