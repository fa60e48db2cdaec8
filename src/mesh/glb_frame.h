/* The frame of a GLB file, checked before assimp believes its lengths. */
#ifndef KDR_MESH_GLB_FRAME_H
#define KDR_MESH_GLB_FRAME_H

#include "mesh/source.h"

bool kdr_source_is_glb(const kdr_source *source);

/* Walks header and chunks: every length must fit into the file. Errors: INVALID_DATA with the byte of the length,
 * UNSUPPORTED (a version other than 1 and 2). */
kdr_status kdr_glb_check_frame(const kdr_source *source);

#endif
