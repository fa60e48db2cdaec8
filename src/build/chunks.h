/* Growing arrays in chunks of equal size: element i lies in chunk i / length, and never moves.
 *
 * Any number of workers take whole chunks with one atomic add and fill them alone. Chunks are kept from build to build.
 * Source: the pools of section 3.5 of the 2007 paper, made addressable by index. */
#ifndef KDR_BUILD_CHUNKS_H
#define KDR_BUILD_CHUNKS_H

#include "base/alloc.h"

typedef struct kdr_chunks {
    size_t chunk_bytes;
    uint32_t capacity;     /* chunks that the table has room for */
    _Atomic uint32_t used; /* chunks taken in this build */
    uint32_t touched;      /* chunks that may have memory: the most ever taken, up to the last reset */
    void **table;          /* NULL entries have no memory yet */
    size_t *bytes;         /* of the allocation that begins at an entry; 0 inside a larger one */
} kdr_chunks;

/* False when there is no memory. */
bool kdr_chunks_init(kdr_chunks *chunks, kdr_alloc *alloc, size_t chunk_bytes, uint32_t capacity);
void kdr_chunks_release(kdr_chunks *chunks, kdr_alloc *alloc);

/* Forgets all contents; memory of single chunks is kept. No worker may be using them. */
void kdr_chunks_reset(kdr_chunks *chunks, kdr_alloc *alloc);

/* Gives back the memory of all chunks. No worker may be using them. */
void kdr_chunks_trim(kdr_chunks *chunks, kdr_alloc *alloc);

/* Takes `count` chunks that lie behind one another in memory; *first is the first one's number. False when there is no
 * memory or no room. Thread safe. */
bool kdr_chunks_take(kdr_chunks *chunks, kdr_alloc *alloc, uint32_t count, uint32_t *first);

#endif
