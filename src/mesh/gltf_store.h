/* Memory that lives as long as an open glTF file: taken piece by piece, given back at once. */
#ifndef KDR_MESH_GLTF_STORE_H
#define KDR_MESH_GLTF_STORE_H

#include <stddef.h>

typedef struct kdr_gltf_block kdr_gltf_block;

typedef struct kdr_gltf_store {
    kdr_gltf_block *newest;
} kdr_gltf_store;

/* Zeros, count * size bytes of them; never NULL for a size of 0. NULL: out of memory. */
void *kdr_gltf_take(kdr_gltf_store *store, size_t count, size_t size);
void kdr_gltf_store_release(kdr_gltf_store *store);

#endif
