/* glTF and GLB files that move. */
#ifndef KDR_MESH_GLTF_ANIMATION_H
#define KDR_MESH_GLTF_ANIMATION_H

#include "mesh/animation_source.h"
#include "mesh/source.h"

/* Opens a file, gzipped or not, and plays its first animation: nodes, skins and morph weights. A file without one has
 * a duration of 0. The file is not needed any more after this. The first sample makes the mesh; the later ones ask for
 * no memory and change positions and normals alone. A time outside of the animation is its nearest end.
 * Errors, each with a sentence: IO, INVALID_DATA, UNSUPPORTED, LIMIT, OUT_OF_MEMORY; of a sample INVALID_ARGUMENT (a
 * time that is NaN), OUT_OF_MEMORY, INVALID_DATA (a vertex that moves out of the floats' range; it lies in the origin).
 */
kdr_status kdr_gltf_animation_open(const char *path, const kdr_logger *logger, kdr_animation_source *out);

/* The same for bytes in memory, which are not gzipped. */
kdr_status kdr_gltf_animation_open_source(const kdr_source *source, kdr_animation_source *out);

#endif
