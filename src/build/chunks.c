#include "build/chunks.h"

#include <string.h>

bool kdr_chunks_init(kdr_chunks *chunks, kdr_alloc *alloc, size_t chunk_bytes, uint32_t capacity) {
    *chunks = (kdr_chunks){.chunk_bytes = chunk_bytes, .capacity = capacity};
    chunks->table = kdr_alloc_array(alloc, capacity, sizeof *chunks->table, 64);
    chunks->bytes = kdr_alloc_array(alloc, capacity, sizeof *chunks->bytes, 64);
    if (!chunks->table || !chunks->bytes) {
        kdr_chunks_release(chunks, alloc);
        return false;
    }
    memset(chunks->table, 0, capacity * sizeof *chunks->table);
    memset(chunks->bytes, 0, capacity * sizeof *chunks->bytes);
    return true;
}

/* Chunks that may have memory. No worker may be using them. */
static uint32_t touched(const kdr_chunks *chunks) {
    uint32_t used = atomic_load_explicit(&chunks->used, memory_order_relaxed);
    uint32_t most = used > chunks->touched ? used : chunks->touched;
    return most < chunks->capacity ? most : chunks->capacity;
}

void kdr_chunks_trim(kdr_chunks *chunks, kdr_alloc *alloc) {
    for (uint32_t i = 0, count = touched(chunks); i < count; i++) {
        if (chunks->bytes[i] > 0)
            kdr_alloc_release(alloc, chunks->table[i], chunks->bytes[i]);
        chunks->table[i] = NULL;
        chunks->bytes[i] = 0;
    }
    atomic_store_explicit(&chunks->used, 0, memory_order_relaxed);
    chunks->touched = 0;
}

void kdr_chunks_release(kdr_chunks *chunks, kdr_alloc *alloc) {
    if (chunks->table && chunks->bytes)
        kdr_chunks_trim(chunks, alloc);
    kdr_alloc_release(alloc, chunks->table, chunks->capacity * sizeof *chunks->table);
    kdr_alloc_release(alloc, chunks->bytes, chunks->capacity * sizeof *chunks->bytes);
    *chunks = (kdr_chunks){0};
}

void kdr_chunks_reset(kdr_chunks *chunks, kdr_alloc *alloc) {
    chunks->touched = touched(chunks);
    for (uint32_t i = 0; i < chunks->touched; i++) {
        if (chunks->bytes[i] != chunks->chunk_bytes) {
            kdr_alloc_release(alloc, chunks->bytes[i] > 0 ? chunks->table[i] : NULL, chunks->bytes[i]);
            chunks->table[i] = NULL;
            chunks->bytes[i] = 0;
        }
    }
    atomic_store_explicit(&chunks->used, 0, memory_order_relaxed);
}

bool kdr_chunks_take(kdr_chunks *chunks, kdr_alloc *alloc, uint32_t count, uint32_t *first) {
    if (count > chunks->capacity)
        return false;
    uint32_t at = atomic_fetch_add_explicit(&chunks->used, count, memory_order_relaxed);
    if (at > chunks->capacity - count) {
        atomic_store_explicit(&chunks->used, chunks->capacity, memory_order_relaxed);
        return false;
    }
    *first = at;
    if (count == 1 && chunks->table[at])
        return true;

    /* A run replaces kept single chunks by one allocation. */
    char *memory = kdr_alloc_array(alloc, count, chunks->chunk_bytes, 64);
    if (!memory)
        return false;
    for (uint32_t i = 0; i < count; i++) {
        kdr_alloc_release(alloc, chunks->bytes[at + i] > 0 ? chunks->table[at + i] : NULL, chunks->bytes[at + i]);
        chunks->table[at + i] = memory + i * chunks->chunk_bytes;
        chunks->bytes[at + i] = i == 0 ? count * chunks->chunk_bytes : 0;
    }
    return true;
}
