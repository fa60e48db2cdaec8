/* MD2 models that move. */
#ifndef KDR_MESH_MD2_ANIMATION_H
#define KDR_MESH_MD2_ANIMATION_H

#include "mesh/animation_source.h"

/* Opens a file and plays its keyframes, ten a second, along straight lines from one to the next. A file with one
 * keyframe has a duration of 0. A time outside of the animation is its nearest end.
 * Errors, each with a sentence: IO, INVALID_DATA, UNSUPPORTED, OUT_OF_MEMORY; of a sample also those. */
kdr_status kdr_md2_animation_open(const char *path, const kdr_logger *logger, kdr_animation_source *out);

#endif
