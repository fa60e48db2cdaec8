/* Something that moves: a mesh for every time. */
#ifndef KDR_MESH_ANIMATION_SOURCE_H
#define KDR_MESH_ANIMATION_SOURCE_H

#include "kdray/render.h"

/* sample: *mesh is NULL at first, and then the mesh of the last sample, which may be written over; the caller destroys
 * it. destroy: allowed while meshes of the source are still in use. One thread at a time. */
typedef struct kdr_animation_source {
    void *state;
    double duration; /* seconds */
    kdr_status (*sample)(void *state, double seconds, const kdr_logger *logger, kdr_mesh **mesh);
    void (*destroy)(void *state);
} kdr_animation_source;

#endif
