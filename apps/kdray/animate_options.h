/* What `kdray animate` is asked for. */
#ifndef KDR_APPS_KDRAY_ANIMATE_OPTIONS_H
#define KDR_APPS_KDRAY_ANIMATE_OPTIONS_H

#include "picture_options.h"
#include "tree_options.h"

typedef struct kdr_animate_options {
    const char *file;
    const char *output; /* a pattern of names; NULL: no pictures are written */
    const char *video;  /* NULL: none */
    const char *csv;    /* NULL: none */
    bool frames_given;
    uint64_t first, last; /* numbers of frames */
    double rate;          /* frames a second */
    bool resume, quiet;
    kdr_picture_options picture;
    kdr_tree_options tree;
} kdr_animate_options;

/* Reads the command line; wrong usage and --help end the program. Names in options are those in argv. */
void kdr_animate_options_parse(int argc, char **argv, kdr_animate_options *options);

#endif
