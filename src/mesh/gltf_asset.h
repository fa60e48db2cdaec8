/* The numbers of a glTF file, at rest in memory: buffers copied or decoded, accessors as strided arrays.
 *
 * A buffer is the GLB's binary chunk, a data: URI or a file beside the source. An accessor is opened when something
 * asks for it: its place and its numbers are checked once, sparse values are merged into a copy of their own. */
#ifndef KDR_MESH_GLTF_ASSET_H
#define KDR_MESH_GLTF_ASSET_H

#include "mesh/gltf_check.h"
#include "mesh/gltf_store.h"

/* The values of an accessor. bytes NULL: not opened. */
typedef struct kdr_gltf_values {
    const unsigned char *bytes;
    size_t count, stride;
    uint32_t component, width;
    bool is_normalized; /* whole numbers stand for 0..1 or -1..1 */
} kdr_gltf_values;

typedef struct kdr_gltf_asset {
    kdr_gltf gltf; /* gone after kdr_gltf_asset_forget_file; all else stays */
    kdr_gltf_store store;
    const unsigned char **buffers;
    kdr_gltf_values *values;                        /* one an accessor */
    const kdr_json_value **objects[KDR_GLTF_LISTS]; /* the lists of the root as arrays */
    uint64_t dense_bytes;                           /* copies of sparse accessors */
    uint64_t buffer_bytes;                          /* all buffers together */
} kdr_gltf_asset;

/* Checks the file and reads its buffers. Errors: those of kdr_gltf_check, IO (a file beside it). Release in any case.
 */
kdr_status kdr_gltf_asset_open(const kdr_source *source, kdr_gltf_asset *out);

/* Lets go of the source and its JSON. */
void kdr_gltf_asset_forget_file(kdr_gltf_asset *asset);
void kdr_gltf_asset_release(kdr_gltf_asset *asset);

/* Reads the buffers; part of kdr_gltf_asset_open. */
kdr_status kdr_gltf_read_buffers(kdr_gltf_asset *asset);

/* Makes asset->values[accessor] usable: floats are finite from here on. Errors: INVALID_DATA, LIMIT, OUT_OF_MEMORY. */
kdr_status kdr_gltf_open_values(kdr_gltf_asset *asset, uint32_t accessor);

/* `count` numbers of an array of the object; `otherwise` where it is left out. Errors: INVALID_DATA (another count,
 * no number, none that a float holds). */
kdr_status kdr_gltf_read_numbers(const kdr_gltf_asset *asset, const kdr_json_value *object, const char *key,
                                 size_t count, const double *otherwise, double *out);

static inline const kdr_json_value *kdr_gltf_find(const kdr_gltf_asset *asset, const kdr_json_value *object,
                                                  const char *key) {
    return kdr_json_find(&asset->gltf.json, object, key);
}

/* A whole number as it is stored, little endian; element below count, component below width. */
uint32_t kdr_gltf_whole(const kdr_gltf_values *values, size_t element, uint32_t component);

/* A number as a float, normalized where the accessor says so. */
float kdr_gltf_number(const kdr_gltf_values *values, size_t element, uint32_t component);

/* The first three numbers of an element. */
void kdr_gltf_vector(const kdr_gltf_values *values, size_t element, float out[3]);

#endif
