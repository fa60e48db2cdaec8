/* The first animation of a glTF file: tracks that move nodes and morph weights. */
#ifndef KDR_MESH_GLTF_MOTION_H
#define KDR_MESH_GLTF_MOTION_H

#include "mesh/gltf_nodes.h"

typedef struct kdr_gltf_track kdr_gltf_track;

typedef struct kdr_gltf_motion {
    kdr_gltf_track *tracks;
    size_t count;
    double duration; /* the last time of all tracks, seconds; 0: nothing moves */
} kdr_gltf_motion;

/* Reads the tracks. Errors: INVALID_DATA (times that do not ascend, a wrong number of values, ...). */
kdr_status kdr_gltf_motion_open(kdr_gltf_asset *asset, const kdr_gltf_nodes *nodes, kdr_gltf_motion *out);

/* Sets what the tracks move to its state at a time; before the first key and behind the last it stands still.
 * kdr_gltf_nodes_place then makes the transforms. */
void kdr_gltf_motion_apply(const kdr_gltf_motion *motion, const kdr_gltf_asset *asset, double seconds,
                           kdr_gltf_nodes *nodes);

#endif
