/* A stack of bytes in chunks: memory that is given back in the reverse order of its taking, and kept between builds.
 *
 * Source: M. Shevtsov, A. Soupikov, A. Kapustin, "Highly Parallel Fast KD-tree Construction for Interactive Ray Tracing
 * of Dynamic Scenes", 2007, section 3.5: linked chunks, a request shifts the end pointer, a return shifts it back.
 * Cost: a few instructions a request; a chunk is allocated only when none that is kept fits.
 * One arena belongs to one worker at a time. */
#ifndef KDR_BASE_ARENA_H
#define KDR_BASE_ARENA_H

#include "base/alloc.h"

typedef struct kdr_arena_chunk kdr_arena_chunk;

typedef struct kdr_arena {
    kdr_alloc *alloc;
    kdr_arena_chunk *first; /* chunks in the order of use; those after `last` are empty and kept */
    kdr_arena_chunk *last;  /* the one in use; NULL before the first request */
    size_t chunk_size;      /* least size of a new chunk */
} kdr_arena;

typedef struct kdr_arena_mark {
    kdr_arena_chunk *chunk;
    size_t used;
} kdr_arena_mark;

void kdr_arena_init(kdr_arena *arena, kdr_alloc *alloc, size_t chunk_size);
void kdr_arena_destroy(kdr_arena *arena); /* gives every chunk back */

/* 64-byte aligned; NULL when there is no memory. */
void *kdr_arena_get(kdr_arena *arena, size_t size);

/* Everything taken after the mark is returned at once. */
kdr_arena_mark kdr_arena_save(const kdr_arena *arena);
void kdr_arena_restore(kdr_arena *arena, kdr_arena_mark mark);

#endif
