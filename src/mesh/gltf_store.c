#include "mesh/gltf_store.h"

#include "mesh/mesh_memory.h"

#include <string.h>

/* Stands before each piece, in a cache line of its own. */
struct kdr_gltf_block {
    _Alignas(KDR_MESH_ALIGNMENT) kdr_gltf_block *older;
    size_t bytes; /* this header included */
};

void *kdr_gltf_take(kdr_gltf_store *store, size_t count, size_t size) {
    size_t bytes;
    if (__builtin_mul_overflow(count, size, &bytes) || __builtin_add_overflow(bytes, sizeof(kdr_gltf_block), &bytes))
        return NULL;
    kdr_gltf_block *block = kdr_alloc_get(kdr_mesh_memory(), bytes, KDR_MESH_ALIGNMENT);
    if (!block)
        return NULL;
    memset(block, 0, bytes);
    block->older = store->newest;
    block->bytes = bytes;
    store->newest = block;
    return block + 1;
}

void kdr_gltf_store_release(kdr_gltf_store *store) {
    while (store->newest) {
        kdr_gltf_block *block = store->newest;
        store->newest = block->older;
        kdr_alloc_release(kdr_mesh_memory(), block, block->bytes);
    }
}
