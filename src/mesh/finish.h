/* The last step of every reader: a mesh that keeps the promises of kdr_mesh. */
#ifndef KDR_MESH_FINISH_H
#define KDR_MESH_FINISH_H

#include "mesh/source.h"

/* Drops triangles with a vertex that is NaN or infinite (counted in the mesh, told as a warning), moves such vertices
 * to the origin, makes normals unit length (one that is zero or not finite becomes the mean of the triangles around),
 * and trims. Indices must be below vertex_count. Errors: OUT_OF_MEMORY, told. */
kdr_status kdr_mesh_finish(kdr_mesh *mesh, const kdr_source *source);

#endif
