/* The room's door to the memory that meshes and images share. */
#ifndef KDR_RENDER_MEMORY_H
#define KDR_RENDER_MEMORY_H

#include "mesh/mesh_memory.h"

/* NULL when there is no memory, or count * size does not fit. Contents are undefined. */
static inline void *kdr_render_get(size_t count, size_t size) {
    return kdr_alloc_array(kdr_mesh_memory(), count, size, KDR_MESH_ALIGNMENT);
}

/* memory NULL is allowed; size is that of the whole request. */
static inline void kdr_render_release(void *memory, size_t size) { kdr_alloc_release(kdr_mesh_memory(), memory, size); }

#endif
