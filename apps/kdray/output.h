/* Text files that appear whole under their name or not at all, and what can be said of a name before the work. */
#ifndef KDR_APPS_KDRAY_OUTPUT_H
#define KDR_APPS_KDRAY_OUTPUT_H

#include "messages.h"

#include <limits.h>
#include <stdio.h>

/* True if a file could be written under this name now. False after a sentence. */
bool kdr_output_check(const char *path, kdr_messages *messages);

/* True if both names lead to the same file, there or not yet there. */
bool kdr_output_same(const char *a, const char *b);

typedef struct kdr_output {
    FILE *file;
    const char *path;
    char target[PATH_MAX];    /* the file's own name, symbolic links followed */
    char temporary[PATH_MAX]; /* written to first; empty: stdout, a device or a pipe, written to directly */
} kdr_output;

/* Opens a file for writing; "-" is stdout. False after a sentence. path must outlive the output. */
bool kdr_output_open(kdr_output *output, const char *path, kdr_messages *messages);

/* Closes it and gives it its name. False after a sentence, with nothing left behind. */
bool kdr_output_close(kdr_output *output, kdr_messages *messages);

#endif
