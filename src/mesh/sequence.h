/* Mesh files that are numbered, one a frame. */
#ifndef KDR_MESH_SEQUENCE_H
#define KDR_MESH_SEQUENCE_H

#include "mesh/animation_source.h"

/* True if the last part of the name has a # in it, which stands for a number. */
bool kdr_sequence_is_meant(const char *path);

/* Finds the files of a name with one run of #: those with a number in its place that has at least as many digits, with
 * zeros before it where it needs them. Each is shown for 1 / rate seconds; nothing is read before it is shown.
 * Errors, each with a sentence: IO (no such folder, no file), INVALID_DATA (a number is left out), INVALID_ARGUMENT
 * (two runs of #), LIMIT, OUT_OF_MEMORY. */
kdr_status kdr_sequence_open(const char *path, double rate, const kdr_logger *logger, kdr_animation_source *out);

#endif
