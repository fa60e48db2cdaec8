/* The memory of kdray-render: one count for every mesh, image and table that the library holds. */
#ifndef KDR_MESH_MESH_MEMORY_H
#define KDR_MESH_MESH_MEMORY_H

#include "base/alloc.h"

/* The alignment of everything taken for meshes and images: one cache line. */
#define KDR_MESH_ALIGNMENT 64

/* The one alloc that meshes and images share; what it holds is what kdr_render_bytes reports. Thread safe. */
kdr_alloc *kdr_mesh_memory(void);

/* For tests: takes memory from `functions` from here on, NULL: kdray's own again.
 * Nothing may be held, and no other thread may be using the library. */
void kdr_mesh_memory_replace(const kdr_allocator *functions);

/* Makes room for `size` bytes in a buffer of this memory, growing geometrically; the first `kept` bytes stay.
 * False, and an unchanged buffer, when there is none. */
bool kdr_mesh_buffer_grow(kdr_buffer *buffer, size_t kept, size_t size);

#endif
