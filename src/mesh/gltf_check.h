/* The JSON of a glTF file, checked before assimp follows its numbers. */
#ifndef KDR_MESH_GLTF_CHECK_H
#define KDR_MESH_GLTF_CHECK_H

#include "mesh/glb_frame.h"
#include "mesh/json.h"

/* Lists of the root; every other number in the file counts into one of them. */
typedef enum kdr_gltf_list {
    KDR_GLTF_BUFFERS,
    KDR_GLTF_VIEWS,
    KDR_GLTF_ACCESSORS,
    KDR_GLTF_IMAGES,
    KDR_GLTF_SAMPLERS,
    KDR_GLTF_TEXTURES,
    KDR_GLTF_MATERIALS,
    KDR_GLTF_MESHES,
    KDR_GLTF_SKINS,
    KDR_GLTF_CAMERAS,
    KDR_GLTF_NODES,
    KDR_GLTF_SCENES,
    KDR_GLTF_LISTS,
} kdr_gltf_list;

typedef struct kdr_gltf_view {
    uint64_t length, stride; /* bytes; stride 0: one after the other */
    uint64_t begin;          /* in the source; 0: in another file, or in text */
    uint64_t offset;         /* in its buffer */
    uint32_t buffer;
} kdr_gltf_view;

typedef struct kdr_gltf_accessor {
    uint64_t count;
    uint64_t begin;     /* in the source; 0: elsewhere, or changed by sparse values */
    uint64_t stride;    /* from one to the next, bytes */
    uint32_t component; /* 5126: float, ... */
    uint32_t width;     /* components of one: 1 to 4, 9, 16; 5 for matrices of 2 rows, to tell them from vectors */
    uint32_t view;      /* KDR_INVALID_ID: none, zeros where no sparse value stands */
    uint64_t offset;    /* in its view */
} kdr_gltf_accessor;

#define KDR_GLTF_BYTE 5120
#define KDR_GLTF_UBYTE 5121
#define KDR_GLTF_SHORT 5122
#define KDR_GLTF_USHORT 5123
#define KDR_GLTF_UINT 5125
#define KDR_GLTF_FLOAT 5126

typedef struct kdr_gltf {
    const kdr_source *source;
    kdr_json json;
    const kdr_json_value *root;
    uint64_t binary_begin;  /* of the GLB's binary chunk, in the source */
    uint64_t binary_length; /* 0: none */
    const kdr_json_value *lists[KDR_GLTF_LISTS];
    size_t counts[KDR_GLTF_LISTS];
    uint64_t *buffers; /* their lengths in bytes */
    kdr_gltf_view *views;
    kdr_gltf_accessor *accessors;
    kdr_buffer memory; /* of the three tables */
    bool is_own;       /* kdray plays it itself: what assimp alone cannot bear is sound */
} kdr_gltf;

/* INVALID_DATA with the byte of `value`. */
kdr_status kdr_gltf_fail(const kdr_gltf *gltf, const kdr_json_value *value, const char *expected);

/* A whole number of an object, `otherwise` where it is left out. Errors: INVALID_DATA (else, or over most). */
kdr_status kdr_gltf_read_whole(const kdr_gltf *gltf, const kdr_json_value *object, const char *key, uint64_t most,
                               uint64_t otherwise, uint64_t *out);

/* A number that counts into a list; KDR_INVALID_ID where it is left out. */
kdr_status kdr_gltf_read_reference(const kdr_gltf *gltf, const kdr_json_value *object, const char *key,
                                   kdr_gltf_list list, uint32_t *out);

/* A value that must itself be such a number. */
kdr_status kdr_gltf_check_reference(const kdr_gltf *gltf, const kdr_json_value *value, kdr_gltf_list list,
                                    uint32_t *out);

/* Meshes, nodes, skins and animations, once the tables of accessors are made. */
kdr_status kdr_gltf_check_meshes(const kdr_gltf *gltf);
kdr_status kdr_gltf_check_nodes(const kdr_gltf *gltf);
kdr_status kdr_gltf_check_motion(const kdr_gltf *gltf);

/* Checks the JSON and the vertex numbers of meshes in the frame of a GLB; of a .gltf, json_begin is 0 and there is no
 * binary chunk. Errors: INVALID_DATA, UNSUPPORTED, LIMIT, OUT_OF_MEMORY. */
kdr_status kdr_gltf_check(const kdr_source *source, const kdr_glb_frame *frame);

/* The same for a file that assimp does not see; the JSON and the tables stay, and point into the source. Strips and
 * fans may lie in any buffer, skins may have no matrices, an accessor may have sparse values only. Close in any case.
 */
kdr_status kdr_gltf_open(const kdr_source *source, const kdr_glb_frame *frame, kdr_gltf *out);
void kdr_gltf_close(kdr_gltf *gltf);

#endif
