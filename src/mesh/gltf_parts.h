/* What a glTF scene shows: primitives of triangles, placed by nodes, one after the other in one mesh. */
#ifndef KDR_MESH_GLTF_PARTS_H
#define KDR_MESH_GLTF_PARTS_H

#include "mesh/gltf_nodes.h"

/* Joints of one vertex: two attributes of four. */
#define KDR_GLTF_JOINT_SETS 2

typedef struct kdr_gltf_skin {
    uint32_t *joints; /* nodes */
    size_t count;
    double (*binds)[12];     /* inverse bind matrices, 3 rows of 4 */
    float (*transforms)[12]; /* of the present pose: a joint's world transform times its bind matrix */
} kdr_gltf_skin;

typedef struct kdr_gltf_target {
    uint32_t positions, normals; /* accessors of what is added; KDR_INVALID_ID: none */
} kdr_gltf_target;

typedef struct kdr_gltf_part {
    uint32_t node;
    uint32_t skin;               /* KDR_INVALID_ID: the node's transform moves it */
    uint32_t positions, normals; /* accessors; normals KDR_INVALID_ID: none */
    uint32_t joints[KDR_GLTF_JOINT_SETS], weights[KDR_GLTF_JOINT_SETS];
    size_t joint_sets;
    kdr_gltf_target *targets;
    size_t target_count;
    size_t first_vertex, vertex_count;
} kdr_gltf_part;

typedef struct kdr_gltf_parts {
    kdr_gltf_part *parts;
    size_t count;
    kdr_gltf_skin *skins;
    size_t skin_count;
    size_t most_targets; /* of one part */
} kdr_gltf_parts;

/* Finds the parts of the shown nodes, checks their numbers and makes the mesh: triangles and materials as they stay,
 * positions and normals undefined. Nodes are placed: what they mirror is turned round. *mesh NULL on failure. */
kdr_status kdr_gltf_parts_open(kdr_gltf_asset *asset, const kdr_gltf_nodes *nodes, kdr_gltf_parts *out,
                               kdr_mesh **mesh);

/* Reads all skins; part of kdr_gltf_parts_open. */
kdr_status kdr_gltf_read_skins(kdr_gltf_asset *asset, kdr_gltf_parts *out);

/* Writes positions and normals, unit length, for the present state of the nodes. is_missing has room for each vertex,
 * moved_targets for most_targets. False: a position is infinite or NaN; it then lies in the origin. */
bool kdr_gltf_pose(const kdr_gltf_asset *asset, const kdr_gltf_nodes *nodes, const kdr_gltf_parts *parts,
                   bool *is_missing, size_t *moved_targets, kdr_mesh *mesh);

#endif
