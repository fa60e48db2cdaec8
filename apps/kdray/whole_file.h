/* Files that appear whole under their name, or not at all. */
#ifndef KDR_APPS_KDRAY_WHOLE_FILE_H
#define KDR_APPS_KDRAY_WHOLE_FILE_H

#include <kdray/render.h>
#include <stdio.h>

/* Finds out, before hours of work, whether a file of this name can be made; leaves nothing behind.
 * False after a sentence to the logger. */
bool kdr_whole_file_possible(const char *path, const kdr_logger *logger);

typedef void kdr_whole_file_fn(FILE *out, const void *context);

/* Writes what write_to(out, context) prints under the name, in place of what is there. What is no regular file, such as
 * a terminal or a pipe, is written to as it is. False after a sentence to the logger; what was there then still is. */
bool kdr_whole_file_write(const char *path, kdr_whole_file_fn *write_to, const void *context, const kdr_logger *logger);

#endif
