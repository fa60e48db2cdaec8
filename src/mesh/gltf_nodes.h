/* The nodes of a glTF file: a forest of transforms, parents before children. */
#ifndef KDR_MESH_GLTF_NODES_H
#define KDR_MESH_GLTF_NODES_H

#include "mesh/gltf_asset.h"

typedef struct kdr_gltf_node {
    uint32_t parent, mesh, skin; /* KDR_INVALID_ID: none */
    bool has_matrix;
    double translation[3], rotation[4], scale[3]; /* a quaternion x, y, z, w of any length but 0 */
    double matrix[12];                            /* 3 rows of 4, where has_matrix */
    double world[12];                             /* 3 rows of 4 */
    double *weights;                              /* of the mesh's morph targets */
    size_t weight_count;
} kdr_gltf_node;

typedef struct kdr_gltf_nodes {
    kdr_gltf_node *nodes;
    size_t count;
    uint32_t *order;    /* all of them, parents first */
    size_t shown_count; /* the first of the order lie in the scene that is shown, as a walk in depth meets them */
} kdr_gltf_nodes;

/* Reads all nodes as the file has them at rest; the scene is the file's own choice or its first, or all nodes where
 * there is none. Memory lies in the asset. */
kdr_status kdr_gltf_nodes_open(kdr_gltf_asset *asset, kdr_gltf_nodes *out);

/* Makes the world transforms of all nodes from their local ones. */
void kdr_gltf_nodes_place(kdr_gltf_nodes *nodes);

/* a times b, both 3 rows of 4 with a fourth of 0, 0, 0, 1; out is neither. */
void kdr_gltf_multiply(const double a[12], const double b[12], double out[12]);

/* 16 numbers in columns, as glTF writes them, to 3 rows of 4. */
void kdr_gltf_transpose(const double columns[16], double rows[12]);

#endif
