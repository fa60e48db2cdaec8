#include "base/alloc.h"

#include "base/check.h"
#include "base/system.h"

#include <stdlib.h>

#define LEAST_ALIGNMENT 16
#define MOST_ALIGNMENT 4096
#define BUFFER_ALIGNMENT 64

static void *default_allocate(size_t size, size_t alignment, void *user) {
    (void)user;
    if (size >= KDR_ALLOC_LARGE)
        return kdr_system_map(size);
    // Below the limit, so rounding up to a multiple of the alignment cannot overflow.
    if (alignment < LEAST_ALIGNMENT)
        alignment = LEAST_ALIGNMENT;
    return aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
}

static void default_release(void *memory, size_t size, void *user) {
    (void)user;
    if (size >= KDR_ALLOC_LARGE)
        kdr_system_unmap(memory, size);
    else
        free(memory);
}

void kdr_alloc_init(kdr_alloc *alloc, const kdr_allocator *functions) {
    if (functions && functions->allocate)
        alloc->functions = *functions;
    else
        alloc->functions = (kdr_allocator){default_allocate, default_release, NULL};
    atomic_init(&alloc->bytes, 0);
    atomic_init(&alloc->peak_bytes, 0);
}

void *kdr_alloc_get(kdr_alloc *alloc, size_t size, size_t alignment) {
    KDR_CHECK(alignment > 0 && alignment <= MOST_ALIGNMENT && (alignment & (alignment - 1)) == 0);
    if (size == 0)
        return NULL;
    void *memory = alloc->functions.allocate(size, alignment, alloc->functions.user);
    if (!memory)
        return NULL;

    // Numbers only: nothing is published through them, so no order is asked for.
    size_t bytes = atomic_fetch_add_explicit(&alloc->bytes, size, memory_order_relaxed) + size;
    size_t peak = atomic_load_explicit(&alloc->peak_bytes, memory_order_relaxed);
    while (peak < bytes && !atomic_compare_exchange_weak_explicit(&alloc->peak_bytes, &peak, bytes,
                                                                  memory_order_relaxed, memory_order_relaxed)) {
    }
    return memory;
}

void *kdr_alloc_array(kdr_alloc *alloc, size_t count, size_t size, size_t alignment) {
    size_t bytes;
    return kdr_size_mul(count, size, &bytes) ? kdr_alloc_get(alloc, bytes, alignment) : NULL;
}

void kdr_alloc_release(kdr_alloc *alloc, void *memory, size_t size) {
    if (!memory)
        return;
    size_t before = atomic_fetch_sub_explicit(&alloc->bytes, size, memory_order_relaxed);
    KDR_CHECK(before >= size);
    alloc->functions.release(memory, size, alloc->functions.user);
}

bool kdr_buffer_reserve(kdr_alloc *alloc, kdr_buffer *buffer, size_t size) {
    if (size <= buffer->capacity)
        return true;
    void *memory = kdr_alloc_get(alloc, size, BUFFER_ALIGNMENT);
    if (!memory)
        return false;
    kdr_alloc_release(alloc, buffer->memory, buffer->capacity);
    *buffer = (kdr_buffer){memory, size};
    return true;
}

void kdr_buffer_release(kdr_alloc *alloc, kdr_buffer *buffer) {
    kdr_alloc_release(alloc, buffer->memory, buffer->capacity);
    *buffer = (kdr_buffer){NULL, 0};
}
