#include "mesh/mesh_memory.h"

#include "base/check.h"
#include "kdray/render.h"

#include <pthread.h>
#include <string.h>

static kdr_alloc memory;
static pthread_once_t once = PTHREAD_ONCE_INIT;

static void begin(void) { kdr_alloc_init(&memory, NULL); }

kdr_alloc *kdr_mesh_memory(void) {
    pthread_once(&once, begin);
    return &memory;
}

void kdr_mesh_memory_replace(const kdr_allocator *functions) {
    kdr_alloc *alloc = kdr_mesh_memory();
    KDR_CHECK(atomic_load(&alloc->bytes) == 0);
    kdr_alloc_init(alloc, functions);
}

size_t kdr_render_bytes(void) { return atomic_load(&kdr_mesh_memory()->bytes); }

bool kdr_mesh_buffer_grow(kdr_buffer *buffer, size_t kept, size_t size) {
    if (size <= buffer->capacity)
        return true;
    size_t larger = buffer->capacity + buffer->capacity / 2, capacity = size > larger ? size : larger;
    void *fresh = kdr_alloc_get(kdr_mesh_memory(), capacity, KDR_MESH_ALIGNMENT);
    if (!fresh)
        return false;
    if (kept)
        memcpy(fresh, buffer->memory, kept);
    kdr_alloc_release(kdr_mesh_memory(), buffer->memory, buffer->capacity);
    *buffer = (kdr_buffer){fresh, capacity};
    return true;
}
