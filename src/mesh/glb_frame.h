/* The frame of a GLB file, read and checked before assimp believes its lengths. */
#ifndef KDR_MESH_GLB_FRAME_H
#define KDR_MESH_GLB_FRAME_H

#include "mesh/source.h"

bool kdr_source_is_glb(const kdr_source *source);

/* Where the parts of a GLB lie, bytes from its beginning. */
typedef struct kdr_glb_frame {
    size_t json_begin, json_end;
    size_t binary_begin, binary_length; /* length 0: no binary chunk */
} kdr_glb_frame;

/* Walks header and chunks: every length must fit into the file. Errors: INVALID_DATA with the byte of the length,
 * UNSUPPORTED (a version other than 2). */
kdr_status kdr_glb_read_frame(const kdr_source *source, kdr_glb_frame *out);

#endif
